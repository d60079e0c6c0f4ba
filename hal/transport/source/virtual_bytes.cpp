#include "asperity/transport/virtual/virtual_bytes.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

namespace asperity {

bool byte_queue::push(std::uint8_t byte, std::int64_t due_ns) noexcept {
  if (room() == 0) return false;
  entries_[(first_ + size_++) % entries_.size()] = {due_ns, byte};
  return true;
}

std::size_t byte_queue::pop(std::int64_t now_ns, std::span<std::uint8_t> bytes) noexcept {
  std::size_t n = 0;
  for (; n < bytes.size() && size_ > 0 && entries_[first_].due_ns <= now_ns; ++n) {
    bytes[n] = entries_[first_].byte;
    first_ = (first_ + 1) % entries_.size();
    --size_;
  }
  return n;
}

virtual_bytes::virtual_bytes(link_script script, std::size_t queue_bytes)
    : player_(std::move(script)), to_device_(queue_bytes), from_device_(queue_bytes), host_(*this), device_(*this) {}

io_status virtual_bytes::host_end::read(std::int64_t now_ns, std::span<std::uint8_t> bytes,
                                        std::size_t& done) noexcept {
  return line_.host_read(now_ns, bytes, done);
}

io_status virtual_bytes::host_end::write(std::int64_t now_ns, std::span<const std::uint8_t> bytes,
                                         std::size_t& done) noexcept {
  return line_.host_write(now_ns, bytes, done);
}

io_status virtual_bytes::device_end::read(std::int64_t now_ns, std::span<std::uint8_t> bytes,
                                          std::size_t& done) noexcept {
  done = line_.gone_ ? 0 : line_.to_device_.queue.pop(now_ns, bytes);
  if (line_.gone_) return io_status::gone;
  return done > 0 ? io_status::ok : io_status::nothing;
}

io_status virtual_bytes::device_end::write(std::int64_t now_ns, std::span<const std::uint8_t> bytes,
                                           std::size_t& done) noexcept {
  done = line_.gone_ ? 0 : bytes.size();
  if (line_.gone_) return io_status::gone;
  line_.lost_ += line_.put(line_.from_device_, link_direction::from_device, line_.player_.calls(), now_ns, bytes);
  return io_status::ok;
}

io_status virtual_bytes::host_read(std::int64_t now_ns, std::span<std::uint8_t> bytes, std::size_t& done) noexcept {
  done = 0;
  io_status scripted = io_status::ok;
  if (stopped(link_direction::from_device, now_ns, scripted)) return scripted;
  done = from_device_.queue.pop(now_ns, bytes);
  return done > 0 ? io_status::ok : io_status::nothing;
}

io_status virtual_bytes::host_write(std::int64_t now_ns, std::span<const std::uint8_t> bytes,
                                    std::size_t& done) noexcept {
  done = 0;
  const std::uint64_t call = player_.calls();
  io_status scripted = io_status::ok;
  if (stopped(link_direction::to_device, now_ns, scripted)) return scripted;
  if (bytes.empty()) return io_status::ok;
  const std::size_t room = to_device_.queue.room();
  done = std::min(bytes.size(), room);
  if (done == 0) return io_status::busy;
  static_cast<void>(put(to_device_, link_direction::to_device, call, now_ns, bytes.first(done)));
  return done == bytes.size() ? io_status::ok : io_status::too_short;
}

bool virtual_bytes::stopped(link_direction way, std::int64_t now_ns, io_status& answer) noexcept {
  const std::uint64_t call = player_.count_call();
  gone_ = gone_ || player_.find(link_fault::unplug, way, now_ns, call) != nullptr;
  const link_event* e = gone_ ? nullptr : player_.find(link_fault::answer, way, now_ns, call);
  answer = gone_ ? io_status::gone : e != nullptr ? e->with : io_status::ok;
  return gone_ || e != nullptr;
}

std::size_t virtual_bytes::put(direction& to, link_direction way, std::uint64_t call, std::int64_t now_ns,
                               std::span<const std::uint8_t> bytes) noexcept {
  if (bytes.empty() || player_.find(link_fault::lose, way, now_ns, call) != nullptr) return 0;
  if (player_.find(link_fault::shorten, way, now_ns, call) != nullptr) bytes = bytes.first(bytes.size() - 1);
  std::size_t wrong_at = bytes.size();
  std::uint8_t wrong_bits = 0;
  if (!bytes.empty() && player_.find(link_fault::flip_bit, way, now_ns, call) != nullptr) {
    const std::uint64_t bit = player_.below(std::uint64_t{bytes.size()} * 8);
    wrong_at = static_cast<std::size_t>(bit / 8);
    wrong_bits = static_cast<std::uint8_t>(1U << (bit % 8));
  }
  const auto byte = [&](std::size_t i) {
    return static_cast<std::uint8_t>(bytes[i] ^ (i == wrong_at ? wrong_bits : std::uint8_t{0}));
  };
  if (to.held_size == 0 && player_.find(link_fault::reorder, way, now_ns, call) != nullptr) {
    to.held_size = std::min(bytes.size(), to.held.size());
    for (std::size_t i = 0; i < to.held_size; ++i) to.held[i] = byte(i);
    return bytes.size() - to.held_size;
  }

  std::int64_t due_ns = now_ns + player_.script().latency_ns;
  if (const link_event* e = player_.find(link_fault::delay, way, now_ns, call)) due_ns += e->amount_ns;
  const int copies = player_.find(link_fault::duplicate, way, now_ns, call) != nullptr ? 2 : 1;
  std::size_t lost = 0;
  for (int c = 0; c < copies; ++c) {
    for (std::size_t i = 0; i < bytes.size(); ++i) lost += to.queue.push(byte(i), due_ns) ? 0U : 1U;
  }
  for (std::size_t i = 0; i < to.held_size; ++i) lost += to.queue.push(to.held[i], due_ns) ? 0U : 1U;
  to.held_size = 0;
  return lost;
}

}  // namespace asperity
