#include "asperity/transport/virtual/virtual_can.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "asperity/transport/can_length.hpp"

namespace asperity {

virtual_can_node::virtual_can_node(virtual_can& bus, link_script script, std::size_t queue_frames)
    : bus_(bus), player_(std::move(script)), queue_(std::max<std::size_t>(queue_frames, 2)) {
  bus_.nodes_.push_back(this);
}

io_status virtual_can_node::send(std::int64_t now_ns, const can_frame& frame) noexcept {
  constexpr auto way = link_direction::to_device;
  const std::uint64_t call = player_.count_call();
  if (is_gone(way, now_ns, call)) return io_status::gone;
  if (const link_event* e = player_.find(link_fault::answer, way, now_ns, call)) return e->with;
  if (!is_possible(frame, bus_.fd_)) return io_status::refused;
  if (health_.bus_off) return io_status::down;
  if (is_off(now_ns, call)) return io_status::ok;
  if (player_.find(link_fault::lose, way, now_ns, call) != nullptr) return io_status::ok;

  can_frame sent = frame;
  spoil(sent, way, now_ns, call);
  std::int64_t due_ns = now_ns + player_.script().latency_ns;
  if (const link_event* e = player_.find(link_fault::delay, way, now_ns, call)) due_ns += e->amount_ns;
  const int copies = player_.find(link_fault::duplicate, way, now_ns, call) != nullptr ? 2 : 1;
  if (!held_ && player_.find(link_fault::reorder, way, now_ns, call) != nullptr) {
    held_ = true;
    held_frame_ = sent;
    return io_status::ok;
  }
  for (int i = 0; i < copies; ++i) bus_.carry(*this, sent, due_ns);
  if (std::exchange(held_, false)) bus_.carry(*this, held_frame_, due_ns);
  return io_status::ok;
}

io_status virtual_can_node::receive(std::int64_t now_ns, can_frame& frame) noexcept {
  constexpr auto way = link_direction::from_device;
  const std::uint64_t call = player_.count_call();
  if (is_gone(way, now_ns, call)) return io_status::gone;
  if (const link_event* e = player_.find(link_fault::answer, way, now_ns, call)) return e->with;
  const std::uint64_t lost = health_.lost;
  health_ = reported_;
  health_.lost = lost;
  health_.bus_off = is_off(now_ns, call);

  std::size_t i = 0;
  while (i < waiting_ && queue_[i].due_ns <= now_ns) {
    if (!queue_[i].judged && !judge(i, now_ns, call)) continue;
    if (queue_[i].after_next) {
      ++i;
      continue;
    }
    frame = queue_[i].frame;
    frame.host_time_ns = queue_[i].due_ns;
    for (std::size_t k = 0; k < i; ++k) queue_[k].after_next = false;
    if (queue_[i].copies > 1) {
      --queue_[i].copies;
    } else {
      remove(i);
    }
    return io_status::ok;
  }
  return health_.bus_off ? io_status::down : io_status::nothing;
}

bool virtual_can_node::is_gone(link_direction way, std::int64_t now_ns, std::uint64_t call) noexcept {
  gone_ = gone_ || player_.find(link_fault::unplug, way, now_ns, call) != nullptr;
  return gone_;
}

bool virtual_can_node::is_off(std::int64_t now_ns, std::uint64_t call) noexcept {
  return reported_.bus_off || player_.find(link_fault::bus_off, link_direction::to_device, now_ns, call) != nullptr ||
         player_.find(link_fault::bus_off, link_direction::from_device, now_ns, call) != nullptr;
}

void virtual_can_node::spoil(can_frame& frame, link_direction way, std::int64_t now_ns, std::uint64_t call) noexcept {
  if (player_.find(link_fault::shorten, way, now_ns, call) != nullptr) frame.size = shorter_can_length(frame.size);
  if (player_.find(link_fault::flip_bit, way, now_ns, call) == nullptr) return;
  if (frame.size == 0) {
    frame.id ^= 1U << player_.below(frame.extended ? 29 : 11);
  } else {
    const std::uint64_t bit = player_.below(std::uint64_t{frame.size} * 8);
    frame.data[bit / 8] = static_cast<std::uint8_t>(frame.data[bit / 8] ^ (1U << (bit % 8)));
  }
}

bool virtual_can_node::judge(std::size_t i, std::int64_t now_ns, std::uint64_t call) noexcept {
  constexpr auto way = link_direction::from_device;
  queue_[i].judged = true;
  if (player_.find(link_fault::lose, way, now_ns, call) != nullptr) {
    remove(i);
    return false;
  }
  spoil(queue_[i].frame, way, now_ns, call);
  if (player_.find(link_fault::duplicate, way, now_ns, call) != nullptr) queue_[i].copies = 2;
  if (const link_event* e = player_.find(link_fault::delay, way, now_ns, call)) {
    entry late = queue_[i];
    late.due_ns += e->amount_ns;
    remove(i);
    insert(late);
    return false;
  }
  const auto first = queue_.begin();
  const bool one_waits =
      std::any_of(first, first + static_cast<std::ptrdiff_t>(i), [](const entry& q) { return q.after_next; });
  if (!one_waits) queue_[i].after_next = player_.find(link_fault::reorder, way, now_ns, call) != nullptr;
  return true;
}

void virtual_can_node::arrive(const can_frame& frame, std::int64_t due_ns) noexcept {
  const std::int64_t here_ns = due_ns + player_.script().latency_ns;
  if (gone_ || is_off(here_ns, player_.calls())) return;
  if (waiting_ == queue_.size()) {
    ++health_.lost;
    return;
  }
  insert({.frame = frame, .due_ns = here_ns});
}

void virtual_can_node::insert(const entry& e) noexcept {
  std::size_t i = waiting_++;
  for (; i > 0 && queue_[i - 1].due_ns > e.due_ns; --i) queue_[i] = queue_[i - 1];
  queue_[i] = e;
}

void virtual_can_node::remove(std::size_t i) noexcept {
  const auto at = queue_.begin() + static_cast<std::ptrdiff_t>(i);
  std::move(at + 1, queue_.begin() + static_cast<std::ptrdiff_t>(waiting_), at);
  --waiting_;
}

void virtual_can::carry(const virtual_can_node& from, const can_frame& frame, std::int64_t due_ns) noexcept {
  ++frames_;
  for (virtual_can_node* node : nodes_) {
    if (node != &from) node->arrive(frame, due_ns);
  }
}

}  // namespace asperity
