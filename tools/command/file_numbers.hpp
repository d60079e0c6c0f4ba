// Numbers in files, least significant byte first, and the checksum that ZIP and MCAP share.
#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace asperity::command {

/// Appends a number.
template <std::integral Number>
void put_number(std::string& out, Number value) {
  auto bits = static_cast<std::make_unsigned_t<Number>>(value);
  for (std::size_t i = 0; i < sizeof(Number); ++i) {
    out += static_cast<char>(static_cast<unsigned char>(bits & 0xffU));
    if constexpr (sizeof(Number) > 1) bits = static_cast<decltype(bits)>(bits >> 8U);
  }
}
inline void put_number(std::string& out, double value) { put_number(out, std::bit_cast<std::uint64_t>(value)); }

namespace detail {

[[nodiscard]] constexpr std::array<std::uint32_t, 256> crc32_table() {
  std::array<std::uint32_t, 256> out{};
  for (std::uint32_t i = 0; i < 256; ++i) {
    std::uint32_t c = i;
    for (int bit = 0; bit < 8; ++bit) c = (c & 1U) != 0 ? 0xedb88320U ^ (c >> 1U) : c >> 1U;
    out[i] = c;
  }
  return out;
}
inline constexpr std::array<std::uint32_t, 256> crc32_of_byte = crc32_table();

}  // namespace detail

/// CRC-32 of ISO 3309 (ZIP, PNG, MCAP), going on from the one of what came before; 0 at the beginning.
[[nodiscard]] constexpr std::uint32_t crc32(std::string_view bytes, std::uint32_t before = 0) noexcept {
  std::uint32_t c = ~before;
  for (const char b : bytes) c = detail::crc32_of_byte[(c ^ static_cast<unsigned char>(b)) & 0xffU] ^ (c >> 8U);
  return ~c;
}
static_assert(crc32("123456789") == 0xcbf43926U);

}  // namespace asperity::command
