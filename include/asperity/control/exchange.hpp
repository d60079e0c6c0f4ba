// The hand-overs between the contact thread, the device thread and the application.
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>

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
  /// Of the contact in use: nothing of a scene before this one is read any more. Whoever reads no planes again says
  /// nothing.
  std::uint64_t version = std::numeric_limits<std::uint64_t>::max();
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

/// Hands single values from one thread to another without a lock: one is on its way at a time, and none is lost. Values
/// are moved, so that nothing is made or freed on either side.
/// @rt safe on both sides, where moving a T is
template <class T>
class mailbox {
 public:
  /// Whether the value that was posted last has not been taken. From either side.
  [[nodiscard]] bool full() const noexcept { return full_.load(std::memory_order_acquire); }
  /// Posts a value. Producer only. @return false where the one before was not taken: the value stays with the caller
  [[nodiscard]] bool post(T&& value) noexcept {
    if (full()) return false;
    value_ = std::move(value);
    full_.store(true, std::memory_order_release);
    return true;
  }
  /// Gives the value that was posted to use(T&&); until that returns, the mailbox is full. Consumer only.
  /// @return false where there is none
  template <class Use>
  bool take(Use&& use) noexcept {
    if (!full()) return false;
    use(std::move(value_));
    full_.store(false, std::memory_order_release);
    return true;
  }

 private:
  T value_{};
  alignas(64) std::atomic<bool> full_{false};
};

/// The way of scenes between the thread that edits them and the contact thread: a new one comes, the old one goes back,
/// because it must not be freed in a tick.
template <class Scene>
class scene_hand_over {
 public:
  using scene_ptr = std::shared_ptr<const Scene>;

  /// Whether a scene waits to be taken. Editing thread.
  [[nodiscard]] bool pending() const noexcept { return next_.full(); }
  /// Offers a scene, and frees the one that came back. Editing thread. @return false while another one is pending
  [[nodiscard]] bool offer(scene_ptr next) {
    if (pending()) return false;
    collect();
    return next_.post(std::move(next));
  }
  /// Frees the scene that came back, if one did. Editing thread.
  void collect() {
    old_.take([](scene_ptr&& old) { const scene_ptr freed = std::move(old); });
  }

  /// Gives the scene that waits to exchange(next), which returns the one that it replaces. That one is kept for those who
  /// still read it, until give_back(). Contact thread.
  /// @pre give_back() said that none is kept   @return whether there was one   @rt safe
  template <class Exchange>
  bool take(Exchange&& exchange) noexcept {
    return next_.take([&](scene_ptr&& next) { kept_ = exchange(std::move(next)); });
  }
  /// Gives back the scene that was kept. offer() frees the one before it, so there is room in the end. Contact thread.
  /// @return whether none is kept any more: false while the editing thread has the one before it to free   @rt safe
  bool give_back() noexcept { return !kept_ || old_.post(std::move(kept_)); }

 private:
  mailbox<scene_ptr> next_, old_;
  scene_ptr kept_;
};

/// Which version of a changing scene the hand feels, and since when.
struct scene_use {
  std::uint64_t version = 0;  ///< placed_scene::version; 0: of a scene that never changes, or none yet
  std::uint64_t tick = 0;     ///< the first device tick with it; the session's first is 1
  std::int64_t time_ns = 0;   ///< of that tick, on the session's clock
};

/// Data goes round once: the device thread publishes poses, the contact thread publishes contacts. Neither waits. An
/// application may tell of moving bodies, from one thread, and take what bodies feel, from one thread.
struct exchange {
  triple_buffer<timed_pose> poses;         ///< written by the device thread
  triple_buffer<linear_contact> contacts;  ///< written by the contact thread
  triple_buffer<moving_bodies> bodies;     ///< written by the application
  triple_buffer<felt_bodies> felt;         ///< written by the device thread
  triple_buffer<scene_use> scene;          ///< written by the device thread, read by whoever edits the scene
  std::atomic<bool> let_go{false};         ///< set by the application; see clutch_settings::by_application
  heartbeat application;                   ///< beaten by the application, never by a loop; see watchdog_ns
};

/// What an application tells a session while it runs, and hears from it.
class session_application {
 public:
  /// Tells where the bodies are that move; see moving_bodies. Their poses are those of told.time_ns, on the session's
  /// clock. From one thread. @rt safe
  void move_bodies(const moving_bodies& told) noexcept {
    shared_.bodies.back() = told;
    shared_.bodies.publish();
  }
  /// What the bodies felt in the newest device tick. From one thread; lives until its next call. @rt safe
  [[nodiscard]] const felt_bodies& felt() noexcept {
    shared_.felt.refresh();
    return shared_.felt.front();
  }
  /// Has the handle let go of the probe, or take it up again; needs clutch_settings::by_application. From any thread.
  /// @rt safe
  void let_go(bool wanted) noexcept { shared_.let_go.store(wanted, std::memory_order_relaxed); }

  /// Which version of the scene the hand feels. From the thread that edits the scene. @rt safe
  [[nodiscard]] scene_use scene_in_use() noexcept {
    shared_.scene.refresh();
    return shared_.scene.front();
  }
  /// A sign of life, from any thread. Only these feed control_settings::watchdog_ns.
  void beat() noexcept { shared_.application.beat(); }

 protected:
  exchange shared_{};
};

}  // namespace asperity
