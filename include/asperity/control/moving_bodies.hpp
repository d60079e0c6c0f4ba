// Bodies of a scene that do not stand still: what an application tells of them, where they are in between, and what they
// feel.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "asperity/core/fixed_vector.hpp"
#include "asperity/core/math.hpp"
#include "asperity/core/pose.hpp"
#include "asperity/core/spatial.hpp"

namespace asperity {

/// Most bodies of a session that ever move.
inline constexpr std::size_t most_moving_bodies = 32;

/// Where one body is, and how fast it goes.
struct body_motion {
  std::uint32_t body = 0;  ///< index in scene::fixed
  pose T_wb{};             ///< of the body frame b in the world
  twist velocity_w{};      ///< of the origin of b, world axes, m/s and rad/s
  /// body_handle::generation of the body, in a scene that changes: what is told of one that is gone moves nobody.
  std::uint32_t generation = 0;
};

/// What an application tells of all bodies that move, or have moved, at one time. A body that is not listed any more
/// stays where it was.
struct moving_bodies {
  std::int64_t time_ns = 0;  ///< of the poses, on the session's clock
  fixed_vector<body_motion, most_moving_bodies> list;
};

/// Where one body was at a contact's pose.
struct body_place {
  std::uint32_t body = 0;
  pose T_wb{};
  std::uint32_t generation = 0;
};
using body_places = fixed_vector<body_place, most_moving_bodies>;

/// The way of one body in one device period: it goes evenly from a pose to another.
struct body_way {
  std::uint32_t body = 0;
  pose from_T_wb{};
  vec6 way{};  ///< translation of the origin of b, m, and rotation vector about it, rad; world axes
  std::uint32_t generation = 0;

  /// After a part of its way, 0 to 1. @rt safe
  [[nodiscard]] pose after(double part) const noexcept {
    return {glm::normalize(exp_rotation(part * way.angular) * from_T_wb.rotation),
            from_T_wb.position + part * way.linear};
  }
};
using body_ways = fixed_vector<body_way, most_moving_bodies>;

/// The way of the body that was there; null where it does not move. @rt safe
[[nodiscard]] inline const body_way* find_way(std::span<const body_way> ways, const body_place& then) noexcept {
  const auto found = std::find_if(ways.begin(), ways.end(), [&](const body_way& w) {
    return w.body == then.body && w.generation == then.generation;
  });
  return found == ways.end() ? nullptr : &*found;
}

/// The way that a body goes in dt_s seconds. @rt safe
[[nodiscard]] inline body_way way_of(const body_motion& m, double dt_s) noexcept {
  return {m.body, m.T_wb, dt_s * to_vec6(m.velocity_w), m.generation};
}

/// Follows the bodies of a session in its device ticks.
///
/// An application tells poses when it has them, perhaps at 100 Hz; the device loop needs them at its own rate. Between two
/// of them a body goes on at the velocity that was told, for longest_guess_ns at most; then it stands still, and is_lost()
/// says so. Where a new pose is not the one that the old velocity led to, the difference is made up for in the time that
/// lay between the two, so that a surface makes no step under the hand. A difference of more than snap_m or snap_rad is a
/// body that was put elsewhere: it is there at once, and has no velocity from it.
/// @rt safe: no allocation, lock, throw, print or clock
class body_follower {
 public:
  static constexpr std::int64_t longest_guess_ns = 100'000'000;
  static constexpr double snap_m = 0.01, snap_rad = 0.1;
  /// Told speeds above these are no body's: the body is not followed. NaN fails too.
  static constexpr double fastest_m_per_s = 100.0, fastest_rad_per_s = 1000.0;

  /// Takes what was told, at now_ns on the session's clock.
  void take(const moving_bodies& told, std::int64_t now_ns) noexcept {
    refused_ = told.list.dropped() > 0;
    for (followed& f : bodies_) f.is_told = false;
    for (const body_motion& m : told.list) {
      followed* const f = is_plausible(m) ? find_or_add(m, now_ns) : nullptr;
      if (f == nullptr) {
        refused_ = true;
        continue;
      }
      const pose was_T_wb = f->at(now_ns);
      f->over_ns = std::clamp<std::int64_t>(now_ns - f->taken_ns, 1'000'000, 50'000'000);
      f->told = m;
      f->told_ns = std::min(told.time_ns, now_ns);
      f->taken_ns = now_ns;
      f->off = {};
      const pose led_T_wb = f->at(now_ns);
      const vec6 off{was_T_wb.position - led_T_wb.position,
                     log_rotation(was_T_wb.rotation * glm::conjugate(led_T_wb.rotation))};
      const bool is_elsewhere = glm::length(off.linear) > snap_m || glm::length(off.angular) > snap_rad;
      if (f->is_new || is_elsewhere) {
        f->last_T_wb = led_T_wb;
      } else {
        f->off = off;
      }
      f->is_new = false;
      f->is_told = true;
    }
    for (followed& f : bodies_) {
      if (!f.is_told) f.stand(now_ns);
    }
  }

  /// Where the bodies went since the last call, and where they are at now_ns.
  void advance(std::int64_t now_ns) noexcept {
    ways_.clear();
    places_.clear();
    lost_ = false;
    for (followed& f : bodies_) {
      const pose T_wb = f.at(now_ns);
      static_cast<void>(ways_.push_back(
          {f.told.body,
           f.last_T_wb,
           {T_wb.position - f.last_T_wb.position, log_rotation(T_wb.rotation * glm::conjugate(f.last_T_wb.rotation))},
           f.told.generation}));
      static_cast<void>(places_.push_back({f.told.body, T_wb, f.told.generation}));
      f.last_T_wb = T_wb;
      lost_ = lost_ || (f.moves() && now_ns - f.told_ns > longest_guess_ns);
    }
  }

  /// Lets go of the bodies that a scene does not have any more: of those that were told of when a contact was rendered,
  /// the ones that it does not list. @param at_ns time of the contact's pose
  void keep_only(const body_places& there, std::int64_t at_ns) noexcept {
    gone_ = false;
    std::size_t kept = 0;
    for (const followed& f : bodies_) {
      const bool is_there = std::any_of(there.begin(), there.end(), [&](const body_place& p) {
        return p.body == f.told.body && p.generation == f.told.generation;
      });
      if (is_there || at_ns < f.since_ns) {
        bodies_[kept++] = f;
      } else {
        gone_ = gone_ || f.is_told;
      }
    }
    bodies_.truncate(kept);
  }

  [[nodiscard]] const body_ways& ways() const noexcept { return ways_; }
  /// At the end of their ways.
  [[nodiscard]] const body_places& places() const noexcept { return places_; }
  /// Whether a body that moves has not been told of for longer than its motion is guessed.
  [[nodiscard]] bool is_lost() const noexcept { return lost_; }
  /// Whether something that was told last was no motion of a body, or one body too many.
  [[nodiscard]] bool refused() const noexcept { return refused_; }
  /// Whether keep_only() has let go of a body that was still told of.
  [[nodiscard]] bool gone() const noexcept { return gone_; }

 private:
  struct followed {
    body_motion told{};
    std::int64_t told_ns = 0, taken_ns = 0, over_ns = 1;
    std::int64_t since_ns = 0;  // told of for the first time
    vec6 off{};  // from where the told motion leads to where the body is, when it was taken; gone after over_ns
    pose last_T_wb{};
    bool is_new = true, is_told = false;

    [[nodiscard]] bool moves() const noexcept {
      const twist& v = told.velocity_w;
      return glm::dot(v.linear, v.linear) > 0.0 || glm::dot(v.angular, v.angular) > 0.0;
    }
    [[nodiscard]] pose at(std::int64_t now_ns) const noexcept {
      const double s = 1e-9 * static_cast<double>(std::clamp<std::int64_t>(now_ns - told_ns, 0, longest_guess_ns));
      const double left =
          std::clamp(1.0 - static_cast<double>(now_ns - taken_ns) / static_cast<double>(over_ns), 0.0, 1.0);
      const vec3 turned = s * told.velocity_w.angular;
      return {glm::normalize(exp_rotation(left * off.angular) * exp_rotation(turned) * told.T_wb.rotation),
              told.T_wb.position + s * told.velocity_w.linear + left * off.linear};
    }
    void stand(std::int64_t now_ns) noexcept {
      told.T_wb = at(now_ns);
      told.velocity_w = {};
      told_ns = taken_ns = now_ns;
      off = {};
    }
  };

  [[nodiscard]] static bool is_plausible(const body_motion& m) noexcept {
    const twist& v = m.velocity_w;
    return is_valid(m.T_wb) && glm::dot(v.linear, v.linear) <= fastest_m_per_s * fastest_m_per_s &&
           glm::dot(v.angular, v.angular) <= fastest_rad_per_s * fastest_rad_per_s;
  }

  [[nodiscard]] followed* find_or_add(const body_motion& told, std::int64_t now_ns) noexcept {
    followed added;
    added.told.body = told.body;
    added.told.generation = told.generation;
    added.since_ns = now_ns;
    followed* const known =
        std::find_if(bodies_.begin(), bodies_.end(), [&](const followed& f) { return f.told.body == told.body; });
    if (known != bodies_.end()) {
      // Another body is in its slot, or the one that is told of was there before.
      if (known->told.generation > told.generation) return nullptr;
      if (known->told.generation < told.generation) *known = added;
      return known;
    }
    return bodies_.push_back(added) ? &bodies_.back() : nullptr;
  }

  fixed_vector<followed, most_moving_bodies> bodies_;
  body_ways ways_;
  body_places places_;
  bool lost_ = false, refused_ = false, gone_ = false;
};

/// The push of the probe on one body: the opposite of what the body does to the probe, friction included.
struct body_wrench {
  std::uint32_t body = 0;  ///< index in scene::fixed
  wrench on_body_w{};      ///< world axes, torque about the felt_bodies' point_w
};

/// What bodies felt in one device period, the mean over its substeps: times the period it is the impulse. A body that
/// is not listed felt nothing. For a body's own motion take the torque about its centre of mass c_B:
///
///     const wrench about_c_b = transport(felt.list[i].on_body_w, felt.point_w, c_b_w);
struct felt_bodies {
  static constexpr std::size_t most = 32;

  std::int64_t time_ns = 0;  ///< of the device tick, on the session's clock
  vec3 point_w{0.0};         ///< the probe's centre of mass c_A, which all torques are about
  fixed_vector<body_wrench, most> list;
  std::uint64_t version = 0;  ///< of the scene whose slots these are: placed_scene::version

  /// Adds to what a body feels. @return false where there is no more room   @rt safe
  bool add(std::uint32_t body, const wrench& on_body_w) noexcept {
    body_wrench* const known =
        std::find_if(list.begin(), list.end(), [&](const body_wrench& b) { return b.body == body; });
    if (known != list.end()) {
      known->on_body_w += on_body_w;
      return true;
    }
    return list.push_back({body, on_body_w});
  }
  /// What a body feels; zero where it is not listed. @rt safe
  [[nodiscard]] wrench on(std::uint32_t body) const noexcept {
    const body_wrench* const known =
        std::find_if(list.begin(), list.end(), [&](const body_wrench& b) { return b.body == body; });
    return known == list.end() ? wrench{} : known->on_body_w;
  }
};

}  // namespace asperity
