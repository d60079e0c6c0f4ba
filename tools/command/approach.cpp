#include "approach.hpp"

#include <algorithm>
#include <limits>

namespace asperity::command {
namespace {

bounds box_in_world(const textured_model& model, const pose& T) {
  constexpr double far = std::numeric_limits<double>::max();
  bounds box{vec3(far), vec3(-far)};
  for (const vec3& p : model.mesh.positions) {
    box.low = glm::min(box.low, T * p);
    box.high = glm::max(box.high, T * p);
  }
  // The fine surface may lie outside the coarse mesh by this much.
  box.low -= vec3(model.report.max_displacement_m);
  box.high += vec3(model.report.max_displacement_m);
  return box;
}

bool touches(const step_function& feel, const pose& T_wa, std::span<const pose> T_wb) {
  tick found;
  const status s = feel({T_wa, T_wb}, found);
  if (s != status::ok && s != status::capacity_reached) return false;
  return std::any_of(found.depths.begin(), found.depths.end(), [](const penetration& p) { return p.depth_m > 0.0; });
}

}  // namespace

result<pose> find_touch(const scene& bodies, const step_function& feel, const quat& orientation,
                        std::span<const pose> T_wb) {
  const bounds probe = box_in_world(*bodies.probe, {orientation, vec3(0.0)});
  const bounds body = box_in_world(*bodies.fixed.front(), T_wb.front());
  double top = body.high.z;
  for (std::size_t i = 1; i < bodies.fixed.size(); ++i) {
    top = std::max(top, box_in_world(*bodies.fixed[i], T_wb[i]).high.z);
  }
  const vec3 centre = 0.5 * (body.low + body.high) - 0.5 * (probe.low + probe.high);
  const auto at_height = [&](double z) { return pose{orientation, {centre.x, centre.y, z}}; };

  constexpr int steps = 400;
  constexpr int halvings = 20;
  const double start = top - probe.low.z;
  const double end = body.low.z - probe.high.z;
  const double step = std::min((start - end) / steps, 0.0025 * std::min(bodies.probe->box.diagonal(), 1.0));
  double free = start;
  for (double z = start; z >= end; z -= step) {
    if (!touches(feel, at_height(z), T_wb)) {
      free = z;
      continue;
    }
    double touching = z;
    for (int i = 0; i < halvings; ++i) {
      const double middle = 0.5 * (free + touching);
      (touches(feel, at_height(middle), T_wb) ? touching : free) = middle;
    }
    return at_height(touching);
  }
  return error{error_code::invalid_argument,
               "the probe meets nothing on its way straight down over the fixed body: give a start with --probe-pose"};
}

}  // namespace asperity::command
