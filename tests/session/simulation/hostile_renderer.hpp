// A renderer that answers honestly, until its scenario says otherwise.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <utility>

#include "session/simulation/scenario.hpp"
#include "session/simulation/scenes.hpp"
#include "unit/control/analytic_wall.hpp"

namespace asperity::simulation {

/// The touched scene of a scenario, with its lies. The session says what time it is.
class hostile_renderer {
 public:
  explicit hostile_renderer(const scenario& s)
      : troubles_(&s.troubles),
        textured_(s.textured ? make_textured_scene(s.textured_scene, s.stiffness_n_per_m) : nullptr),
        dice_(s.seed ^ 0x6c69657300000000ULL) {
    wall_.stiffness_n_per_m = s.stiffness_n_per_m;
    wall_.arm_m = s.arm_m;
    wall_.linearised = s.linearised;
  }

  void set_time(std::int64_t since_start_ns) noexcept { now_ns_ = since_start_ns; }

  [[nodiscard]] status step(const scene_pose& at, tick& out) noexcept {
    const status honest = textured_ ? textured_->step(at, out) : wall_.step(at, out);
    status answer = honest;
    for (const trouble& t : *troubles_) {
      if (now_ns_ >= t.from_ns && now_ns_ < t.until_ns) answer = lie(t.kind, answer, out);
    }
    return answer;
  }

 private:
  [[nodiscard]] status lie(trouble_kind kind, status honest, tick& out) noexcept {
    wrench& w = out.force.on_probe_w;
    switch (kind) {
      case trouble_kind::nan_wrench:
        w.force[static_cast<int>(dice_.below(3))] = std::numeric_limits<double>::quiet_NaN();
        return honest;
      case trouble_kind::infinite_wrench:
        w.torque[static_cast<int>(dice_.below(3))] = -std::numeric_limits<double>::infinity();
        return honest;
      case trouble_kind::enormous_wrench:
        w.force = 1e300 * dice_.direction();
        return honest;
      case trouble_kind::leaping_wrench:
        w.force = leap(100.0);
        w.torque = leap(2.0);
        return honest;
      case trouble_kind::growing_contact:
        out.force.stiffness = mat6{};
        for (std::size_t i = 0; i < 3; ++i) out.force.stiffness(i, i) = dice_.log_between(10.0, 1e6);
        return honest;
      case trouble_kind::refusing:
        return status::backend_failed;
      default:
        return honest;  // not a trouble of the renderer
    }
  }

  [[nodiscard]] vec3 leap(double most) noexcept {
    const double length = dice_.between(0.0, most);
    return length * dice_.direction();
  }

  const std::vector<trouble>* troubles_;
  std::unique_ptr<touched_scene> textured_;
  test_support::analytic_wall wall_{};
  dice dice_;
  std::int64_t now_ns_ = 0;
};

}  // namespace asperity::simulation
