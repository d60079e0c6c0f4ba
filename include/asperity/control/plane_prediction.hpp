// The support planes of the pose where the probe will come to rest: what planes of its present pose cannot know.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "asperity/control/contact_solver.hpp"
#include "asperity/control/linear_contact.hpp"
#include "asperity/control/virtual_coupling.hpp"
#include "asperity/core/pose.hpp"
#include "asperity/core/spatial.hpp"
#include "asperity/render/plane_source.hpp"

namespace asperity {

namespace detail {

/// How far planes are followed from where they were told: planes further off are too wrong.
inline constexpr double furthest_rest_m = 1e-4, furthest_rest_rad = 5e-3;
/// How many such ways a pose of rest may be from the probe's: as far as one that slides off an edge comes in two
/// periods of a slow contact loop.
inline constexpr double most_ways = 5.0;

/// The length of a motion, in those of furthest_rest_m and furthest_rest_rad.
[[nodiscard]] inline double share_of_furthest(const vec6& way) noexcept {
  return std::max(std::sqrt(glm::dot(way.linear, way.linear)) / furthest_rest_m,
                  std::sqrt(glm::dot(way.angular, way.angular)) / furthest_rest_rad);
}

/// Where springs and planes balance, as a motion from the pose where both were told, of at most half a millimetre and
/// 25 mrad.
[[nodiscard]] inline vec6 rest_of(const coupling_pull& pull, const support_planes& planes) noexcept {
  mat6 springs;
  for (std::size_t i = 0; i < 6; ++i) springs(i, i) = i < 3 ? pull.stiffness_n_per_m : pull.stiffness_n_m_per_rad;
  contact_law still;
  still.dissipation_s_per_m = 0.0;
  // A step of one second with the springs in the place of the mass: its velocity is the way.
  const contact_solution s = solve_contact(springs, to_vec6(pull.on_probe_w), {}, 1.0, planes, {}, still);
  if (!s.solved || !is_finite(s.velocity)) return {};
  const double ways = share_of_furthest(s.velocity);
  return ways > most_ways ? (most_ways / ways) * s.velocity : s.velocity;
}

/// Whether two planes stand for one point of a surface.
[[nodiscard]] inline bool same_point(const support_plane& p, const support_plane& q) noexcept {
  constexpr double same_sample_m = 2e-5;  // a sample turns with the probe by less than this
  if (p.body != q.body) return false;
  if (p.sample != 0 && q.sample != 0) return p.sample == q.sample;
  const vec3 apart = q.r_w - p.r_w;
  return glm::dot(apart, apart) < same_sample_m * same_sample_m;
}

}  // namespace detail

/// Completes the planes of a contact by those of the pose where the probe will rest on them.
///
/// Planes are the surface to first order. A curved or textured surface meets the probe where none of them says so; told
/// a period later, the new plane pushes at once, the old one is not needed any more, and a resting probe trembles. So
/// the pose is sought where the coupling's springs and the true surface balance: the least energy of the springs and of
/// a spring behind every sample that is in overlap. From a pose that is known the planes there are balanced with the
/// springs; where the energy at the balance is less, the search goes on from it. Where it is not, the planes of the
/// balance that hold at the known pose as well are added (cutting planes: the surface is concave), and where none does
/// (the surface is convex: beyond the edge it falls away), the way is shortened.
///
/// The pose is kept for the next contact, whose search begins there unless the probe's own pose has less energy. So a
/// resting probe is told the same planes again, whatever it does meanwhile; begun anew at each pose, the search
/// went to another side of an edge from each, and the probe with it.
///
/// Of each sample a contact then tells the plane of that pose, in the place of one of the probe's own pose that says
/// the same there or more. Where the pose is further away than a tenth of a millimetre or 5 mrad, the planes of one so
/// far on the way to it are told.
/// @source cutting planes: J. E. Kelley, The cutting-plane method for solving convex programs, 1960; steps that have to
/// lessen a merit: bundle methods, e.g. K. C. Kiwiel, Methods of descent for nondifferentiable optimization, 1985
class rest_prediction {
 public:
  /// Forgets the pose of rest: the next search begins where the probe is.
  void forget() noexcept { known_ = false; }

  /// @param pull of the coupling at T_wc; nothing is done where it is not known
  /// @param T_wc pose of c_A that pull and planes were told at
  /// @param planes completed in place
  /// @rt safe: at most 9 questions to planes_near
  void complete(const plane_source& planes_near, const coupling_pull& pull, const pose& T_wc,
                support_planes& planes) noexcept {
    const bool known = known_;
    known_ = false;
    if (!planes_near || planes.empty()) return;
    if (!(pull.stiffness_n_per_m > 0.0) || !(pull.stiffness_n_m_per_rad > 0.0) || !is_finite(pull.on_probe_w)) return;
    pull_ = pull;
    if (!begin(planes_near, known, known ? pose_difference(rest_T_wc_, T_wc) : vec6{})) return;
    search(planes_near);
    rest_T_wc_ = {glm::normalize(exp_rotation(here_.moved.angular) * T_wc.rotation),
                  T_wc.position + here_.moved.linear};
    known_ = true;
    if (come_near(planes_near)) tell(planes);
  }

 private:
  static constexpr double gap_m = 1e-5;     // planes that are further away than this change nothing at that pose
  static constexpr double agrees_m = 1e-7;  // of a spring of 200 N/mm: 20 mN
  static constexpr double kink_m = 1e-6;    // by less than this two planes of a point say the same

  /// A pose, as a motion from the probe's, and what is there.
  struct place {
    vec6 moved{};
    plane_list planes{};  // told there, their depths too
    double energy_j = 0.0;
    bool all = true;  // of the planes above the gap
  };

  [[nodiscard]] static double depth_at(const support_plane& told_at_0, const vec6& moved) noexcept {
    return told_at_0.depth_m + dot(told_at_0.gradient, moved);
  }

  [[nodiscard]] bool look(const plane_source& planes_near, const vec6& moved, place& out) noexcept {
    const status answer = planes_near(moved, -gap_m, out.planes);
    if (answer != status::ok && answer != status::capacity_reached) return false;
    out.all = answer == status::ok;
    out.moved = moved;
    const vec6 f = to_vec6(pull_.on_probe_w);
    double energy_j = -dot(f, moved);
    energy_j += 0.5 * pull_.stiffness_n_per_m * glm::dot(moved.linear, moved.linear) +
                0.5 * pull_.stiffness_n_m_per_rad * glm::dot(moved.angular, moved.angular);
    for (support_plane& p : out.planes) {
      if (!is_finite(p)) return false;
      energy_j += 0.5 * stiffness_n_per_m_ * std::max(0.0, p.depth_m) * std::max(0.0, p.depth_m);
    }
    out.energy_j = energy_j;
    return std::isfinite(energy_j);
  }

  // Where the search begins: at the pose of rest of the contact before where that is here or has less energy than the
  // probe's own pose, which is known where the way is short.
  [[nodiscard]] bool begin(const plane_source& planes_near, bool known, const vec6& rest) noexcept {
    constexpr double here_share = 0.02;
    const double share = detail::share_of_furthest(rest);
    if (known && share < here_share) return look(planes_near, rest, here_);
    if (!look(planes_near, {}, here_)) return false;
    if (!known || share > detail::most_ways) return true;
    if (!look(planes_near, rest, there_)) return false;
    if (there_.energy_j < here_.energy_j) std::swap(here_, there_);
    return true;
  }

  // Of a place, the plane of the same point; null where it has none.
  [[nodiscard]] static const support_plane* same_in(const place& at, const support_plane& p) noexcept {
    const support_plane* const found = std::find_if(at.planes.begin(), at.planes.end(),
                                                    [&](const support_plane& q) { return detail::same_point(p, q); });
    return found == at.planes.end() ? nullptr : found;
  }

  // A plane told at `from`, as told where the probe is.
  [[nodiscard]] static support_plane as_from_here(const support_plane& p, const vec6& from) noexcept {
    support_plane out = p;
    out.depth_m -= dot(p.gradient, from);
    return out;
  }

  void search(const plane_source& planes_near) noexcept {
    constexpr int most_trials = 6;
    constexpr double still_m = 5e-8, still_rad = 2.5e-6;
    double reach = 1.0;
    cuts_.clear();
    for (int trial = 0; trial < most_trials; ++trial) {
      all_.clear();
      for (const support_plane& p : here_.planes) static_cast<void>(all_.push_back(as_from_here(p, here_.moved)));
      for (const support_plane& p : cuts_) static_cast<void>(all_.push_back(p));
      const vec6 way = detail::rest_of(pull_, all_) - here_.moved;
      const double share = detail::share_of_furthest(way);
      if (share * detail::furthest_rest_m < still_m && share * detail::furthest_rest_rad < still_rad) return;
      const vec6 step = share > reach ? (reach / share) * way : way;
      if (!look(planes_near, here_.moved + step, there_)) return;
      if (there_.energy_j < here_.energy_j) {
        go_there();
      } else if (!add_cuts()) {
        reach = 0.25 * std::min(reach, share);
      }
    }
  }

  // What holds of the planes so far at the new pose, and is not its own, are cuts from now on.
  void go_there() noexcept {
    cuts_.clear();
    for (const support_plane& p : all_) {
      const support_plane* const now = same_in(there_, p);
      const double said_m = depth_at(p, there_.moved);
      if (now != nullptr && said_m > -gap_m && said_m < now->depth_m - kink_m) keep(p);
    }
    std::swap(here_, there_);
  }

  // The planes of the pose that was tried which the known pose does not contradict and whose points are deeper than
  // told so far: a wall that was not known. Where the surface only bends, a shorter way does better, since two planes
  // of a point push twice. @return whether there is one
  [[nodiscard]] bool add_cuts() noexcept {
    bool added = false;
    for (const support_plane& p : there_.planes) {
      const support_plane from_here = as_from_here(p, there_.moved);
      const support_plane* const now = same_in(here_, p);
      const double most_m = now != nullptr ? now->depth_m + agrees_m : -gap_m;
      if (depth_at(from_here, here_.moved) > most_m) continue;
      if (now != nullptr && depth_at(as_from_here(*now, here_.moved), there_.moved) > p.depth_m - kink_m) continue;
      added = keep(from_here) || added;
    }
    return added;
  }

  bool keep(const support_plane& p) noexcept {
    if (cuts_.size() == most_cuts) return false;
    return cuts_.push_back(p);
  }

  // Planes of a pose that is far away would push the probe through what lies between: those of a pose on the way are
  // told.
  [[nodiscard]] bool come_near(const plane_source& planes_near) noexcept {
    const double ways = detail::share_of_furthest(here_.moved);
    if (!(ways > 1.0)) return true;
    cuts_.clear();
    return look(planes_near, (1.0 / ways) * here_.moved, here_);
  }

  // Each point that presses is told once: by its planes at the pose of rest. Planes of the probe's own pose that say
  // more there than is true would keep the probe from it, those that say less would be a second spring.
  void tell(support_planes& planes) noexcept {
    all_.clear();
    std::swap(all_, planes);  // the planes of the probe's pose
    for (const support_plane& p : here_.planes) static_cast<void>(planes.push_back(as_from_here(p, here_.moved)));
    for (const support_plane& p : cuts_) static_cast<void>(planes.push_back(p));
    for (const support_plane& p : all_) {
      const double said_m = depth_at(p, here_.moved);
      const support_plane* const now = same_in(here_, p);
      const double most_m = now != nullptr ? std::min(0.0, now->depth_m - agrees_m) : -gap_m;
      const bool replaced = said_m > most_m && (now != nullptr || (here_.all && p.sample != 0));
      if (!replaced) static_cast<void>(planes.push_back(p));
    }
  }

  static constexpr std::size_t most_cuts = 12;
  double stiffness_n_per_m_ = contact_law{}.stiffness_n_per_m;
  bool known_ = false;
  pose rest_T_wc_{};
  coupling_pull pull_{};
  place here_{}, there_{};
  support_planes cuts_{};  // told where the probe is
  support_planes all_{};
};

}  // namespace asperity
