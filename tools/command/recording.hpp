// A session as a table: one row per device tick.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <utility>

#include "asperity/control/session_record.hpp"
#include "output_file.hpp"
#include "recorded_row.hpp"
#include "row_encoder.hpp"

namespace asperity::command {

/// Header line of a table.
[[nodiscard]] const std::string& recording_header();

/// Appends one line: the same session gives the same bytes.
void append_row(std::string& out, const session_record& tick);

/// Writes rows as they come; the file appears under its name when close() is called. The name says which format.
class recording {
 public:
  /// Opens the file and writes its beginning. @return io_failed | invalid_argument
  [[nodiscard]] static result<recording> create(const std::filesystem::path& file);

  /// @return io_failed | limit_exceeded
  [[nodiscard]] result<void> add(const session_record& tick);
  /// @return io_failed
  [[nodiscard]] result<void> close();

 private:
  recording(output_file file, std::filesystem::path name, std::unique_ptr<row_encoder> encoder)
      : file_(std::move(file)), name_(std::move(name)), encoder_(std::move(encoder)) {}
  [[nodiscard]] result<void> flush();

  output_file file_;
  std::filesystem::path name_;
  std::unique_ptr<row_encoder> encoder_;
  std::string pending_;
  bool closing_ = false;
};

}  // namespace asperity::command
