// A CAN bus within this process, with any number of nodes and scripted faults.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "asperity/core/export.hpp"
#include "asperity/transport/can_bus.hpp"
#include "asperity/transport/link_script.hpp"

namespace asperity {

class virtual_can_node;

/// The bus: what one node sends, all others receive. It outlives its nodes.
class ASPERITY_API virtual_can {
 public:
  /// @param fd whether it carries CAN FD
  explicit virtual_can(bool fd = true) : fd_(fd) {}
  virtual_can(const virtual_can&) = delete;
  virtual_can& operator=(const virtual_can&) = delete;
  [[nodiscard]] bool fd() const noexcept { return fd_; }
  /// Frames that nodes have put on the bus so far.
  [[nodiscard]] std::uint64_t frames() const noexcept { return frames_; }

 private:
  friend class virtual_can_node;
  void carry(const virtual_can_node& from, const can_frame& frame, std::int64_t due_ns) noexcept;

  std::vector<virtual_can_node*> nodes_;
  std::uint64_t frames_ = 0;
  bool fd_;
};

/// One end of the bus, the host's or a device's. Faults of its script are seen from here: to_device is what this end
/// sends, from_device what it receives. It behaves as open_socketcan()'s bus does: bus-off is known, and reported
/// as `down`, from the first receive() on; until then frames are taken and lost.
/// @rt send() and receive() are safe; the queue is made at construction
class ASPERITY_API virtual_can_node final : public can_bus {
 public:
  /// @param queue_frames most frames that wait here; what comes after is lost and counted
  explicit virtual_can_node(virtual_can& bus, link_script script = {}, std::size_t queue_frames = 256);
  ~virtual_can_node() override { std::erase(bus_.nodes_, this); }
  virtual_can_node(const virtual_can_node&) = delete;
  virtual_can_node& operator=(const virtual_can_node&) = delete;
  [[nodiscard]] io_status send(std::int64_t now_ns, const can_frame& frame) noexcept override;
  [[nodiscard]] io_status receive(std::int64_t now_ns, can_frame& frame) noexcept override;

  /// As of the last receive().
  [[nodiscard]] can_health health() const noexcept override { return health_; }
  [[nodiscard]] bool takes_fd() const noexcept override { return bus_.fd_; }

  /// What the controller tells from the next receive() on, as if by an error frame: bus-off, error counters. `lost` is
  /// left out.
  void report(const can_health& health) noexcept { reported_ = health; }
  /// Calls on this end so far, and the script it plays.
  [[nodiscard]] const link_player& player() const noexcept { return player_; }
  /// Frames that wait here.
  [[nodiscard]] std::size_t waiting() const noexcept { return waiting_; }

 private:
  friend class virtual_can;
  struct entry {
    can_frame frame{};
    std::int64_t due_ns = 0;
    int copies = 1;
    bool judged = false;      // from_device faults are drawn once per frame, when it is first looked at
    bool after_next = false;  // reordered: waits until another has gone
  };

  [[nodiscard]] bool is_gone(link_direction way, std::int64_t now_ns, std::uint64_t call) noexcept;

  // A controller leaves the bus as a whole, so the direction in the script means nothing here.
  [[nodiscard]] bool is_off(std::int64_t now_ns, std::uint64_t call) noexcept;

  // The length and bits of one frame.
  void spoil(can_frame& frame, link_direction way, std::int64_t now_ns, std::uint64_t call) noexcept;

  // Plays the faults of an arriving frame. False: it is not there any more, and another may stand in its place.
  [[nodiscard]] bool judge(std::size_t i, std::int64_t now_ns, std::uint64_t call) noexcept;

  // A frame on its way here. What comes to a controller that has left the bus is lost on it.
  void arrive(const can_frame& frame, std::int64_t due_ns) noexcept;

  // Sorted by time; of equal times, what came first stands first.
  void insert(const entry& e) noexcept;

  void remove(std::size_t i) noexcept;

  virtual_can& bus_;
  link_player player_;
  std::vector<entry> queue_;
  std::size_t waiting_ = 0;
  can_frame held_frame_{};
  bool held_ = false;  // held_frame_ goes after the next one
  bool gone_ = false;
  can_health health_{};
  can_health reported_{};
};

}  // namespace asperity
