// One row of a recording: what a device tick has in numbers and in words.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "asperity/control/session_record.hpp"

namespace asperity::command {

inline constexpr std::size_t recorded_numbers = 34, recorded_words = 3;

/// Names of the columns, numbers first, with the unit in every number's name.
[[nodiscard]] const std::vector<std::string>& recording_columns();
/// The numbers of a row, and its words. Only what belongs to the session itself, never a measured time.
[[nodiscard]] std::array<double, recorded_numbers> numbers_of(const session_record& tick) noexcept;
[[nodiscard]] std::array<const char*, recorded_words> words_of(const session_record& tick) noexcept;

}  // namespace asperity::command
