// A device session as bytes: docs/reference/device-recording.md in code. Never inside a tick.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "asperity/device/replay_device.hpp"

namespace asperity {

namespace recording_detail {

inline constexpr char magic[] = {'A', 'S', 'P', 'D', 'E', 'V', 'R', '2'};
inline constexpr char magic_without_blocks[] = {'A', 'S', 'P', 'D', 'E', 'V', 'R', '1'};
inline constexpr std::uint64_t block_calls = 256;  // a quarter of a second and less at 1 kHz
inline constexpr std::uint8_t block_mark = 0xfe;
inline constexpr std::size_t longest_name = 256;
inline constexpr std::uintmax_t largest_file = std::uintmax_t{1} << 30;
inline constexpr std::size_t most_calls = std::size_t{1} << 23;  // an hour and more at 1 kHz
inline constexpr std::size_t free_call_bytes = std::size_t{512} << 20;
inline constexpr std::uint8_t end_mark = 0xff;
inline constexpr std::uint8_t same_sample = 0x80;  // in the byte of the call: the sample is that of the read before

inline std::uint64_t add_to_sum(std::uint64_t sum, char byte) noexcept {
  return (sum ^ static_cast<unsigned char>(byte)) * 0x100000001b3ULL;  // FNV-1a: against accidents, not against malice
}
inline constexpr std::uint64_t first_sum = 0xcbf29ce484222325ULL;

/// Little endian, whatever the machine.
class byte_writer {
 public:
  template <class T>
  void number(T x) {
    auto bits = static_cast<std::uint64_t>(x);
    for (std::size_t i = 0; i < sizeof(T); ++i, bits >>= 8U) bytes_ += static_cast<char>(bits & 0xffU);
  }
  void real(double x) { number(std::bit_cast<std::uint64_t>(x)); }
  void vector(const vec3& v) {
    for (int i = 0; i < 3; ++i) real(v[i]);
  }
  void text(const char* first, std::size_t n) { bytes_.append(first, n); }
  [[nodiscard]] std::string take() { return std::exchange(bytes_, {}); }

 private:
  std::string bytes_;
};

/// Reads until the bytes end; afterwards everything is zero and ok() false.
class byte_reader {
 public:
  explicit byte_reader(const std::string& bytes) : bytes_(&bytes) {}

  template <class T>
  [[nodiscard]] T number() noexcept {
    if (bytes_->size() - at_ < sizeof(T)) {
      at_ = bytes_->size();
      ok_ = false;
      ended_ = true;
      return T{};
    }
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      bits |= std::uint64_t{static_cast<unsigned char>((*bytes_)[at_ + i])} << (8U * i);
    }
    at_ += sizeof(T);
    return static_cast<T>(bits);
  }
  [[nodiscard]] double real() noexcept { return std::bit_cast<double>(number<std::uint64_t>()); }
  [[nodiscard]] vec3 vector() noexcept {
    vec3 v{0.0};
    for (int i = 0; i < 3; ++i) v[i] = real();
    return v;
  }
  /// An enumerator below `count`; otherwise the reader is no longer ok.
  template <class Enum>
  [[nodiscard]] Enum choice(int count) noexcept {
    const auto value = number<std::uint8_t>();
    if (value >= count) ok_ = false;
    return static_cast<Enum>(value < count ? value : 0);
  }
  [[nodiscard]] std::string text(std::size_t n) {
    if (bytes_->size() - at_ < n) {
      ok_ = false;
      ended_ = true;
      return {};
    }
    at_ += n;
    return bytes_->substr(at_ - n, n);
  }
  [[nodiscard]] bool ok() const noexcept { return ok_; }
  /// Whether more was asked for than there is.
  [[nodiscard]] bool ended() const noexcept { return ended_; }
  [[nodiscard]] std::size_t at() const noexcept { return at_; }

 private:
  const std::string* bytes_;
  std::size_t at_ = 0;
  bool ok_ = true;
  bool ended_ = false;
};

/// The check sum of a recording's first bytes, as far as somebody asked.
class running_sum {
 public:
  explicit running_sum(const std::string& bytes) : bytes_(&bytes) {}
  /// @param at not before that of the last call
  [[nodiscard]] std::uint64_t up_to(std::size_t at) noexcept {
    for (; at_ < at; ++at_) sum_ = add_to_sum(sum_, (*bytes_)[at_]);
    return sum_;
  }

 private:
  const std::string* bytes_;
  std::size_t at_ = 0;
  std::uint64_t sum_ = first_sum;
};

inline constexpr std::array capability_numbers{
    &device_capabilities::continuous_force_n,      &device_capabilities::peak_force_n,
    &device_capabilities::continuous_torque_n_m,   &device_capabilities::peak_torque_n_m,
    &device_capabilities::force_slew_n_per_s,      &device_capabilities::torque_slew_n_m_per_s,
    &device_capabilities::max_stiffness_n_per_m,   &device_capabilities::max_stiffness_n_m_per_rad,
    &device_capabilities::max_stiffness_rate_hz,   &device_capabilities::position_resolution_m,
    &device_capabilities::rotation_resolution_rad, &device_capabilities::nominal_rate_hz,
    &device_capabilities::minimum_rate_hz,         &device_capabilities::moving_mass_kg,
    &device_capabilities::moving_inertia_kg_m2};

inline void write(byte_writer& w, const device_capabilities& c) {
  w.number(static_cast<std::uint8_t>(c.maturity));
  w.number(c.sensed);
  w.number(c.actuated);
  w.number(static_cast<std::uint8_t>((c.needs_homing ? 1 : 0) | (c.device_side_watchdog ? 2 : 0)));
  for (const auto member : capability_numbers) w.real(c.*member);
  w.vector(c.workspace_low_d);
  w.vector(c.workspace_high_d);
  w.number(c.worst_latency_ns);
}

inline device_capabilities read_capabilities(byte_reader& r) noexcept {
  device_capabilities c;
  c.maturity = r.choice<driver_maturity>(3);
  c.sensed = r.number<axis_mask>();
  c.actuated = r.number<axis_mask>();
  const auto flags = r.number<std::uint8_t>();
  c.needs_homing = (flags & 1U) != 0;
  c.device_side_watchdog = (flags & 2U) != 0;
  for (const auto member : capability_numbers) c.*member = r.real();
  c.workspace_low_d = r.vector();
  c.workspace_high_d = r.vector();
  c.worst_latency_ns = r.number<std::int64_t>();
  return c;
}

inline void write(byte_writer& w, const device_sample& s) {
  w.number(s.host_time_ns);
  w.number(s.device_time_ns);
  w.number(s.sequence);
  w.number(s.lost);
  for (const double q : {s.T_dh.rotation.w, s.T_dh.rotation.x, s.T_dh.rotation.y, s.T_dh.rotation.z}) w.real(q);
  w.vector(s.T_dh.position);
  w.vector(s.velocity_d.linear);
  w.vector(s.velocity_d.angular);
  w.number(s.buttons);
  w.number(static_cast<std::uint8_t>(s.valid));
}

inline device_sample read_sample(byte_reader& r) noexcept {
  device_sample s;
  s.host_time_ns = r.number<std::int64_t>();
  s.device_time_ns = r.number<std::int64_t>();
  s.sequence = r.number<std::uint64_t>();
  s.lost = r.number<std::uint64_t>();
  const double qw = r.real(), qx = r.real(), qy = r.real(), qz = r.real();
  s.T_dh.rotation = quat(qw, qx, qy, qz);
  s.T_dh.position = r.vector();
  s.velocity_d.linear = r.vector();
  s.velocity_d.angular = r.vector();
  s.buttons = r.number<std::uint32_t>();
  s.valid = static_cast<sample_field>(r.number<std::uint8_t>());
  return s;
}

inline void write(byte_writer& w, const device_command& c) {
  w.vector(c.on_hand.force);
  w.vector(c.on_hand.torque);
  w.number(static_cast<std::uint8_t>(c.frame));
  w.number(c.valid_until_ns);
  w.number(c.sequence);
}

inline device_command read_command(byte_reader& r) noexcept {
  device_command c;
  c.on_hand.force = r.vector();
  c.on_hand.torque = r.vector();
  c.frame = r.choice<wrench_frame>(4);
  c.valid_until_ns = r.number<std::int64_t>();
  c.sequence = r.number<std::uint64_t>();
  return c;
}

}  // namespace recording_detail

/// Turns calls into the bytes of a recording, piece by piece: begin, then every call in order, then end.
/// After every 256 calls comes a mark with a check sum: bytes that were written up to a mark can be read again,
/// whatever became of the rest.
class recording_encoder {
 public:
  [[nodiscard]] std::string begin(const device_capabilities& c, device_state before) {
    using namespace recording_detail;
    byte_writer w;
    w.text(magic, sizeof magic);
    const std::size_t length = c.name.size() < longest_name ? c.name.size() : longest_name;
    w.number(static_cast<std::uint16_t>(length));
    w.text(c.name.data(), length);
    write(w, c);
    w.number(static_cast<std::uint8_t>(before));
    return counted(w.take());
  }

  [[nodiscard]] std::string call(const call_record& c) {
    using namespace recording_detail;
    byte_writer sample;
    std::string seen;
    if (c.call == device_call::read) {
      write(sample, c.sample);
      seen = sample.take();
    }
    const bool same = c.call == device_call::read && seen == last_seen_;
    byte_writer w;
    w.number(static_cast<std::uint8_t>(static_cast<std::uint8_t>(c.call) | (same ? same_sample : 0U)));
    w.number(static_cast<std::uint8_t>(c.answered));
    w.number(static_cast<std::uint8_t>(c.after));
    if (c.call == device_call::read || c.call == device_call::write) w.number(c.now_ns);
    if (c.call == device_call::read && !same) w.text(seen.data(), seen.size());
    if (c.call == device_call::write) write(w, c.command);
    if (c.call == device_call::read) last_seen_ = std::move(seen);
    ++calls_;
    std::string out = counted(w.take());
    if (calls_ % block_calls == 0) out += mark();
    return out;
  }

  /// Whole blocks so far.
  [[nodiscard]] std::uint64_t blocks() const noexcept { return calls_ / recording_detail::block_calls; }

  /// @param writes_before_end see device_recording
  [[nodiscard]] std::string end(recorded_end why = recorded_end::not_reported, std::uint64_t writes_before_end = 0) {
    recording_detail::byte_writer w;
    w.number(recording_detail::end_mark);
    w.number(calls_);
    w.number(static_cast<std::uint8_t>(why));
    w.number(writes_before_end);
    std::string tail = counted(w.take());
    recording_detail::byte_writer s;
    s.number(sum_);
    return tail + s.take();
  }

 private:
  std::string mark() {
    recording_detail::byte_writer w;
    w.number(recording_detail::block_mark);
    w.number(calls_);
    std::string out = counted(w.take());
    recording_detail::byte_writer s;
    s.number(sum_);
    return out + counted(s.take());
  }
  std::string counted(std::string bytes) {
    for (const char b : bytes) sum_ = recording_detail::add_to_sum(sum_, b);
    return bytes;
  }

  std::string last_seen_;
  std::uint64_t calls_ = 0;
  std::uint64_t sum_ = recording_detail::first_sum;
};

/// The bytes of a whole recording.
[[nodiscard]] inline std::string encode(const device_recording& recording) {
  recording_encoder e;
  device_capabilities c = recording.capabilities;
  c.name = recording.name;
  std::string out = e.begin(c, recording.before);
  for (const call_record& call : recording.calls) out += e.call(call);
  return out + e.end(recording.end, recording.writes_before_end);
}

/// The recording in `bytes`, of at most 8,388,608 calls. Memory grows with the calls that are there, whatever their
/// number is said to be, and takes at most four times the bytes and 512 MiB: a recording of so many short calls that
/// they would need more is no session. Bytes that end before the recording does, as those of a program that was killed,
/// give the calls up to the last whole block, and `cut` says so.
/// @param keep_going asked on the way; false ends the reading
/// @return bad_format for anything that encode() does not write, and for a cut before the first whole block's end |
/// limit_exceeded | cancelled
[[nodiscard]] inline result<device_recording> decode(const std::string& bytes,
                                                     const std::function<bool()>& keep_going = {}) {
  using namespace recording_detail;
  const auto bad = [](const std::string& what) {
    return error{error_code::bad_format, "the device recording " + what + ": record the session again"};
  };
  byte_reader r(bytes);
  const std::string first_bytes = r.text(sizeof magic);
  const bool in_blocks = first_bytes == std::string(magic, sizeof magic);
  if (!in_blocks && first_bytes != std::string(magic_without_blocks, sizeof magic)) {
    return error{error_code::bad_format,
                 "it is no device recording, for it does not begin with ASPDEVR2: give a file of `asperity run "
                 "--record-device`"};
  }
  device_recording out;
  const std::size_t length = r.number<std::uint16_t>();
  if (length > longest_name) return bad("names a device of more than 256 bytes");
  out.name = r.text(length);
  out.capabilities = read_capabilities(r);
  out.before = r.choice<device_state>(device_state_count);
  if (!r.ok()) return bad("is cut off, or wrong, in its header");

  running_sum sum(bytes);
  std::size_t whole = 0;  // calls up to the last mark
  // What to do where the bytes cannot be understood: they may just have ended.
  const auto broken = [&](const std::string& what) -> result<device_recording> {
    if (!r.ended() || whole == 0) return bad(what);
    out.calls.resize(whole);
    out.cut = true;
    return std::move(out);
  };
  // The number of calls stands near the end. Believed for the room alone, which takes no memory until it is used.
  const std::size_t shortest_call = 3;
  const std::size_t room = free_call_bytes + 4 * bytes.size();
  if (constexpr std::size_t tail = 25; bytes.size() > tail) {
    const std::string end = bytes.substr(bytes.size() - tail, 8);
    const auto stated = byte_reader(end).number<std::uint64_t>();
    const std::size_t most = std::min({most_calls, bytes.size() / shortest_call, room / sizeof(call_record)});
    out.calls.reserve(static_cast<std::size_t>(std::min<std::uint64_t>(stated, most)));
  }
  const auto wanted = [&](std::size_t step) { return step % 65536 != 0 || !keep_going || keep_going(); };
  const error cancelled{error_code::cancelled, "the device recording was not read to its end: cancelled"};
  device_sample last;
  bool seen = false;
  std::uint64_t writes = 0;
  while (true) {
    const std::size_t at = r.at();
    const auto first = r.number<std::uint8_t>();
    if (!r.ok()) return broken("is cut off after call " + std::to_string(out.calls.size()));
    if (first == end_mark) break;
    if (in_blocks && first == block_mark) {
      const bool counted = r.number<std::uint64_t>() == out.calls.size() && out.calls.size() == whole + block_calls;
      const std::uint64_t computed = r.ok() ? sum.up_to(r.at()) : 0;
      const bool matches = r.number<std::uint64_t>() == computed;
      if (!r.ok()) return broken("is cut off after call " + std::to_string(out.calls.size()));
      if (!counted || !matches) return bad("does not match the check sum at byte " + std::to_string(at));
      whole = out.calls.size();
      continue;
    }
    if (in_blocks && out.calls.size() == whole + block_calls) {
      return bad("lacks the check sum at byte " + std::to_string(at));
    }
    if (!wanted(out.calls.size())) return cancelled;
    if ((out.calls.size() + 1) * sizeof(call_record) > room) {
      return error{error_code::limit_exceeded,
                   "the device recording holds so many calls in so few bytes that they would need more memory than "
                   "four times its size and 512 MiB, as no session does: record the session again"};
    }
    if (out.calls.size() == most_calls) {
      return error{error_code::limit_exceeded,
                   "the device recording holds more than 8,388,608 calls: record a shorter session"};
    }
    const bool same = (first & same_sample) != 0;
    const auto kind = static_cast<std::uint8_t>(first & ~same_sample);
    call_record c;
    c.call = static_cast<device_call>(kind);
    const bool reads = c.call == device_call::read;
    if (kind >= device_call_count || (same && (!reads || !seen))) {
      return bad("holds no call where one should be, at byte " + std::to_string(at));
    }
    c.answered = r.choice<status>(static_cast<int>(status::backend_failed) + 1);
    c.after = r.choice<device_state>(device_state_count);
    if (reads || c.call == device_call::write) c.now_ns = r.number<std::int64_t>();
    if (reads) {
      if (!same) last = read_sample(r);
      c.sample = last;
      seen = true;
    }
    if (c.call == device_call::write) {
      c.command = read_command(r);
      ++writes;
    }
    if (!r.ok()) return broken("is cut off, or wrong, in call " + std::to_string(out.calls.size()));
    out.calls.push_back(c);
  }
  const bool counted = r.number<std::uint64_t>() == out.calls.size();
  out.end = r.choice<recorded_end>(recorded_end_count);
  out.writes_before_end = r.number<std::uint64_t>();
  const std::uint64_t computed = r.ok() ? sum.up_to(r.at()) : 0;
  const bool matches = r.number<std::uint64_t>() == computed;
  if (r.ended() && whole > 0) {
    out.end = recorded_end::not_reported;
    out.writes_before_end = 0;
  }
  if (r.ended()) return broken("is cut off where it tells its end");
  if (!counted) return bad("holds another number of calls than it says");
  if (!r.ok() || out.writes_before_end > (out.end == recorded_end::not_reported ? 0 : writes)) {
    return bad("is wrong where it tells its end");
  }
  if (!matches) return bad("does not match its check sum");
  if (r.at() != bytes.size()) return bad("goes on after its end");
  return out;
}

/// Reads a recording from a file of at most 1 GiB.
/// @return io_failed | bad_format | limit_exceeded | cancelled
[[nodiscard]] inline result<device_recording> load_device_recording(const std::filesystem::path& file,
                                                                    const std::function<bool()>& keep_going = {}) {
  std::error_code failed;
  if (!std::filesystem::exists(file, failed)) {
    return error{error_code::io_failed, file.string() + ": cannot be found; check the path"};
  }
  if (!std::filesystem::is_regular_file(file, failed)) {
    return error{error_code::io_failed, file.string() + " is not a file that can be read"};
  }
  const std::uintmax_t size = std::filesystem::file_size(file, failed);
  if (failed) return error{error_code::io_failed, file.string() + " cannot be read: " + failed.message()};
  if (size > recording_detail::largest_file) {
    return error{error_code::limit_exceeded, file.string() + " is larger than 1 GiB: record a shorter session"};
  }
  std::string bytes(static_cast<std::size_t>(size), '\0');
  std::ifstream in(file, std::ios::binary);
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!in) return error{error_code::io_failed, file.string() + " could not be read to its end"};
  result<device_recording> decoded = decode(bytes, keep_going);
  if (!decoded) return error{decoded.error().code, file.string() + ": " + decoded.error().message};
  return decoded;
}

}  // namespace asperity
