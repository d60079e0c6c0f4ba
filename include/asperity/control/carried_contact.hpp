// What becomes of a contact's support planes until the next contact: they are read again, and go with their bodies.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>

#include "asperity/control/linear_contact.hpp"
#include "asperity/control/moving_bodies.hpp"
#include "asperity/core/fixed_vector.hpp"
#include "asperity/core/pose.hpp"
#include "asperity/core/spatial.hpp"
#include "asperity/render/plane_source.hpp"

namespace asperity {

/// Reads a contact's planes again where the probe is.
///
/// A plane is the surface to first order at the pose of its contact. On a texture that is soon wrong: a hand of 0.1 m/s
/// goes half a millimetre in a period of 200 Hz, past a ridge and into the next valley. The points that the planes stand
/// for are few, and to read them is a small part of a contact tick; to find them is the rest. So the contact thread finds
/// them, and the device thread reads them.
///
/// What lies beside a point is not known here. Where a probe slides over an edge or a ridge the surface falls away from
/// the point that was told, and another one comes to press that was not: the contact left it out because the plane of
/// the first one stood for it. So where a body is touched, the contact's own plane is a wall. A reading may let go of the
/// probe by 5 um against the wall, and there the wall holds. Contacts that are slow would not let a texture be felt like
/// that. So where the point has gone 0.1 mm since its contact, a reading may let go by as much more as it goes on, up to
/// 0.2 mm, but by no more than 0.1 m/s since the contact came. So the 5 um stay where every device tick has a contact of
/// its own; a faster device loop, or a contact that is late, comes to 0.1 mm within a millisecond.
///
/// Where a point had let go before its body was touched, or before its contact came, as an older contact's may have, its
/// wall is kept as far out as it takes to press on nothing: it holds the probe and does not push it.
///
/// A body is touched where a point is a quarter of a millimetre from it or closer, and for a tenth of a second after, since
/// a probe that slides off hops. The planes of a body that the probe only sweeps by do not hold: a wall that is level with
/// the surface at a flank or an edge stands in the way a few millimetres on.
/// @rt safe
class local_model {
 public:
  /// @param reads false: planes stay as the contact has them
  explicit local_model(bool reads) noexcept : reads_(reads) {}

  /// The next call of planes_of() is the first for another contact.
  void take_contact() noexcept { is_new_ = true; }

  /// The contact's planes as they are for a probe at T_wc, linear about the contact's pose like its own. Bodies that move
  /// are where their ways begin; carried_contact takes the planes there.
  /// @param contact the one of the last call, unless take_contact() was called since
  /// @return contact.planes where nobody can read them again   @warning until the next call
  [[nodiscard]] const support_planes& planes_of(const linear_contact& contact, std::span<const body_way> ways,
                                                const pose& T_wc) noexcept {
    if (!reads(contact)) return contact.planes;
    if (std::exchange(is_new_, false)) begin(contact);
    read(contact, ways, T_wc, 0.0, -std::numeric_limits<double>::infinity());
    return planes_;
  }

  /// A period of dt_s seconds has gone by with the contact of the last planes_of().
  void pass(double dt_s) noexcept { age_s_ += dt_s; }

  /// Reads those planes again that may press on a probe that has come to T_wc since: what planes_of() returned follows.
  /// @param part of the period that has passed: bodies that move have gone so far on their ways
  /// @pre planes_of() with the same contact
  void follow(const linear_contact& contact, std::span<const body_way> ways, const pose& T_wc, double part) noexcept {
    if (reads(contact)) read(contact, ways, T_wc, part, -may_press_m);
  }

 private:
  static constexpr double may_press_m = 2e-5;  // a gap, which a hand of 0.15 m/s closes in an eighth of a millisecond
  static constexpr double near_m = 2.5e-4;
  static constexpr double least_give_m = 5e-6;
  static constexpr double most_give_m = 2e-4;
  static constexpr double firm_way_m = 1e-4;  // what a point goes beyond it, a reading may let go by
  static constexpr double lets_go_m_per_s = 0.1;
  static constexpr double slack_m = 1e-6;  // a point that stays as deep is read, and its wall does not press
  static constexpr double holds_not_m = std::numeric_limits<double>::infinity();
  static constexpr std::int64_t hop_ns = 100'000'000;

  struct touched_body {
    std::uint32_t body = 0;
    std::int64_t at_ns = 0;  // time of the last contact by which it was touched
  };

  [[nodiscard]] bool reads(const linear_contact& contact) const noexcept {
    return reads_ && contact.reader != nullptr && !contact.places.empty();
  }

  void begin(const linear_contact& contact) noexcept {
    planes_ = contact.planes;
    age_s_ = 0.0;
    gives_m_.fill(holds_not_m);
    const auto is_over = [&](const touched_body& t) { return contact.time_ns - t.at_ns > hop_ns; };
    touched_.truncate(
        static_cast<std::size_t>(std::remove_if(touched_.begin(), touched_.end(), is_over) - touched_.begin()));
  }

  // Reads the planes that are deeper than least_m, as far as is known.
  void read(const linear_contact& contact, std::span<const body_way> ways, const pose& T_wc, double part,
            double least_m) noexcept {
    for (const body_place& then : contact.places) {
      // A depth depends on the bodies' pose to each other: the body stays where it was, and the probe is moved.
      const body_way* const way = find_way(ways, then);
      const pose there_T_wc = way == nullptr ? T_wc : then.T_wb * inverse(way->after(part)) * T_wc;
      const vec6 moved = pose_difference(there_T_wc, contact.T_wc);
      read_.clear();
      std::array<std::size_t, most_support_planes> of{};
      for (std::size_t i = 0; i < planes_.size(); ++i) {
        if (planes_[i].body != then.body || planes_[i].depth_m + dot(planes_[i].gradient, moved) < least_m) continue;
        of[read_.size()] = i;
        support_plane p = contact.planes[i];
        p.depth_m += dot(p.gradient, moved);
        static_cast<void>(read_.push_back(p));
      }
      contact.reader->read(there_T_wc, then.T_wb, then.body, {read_.data(), read_.size()});
      const bool touched = note_touch(then.body, contact.time_ns);
      for (std::size_t r = 0; r < read_.size(); ++r) hold(of[r], contact.planes[of[r]], read_[r], touched, moved);
    }
  }

  // A plane that was read becomes linear about the contact's pose; where its body is touched, the plane that was told
  // holds.
  // @param moved of the probe against the body since the contact
  void hold(std::size_t i, const support_plane& told, const support_plane& now, bool touched,
            const vec6& moved) noexcept {
    const double wall_m = told.depth_m + dot(told.gradient, moved);
    if (touched && gives_m_[i] == holds_not_m) {
      gives_m_[i] = std::max(least_give_m, wall_m - std::max(now.depth_m, 0.0) + slack_m);
    }
    double give_m = gives_m_[i];
    if (now.depth_m < wall_m - give_m) give_m = std::max(give_m, slow_give_m(told, moved));
    support_plane& p = planes_[i];
    if (now.depth_m < wall_m - give_m) {
      p = told;
      p.depth_m -= give_m;
    } else {
      p = now;
      p.depth_m -= dot(p.gradient, moved);
    }
  }

  // By how much a reading may let go of a point that has moved since its contact came.
  [[nodiscard]] double slow_give_m(const support_plane& told, const vec6& moved) const noexcept {
    const double way_m = glm::length(moved.linear + glm::cross(moved.angular, told.r_w));
    return std::min({way_m - firm_way_m, lets_go_m_per_s * age_s_, most_give_m});
  }

  // Notes whether a body is touched, by its planes as they were read. @return whether it is, or was a short time ago
  // @param now_ns time of the contact
  [[nodiscard]] bool note_touch(std::uint32_t body, std::int64_t now_ns) noexcept {
    const auto known =
        std::find_if(touched_.begin(), touched_.end(), [&](const touched_body& t) { return t.body == body; });
    const bool now =
        std::any_of(read_.begin(), read_.end(), [](const support_plane& p) { return p.depth_m > -near_m; });
    if (!now) return known != touched_.end();
    if (known != touched_.end()) {
      known->at_ns = now_ns;
    } else {
      static_cast<void>(touched_.push_back({body, now_ns}));  // one of more bodies does without what comes after
    }
    return true;
  }

  bool reads_;
  bool is_new_ = true;
  double age_s_ = 0.0;  // since the contact came
  fixed_vector<touched_body, most_read_bodies> touched_{};
  std::array<double, most_support_planes> gives_m_{};  // how far each reading may let go of what was told
  support_planes planes_{};
  support_planes read_{};  // the planes of one body, as they are read
};

/// Velocity of the point of a body that is at c_A, and of the body: what the probe would have if it stuck to it.
struct body_velocity {
  std::uint32_t body = 0;
  vec6 about_c_w{};  ///< m/s and rad/s
};
using body_velocities = fixed_vector<body_velocity, most_moving_bodies>;

/// The velocity of a body; zero where it does not move. @rt safe
[[nodiscard]] inline vec6 velocity_of(std::span<const body_velocity> all, std::uint32_t body) noexcept {
  const auto found = std::find_if(all.begin(), all.end(), [&](const body_velocity& v) { return v.body == body; });
  return found == all.end() ? vec6{} : found->about_c_w;
}

/// What moving bodies do to a contact between its pose and a step of the probe.
///
/// The depth of a pair of rigid bodies depends on their pose to each other alone. So a plane of a body that has moved by
/// X (world) since the contact was rendered has, for the probe at T_wc, the depth that it had for X^-1 T_wc; its gradient,
/// normal and point turn with the body, and the depth grows by minus the gradient times the body's velocity.
/// Exact for a plane that turns; what a plane is not told of a curved surface is not known here either.
/// @rt safe
class carried_contact {
 public:
  /// @param contact outlives this
  /// @param planes  the contact's, as they are or read again; outlive this
  /// @param ways    of the bodies in the period; outlive this
  carried_contact(const linear_contact& contact, const support_planes& planes, std::span<const body_way> ways) noexcept
      : contact_(&contact), planes_(&planes), ways_(ways) {}

  /// Whether a body that the contact knows is one that may move. Where none is, the contact stands as it is.
  [[nodiscard]] bool moves() const noexcept { return !ways_.empty() && !contact_->bodies.empty(); }

  /// Planes for a step that begins with the probe at T_wc, after a part of the period.
  /// @param dt_s the period's length, s; 0 leaves the velocities at 0
  void at(const pose& T_wc, double part, double dt_s, support_planes& planes,
          body_velocities& velocities) const noexcept {
    planes = *planes_;
    velocities.clear();
    const vec6 moved = pose_difference(T_wc, contact_->T_wc);
    for (const body_place& then : contact_->bodies) {
      const body_way* const way = find_way(ways_, then);
      if (way == nullptr) continue;
      const pose T_wb = way->after(part);
      vec6 v;
      if (dt_s > 0.0) {
        const vec6 of_origin = (1.0 / dt_s) * way->way;
        v = {of_origin.linear + glm::cross(of_origin.angular, T_wc.position - T_wb.position), of_origin.angular};
        static_cast<void>(velocities.push_back({then.body, v}));
      }
      const pose X = T_wb * inverse(then.T_wb);
      const vec6 relative = pose_difference(inverse(X) * T_wc, contact_->T_wc);
      for (support_plane& p : planes) {
        if (p.body != then.body) continue;
        const double depth_m = p.depth_m + dot(p.gradient, relative);
        p.gradient = {X.rotation * p.gradient.linear, X.rotation * p.gradient.angular};
        p.n_ab_w = X.rotation * p.n_ab_w;
        p.r_w = X.rotation * p.r_w;
        p.depth_m = depth_m - dot(p.gradient, moved);
        p.closing_m_per_s = -dot(p.gradient, v);
      }
    }
  }

  /// How far the probe may go on what the contact knows, after a part of the period. Bodies that come use up some of it,
  /// but never more than half: a body must not be able to hold the probe by being quick.
  [[nodiscard]] known_motion known(const pose& T_wc, double part) const noexcept {
    known_motion out = contact_->known;
    if (!out.is_limited()) return out;
    const double left = std::max(0.5, 1.0 - body_share(T_wc, part));
    out.way_m *= left;
    out.turn_rad *= left;
    return out;
  }

  /// The largest share of what the contact knows that a body has used up by its own motion.
  [[nodiscard]] double body_share(const pose& T_wc, double part) const noexcept {
    double most = 0.0;
    if (!contact_->known.is_limited()) return most;
    for (const body_place& then : contact_->bodies) {
      const body_way* const way = find_way(ways_, then);
      if (way == nullptr) continue;
      const pose X = way->after(part) * inverse(then.T_wb);
      most = std::max(most, contact_->known.share({X * T_wc.position - T_wc.position, log_rotation(X.rotation)}));
    }
    return most;
  }

 private:
  const linear_contact* contact_;
  const support_planes* planes_;
  std::span<const body_way> ways_;
};

}  // namespace asperity
