#include "asperity/drivers/falcon/falcon_frame.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace asperity {
namespace {

constexpr std::uint8_t base = 0x41;
constexpr std::uint8_t opening = 0x3c;
constexpr std::uint8_t closing = 0x3e;

constexpr void put_word(std::int16_t word, std::span<std::uint8_t, 4> bytes) noexcept {
  const auto bits = static_cast<std::uint16_t>(word);
  for (std::size_t i = 0; i < 4; ++i) bytes[i] = static_cast<std::uint8_t>(base + ((bits >> (4 * i)) & 0xf));
}

// Nothing where a byte is not one of the sixteen that a number can have.
constexpr std::optional<std::int16_t> get_word(std::span<const std::uint8_t, 4> bytes) noexcept {
  std::uint16_t bits = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    if (bytes[i] < base || bytes[i] > base + 0xf) return std::nullopt;
    bits = static_cast<std::uint16_t>(bits | ((bytes[i] - base) << (4 * i)));
  }
  return static_cast<std::int16_t>(bits);
}

constexpr std::int16_t within_limit(std::int16_t counts) noexcept {
  constexpr auto limit = falcon_counts_limit;
  if (counts > limit) return limit;
  return counts < -limit ? static_cast<std::int16_t>(-limit) : counts;
}

}  // namespace

falcon_frame encode_falcon(const falcon_command& command) noexcept {
  falcon_frame bytes{};
  bytes[0] = opening;
  for (std::size_t i = 0; i < 3; ++i) {
    put_word(within_limit(command.motor_counts[i]), std::span(bytes).subspan(1 + 4 * i).first<4>());
  }
  const unsigned flags = (static_cast<unsigned>(command.light) & 0xeU) | (command.home ? 1U : 0U);
  bytes[13] = static_cast<std::uint8_t>(base + flags);
  bytes[14] = base;
  bytes[15] = closing;
  return bytes;
}

std::optional<falcon_command> decode_falcon_command(const falcon_frame& bytes) noexcept {
  if (bytes[0] != opening || bytes[15] != closing) return std::nullopt;
  if (bytes[13] < base || bytes[13] > base + 0xf || bytes[14] < base) return std::nullopt;
  falcon_command command;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto word = get_word(std::span(bytes).subspan(1 + 4 * i).first<4>());
    if (!word) return std::nullopt;
    command.motor_counts[i] = *word;
  }
  const unsigned flags = bytes[13] - unsigned{base};
  command.light = static_cast<falcon_light>(flags & 0xeU);
  command.home = (flags & 1U) != 0;
  return command;
}

std::optional<falcon_report> decode_falcon_report(const falcon_frame& bytes) noexcept {
  if (bytes[0] != opening || bytes[15] != closing) return std::nullopt;
  if (bytes[13] < base || bytes[13] > base + 0x7f || bytes[14] < base) return std::nullopt;
  falcon_report report;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto word = get_word(std::span(bytes).subspan(1 + 4 * i).first<4>());
    if (!word) return std::nullopt;
    report.encoder_counts[i] = *word;
  }
  const unsigned flags = bytes[13] - unsigned{base};
  report.buttons = static_cast<std::uint8_t>(flags & 0xfU);
  report.homed = static_cast<std::uint8_t>(flags >> 4U);
  return report;
}

falcon_frame encode_falcon_report(const falcon_report& report) noexcept {
  falcon_frame bytes{};
  bytes[0] = opening;
  for (std::size_t i = 0; i < 3; ++i) {
    put_word(report.encoder_counts[i], std::span(bytes).subspan(1 + 4 * i).first<4>());
  }
  const unsigned flags = (report.buttons & 0xfU) | ((report.homed & 7U) << 4U);
  bytes[13] = static_cast<std::uint8_t>(base + flags);
  bytes[14] = base;
  bytes[15] = closing;
  return bytes;
}

std::optional<falcon_frame> falcon_deframer::push(std::uint8_t byte) noexcept {
  if (byte == opening) {
    if (size_ != 0) ++broken_;
    bytes_[0] = byte;
    size_ = 1;
    return std::nullopt;
  }
  if (size_ == 0) return std::nullopt;
  bytes_[size_++] = byte;
  const bool full = size_ == falcon_frame_size;
  if (!full && byte != closing) return std::nullopt;
  size_ = 0;
  if (full && byte == closing) return bytes_;
  ++broken_;
  return std::nullopt;
}

}  // namespace asperity
