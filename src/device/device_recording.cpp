#include "asperity/device/device_recording.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <functional>
#include <string>
#include <utility>

#include "device/recording_bytes.hpp"

namespace asperity {

recording_encoder::recording_encoder() noexcept : sum_(recording_detail::first_sum) {}

std::string recording_encoder::begin(const device_capabilities& c, device_state before) {
  using namespace recording_detail;
  byte_writer w;
  gripper_ = c.has_gripper();
  w.text(gripper_ ? magic_with_gripper : magic, sizeof magic);
  const std::size_t length = c.name.size() < longest_name ? c.name.size() : longest_name;
  w.number(static_cast<std::uint16_t>(length));
  w.text(c.name.data(), length);
  write(w, c);
  w.number(static_cast<std::uint8_t>(before));
  return counted(w.take());
}

std::string recording_encoder::call(const call_record& c) {
  using namespace recording_detail;
  byte_writer sample;
  std::string seen;
  if (c.call == device_call::read) {
    write(sample, c.sample, gripper_);
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

std::uint64_t recording_encoder::blocks() const noexcept { return calls_ / recording_detail::block_calls; }

std::string recording_encoder::end(recorded_end why, std::uint64_t writes_before_end) {
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

std::string recording_encoder::mark() {
  recording_detail::byte_writer w;
  w.number(recording_detail::block_mark);
  w.number(calls_);
  std::string out = counted(w.take());
  recording_detail::byte_writer s;
  s.number(sum_);
  return out + counted(s.take());
}

std::string recording_encoder::counted(std::string bytes) {
  for (const char b : bytes) sum_ = recording_detail::add_to_sum(sum_, b);
  return bytes;
}

std::string encode(const device_recording& recording) {
  recording_encoder e;
  device_capabilities c = recording.capabilities;
  c.name = recording.name;
  std::string out = e.begin(c, recording.before);
  for (const call_record& call : recording.calls) out += e.call(call);
  return out + e.end(recording.end, recording.writes_before_end);
}

result<device_recording> decode(const std::string& bytes, const std::function<bool()>& keep_going) {
  using namespace recording_detail;
  const auto bad = [](const std::string& what) {
    return error{error_code::bad_format, "the device recording " + what + ": record the session again"};
  };
  byte_reader r(bytes);
  const std::string first_bytes = r.text(sizeof magic);
  const bool gripper = first_bytes == std::string(magic_with_gripper, sizeof magic_with_gripper);
  const bool in_blocks = gripper || first_bytes == std::string(magic, sizeof magic);
  if (!in_blocks && first_bytes != std::string(magic_without_blocks, sizeof magic)) {
    return error{error_code::bad_format,
                 "it is no device recording, for it does not begin with ASPDEVR2: give a file of `asperity run "
                 "--record-device`"};
  }
  device_recording out;
  const std::size_t length = r.number<std::uint16_t>();
  if (length > longest_name) return bad("names a device of more than 256 bytes");
  out.name = r.text(length);
  out.capabilities = read_capabilities(r, gripper);
  out.before = r.choice<device_state>(device_state_count);
  if (r.ok() && gripper != out.capabilities.has_gripper()) return bad("tells of a gripper that does not open");
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
      if (!same) last = read_sample(r, gripper);
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

result<device_recording> load_device_recording(const std::filesystem::path& file,
                                               const std::function<bool()>& keep_going) {
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
