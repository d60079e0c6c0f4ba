#include "libusb_link.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace asperity::usb {

libusb_link::libusb_link(context session, handle device, const usb_pipes& pipes, bool interrupt_in, bool interrupt_out)
    : session_(std::move(session)),
      device_(std::move(device)),
      interface_(pipes.interface),
      in_(pipes.in_transfers),
      out_(pipes.out_transfers),
      ended_(pipes.in_transfers) {
  const auto make = [&](slot& s, std::uint8_t endpoint, bool interrupt, libusb_transfer_cb_fn callback) {
    s.owner = this;
    s.buffer.resize(pipes.transfer_bytes);
    s.transfer = libusb_alloc_transfer(0);
    if (s.transfer == nullptr) return;
    const int size = static_cast<int>(s.buffer.size());
    if (interrupt) {
      libusb_fill_interrupt_transfer(s.transfer, device_.get(), endpoint, s.buffer.data(), size, callback, &s, 0);
    } else {
      libusb_fill_bulk_transfer(s.transfer, device_.get(), endpoint, s.buffer.data(), size, callback, &s, 0);
    }
  };
  for (slot& s : in_) make(s, pipes.in, interrupt_in, in_ended);
  for (slot& s : out_) make(s, pipes.out, interrupt_out, out_ended);
}

libusb_link::~libusb_link() {
  constexpr int for_what_was_written_ms = 100;
  constexpr int for_cancellation_ms = 500;
  if (!gone_) wait_while_flying(out_, for_what_was_written_ms);
  for (std::vector<slot>* slots : {&in_, &out_}) {
    for (slot& s : *slots) {
      if (s.flying) libusb_cancel_transfer(s.transfer);
    }
  }
  wait_while_flying(in_, for_cancellation_ms);
  wait_while_flying(out_, for_cancellation_ms);
  libusb_release_interface(device_.get(), interface_);  // gives it back to the kernel's driver
  if (any_flying(in_) || any_flying(out_)) {
    // The kernel may still write into these buffers. Memory that is lost is better than memory that changes by itself.
    // Without memory to put it aside, the process ends here, as a destructor has no other way to say so.
    static_cast<void>(new std::vector<slot>(std::move(in_)));   // NOLINT(bugprone-unhandled-exception-at-new)
    static_cast<void>(new std::vector<slot>(std::move(out_)));  // NOLINT(bugprone-unhandled-exception-at-new)
    static_cast<void>(device_.release());
    static_cast<void>(session_.release());
    return;
  }
  for (std::vector<slot>* slots : {&in_, &out_}) {
    for (slot& s : *slots) libusb_free_transfer(s.transfer);
  }
}

io_status libusb_link::start() noexcept {
  for (const std::vector<slot>* slots : {&in_, &out_}) {
    for (const slot& s : *slots) {
      if (s.transfer == nullptr) return io_status::failed;
    }
  }
  for (slot& s : in_) {
    const io_status answer = submit(s);
    if (answer != io_status::ok) return answer;
  }
  collect(0);  // libusb makes its own lists on the first call
  return io_status::ok;
}

io_status libusb_link::control(const usb_setup& setup, std::span<std::uint8_t> data, std::size_t& done,
                               std::int64_t timeout_ns) noexcept {
  done = 0;
  if (gone_) return io_status::gone;
  if (data.size() > std::numeric_limits<std::uint16_t>::max()) return io_status::refused;
  const auto timeout_ms = static_cast<unsigned>(std::clamp<std::int64_t>(timeout_ns / 1'000'000, 1, 60'000));
  const int answer = libusb_control_transfer(device_.get(), setup.request_type, setup.request, setup.value, setup.index,
                                             data.data(), static_cast<std::uint16_t>(data.size()), timeout_ms);
  if (answer >= 0) {
    done = static_cast<std::size_t>(answer);
    return io_status::ok;
  }
  const io_status s = status_of(answer);
  gone_ = gone_ || s == io_status::gone;
  return s;
}

io_status libusb_link::write(std::int64_t now_ns, std::span<const std::uint8_t> bytes) noexcept {
  if (gone_) return io_status::gone;
  slot* s = free_out();
  if (s == nullptr) {
    collect(now_ns);
    s = free_out();
    if (gone_) return io_status::gone;
  }
  if (out_trouble_ != io_status::ok) return std::exchange(out_trouble_, io_status::ok);
  if (s == nullptr) return io_status::busy;
  if (bytes.size() > s->buffer.size()) return io_status::refused;
  std::copy(bytes.begin(), bytes.end(), s->buffer.begin());
  s->transfer->length = static_cast<int>(bytes.size());
  return submit(*s);
}

io_status libusb_link::read(std::int64_t now_ns, std::span<std::uint8_t> bytes, usb_packet& packet) noexcept {
  if (ended_count_ == 0 && !gone_) collect(now_ns);
  if (ended_count_ == 0) return gone_ ? io_status::gone : io_status::nothing;
  slot& s = in_[ended_[first_ended_]];
  first_ended_ = (first_ended_ + 1) % ended_.size();
  --ended_count_;
  return take(s, bytes, packet);
}

// What an ended transfer brought; it goes back to the device at once.
io_status libusb_link::take(slot& s, std::span<std::uint8_t> bytes, usb_packet& packet) noexcept {
  const libusb_transfer_status ended = s.transfer->status;
  const auto size = static_cast<std::size_t>(std::max(s.transfer->actual_length, 0));
  if (ended == LIBUSB_TRANSFER_NO_DEVICE) gone_ = true;
  if (ended == LIBUSB_TRANSFER_COMPLETED && size <= bytes.size()) {
    std::copy_n(s.buffer.begin(), size, bytes.begin());
    packet = {.size = size, .host_time_ns = s.ended_ns};
    // Where it cannot be submitted again, this packet is still good; the next call tells.
    static_cast<void>(submit(s));
    return io_status::ok;
  }
  if (gone_) return io_status::gone;
  // A cable that is pulled shows as an error on some host controllers; then the submission knows.
  const io_status again = submit(s);
  if (again == io_status::gone) return io_status::gone;
  return ended == LIBUSB_TRANSFER_COMPLETED ? io_status::too_short : io_status::failed;
}

io_status libusb_link::submit(slot& s) noexcept {
  const io_status answer = status_of(libusb_submit_transfer(s.transfer));
  s.flying = answer == io_status::ok;
  gone_ = gone_ || answer == io_status::gone;
  return answer == io_status::refused ? io_status::failed : answer;
}

void libusb_link::collect(std::int64_t now_ns) noexcept {
  now_ns_ = now_ns;
  timeval at_once{0, 0};
  static_cast<void>(libusb_handle_events_timeout_completed(session_.get(), &at_once, nullptr));
}

libusb_link::slot* libusb_link::free_out() noexcept {
  const auto free = std::find_if(out_.begin(), out_.end(), [](const slot& s) { return !s.flying; });
  return free == out_.end() ? nullptr : &*free;
}

bool libusb_link::any_flying(std::span<const slot> slots) const noexcept {
  return std::any_of(slots.begin(), slots.end(), [](const slot& s) { return s.flying; });
}

void libusb_link::wait_while_flying(std::span<const slot> slots, int most_ms) noexcept {
  constexpr long step_ms = 10;
  for (long waited_ms = 0; waited_ms < most_ms && any_flying(slots); waited_ms += step_ms) {
    timeval step{0, step_ms * 1000};
    static_cast<void>(libusb_handle_events_timeout_completed(session_.get(), &step, nullptr));
  }
}

void LIBUSB_CALL libusb_link::in_ended(libusb_transfer* transfer) noexcept {
  slot& s = *static_cast<slot*>(transfer->user_data);
  libusb_link& link = *s.owner;
  s.flying = false;
  s.ended_ns = link.now_ns_;
  if (transfer->status == LIBUSB_TRANSFER_CANCELLED) return;  // only the destructor cancels
  const auto index = static_cast<std::size_t>(&s - link.in_.data());
  link.ended_[(link.first_ended_ + link.ended_count_) % link.ended_.size()] = index;
  ++link.ended_count_;
}

void LIBUSB_CALL libusb_link::out_ended(libusb_transfer* transfer) noexcept {
  slot& s = *static_cast<slot*>(transfer->user_data);
  libusb_link& link = *s.owner;
  s.flying = false;
  if (transfer->status == LIBUSB_TRANSFER_NO_DEVICE) {
    link.gone_ = true;
  } else if (transfer->status != LIBUSB_TRANSFER_COMPLETED) {
    link.out_trouble_ = io_status::failed;
  } else if (transfer->actual_length < transfer->length) {
    link.out_trouble_ = io_status::too_short;
  }
}

}  // namespace asperity::usb
