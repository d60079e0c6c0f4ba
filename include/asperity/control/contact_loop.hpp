// The slower of the two rates: from the newest probe pose to a linear contact.
#pragma once

#include <concepts>
#include <cstdint>
#include <utility>
#include <vector>

#include "asperity/control/exchange.hpp"
#include "asperity/control/linearise.hpp"
#include "asperity/render/renderer.hpp"
#include "asperity/render/tick_flag.hpp"

namespace asperity {

/// Anything that turns poses into a tick; basic_renderer is one.
template <class R>
concept contact_renderer = requires(R& renderer, const scene_pose& at, tick& out) {
  { renderer.step(at, out) }
  noexcept->std::same_as<status>;
};

/// Where the bodies of a session are. The fixed bodies stay where they are put, but for those that an application moves
/// (exchange::bodies).
struct scene_placement {
  std::vector<pose> T_wb;      ///< one per fixed body
  vec3 centre_of_mass_a{0.0};  ///< c_A in the probe's body frame, metres (textured_model::mass)

  /// Pose of the probe's centre-of-mass frame c, which has the body's axes, in the body frame.
  [[nodiscard]] pose T_ac() const noexcept { return {quat(1.0, 0.0, 0.0, 0.0), centre_of_mass_a}; }
};

/// Owns the renderer. One tick takes the newest probe pose, renders, and publishes W0, J, the support planes, q0 and
/// the time of q0. A flag of a tick stays in the contacts of the next 50 ms.
/// @tparam Renderer see contact_renderer
template <contact_renderer Renderer>
class contact_loop {
 public:
  /// @param shared outlives the loop
  /// @param selection which support planes are handed on; selection_for() knows what fits a period
  /// @param laws those that the device loop holds the probe by: where it will rest depends on them
  contact_loop(Renderer feel, scene_placement placement, exchange& shared, const plane_selection& selection = {},
               contact_laws laws = {})
      : renderer_(std::move(feel)),
        placement_(std::move(placement)),
        shared_(&shared),
        selection_(selection),
        rest_(std::move(laws)) {}

  /// compute() and publish() in one.
  /// @return the renderer's answer; ok without work where no new pose came
  /// @rt as safe as the renderer
  [[nodiscard]] status tick(std::int64_t now_ns) noexcept {
    const status s = compute(now_ns);
    publish();
    return s;
  }

  /// Renders at the newest probe pose and keeps the result until publish(). Without a new pose there is nothing to do.
  /// Where the renderer cannot answer, the result is an empty contact that carries its status: the wrench goes to zero.
  [[nodiscard]] status compute(std::int64_t now_ns) noexcept {
    if (!shared_->poses.refresh()) return status::ok;
    const timed_pose& at = shared_->poses.front();
    const pose T_wa = at.T_wc * inverse(placement_.T_ac());
    for (const body_place& b : at.bodies) {
      if (b.body < placement_.T_wb.size()) placement_.T_wb[b.body] = b.T_wb;
    }
    const status answer = renderer_.step({T_wa, placement_.T_wb, at.gaps_m}, last_);
    linearise(last_, answer, at, selection_, rest_, shared_->contacts.back());
    shared_->contacts.back().flags = flags_.held(shared_->contacts.back().flags, at.time_ns);
    pending_ = true;
    ++computed_;
    computed_at_ns_ = now_ns;
    return answer;
  }

  /// Hands the last result over, if it was not handed over yet.
  void publish() noexcept {
    if (!pending_) return;
    shared_->contacts.publish();
    pending_ = false;
  }

  [[nodiscard]] Renderer& renderer() noexcept { return renderer_; }
  /// What the last compute() found.
  [[nodiscard]] const asperity::tick& last() const noexcept { return last_; }
  /// How many poses were rendered.
  [[nodiscard]] std::uint64_t computed() const noexcept { return computed_; }
  [[nodiscard]] std::int64_t computed_at_ns() const noexcept { return computed_at_ns_; }
  /// Where the bodies were in the last compute().
  [[nodiscard]] const scene_placement& placement() const noexcept { return placement_; }

 private:
  Renderer renderer_;
  scene_placement placement_;
  exchange* shared_;
  plane_selection selection_;
  rest_prediction rest_;
  held_flags flags_;
  asperity::tick last_{};
  bool pending_ = false;
  std::uint64_t computed_ = 0;
  std::int64_t computed_at_ns_ = 0;
};

}  // namespace asperity
