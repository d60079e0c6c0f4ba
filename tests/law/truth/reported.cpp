#include "law/truth/reported.hpp"

#include <array>
#include <stdexcept>
#include <string>
#include <utility>

#include "asperity/least_motion/least_motion_renderer.hpp"
#include "asperity/planes/plane_renderer.hpp"
#include "law/truth/made_or_thrown.hpp"

namespace asperity::truth {
namespace {

// The two places where these tests name how a renderer is made.
plane_renderer planes_of(const scene& bodies, std::shared_ptr<const field_scene> fields, double reach_m) {
  plane_renderer_settings settings;
  settings.reach_m = reach_m;
  return made_or_thrown(make_plane_renderer(bodies, std::move(fields), settings));
}
least_motion_renderer force_of(const scene& bodies, std::shared_ptr<const field_scene> fields,
                               const pose_law_settings& with) {
  least_motion_renderer_settings settings;
  settings.force.softness_m = with.softness_m;
  settings.force.period_s = with.period_s;
  return made_or_thrown(make_least_motion_renderer(bodies, std::move(fields), settings));
}

template <class Renderer>
status step(Renderer& feel, const pose& T_wa, const pose& T_wb, tick& t) {
  const std::array<pose, 1> fixed{T_wb};
  const status s = feel.step({T_wa, fixed}, t);
  if (s != status::ok && s != status::capacity_reached) throw std::runtime_error("a tick failed");
  return s;
}

}  // namespace

struct plane_law::made {
  plane_renderer feel;
  bool crowded = false;
};

plane_law::plane_law(const scene& bodies, std::shared_ptr<const field_scene> fields, double reach_m)
    : made_(new made{planes_of(bodies, std::move(fields), reach_m)}) {}
plane_law::plane_law(plane_law&&) noexcept = default;
plane_law::~plane_law() = default;

bool plane_law::crowded() const noexcept { return made_->crowded; }

std::optional<reported_plane> plane_law::deepest(const pose& T_wa, const pose& T_wb) {
  tick t;
  made_->crowded = step(made_->feel, T_wa, T_wb, t) == status::capacity_reached;
  const support_plane* deepest = nullptr;
  for (const support_plane& p : t.planes) {
    if (deepest == nullptr || p.depth_m > deepest->depth_m) deepest = &p;
  }
  if (deepest == nullptr) return std::nullopt;
  return reported_plane{deepest->depth_m, deepest->n_ab_w, t.centre_of_mass_w + deepest->r_w, deepest->gradient};
}

struct pose_law::made {
  least_motion_renderer feel;
};

pose_law::pose_law(const scene& bodies, std::shared_ptr<const field_scene> fields, const pose_law_settings& settings)
    : made_(new made{force_of(bodies, std::move(fields), settings)}) {}
pose_law::pose_law(pose_law&&) noexcept = default;
pose_law& pose_law::operator=(pose_law&&) noexcept = default;
pose_law::~pose_law() = default;

double pose_law::stiffness_n_per_m() const noexcept { return made_->feel.force().settings().stiffness_n_per_m; }
double pose_law::softness_m() const noexcept { return made_->feel.force().settings().softness_m; }

reported_force pose_law::at(const pose& T_wa, const pose& T_wb) {
  tick t;
  reported_force out;
  out.complete = step(made_->feel, T_wa, T_wb, t) == status::ok;
  out.on_probe_w = t.force.on_probe_w;
  out.energy_j = made_->feel.force().energy_j();
  out.contacts = t.contacts.size();
  if (!t.contacts.empty()) out.n_ab_w = t.contacts.front().window.n_ab_w;
  return out;
}

}  // namespace asperity::truth
