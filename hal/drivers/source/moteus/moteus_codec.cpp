#include "asperity/drivers/moteus/moteus_codec.hpp"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace asperity::moteus {

void frame_writer::begin(action a, resolution r, std::uint32_t count, reg first) noexcept {
  constexpr std::array<std::uint8_t, 3> base{0x00, 0x10, 0x20};
  const auto kind = static_cast<std::size_t>(a);
  if (kind >= base.size() || count == 0) {
    fits_ = false;
    return;
  }
  const auto head = static_cast<std::uint8_t>(base[kind] + 4U * static_cast<unsigned>(r));
  resolution_ = r;
  if (count <= 3) {
    put(static_cast<std::uint8_t>(head + count));
  } else {
    put(head);
    put_varuint(count);
  }
  put_varuint(static_cast<std::uint32_t>(first));
}

void frame_writer::value(double v, quantity q, double limit) noexcept {
  if (resolution_ == resolution::real) {
    put_u32(std::bit_cast<std::uint32_t>(float_toward_zero(saturated(v, limit))));
  } else {
    put_int(encode_int(v, q, resolution_, limit));
  }
}

void frame_writer::none() noexcept {
  if (resolution_ == resolution::real) {
    put_u32(0x7fc00000U);
  } else {
    put_int(-static_cast<std::int32_t>(most_of(resolution_)) - 1);
  }
}

void frame_writer::error(action a, reg which, std::uint32_t code) noexcept {
  put(a == action::write_error ? 0x30 : 0x31);
  put_varuint(static_cast<std::uint32_t>(which));
  put_varuint(code);
}

std::size_t frame_writer::finish(std::array<std::uint8_t, capacity>& out) noexcept {
  if (!fits_) return 0;
  constexpr std::array<std::size_t, 7> lengths{8, 12, 16, 20, 24, 32, 48};
  std::size_t padded = capacity;
  for (auto it = lengths.rbegin(); it != lengths.rend(); ++it) {
    if (size_ <= *it) padded = *it;
  }
  if (size_ <= 8) padded = size_;
  while (size_ < padded) put(0x50);
  out = bytes_;
  return size_;
}

void frame_writer::put(std::uint8_t b) noexcept {
  if (size_ < capacity) {
    bytes_[size_++] = b;
  } else {
    fits_ = false;
  }
}

void frame_writer::put_u32(std::uint32_t v) noexcept {
  for (unsigned i = 0; i < 4; ++i) put(static_cast<std::uint8_t>(v >> (8U * i)));
}

void frame_writer::put_int(std::int32_t v) noexcept {
  const auto bits = static_cast<std::uint32_t>(v);
  for (unsigned i = 0; i < bytes_of(resolution_); ++i) put(static_cast<std::uint8_t>(bits >> (8U * i)));
}

void frame_writer::put_varuint(std::uint32_t v) noexcept {
  for (; v > 0x7fU; v >>= 7U) put(static_cast<std::uint8_t>(v | 0x80U));
  put(static_cast<std::uint8_t>(v));
}

bool frame_reader::next(item& out) noexcept {
  if (left_ == 0 && !begin(out)) return false;
  if (item_.what == action::read || item_.what == action::write_error || item_.what == action::read_error) {
    left_ = 0;
    out = item_;
    return true;
  }
  const std::size_t n = bytes_of(item_.how);
  if (bytes_.size() - at_ < n) return give_up();
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < n; ++i) bits |= static_cast<std::uint32_t>(bytes_[at_ + i]) << (8U * i);
  at_ += n;
  out = item_;
  out.whole = n == 1   ? static_cast<std::int8_t>(bits)
              : n == 2 ? static_cast<std::int16_t>(bits)
                       : static_cast<std::int32_t>(bits);
  out.real = item_.how == resolution::real ? std::bit_cast<float>(bits) : 0.0F;
  ++item_.first;
  --left_;
  return true;
}

bool frame_reader::begin(item&) noexcept {
  while (at_ < bytes_.size() && bytes_[at_] == 0x50) ++at_;
  if (at_ == bytes_.size()) return false;
  const std::uint8_t head = bytes_[at_++];
  item_ = {};
  if (head == 0x30 || head == 0x31) {
    item_.what = head == 0x30 ? action::write_error : action::read_error;
    left_ = 1;
    return varuint(item_.first) && varuint(item_.code);
  }
  if (head >= 0x30) return give_up();
  item_.what = head < 0x10 ? action::write : head < 0x20 ? action::read : action::reply;
  item_.how = static_cast<resolution>((head >> 2U) & 3U);
  std::uint32_t count = head & 3U;
  if (count == 0 && !varuint(count)) return false;
  if (!varuint(item_.first)) return false;
  if (count == 0) return give_up();
  left_ = count;
  item_.count = item_.what == action::read ? count : 1;
  return true;
}

bool frame_reader::varuint(std::uint32_t& out) noexcept {
  std::uint64_t v = 0;
  for (unsigned i = 0; i < 5; ++i) {
    if (at_ == bytes_.size()) return give_up();
    const std::uint8_t b = bytes_[at_++];
    v |= static_cast<std::uint64_t>(b & 0x7fU) << (7U * i);
    if ((b & 0x80U) == 0) {
      if (v > 0xffffffffU) return give_up();
      out = static_cast<std::uint32_t>(v);
      return true;
    }
  }
  return give_up();
}

bool frame_reader::give_up() noexcept {
  malformed_ = true;
  at_ = bytes_.size();
  left_ = 0;
  return false;
}

const char* to_string_fault(std::uint32_t code) noexcept {
  switch (code) {
    case 32:
      return "the drive reports a fault of its calibration";
    case 33:
      return "the drive reports a fault of its motor driver";
    case 34:
      return "the drive reports an over-voltage";
    case 35:
      return "the drive reports a fault of its encoder";
    case 36:
      return "the drive reports that its motor is not configured";
    case 37:
    case 46:
      return "the drive reports that its control loop was late";
    case 38:
      return "the drive reports an over-temperature";
    case 39:
      return "the drive reports that it started outside its position limits";
    case 40:
      return "the drive reports an under-voltage";
    case 41:
      return "the drive reports that its configuration was changed";
    case 42:
    case 43:
      return "the drive reports that it has no valid encoder";
    case 44:
      return "the drive reports that its gate driver did not start";
    case 48:
      return "the drive reports invalid position limits";
    case 49:
    case 50:
      return "the drive reports an error of control over its threshold";
    default:
      return "the drive reports a fault";
  }
}

}  // namespace asperity::moteus
