// Whole files in and out, and the sentence that says what is wrong with one.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <exception>
#include <filesystem>
#include <initializer_list>
#include <new>
#include <string>
#include <string_view>

#include "asperity/core/status.hpp"
#include "reading_watch.hpp"

namespace asperity::io {

static_assert(std::endian::native == std::endian::little, "asperity::io copies little-endian numbers as they stand");

/// Largest mesh file that is read, bytes.
inline constexpr std::uintmax_t max_mesh_bytes = std::uintmax_t{2} << 30;
/// Largest textured model that is read, bytes.
inline constexpr std::uintmax_t max_model_bytes = std::uintmax_t{256} << 20;

/// "file: what is wrong, where; how to mend it".
[[nodiscard]] error fault(error_code code, const std::filesystem::path& file, std::string_view what);

/// The message of a rejection with a mend at its end, where it has none of its own.
[[nodiscard]] std::string with_mend(std::string what, std::string_view mend);

/// A word from a file as it may stand in a message: in quotes, printable, at most 40 characters of it.
[[nodiscard]] std::string in_quotes(std::string_view word);

/// @return io_failed for what is absent, a directory or a device
[[nodiscard]] result<void> check_regular_file(const std::filesystem::path& file);

/// All bytes of a regular, non-empty file.
/// @return io_failed (absent, directory, device, unreadable), bad_format (empty), limit_exceeded
/// Throws rejection where the watch does.
[[nodiscard]] result<std::string> read_file(const std::filesystem::path& file, std::uintmax_t limit,
                                            const reading_watch& watch = {});

/// The same for a file below a folder. No link is followed on the way down, so nothing outside the folder is opened,
/// even where somebody changes the folder meanwhile.
/// @pre `name` is relative, normal and without ".."
/// @return as read_file(); io_failed for a link
[[nodiscard]] result<std::string> read_file_below(const std::filesystem::path& folder,
                                                  const std::filesystem::path& name, std::uintmax_t limit,
                                                  const reading_watch& watch = {});

/// Writes a file from parts, under another name beside it first: it appears whole or not at all.
/// @return io_failed; nothing is left behind
[[nodiscard]] result<void> write_file(const std::filesystem::path& file, std::initializer_list<std::string_view> parts);

/// Number of type T at an address of any alignment.
template <class T>
[[nodiscard]] T load_number(const char* at) noexcept {
  T value;
  std::memcpy(&value, at, sizeof value);
  return value;
}

/// Appends the bytes of a number.
template <class T>
void append_number(std::string& to, T value) {
  char bytes[sizeof value];
  std::memcpy(bytes, &value, sizeof value);
  to.append(bytes, sizeof value);
}

/// Runs a reader or writer; what it throws (memory, mostly) comes back as an error.
template <class Function>
[[nodiscard]] auto without_exceptions(const std::filesystem::path& file, Function&& body) -> decltype(body()) {
  try {
    return body();
  } catch (const rejection& r) {
    return fault(r.code, file, r.what);
  } catch (const std::bad_alloc&) {
    return fault(error_code::limit_exceeded, file, "does not fit into memory; use a smaller mesh");
  } catch (const std::exception& e) {
    return fault(error_code::io_failed, file,
                 std::string("cannot be processed: ") + e.what() + "; check the path and the free memory");
  }
}

/// Runs a reader; what it rejects comes back as an error with a mend.
template <class Function>
[[nodiscard]] auto refusing(const std::filesystem::path& file, std::string_view mend, Function&& body)
    -> decltype(body()) {
  try {
    return body();
  } catch (const rejection& r) {
    return fault(r.code, file, with_mend(r.what, mend));
  }
}

}  // namespace asperity::io
