// Service data: one object of a node's dictionary read or written, up to four bytes at once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "asperity/core/export.hpp"
#include "asperity/drivers/canopen/frames.hpp"

namespace asperity::canopen {

/// An entry of the object dictionary.
struct object_address {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  friend bool operator==(const object_address&, const object_address&) = default;
};

namespace abort_code {
inline constexpr std::uint32_t toggle = 0x05030000;
inline constexpr std::uint32_t timed_out = 0x05040000;
inline constexpr std::uint32_t unknown_command = 0x05040001;
inline constexpr std::uint32_t unsupported = 0x06010000;
inline constexpr std::uint32_t write_only = 0x06010001;
inline constexpr std::uint32_t read_only = 0x06010002;
inline constexpr std::uint32_t no_object = 0x06020000;
inline constexpr std::uint32_t not_mappable = 0x06040041;
inline constexpr std::uint32_t mapping_too_long = 0x06040042;
inline constexpr std::uint32_t wrong_length = 0x06070010;
inline constexpr std::uint32_t no_sub = 0x06090011;
inline constexpr std::uint32_t bad_value = 0x06090030;
inline constexpr std::uint32_t too_high = 0x06090031;
inline constexpr std::uint32_t too_low = 0x06090032;
inline constexpr std::uint32_t general = 0x08000000;
inline constexpr std::uint32_t not_storable = 0x08000020;
inline constexpr std::uint32_t local_control = 0x08000021;
inline constexpr std::uint32_t wrong_state = 0x08000022;
}  // namespace abort_code

/// A node's reason for refusing, in words.
/// @source CiA 301, section 7.2.4.3.17
[[nodiscard]] ASPERITY_API const char* abort_words(std::uint32_t code) noexcept;

/// Asks for an object.
[[nodiscard]] constexpr can_frame encode_upload_request(std::uint8_t node, object_address at) noexcept {
  can_frame f = empty_frame(sdo_request_id + node, 8);
  f.data[0] = 0x40;
  put(f, 1, at.index);
  f.data[3] = at.sub;
  return f;
}

/// Writes an object of 1, 2 or 4 bytes. @pre size is one of them
[[nodiscard]] constexpr can_frame encode_download_request(std::uint8_t node, object_address at, std::uint32_t value,
                                                          std::uint8_t size) noexcept {
  can_frame f = empty_frame(sdo_request_id + node, 8);
  f.data[0] = static_cast<std::uint8_t>(0x23 | ((4 - size) << 2));
  put(f, 1, at.index);
  f.data[3] = at.sub;
  for (std::size_t i = 0; i < size; ++i) f.data[4 + i] = static_cast<std::uint8_t>(value >> (8 * i));
  return f;
}

/// A request to a node.
struct sdo_request {
  bool write = false;
  object_address at{};
  std::uint32_t value = 0;
  std::uint8_t size = 0;  ///< of a write; 0 where the request does not say
};
/// A request to that node; nothing where it is none that fits into one frame.
[[nodiscard]] constexpr std::optional<sdo_request> decode_request(const can_frame& f, std::uint8_t node) noexcept {
  if (!is_plain(f) || f.id != sdo_request_id + node || f.size != 8) return std::nullopt;
  sdo_request r;
  r.at = {get<std::uint16_t>(f, 1), f.data[3]};
  if (f.data[0] == 0x40) return r;
  if ((f.data[0] & 0xe2) != 0x22) return std::nullopt;  // expedited download
  r.write = true;
  r.size = (f.data[0] & 1) != 0 ? static_cast<std::uint8_t>(4 - ((f.data[0] >> 2) & 3)) : std::uint8_t{0};
  for (std::size_t i = 0; i < (r.size == 0 ? 4U : r.size); ++i) r.value |= std::uint32_t{f.data[4 + i]} << (8 * i);
  return r;
}

/// A node's answer.
struct sdo_response {
  enum class kind : std::uint8_t {
    written,
    value,
    aborted,
    other,  ///< longer than four bytes, or nothing that was asked for
  };
  kind what = kind::other;
  object_address at{};
  std::uint32_t value = 0;  ///< the object's, zero-extended, or the reason for aborting
  std::uint8_t size = 0;    ///< bytes of the object; 0 where the node does not say
};
/// An answer of that node; nothing where the frame is none.
[[nodiscard]] constexpr std::optional<sdo_response> decode_response(const can_frame& f, std::uint8_t node) noexcept {
  if (!is_plain(f) || f.id != sdo_response_id + node || f.size != 8) return std::nullopt;
  sdo_response r;
  r.at = {get<std::uint16_t>(f, 1), f.data[3]};
  const std::uint8_t command = f.data[0];
  if (command == 0x60) {
    r.what = sdo_response::kind::written;
  } else if (command == 0x80) {
    r.what = sdo_response::kind::aborted;
    r.value = get<std::uint32_t>(f, 4);
  } else if ((command & 0xe2) == 0x42) {
    r.what = sdo_response::kind::value;
    r.size = (command & 1) != 0 ? static_cast<std::uint8_t>(4 - ((command >> 2) & 3)) : std::uint8_t{0};
    for (std::size_t i = 0; i < (r.size == 0 ? 4U : r.size); ++i) r.value |= std::uint32_t{f.data[4 + i]} << (8 * i);
  }
  return r;
}

[[nodiscard]] constexpr can_frame encode_written(std::uint8_t node, object_address at) noexcept {
  can_frame f = empty_frame(sdo_response_id + node, 8);
  f.data[0] = 0x60;
  put(f, 1, at.index);
  f.data[3] = at.sub;
  return f;
}
/// @pre size is 1, 2 or 4
[[nodiscard]] constexpr can_frame encode_value(std::uint8_t node, object_address at, std::uint32_t value,
                                               std::uint8_t size) noexcept {
  can_frame f = encode_download_request(node, at, value, size);
  f.id = sdo_response_id + node;
  f.data[0] = static_cast<std::uint8_t>(0x43 | ((4 - size) << 2));
  return f;
}
[[nodiscard]] constexpr can_frame encode_abort(std::uint8_t node, object_address at, std::uint32_t code) noexcept {
  can_frame f = encode_written(node, at);
  f.data[0] = 0x80;
  put(f, 4, code);
  return f;
}

}  // namespace asperity::canopen
