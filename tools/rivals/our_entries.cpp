// asperity's renderers as contenders.
#include <algorithm>
#include <array>
#include <memory>
#include <utility>

#include "asperity/least_motion/least_motion_renderer.hpp"
#include "asperity/planes/plane_renderer.hpp"
#include "asperity/window/window_renderer.hpp"
#include "contender.hpp"

namespace asperity::rivals {
namespace {

template <class Renderer>
class our_contender final : public contender {
 public:
  explicit our_contender(Renderer feel) : feel_(std::move(feel)) {}

  felt feel(const pose& T_wa) override {
    const std::array<pose, 1> T_wb{};
    tick found;
    const status s = feel_.step({T_wa, T_wb}, found);
    felt out;
    if (s != status::ok && s != status::capacity_reached) return out;
    for (const penetration& p : found.depths) {
      if (has(p.flags, depth_flag::no_overlap) || !(p.depth_m > 0.0)) continue;
      ++out.contacts;
      out.touches = true;
      out.depth_m = std::max(out.depth_m, p.depth_m);
    }
    out.force_w = found.force.on_probe_w.force;
    return out;
  }

 private:
  Renderer feel_;
};

template <class Renderer>
result<contender_ptr> contender_of(result<Renderer> made) {
  if (!made) return made.error();
  return contender_ptr(std::make_unique<our_contender<Renderer>>(std::move(made).value()));
}

}  // namespace

std::vector<entry> our_entries() {
  return {
      {"asperity, planes", true,
       [](const body_pair& b) { return contender_of(make_plane_renderer(b.baked, {.reach_m = reach_for(1e-3)})); }},
      {"asperity, least motion", true,
       [](const body_pair& b) { return contender_of(make_least_motion_renderer(b.baked)); }},
      {"asperity, the paper's", true, [](const body_pair& b) { return contender_of(make_window_renderer(b.baked)); }},
  };
}

std::vector<entry> rival_entries() {
  return {
      {"FCL, mesh on mesh", false, make_fcl},
      {"Bullet GImpact", false, make_gimpact},
      {"point shell, 0.2 % voxels", false, [](const body_pair& b) { return make_point_shell(b, 0.002); }},
      {"point shell, 0.1 % voxels", false, [](const body_pair& b) { return make_point_shell(b, 0.001); }},
      {"MuJoCo, convex hulls", false, make_mujoco},
  };
}

}  // namespace asperity::rivals
