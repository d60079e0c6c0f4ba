// A session as a table: one row per device tick.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "asperity/control/session_record.hpp"
#include "output_file.hpp"
#include "row_encoder.hpp"

namespace asperity::command {

inline constexpr std::size_t recorded_numbers = 34, recorded_words = 3;

/// Names of the columns, numbers first, with the unit in every number's name.
[[nodiscard]] const std::vector<std::string>& recording_columns();
/// Header line of a table.
[[nodiscard]] const std::string& recording_header();
/// The numbers of a row, and its words. Only what belongs to the session itself, never a measured time.
[[nodiscard]] std::array<double, recorded_numbers> numbers_of(const session_record& tick) noexcept;
[[nodiscard]] std::array<const char*, recorded_words> words_of(const session_record& tick) noexcept;

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
