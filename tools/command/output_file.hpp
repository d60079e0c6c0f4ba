// A result that appears whole or not at all.
#pragma once

#include <filesystem>
#include <string_view>

#include "asperity/core/status.hpp"

namespace asperity::command {

/// A file that is written under a temporary name beside its destination and moved there by commit(); without a commit
/// nothing remains, unless the process is killed. The temporary name is io::create_beside()'s, and what is there
/// already keeps its mode, its owner where that is permitted, and the links to it. A destination that is a device or a
/// pipe is written directly, for it cannot be replaced. A pipe is waited for, for its reader and for room; once a
/// signal asked to stop, for a second at the most.
class output_file {
 public:
  /// Opens it now, so that an unwritable destination is found before the work and not after it.
  /// @return io_failed with the path and the reason | cancelled where a signal ended the wait for a pipe's reader
  [[nodiscard]] static result<output_file> create(const std::filesystem::path& destination);

  output_file(output_file&& other) noexcept;
  output_file& operator=(output_file&&) = delete;
  ~output_file();

  /// @return io_failed, for example where the disk is full | cancelled
  [[nodiscard]] result<void> write(std::string_view bytes);

  /// Whether it is a regular file, which appears with commit().
  [[nodiscard]] bool is_replaceable() const noexcept { return !temporary_.empty(); }

  /// Forgets what was written; a pipe keeps what it was given. @return io_failed
  [[nodiscard]] result<void> start_anew();

  /// Makes the file appear under its name. @return io_failed
  [[nodiscard]] result<void> commit();

 private:
  output_file(int descriptor, std::filesystem::path destination, std::filesystem::path temporary);

  int descriptor_;
  std::filesystem::path destination_;
  std::filesystem::path temporary_;  // empty where the destination is written directly
};

/// Proves that a regular file can be made at the destination, and leaves nothing there.
/// For results that a library function writes: it opens the file only when the long work is done.
[[nodiscard]] result<void> check_writable(const std::filesystem::path& destination);

/// Makes the folder, and those above it, where it is not there. @return io_failed with the path and the reason
[[nodiscard]] result<void> make_folder(const std::filesystem::path& folder);

}  // namespace asperity::command
