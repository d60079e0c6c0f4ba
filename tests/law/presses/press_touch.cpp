#include "law/presses/press_touch.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace asperity::presses {
namespace {

constexpr double least_facing = 0.2;
constexpr double off_the_surface_m = 1e-6;  // a ray starts on the surface itself

}  // namespace

touch_finder::touch_finder(std::string name, const triangle_mesh& probe, const triangle_mesh& fixed,
                           touch_region region)
    : sampler_(std::move(name), probe, fixed), region_(std::move(region)) {}

std::optional<press_touch> touch_finder::at(std::uint64_t seed, std::uint64_t index) {
  const oracle::approach on = sampler_.draw(seed, index);
  press_touch out;
  out.index = index;
  out.touching_T_wa = on.touching;
  out.point_w = on.window.centre_w;
  out.way_w = on.window.n_ab_w;
  out.out_w = on.out_w;
  if (!(glm::dot(out.out_w, out.way_w) <= -least_facing)) return std::nullopt;
  if (region_ && !region_(inverse(on.touching) * out.point_w, out.point_w)) return std::nullopt;

  // The sampler left both meshes with the approach along +z: its frame has the window's axes.
  const auto in_sampler = [&](const vec3& v) {
    return vec3(glm::dot(v, on.window.u_w), glm::dot(v, on.window.v_w), glm::dot(v, on.window.n_ab_w));
  };
  const vec3 point = in_sampler(out.point_w), up = in_sampler(out.out_w);
  const auto through = [&](const oracle::placed_mesh& mesh, const vec3& direction) {
    return mesh.contains(point + off_the_surface_m * direction)
               ? mesh.crossing_along(point, direction, off_the_surface_m)
               : std::numeric_limits<double>::infinity();
  };
  out.probe_thickness_m = through(sampler_.probe(), up);
  out.fixed_thickness_m = through(sampler_.fixed(), -up);
  out.press_m =
      std::min(longest_press_m, share_of_half_thickness * 0.5 * std::min(out.probe_thickness_m, out.fixed_thickness_m));
  if (out.press_m < shortest_press_m) return std::nullopt;
  return out;
}

std::optional<press_touch> touch_finder::next(std::uint64_t seed, int attempts) {
  for (; attempts > 0; --attempts) {
    if (auto found = at(seed, next_++)) return found;
  }
  return std::nullopt;
}

}  // namespace asperity::presses
