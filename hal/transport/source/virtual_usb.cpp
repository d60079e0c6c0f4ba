#include "asperity/transport/virtual/virtual_usb.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace asperity {

// Transfers on their way in one direction, by the time at which they arrive. No more memory after construction.
class usb_queue {
 public:
  static constexpr std::size_t most_bytes = 512;  //< of one transfer
  struct entry {
    std::array<std::uint8_t, most_bytes> bytes{};
    std::size_t size = 0;
    std::int64_t due_ns = 0;
    bool judged = false;      // faults are drawn once per transfer
    bool after_next = false;  // reordered: waits until another has gone
  };

  explicit usb_queue(std::size_t most) : entries_(std::max<std::size_t>(most, 2)) {}

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] bool full() const noexcept { return size_ == entries_.size(); }
  [[nodiscard]] entry& operator[](std::size_t i) noexcept { return entries_[i]; }

  // Sorted by time; of equal times, what came first stands first. @return false where it does not fit
  bool insert(const entry& e) noexcept {
    if (full()) return false;
    std::size_t i = size_++;
    for (; i > 0 && entries_[i - 1].due_ns > e.due_ns; --i) entries_[i] = entries_[i - 1];
    entries_[i] = e;
    return true;
  }
  void remove(std::size_t i) noexcept {
    for (; i + 1 < size_; ++i) entries_[i] = entries_[i + 1];
    --size_;
  }
  void clear() noexcept { size_ = 0; }

 private:
  std::vector<entry> entries_;
  std::size_t size_ = 0;
};

struct virtual_usb::shared {
  shared(link_script script, std::size_t out_transfers)
      : player(std::move(script)), most_out(std::max<std::size_t>(out_transfers, 1)) {}
  void unplug() noexcept {
    plugged = open = false;
    ++times_unplugged;
    to_device.clear();
    to_host.clear();
  }
  link_player player;
  std::size_t most_out;
  usb_queue to_device{64};
  usb_queue to_host{64};
  control_handler control{};
  std::uint64_t times_unplugged = 0;
  bool plugged = true;
  bool open = false;
  bool held = false;  // held_out goes after the next one
  usb_queue::entry held_out{};
};

class virtual_usb::host_end final : public usb_link {
 public:
  explicit host_end(std::shared_ptr<shared> both) : both_(std::move(both)), unplugged_(both_->times_unplugged) {}
  ~host_end() override {
    if (unplugged_ == both_->times_unplugged) both_->open = false;
  }
  host_end(const host_end&) = delete;
  host_end& operator=(const host_end&) = delete;

  [[nodiscard]] io_status control(const usb_setup& setup, std::span<std::uint8_t> data, std::size_t& done,
                                  std::int64_t) noexcept override {
    const std::uint64_t call = both_->player.count_call();
    done = 0;
    if (is_gone(link_direction::to_device, last_ns_, call)) return io_status::gone;
    if (const link_event* e = find(link_fault::answer, link_direction::to_device, last_ns_, call)) return e->with;
    if (!both_->control) return io_status::refused;
    return both_->control(setup, data, done);
  }

  [[nodiscard]] io_status write(std::int64_t now_ns, std::span<const std::uint8_t> bytes) noexcept override {
    constexpr auto way = link_direction::to_device;
    last_ns_ = now_ns;
    const std::uint64_t call = both_->player.count_call();
    if (is_gone(way, now_ns, call)) return io_status::gone;
    if (const link_event* e = find(link_fault::answer, way, now_ns, call)) return e->with;
    if (bytes.size() > usb_queue::most_bytes) return io_status::refused;
    if (both_->to_device.size() >= both_->most_out) return io_status::busy;
    if (find(link_fault::lose, way, now_ns, call) != nullptr) return io_status::ok;

    usb_queue::entry e;
    std::copy(bytes.begin(), bytes.end(), e.bytes.begin());
    e.size = bytes.size();
    e.due_ns = now_ns + both_->player.script().latency_ns;
    spoil(e, way, now_ns, call);
    if (const link_event* late = find(link_fault::delay, way, now_ns, call)) e.due_ns += late->amount_ns;
    if (!both_->held && find(link_fault::reorder, way, now_ns, call) != nullptr) {
      both_->held = true;
      both_->held_out = e;
      return io_status::ok;
    }
    const int copies = find(link_fault::duplicate, way, now_ns, call) != nullptr ? 2 : 1;
    for (int i = 0; i < copies; ++i) both_->to_device.insert(e);
    if (std::exchange(both_->held, false)) {
      both_->held_out.due_ns = std::max(both_->held_out.due_ns, e.due_ns);
      both_->to_device.insert(both_->held_out);
    }
    return io_status::ok;
  }

  [[nodiscard]] io_status read(std::int64_t now_ns, std::span<std::uint8_t> bytes,
                               usb_packet& packet) noexcept override {
    constexpr auto way = link_direction::from_device;
    last_ns_ = now_ns;
    const std::uint64_t call = both_->player.count_call();
    if (is_gone(way, now_ns, call)) return io_status::gone;
    if (const link_event* e = find(link_fault::answer, way, now_ns, call)) return e->with;
    usb_queue& q = both_->to_host;
    std::size_t i = 0;
    while (i < q.size() && q[i].due_ns <= now_ns) {
      if (!q[i].judged && !judge(i, now_ns, call)) continue;
      if (q[i].after_next) {
        ++i;
        continue;
      }
      for (std::size_t k = 0; k < i; ++k) q[k].after_next = false;
      const std::size_t size = q[i].size;
      const std::int64_t due_ns = q[i].due_ns;
      if (size <= bytes.size()) std::copy_n(q[i].bytes.begin(), size, bytes.begin());
      q.remove(i);
      if (size > bytes.size()) return io_status::too_short;
      packet = {.size = size, .host_time_ns = due_ns};
      return io_status::ok;
    }
    return io_status::nothing;
  }

 private:
  [[nodiscard]] const link_event* find(link_fault kind, link_direction way, std::int64_t now_ns,
                                       std::uint64_t call) noexcept {
    return both_->player.find(kind, way, now_ns, call);
  }
  [[nodiscard]] bool is_gone(link_direction way, std::int64_t now_ns, std::uint64_t call) noexcept {
    if (unplugged_ != both_->times_unplugged) return true;
    if (find(link_fault::unplug, way, now_ns, call) == nullptr) return false;
    both_->unplug();
    return true;
  }
  void spoil(usb_queue::entry& e, link_direction way, std::int64_t now_ns, std::uint64_t call) noexcept {
    if (e.size > 0 && find(link_fault::shorten, way, now_ns, call) != nullptr) --e.size;
    if (e.size == 0 || find(link_fault::flip_bit, way, now_ns, call) == nullptr) return;
    const std::uint64_t bit = both_->player.below(std::uint64_t{e.size} * 8);
    e.bytes[bit / 8] = static_cast<std::uint8_t>(e.bytes[bit / 8] ^ (1U << (bit % 8)));
  }

  // Plays the faults of an arriving transfer. False: it is not there any more, and another may stand in its place.
  [[nodiscard]] bool judge(std::size_t i, std::int64_t now_ns, std::uint64_t call) noexcept {
    constexpr auto way = link_direction::from_device;
    usb_queue& q = both_->to_host;
    q[i].judged = true;
    if (find(link_fault::lose, way, now_ns, call) != nullptr) {
      q.remove(i);
      return false;
    }
    spoil(q[i], way, now_ns, call);
    if (find(link_fault::duplicate, way, now_ns, call) != nullptr) {
      const usb_queue::entry twin = q[i];
      q.insert(twin);
    }
    if (const link_event* e = find(link_fault::delay, way, now_ns, call)) {
      usb_queue::entry late = q[i];
      late.due_ns += e->amount_ns;
      q.remove(i);
      q.insert(late);
      return false;
    }
    bool one_waits = false;
    for (std::size_t k = 0; k < i; ++k) one_waits = one_waits || q[k].after_next;
    if (!one_waits) q[i].after_next = find(link_fault::reorder, way, now_ns, call) != nullptr;
    return true;
  }

  std::shared_ptr<shared> both_;
  std::uint64_t unplugged_;
  std::int64_t last_ns_ = 0;
};

virtual_usb::virtual_usb(link_script script, std::size_t out_transfers)
    : shared_(std::make_shared<shared>(std::move(script), out_transfers)) {}

void virtual_usb::on_control(control_handler handler) { shared_->control = std::move(handler); }

std::size_t virtual_usb::take(std::int64_t now_ns, std::span<std::uint8_t> bytes) noexcept {
  usb_queue& q = shared_->to_device;
  if (q.size() == 0 || q[0].due_ns > now_ns) return 0;
  const std::size_t size = std::min(q[0].size, bytes.size());
  std::copy_n(q[0].bytes.begin(), size, bytes.begin());
  q.remove(0);
  return size;
}

bool virtual_usb::give(std::int64_t now_ns, std::span<const std::uint8_t> bytes) noexcept {
  if (!shared_->open || bytes.size() > usb_queue::most_bytes) return false;
  usb_queue::entry e;
  std::copy(bytes.begin(), bytes.end(), e.bytes.begin());
  e.size = bytes.size();
  e.due_ns = now_ns + shared_->player.script().latency_ns;
  return shared_->to_host.insert(e);
}

void virtual_usb::unplug() noexcept { shared_->unplug(); }

void virtual_usb::plug_in() noexcept { shared_->plugged = true; }

bool virtual_usb::plugged() const noexcept { return shared_->plugged; }

bool virtual_usb::is_open() const noexcept { return shared_->open; }

const link_player& virtual_usb::player() const noexcept { return shared_->player; }

std::unique_ptr<usb_link> virtual_usb::open() {
  if (!shared_->plugged || shared_->open) return nullptr;
  shared_->open = true;
  shared_->to_device.clear();
  shared_->to_host.clear();
  return std::make_unique<host_end>(shared_);
}

void virtual_usb_bus::move(const virtual_usb& device, std::string path) {
  for (socket& s : sockets_) {
    if (s.device == &device) s.listing.path = path;
  }
}

result<std::vector<usb_listing>> virtual_usb_bus::list(std::uint16_t vendor, std::uint16_t product) {
  std::vector<usb_listing> found;
  for (const socket& s : sockets_) {
    if (!s.device->plugged()) continue;
    if (vendor != 0 && s.listing.vendor != vendor) continue;
    if (product == 0 || s.listing.product == product) found.push_back(s.listing);
  }
  return found;
}

result<std::unique_ptr<usb_link>> virtual_usb_bus::open(const usb_listing& which, const usb_pipes&) {
  for (const socket& s : sockets_) {
    if (s.listing.path != which.path || !s.device->plugged()) continue;
    if (which.not_openable) return error{error_code::io_failed, *which.not_openable};
    std::unique_ptr<usb_link> link = s.device->open();
    if (link) return link;
    return error{error_code::io_failed, "the virtual USB device at " + which.path + " is open already; close it"};
  }
  return error{error_code::io_failed, "no virtual USB device is plugged in at " + which.path};
}

}  // namespace asperity
