// A session as a table: one row per device tick.
#pragma once

#include <filesystem>
#include <string>
#include <utility>

#include "asperity/control/session_record.hpp"
#include "output_file.hpp"

namespace asperity::command {

/// Header line of a recording, with the unit in every column's name.
[[nodiscard]] const std::string& recording_header();

/// Appends one line. Only what belongs to the session itself is written, never a measured time: the same session gives
/// the same bytes.
void append_row(std::string& out, const session_record& tick);

/// Writes rows as they come; the file appears under its name when close() is called.
class recording {
 public:
  /// Opens the file and writes the header. @return io_failed
  [[nodiscard]] static result<recording> create(const std::filesystem::path& file);

  /// @return io_failed
  [[nodiscard]] result<void> add(const session_record& tick);
  /// @return io_failed
  [[nodiscard]] result<void> close();

 private:
  explicit recording(output_file file) : file_(std::move(file)) {}
  [[nodiscard]] result<void> flush();

  output_file file_;
  std::string pending_;
};

}  // namespace asperity::command
