// A HID device that exists in this process only: the twin of asperity::hid.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "asperity/core/fixed_vector.hpp"
#include "asperity/transport/hid_link.hpp"
#include "asperity/transport/link_script.hpp"

namespace asperity {

/// A device on a cable. Its far end is this object, which a fake peer reads and writes; its host's end is a hid_link.
///
/// As the kernel's: the device side queues up to 63 input reports, drops the newest beyond that without a word, and an
/// open link answers `gone` from the moment of unplugging on. Plugging it in again makes a new link possible and
/// does not revive an old one. Neither end allocates after construction, except that host_end() makes the link.
class virtual_hid {
 public:
  static constexpr std::size_t max_report_bytes = 64;
  static constexpr std::size_t kernel_queue = 63;

  /// @param report_descriptor what the device says of itself
  /// @param script faults; calls are counted on the host's end, over all links that were ever open
  explicit virtual_hid(std::vector<std::uint8_t> report_descriptor, link_script script = {})
      : wire_(std::make_shared<wire>(std::move(report_descriptor), std::move(script))) {}

  /// The host's end of the cable as it is plugged in now. It outlives this object where it has to.
  [[nodiscard]] std::unique_ptr<hid_link> host_end() const { return std::make_unique<end>(wire_); }

  /// An input report: from the device to the host. @return false where it is too long or nothing is plugged in
  bool send(std::int64_t now_ns, std::span<const std::uint8_t> report) noexcept {
    return wire_->plugged && wire_->put(link_direction::from_device, now_ns, report);
  }

  /// The oldest output report that has arrived at the device. @param size its bytes, where there is one
  [[nodiscard]] bool receive(std::int64_t now_ns, std::span<std::uint8_t> report, std::size_t& size) noexcept {
    return wire_->get(link_direction::to_device, now_ns, report, size);
  }

  void unplug() noexcept { wire_->unplug(); }
  /// Back on the bus, with empty queues.
  void plug_in() noexcept {
    wire_->plugged = true;
    ++wire_->plugging;
  }
  [[nodiscard]] bool plugged() const noexcept { return wire_->plugged; }

  /// Calls on the host's end so far.
  [[nodiscard]] std::uint64_t calls() const noexcept { return wire_->player.calls(); }
  /// Input reports that were dropped because nobody read.
  [[nodiscard]] std::uint64_t dropped() const noexcept { return wire_->dropped; }

 private:
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

  struct wire {
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
        if (next == nullptr || q.due_ns < next->due_ns || (q.due_ns == next->due_ns && q.order < next->order))
          next = &q;
      }
      if (next == nullptr) return false;
      size = std::min(next->size, report.size());  // as the kernel: what does not fit is lost
      std::copy_n(next->bytes.begin(), size, report.begin());
      *next = from.waiting.back();
      from.waiting.truncate(from.waiting.size() - 1);
      return true;
    }
  };

  class end final : public hid_link {
   public:
    explicit end(std::shared_ptr<wire> w) noexcept : wire_(std::move(w)), plugging_(wire_->plugging) {}

    [[nodiscard]] std::span<const std::uint8_t> report_descriptor() const noexcept override {
      return wire_->descriptor;
    }

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

  std::shared_ptr<wire> wire_;
};

}  // namespace asperity
