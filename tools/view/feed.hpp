// The way from a session to its pages, and back: what happens, and what a page asks of a virtual clock.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>

#include "asperity/control/workspace_map.hpp"
#include "asperity/core/fixed_vector.hpp"
#include "asperity/core/triple_buffer.hpp"
#include "asperity/device/simulated/hand_lead.hpp"
#include "asperity/render/any_renderer.hpp"
#include "view/trace.hpp"

namespace asperity::view {

/// A point where the probe touches a body, or nearly does.
struct shown_contact {
  vec3 point_w{0.0};      ///< m
  vec3 n_ab_w{0.0};       ///< unit, from the probe to the body
  double depth_m = 0.0;   ///< above 0: overlap; below: a gap
  double spread_m = 0.0;  ///< radius across n of the surface that it stands for
};

/// The contacts of one tick of the contact loop.
struct contact_snapshot {
  static constexpr std::size_t capacity = 64;
  std::uint64_t number = 0;  ///< counts the snapshots of a session
  fixed_vector<shown_contact, capacity> list;
  fixed_vector<pose, 16> T_wb;  ///< where the first fixed bodies are
  pose T_wa{};                  ///< where the probe was when they were found
};

/// Copies what a tick found. Planes come first where there are some, contacts of windows otherwise; what does not fit is
/// left out and counted by the list.
/// @rt safe
inline void take_contacts(const scene_pose& at, const tick& found, contact_snapshot& to) noexcept {
  to.T_wa = at.T_wa;
  to.T_wb.clear();
  for (const pose& T : at.T_wb) static_cast<void>(to.T_wb.push_back(T));
  to.list.clear();
  for (const support_plane& p : found.planes) {
    static_cast<void>(to.list.push_back({found.centre_of_mass_w + p.r_w, p.n_ab_w, p.depth_m, p.spread_m}));
  }
  if (!found.planes.empty()) return;
  for (std::size_t i = 0; i < std::min(found.contacts.size(), found.depths.size()); ++i) {
    const penetration& d = found.depths[i];
    const vec3& n = found.contacts[i].window.n_ab_w;
    if (has(d.flags, depth_flag::no_overlap)) continue;
    static_cast<void>(to.list.push_back({d.witness_w, n, d.depth_m, 0.0}));
  }
}

/// Between one session and the pages that watch it. The session's side never waits for a page and never allocates;
/// pages take the newest of what there is.
class feed {
 public:
  /// A tick of the device loop. From one thread. @rt safe
  void saw(const session_record& record, double took_s) noexcept { rows_.add(to_row(record, took_s)); }

  /// A tick of the contact loop. From one thread, another one than saw()'s. @rt safe
  void saw_contacts(const scene_pose& at, const tick& found) noexcept {
    contact_snapshot& to = contacts_.back();
    take_contacts(at, found, to);
    to.number = ++contact_ticks_;
    contacts_.publish();
  }

  [[nodiscard]] const trace_ring& rows() const noexcept { return rows_; }

  /// The newest contacts. Any thread of a page; pages wait for each other here, a session never does.
  [[nodiscard]] contact_snapshot contacts() {
    const std::lock_guard lock(reading_);
    contacts_.refresh();
    return contacts_.front();
  }

  /// The session is over: pages keep what they have.
  void end() noexcept { ended_.store(true, std::memory_order_release); }
  [[nodiscard]] bool ended() const noexcept { return ended_.load(std::memory_order_acquire); }

  // What pages ask of a virtual clock; a session on the real one does not look.
  void pause(bool wanted) noexcept { paused_.store(wanted, std::memory_order_relaxed); }
  [[nodiscard]] bool paused() const noexcept { return paused_.load(std::memory_order_relaxed); }
  /// Lets a paused session make this many ticks more.
  void allow_steps(std::uint32_t ticks) noexcept { steps_.fetch_add(ticks, std::memory_order_relaxed); }
  /// Takes one of the steps that were allowed. From the session's thread.
  [[nodiscard]] bool take_step() noexcept {
    std::uint32_t left = steps_.load(std::memory_order_relaxed);
    while (left > 0 && !steps_.compare_exchange_weak(left, left - 1, std::memory_order_relaxed)) continue;
    return left > 0;
  }
  /// Pages lead the simulated hand from now on. Before the session begins.
  void take_lead(std::shared_ptr<hand_lead> lead, const workspace_map& map) noexcept {
    lead_ = std::move(lead);
    map_ = map;
  }
  [[nodiscard]] bool leads() const noexcept { return lead_ != nullptr; }
  /// A page wants the probe's body frame there. Any thread of a page; pages wait for each other here, a session never does.
  /// @pre leads(), is_valid(T_wa)
  void lead_to(const pose& T_wa) {
    const std::lock_guard lock(leading_);
    lead_->lead_to(map_.handle_at(T_wa * inverse(map_.T_ha)));
  }
  void forget_steps() noexcept { steps_.store(0, std::memory_order_relaxed); }
  /// Seconds of the session for one of the wall.
  void set_speed(double speed) noexcept { speed_.store(speed, std::memory_order_relaxed); }
  [[nodiscard]] double speed() const noexcept { return speed_.load(std::memory_order_relaxed); }

 private:
  trace_ring rows_;
  triple_buffer<contact_snapshot> contacts_;
  std::mutex reading_;  // of contacts_, among pages
  std::shared_ptr<hand_lead> lead_;
  workspace_map map_;
  std::mutex leading_;  // among pages
  std::uint64_t contact_ticks_ = 0;
  std::atomic<bool> ended_{false};
  std::atomic<bool> paused_{false};
  std::atomic<std::uint32_t> steps_{0};
  std::atomic<double> speed_{1.0};
};

/// A renderer whose ticks are shown: it answers as the one inside does.
class watched_renderer {
 public:
  /// @param to outlives the renderer
  watched_renderer(any_renderer inside, feed& to) : inside_(std::move(inside)), to_(&to) {}

  /// @rt as the renderer inside
  [[nodiscard]] status step(const scene_pose& at, tick& out) noexcept {
    const status answered = inside_.step(at, out);
    to_->saw_contacts(at, out);
    return answered;
  }
  [[nodiscard]] const asperity::scene& scene() const noexcept { return inside_.scene(); }
  [[nodiscard]] std::size_t memory_bytes() const noexcept { return inside_.memory_bytes(); }

 private:
  any_renderer inside_;
  feed* to_;
};

static_assert(ticks_contacts<watched_renderer>);

}  // namespace asperity::view
