// The hand-overs between the contact thread, the device thread and the application.
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>

#include "asperity/control/linear_contact.hpp"
#include "asperity/control/moving_bodies.hpp"
#include "asperity/control/virtual_coupling.hpp"
#include "asperity/core/pose.hpp"
#include "asperity/core/triple_buffer.hpp"

namespace asperity {

/// Where the probe was, when, and how the virtual coupling pulled at it: enough to know where it will come to rest.
struct timed_pose {
  pose T_wc{};  ///< the probe's centre-of-mass frame
  std::int64_t time_ns = 0;
  coupling_pull pull{};
  double gaps_m = std::numeric_limits<double>::infinity();  ///< gaps that are wanted; see gaps_for()
  body_places bodies{};                                     ///< where the moving bodies are at this time
};

/// How an application shows that it is alive: any of its threads beats, the device thread counts. It carries no time,
/// so nobody needs the session's clock.
class heartbeat {
 public:
  /// One sign of life. From any thread. @rt safe
  void beat() noexcept { beats_.fetch_add(1, std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t beats() const noexcept { return beats_.load(std::memory_order_relaxed); }

 private:
  std::atomic<std::uint64_t> beats_{0};
};

/// Data goes round once: the device thread publishes poses, the contact thread publishes contacts. Neither waits. An
/// application may tell of moving bodies, from one thread, and take what bodies feel, from one thread.
struct exchange {
  triple_buffer<timed_pose> poses;         ///< written by the device thread
  triple_buffer<linear_contact> contacts;  ///< written by the contact thread
  triple_buffer<moving_bodies> bodies;     ///< written by the application
  triple_buffer<felt_bodies> felt;         ///< written by the device thread
  std::atomic<bool> let_go{false};         ///< set by the application; see clutch_settings::by_application
  heartbeat application;                   ///< beaten by the application, never by a loop; see watchdog_ns
};

}  // namespace asperity
