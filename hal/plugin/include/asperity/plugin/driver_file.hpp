// A driver's file, opened once and judged before anything in it runs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "asperity/core/status.hpp"
#include "asperity/plugin/table_check.hpp"

namespace asperity::plugin {

/// Which users must not be able to write to a driver's file.
enum class file_trust : std::uint8_t {
  /// The file and every folder above it belong to root or to this user and nobody else may write to them.
  owner_only,
  /// Whatever file was named. For a person who tries a file of his own, such as the conformance kit.
  as_named,
};

/// Why a driver's file was not loaded.
struct load_failure {
  table_fault fault;
  error why;
};

/// An open descriptor of a file that was judged. What is loaded is the file behind the descriptor, whatever its name
/// means by then.
class driver_file {
 public:
  /// Opens a file and judges it: who may write to it and to the folders above it, and whether it is a shared object for
  /// this machine that exports the driver's function. Nothing in it runs. The file itself must not be a link; links
  /// among the folders are followed where only root and this user could have made them. A folder that all may write to
  /// is refused with its sticky bit too: who may add a file there may have added this one.
  [[nodiscard]] static result<driver_file> open(const std::filesystem::path& file,
                                                file_trust trust = file_trust::owner_only);
  /// The same, with the kind of fault told apart. @return nullopt where `failure` says why
  [[nodiscard]] static std::optional<driver_file> open(const std::filesystem::path& file, file_trust trust,
                                                       load_failure& failure);
  /// A descriptor that another process judged and handed over.
  [[nodiscard]] static driver_file adopt(int descriptor, std::filesystem::path file) {
    return {descriptor, std::move(file)};
  }

  driver_file(driver_file&& other) noexcept
      : descriptor_(std::exchange(other.descriptor_, -1)), file_(std::move(other.file_)) {}
  driver_file& operator=(driver_file&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    std::swap(file_, other.file_);
    return *this;
  }
  ~driver_file();

  [[nodiscard]] int descriptor() const noexcept { return descriptor_; }
  /// As it was named.
  [[nodiscard]] const std::filesystem::path& path() const noexcept { return file_; }

 private:
  driver_file(int descriptor, std::filesystem::path file) : descriptor_(descriptor), file_(std::move(file)) {}

  int descriptor_;
  std::filesystem::path file_;
};

}  // namespace asperity::plugin
