// Support planes as springs that only push, solved for the end of an implicit step.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "asperity/control/linear_contact.hpp"
#include "asperity/core/export.hpp"
#include "asperity/core/fixed_vector.hpp"
#include "asperity/core/spatial.hpp"
#include "asperity/core/status.hpp"
#include "asperity/model/material.hpp"

namespace asperity {

/// What a support plane does where the probe is in it: lambda = k max(0, d + 1.5 alpha d_0 d'), d the depth, d' its
/// rate and d_0 the depth at the beginning of the step.
struct contact_law {
  /// k of each plane, N/m. A contact of 50 N/mm lets textured faces overlap by 5 to 20 um, so that hundreds of samples
  /// press of which a list of planes holds some, each time others: the block rested on the gear with 131 mN of
  /// vibration above 60 Hz, and rests with 4 mN on planes of 200 N/mm.
  double stiffness_n_per_m = 2e5;
  /// alpha, s/m, of Hunt and Crossley: the loss grows with the depth, so that a touch begins without a jump.
  /// A slow blow of speed v comes back with about 1 - alpha v of it.
  double dissipation_s_per_m = 5.0;
  int most_passes = 30;  ///< of the solver; two are usual, and a solution that needed more tells its residual
};

/// Says which setting is out of range and what would do.
[[nodiscard]] inline result<void> check(const contact_law& law) {
  const auto bad = [](std::string what) { return error{error_code::invalid_argument, "contact law: " + what}; };
  if (!(std::isfinite(law.stiffness_n_per_m) && law.stiffness_n_per_m > 0.0 && law.stiffness_n_per_m <= 1e8)) {
    return bad("stiffness_n_per_m must be above 0 and at most 1e8");
  }
  if (!(std::isfinite(law.dissipation_s_per_m) && law.dissipation_s_per_m >= 0.0)) {
    return bad("dissipation_s_per_m must be a finite number, 0 or more");
  }
  if (law.most_passes < 1 || law.most_passes > 1000) return bad("most_passes must be from 1 to 1000");
  return {};
}

/// The law of every body's planes: what its surface and the probe's make of a touch, where the plane is, and one law for
/// all of which that is not known. Copied outside a tick only.
struct contact_laws {
  contact_laws(const contact_law& of_the_others = {}, surface_pairs of_bodies = {}) noexcept
      : usual(of_the_others), pairs(std::move(of_bodies)) {}

  /// The pair of a body (support_plane::body) and the first materials; null where the usual law holds. @rt safe
  [[nodiscard]] const surface_pair* pair(std::uint32_t body) const noexcept {
    return body < pairs.size() && pairs[body] ? &*pairs[body] : nullptr;
  }
  /// The pair of a plane's own materials, and of the first ones where theirs is not known. @rt safe
  [[nodiscard]] const surface_pair* pair(const support_plane& p) const noexcept {
    if (p.of_probe == 0 && p.of_body == 0) return pair(p.body);
    for (const mapped_pair& m : told) {
      if (m.body == p.body && m.of_probe == p.of_probe && m.of_body == p.of_body) return &m.pair;
    }
    const surface_pair* const found = (of_scene != nullptr ? *of_scene : pairs).find(p.body, p.of_probe, p.of_body);
    return found != nullptr ? found : pair(p.body);
  }
  /// @rt safe
  [[nodiscard]] double stiffness_n_per_m(const support_plane& of) const noexcept {
    const surface_pair* const p = pair(of);
    return p != nullptr ? p->stiffness_n_per_m : usual.stiffness_n_per_m;
  }
  /// @rt safe
  [[nodiscard]] double dissipation_s_per_m(const support_plane& of) const noexcept {
    const surface_pair* const p = pair(of);
    return p != nullptr ? p->dissipation_s_per_m : usual.dissipation_s_per_m;
  }
  /// @rt safe
  [[nodiscard]] double stiffness_n_per_m(std::uint32_t body) const noexcept {
    const surface_pair* const p = pair(body);
    return p != nullptr ? p->stiffness_n_per_m : usual.stiffness_n_per_m;
  }
  /// @rt safe
  [[nodiscard]] double dissipation_s_per_m(std::uint32_t body) const noexcept {
    const surface_pair* const p = pair(body);
    return p != nullptr ? p->dissipation_s_per_m : usual.dissipation_s_per_m;
  }

  /// Another body is in a slot. Slots beyond the pairs that there were room for go on with the usual law. @rt safe
  void put(std::uint32_t body, const std::optional<surface_pair>& pair) noexcept {
    if (body < pairs.size()) pairs[body] = pair;
  }
  /// What a contact of a changing scene tells of its planes' materials, in the place of what the last one told. @rt safe
  void put(std::span<const contact_body> of_planes) noexcept {
    told.clear();
    for (const contact_body& b : of_planes) {
      if (b.of_probe == 0 && b.of_body == 0) {
        put(b.body, b.surface);
      } else if (b.surface) {
        static_cast<void>(told.push_back({b.body, b.of_probe, b.of_body, *b.surface}));
      }
    }
  }

  contact_law usual;
  surface_pairs pairs;
  /// Pairs of maps of materials are looked for here first; empty where the scene never changes.
  fixed_vector<mapped_pair, most_support_planes> told{};
  /// And then here, where it is not null, instead of in `pairs`: those of the scene that is rendered.
  const surface_pairs* of_scene = nullptr;
};

/// Outcome of one step against support planes.
struct contact_solution {
  vec6 velocity{};                                     ///< of c_A at the end of the step, m/s and rad/s, world axes
  std::array<double, most_support_planes> lambda_n{};  ///< force along each plane's gradient, 0 or more, N
  wrench on_probe_w{};                                 ///< minus the sum of lambda times gradient, about c_A
  double from_bodies_w = 0.0;  ///< power with which moving bodies push, W; see support_plane::closing_m_per_s
  double deepest_m = 0.0;      ///< of the planes at the beginning of the step; 0 where none is met
  double residual_n = 0.0;  ///< largest force that is out of balance in a plane, N; above 1e-7 the passes were too few
  int passes = 0;
  bool solved = false;  ///< false: the matrix is not positive definite, and nothing else here means anything
};

/// Velocity v and forces lambda at the end of a step of length h, with
///   A (v - v0) = load - sum lambda_i g_i,   lambda_i = k max(0, d_i + h_i (g_i . v + c_i)),
///   h_i = h + 1.5 alpha max(0, d_i),
/// k and alpha those of the plane's body and materials, c_i its own approach.
/// These are the conditions for the least value of a convex function of v that is quadratic wherever the set of pressed
/// planes is the same. Newton's method with an exact line search finds it in finitely many passes; each factorises one
/// 6x6 matrix. It keeps no state: the same step has the same answer whatever came before.
/// @param moved q - q0 of the planes at the beginning of the step
/// @pre a symmetric positive definite; h_s > 0; check(laws.usual)
/// @rt safe: at most laws.usual.most_passes passes
/// @source the problem: compliant unilateral constraints with implicit steps; the primal form as in Castro et al. 2023
[[nodiscard]] ASPERITY_API contact_solution solve_contact(const mat6& a, const vec6& load, const vec6& v0, double h_s,
                                                          const support_planes& planes, const vec6& moved,
                                                          const contact_laws& laws) noexcept;

/// Where springs and planes balance, planes as springs that dissipate nothing and stand still: the velocity of the answer is the way, m
/// and rad, from where `moved` is.
/// @param springs their stiffness about c_A, symmetric positive definite
/// @param pull    of the springs at `moved`
[[nodiscard]] ASPERITY_API contact_solution balance_of(const mat6& springs, const vec6& pull,
                                                       const support_planes& planes, const vec6& moved,
                                                       const contact_laws& laws) noexcept;

/// Most planes that way_to_balance() looks at.
inline constexpr std::size_t most_balanced_planes = 320;

/// The way of balance_of() alone, from where the planes were reported, for more planes than a contact carries.
/// @pre planes.size() <= most_balanced_planes
/// @return null where the springs are not positive definite or the way is not finite   @rt safe, as solve_contact()
[[nodiscard]] ASPERITY_API std::optional<vec6> way_to_balance(const mat6& springs, const vec6& pull,
                                                              std::span<const support_plane> planes,
                                                              const contact_laws& laws) noexcept;

}  // namespace asperity
