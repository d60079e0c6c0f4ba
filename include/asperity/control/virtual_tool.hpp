// The virtual tool by itself: for programs that call a renderer's step() and have a loop of their own.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "asperity/control/linearise.hpp"
#include "asperity/control/moving_bodies.hpp"
#include "asperity/control/plane_selection.hpp"
#include "asperity/control/probe_motion.hpp"
#include "asperity/core/pose.hpp"
#include "asperity/render/renderer.hpp"

namespace asperity {

/// What a virtual tool is made of.
struct virtual_tool_settings {
  probe_settings probe{};
  coupling_settings coupling{};
  contact_law contact{};
  friction_settings friction{};
  surface_pairs surfaces{};     ///< as control_settings::surfaces
  plane_selection selection{};  ///< selection_for() the period in which ticks are rendered
  pose T_ha{};                  ///< the probe's body frame on the handle
  vec3 centre_of_mass_a{0.0};   ///< c_A in the probe's body frame, m (textured_model::mass)
  int substeps = 8;             ///< of the probe in one call of a millisecond or longer; see control_settings::substeps
  double longest_step_s = 0.02;  ///< a longer pause advances the probe by this much only
};

/// Probe, virtual coupling and contact behind a handle, for one thread:
///
///     virtual_tool tool({.probe = solid_probe(model->mass), .centre_of_mass_a = model->mass.centre_of_mass});
///     tool.place(T_wh);
///     for (;;) {                                       // one pass per device period
///       const status s = renderer.step({tool.T_wa(), T_wb}, found);
///       send(tool.follow(read_handle(), period_s, found, s));
///     }
///
/// It limits no force and watches no clock: what leaves should pass an output_gate, as a device_loop's wrench does.
class virtual_tool {
 public:
  /// @pre check(settings.contact), check(settings.friction), check(settings.selection)
  explicit virtual_tool(const virtual_tool_settings& settings) noexcept
      : settings_(settings),
        T_hc_(settings.T_ha * pose{quat(1.0, 0.0, 0.0, 0.0), settings.centre_of_mass_a}),
        T_ca_(inverse(pose{quat(1.0, 0.0, 0.0, 0.0), settings.centre_of_mass_a})),
        motion_(settings.probe, settings.coupling, {settings.contact, settings.surfaces}, settings.substeps,
                settings.friction),
        rest_({settings.contact, settings.surfaces}) {}

  /// Puts the probe where the handle is, at rest.
  /// @pre is_valid(T_wh)
  void place(const pose& T_wh) noexcept {
    motion_.forget_contact();
    rest_.forget();
    motion_.place(T_wh * T_hc_);
  }

  /// Pose of the probe's body frame: where the next tick is to be rendered.
  [[nodiscard]] pose T_wa() const noexcept { return motion_.probe().state().T_wc * T_ca_; }

  /// Lets the probe follow the handle for dt_s seconds against what a renderer found.
  /// @param T_wh the handle's pose now
  /// @param found rendered at T_wa() as it was before this call
  /// @param answer of the renderer; a contact of one that could not answer is empty
  /// @return wrench on the hand, world axes, about the handle's origin; zero where last() is not ok
  /// @rt safe
  [[nodiscard]] wrench follow(const pose& T_wh, double dt_s, const tick& found, status answer = status::ok) noexcept {
    return follow(T_wh, dt_s, found, answer, T_wa());
  }

  /// The same where bodies move meanwhile.
  /// @param moving where they are at the beginning of these dt_s seconds, and how fast they go; the tick was rendered
  ///               with them there
  [[nodiscard]] wrench follow(const pose& T_wh, double dt_s, const tick& found, status answer,
                              std::span<const body_motion> moving) noexcept {
    moving_.clear();
    places_.clear();
    for (const body_motion& m : moving) {
      if (!moving_.push_back(m)) break;
      static_cast<void>(places_.push_back({m.body, m.T_wb}));
    }
    const wrench felt = follow(T_wh, dt_s, found, answer, T_wa());
    moving_.clear();
    places_.clear();
    return felt;
  }

  /// The same for a tick that was rendered earlier, at T_wa_then.
  [[nodiscard]] wrench follow(const pose& T_wh, double dt_s, const tick& found, status answer,
                              const pose& T_wa_then) noexcept {
    if (!is_valid(T_wh) || !is_valid(T_wa_then) || !std::isfinite(dt_s)) {
      last_ = status::invalid_pose;
      return {};
    }
    const pose then_T_wc = T_wa_then * inverse(T_ca_);
    coupling_pull pull = motion_.coupling().pull(T_wh * T_hc_, then_T_wc);
    pull.on_probe_w += motion_.rubbing().on_probe_w();
    const double step_s = std::min(dt_s, settings_.longest_step_s);
    linearise(found, answer, {.T_wc = then_T_wc, .pull = pull, .bodies = places_}, settings_.selection, rest_,
              contact_);
    body_ways ways;
    for (const body_motion& m : moving_) static_cast<void>(ways.push_back(way_of(m, step_s)));
    last_ = motion_.move(step_s, T_wh * T_hc_, 1.0, contact_, ways);
    const wrench felt = transport(motion_.on_hand_w(), motion_.target().position, T_wh.position);
    if (last_ == status::ok && !is_finite(felt)) last_ = status::not_finite;
    return last_ == status::ok ? felt : wrench{};
  }

  /// How the last follow() ended: ok | invalid_pose | not_finite. The contact's own answer is in contact().answer.
  [[nodiscard]] status last() const noexcept { return last_; }
  /// What the last follow() was held by.
  [[nodiscard]] const linear_contact& contact() const noexcept { return contact_; }
  [[nodiscard]] const probe_motion& motion() const noexcept { return motion_; }

 private:
  virtual_tool_settings settings_;
  pose T_hc_;
  pose T_ca_;
  probe_motion motion_;
  rest_prediction rest_;
  fixed_vector<body_motion, most_moving_bodies> moving_;
  body_places places_;
  linear_contact contact_{};
  status last_ = status::not_ready;
};

}  // namespace asperity
