#include "asperity/transport/virtual/virtual_hid.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "asperity/core/fixed_vector.hpp"

namespace asperity {

struct virtual_hid::wire {
  struct queued {
    std::array<std::uint8_t, max_report_bytes> bytes{};
    std::size_t size = 0;
    std::int64_t due_ns = 0;
    std::uint64_t order = 0;
  };
  struct queue {
    fixed_vector<queued, kernel_queue + 1> waiting{};  // one more, for a report that was sent twice
    queued held{};                                     // to be put behind the next one
    bool holding = false;
  };

  wire(std::vector<std::uint8_t> d, link_script s) : descriptor(std::move(d)), player(std::move(s)) {}

  std::vector<std::uint8_t> descriptor;
  link_player player;
  std::array<queue, 2> queues{};
  bool plugged = true;
  std::uint64_t plugging = 0;
  std::uint64_t order = 0;
  std::uint64_t dropped = 0;

  [[nodiscard]] queue& of(link_direction d) noexcept { return queues[d == link_direction::to_device ? 0 : 1]; }

  void unplug() noexcept {
    plugged = false;
    for (queue& q : queues) {
      q.waiting.clear();
      q.holding = false;
    }
  }

  // The frame belongs to the call under way, or to the next one where the device sends by itself.
  bool put(link_direction d, std::int64_t now_ns, std::span<const std::uint8_t> report) noexcept {
    if (report.size() > max_report_bytes || report.empty()) return false;
    const std::uint64_t call = player.calls() - (d == link_direction::to_device ? 1 : 0);
    queued q;
    q.size = report.size();
    std::copy(report.begin(), report.end(), q.bytes.begin());
    q.due_ns = now_ns + player.script().latency_ns;
    if (player.find(link_fault::lose, d, now_ns, call) != nullptr) return true;
    if (const link_event* e = player.find(link_fault::delay, d, now_ns, call)) q.due_ns += e->amount_ns;
    if (player.find(link_fault::shorten, d, now_ns, call) != nullptr) --q.size;
    if (q.size > 0 && player.find(link_fault::flip_bit, d, now_ns, call) != nullptr) {
      const std::uint64_t bit = player.below(8 * q.size);
      q.bytes[bit / 8] = static_cast<std::uint8_t>(q.bytes[bit / 8] ^ (1U << (bit % 8)));
    }
    queue& to = of(d);
    if (!to.holding && player.find(link_fault::reorder, d, now_ns, call) != nullptr) {
      to.held = q;
      to.holding = true;
      return true;
    }
    enqueue(to, q);
    if (player.find(link_fault::duplicate, d, now_ns, call) != nullptr) enqueue(to, q);
    if (to.holding) {
      to.holding = false;
      to.held.due_ns = std::max(to.held.due_ns, q.due_ns);
      enqueue(to, to.held);
    }
    return true;
  }

  void enqueue(queue& to, queued q) noexcept {
    q.order = order++;
    if (to.waiting.size() >= kernel_queue) {
      ++dropped;
      return;
    }
    static_cast<void>(to.waiting.push_back(q));
  }

  bool get(link_direction d, std::int64_t now_ns, std::span<std::uint8_t> report, std::size_t& size) noexcept {
    queue& from = of(d);
    queued* next = nullptr;
    for (queued& q : from.waiting) {
      if (q.due_ns > now_ns) continue;
      if (next == nullptr || q.due_ns < next->due_ns || (q.due_ns == next->due_ns && q.order < next->order)) next = &q;
    }
    if (next == nullptr) return false;
    size = std::min(next->size, report.size());  // as the kernel: what does not fit is lost
    std::copy_n(next->bytes.begin(), size, report.begin());
    *next = from.waiting.back();
    from.waiting.truncate(from.waiting.size() - 1);
    return true;
  }
};

class virtual_hid::end final : public hid_link {
 public:
  explicit end(std::shared_ptr<wire> w) noexcept : wire_(std::move(w)), plugging_(wire_->plugging) {}

  [[nodiscard]] std::span<const std::uint8_t> report_descriptor() const noexcept override { return wire_->descriptor; }

  [[nodiscard]] io_status read(std::int64_t now_ns, std::span<std::uint8_t> bytes,
                               hid_report& report) noexcept override {
    io_status early = io_status::ok;
    if (!begin(link_direction::from_device, now_ns, early)) return early;
    std::size_t size = 0;
    if (!wire_->get(link_direction::from_device, now_ns, bytes, size)) return io_status::nothing;
    report = {size, now_ns};
    return io_status::ok;
  }

  [[nodiscard]] io_status write(std::int64_t now_ns, std::span<const std::uint8_t> bytes) noexcept override {
    io_status early = io_status::ok;
    if (!begin(link_direction::to_device, now_ns, early)) return early;
    return wire_->put(link_direction::to_device, now_ns, bytes) ? io_status::ok : io_status::refused;
  }

 private:
  // @return false where the call ends here, with `answer`
  [[nodiscard]] bool begin(link_direction d, std::int64_t now_ns, io_status& answer) noexcept {
    const std::uint64_t call = wire_->player.count_call();
    if (wire_->player.find(link_fault::unplug, d, now_ns, call) != nullptr) wire_->unplug();
    if (!wire_->plugged || plugging_ != wire_->plugging) {
      answer = io_status::gone;
      return false;
    }
    if (const link_event* e = wire_->player.find(link_fault::answer, d, now_ns, call)) {
      answer = e->with;
      return false;
    }
    return true;
  }

  std::shared_ptr<wire> wire_;
  std::uint64_t plugging_;
};

virtual_hid::virtual_hid(std::vector<std::uint8_t> report_descriptor, link_script script)
    : wire_(std::make_shared<wire>(std::move(report_descriptor), std::move(script))) {}

std::unique_ptr<hid_link> virtual_hid::host_end() const { return std::make_unique<end>(wire_); }

bool virtual_hid::send(std::int64_t now_ns, std::span<const std::uint8_t> report) noexcept {
  return wire_->plugged && wire_->put(link_direction::from_device, now_ns, report);
}

bool virtual_hid::receive(std::int64_t now_ns, std::span<std::uint8_t> report, std::size_t& size) noexcept {
  return wire_->get(link_direction::to_device, now_ns, report, size);
}

void virtual_hid::unplug() noexcept { wire_->unplug(); }

void virtual_hid::plug_in() noexcept {
  wire_->plugged = true;
  ++wire_->plugging;
}

bool virtual_hid::plugged() const noexcept { return wire_->plugged; }

std::uint64_t virtual_hid::calls() const noexcept { return wire_->player.calls(); }

std::uint64_t virtual_hid::dropped() const noexcept { return wire_->dropped; }

}  // namespace asperity
