// The hammer: a forged head with a cross peen, and a wooden handle.
#include <algorithm>
#include <cmath>

#include "lattice_solid.hpp"
#include "shapes.hpp"
#include "surface_relief.hpp"

namespace asperity::models {
namespace {

// The head lies along x with its peen at -x; the handle hangs along -z. All metres.
constexpr double peen_end = -55e-3;
constexpr double face_end = 45e-3;
constexpr double half_head = 14e-3;
constexpr double half_handle = 9e-3;
constexpr double handle_end = -190e-3;
constexpr double stub_end = 17e-3;  ///< the handle's other end, above the head

bool filled(const vec3& p) {
  const bool head = std::abs(p.z) < half_head;
  const bool handle = std::abs(p.x) < half_handle && std::abs(p.y) < half_handle;
  return head || handle;
}

/// The square lattice column becomes the handle, a little flat, thicker towards its end.
vec3 round_handle(const vec3& p) {
  const vec2 q = square_to_disc({p.x, p.y}, half_handle, 0.99 * half_head);
  const double below = -half_head - p.z;
  const double waist = 1.0 - 0.12 * smoothstep(below / 50e-3);
  const double grip = 0.5 * smoothstep((below - 60e-3) / 110e-3);
  const double flat = 0.2 * smoothstep(below / 40e-3);
  return {q.x * (waist + grip), q.y * (waist + 0.6 * grip) * (1.0 - flat), p.z};
}

/// The head's square section gets round corners. What lies above and below the head follows, and ever less so.
vec3 round_head(const vec3& p) {
  constexpr double share = 0.75;
  const double z = std::clamp(p.z, -half_head, half_head);
  const double m = std::max(std::abs(p.y), std::abs(z));
  if (m == 0.0 || std::abs(p.y) > half_head) return p;
  const double inward = share * (m / std::sqrt(p.y * p.y + z * z) - 1.0);
  const double fade = 1.0 - smoothstep((std::abs(p.z) - half_head) / 10e-3);
  return {p.x, p.y * (1.0 + fade * inward), p.z + z * fade * inward};
}

/// The head along its length: a wedge at one end, a neck and a wider face at the other.
vec3 forge_head(const vec3& p) {
  const double wedge = 1.0 - 0.72 * smoothstep((-16e-3 - p.x) / 42e-3);
  const double neck = 1.0 - 0.22 * smoothstep((p.x - 14e-3) / 12e-3) + 0.18 * smoothstep((p.x - 26e-3) / 10e-3);
  if (p.x < -16e-3) return {p.x, p.y, p.z * wedge};
  if (p.x > 14e-3) return {p.x, p.y * neck, p.z * neck};
  return p;
}

}  // namespace

triangle_mesh make_hammer() {
  // Cells of about a third of a millimetre. The surface has 216,576 of their faces: 433,152 triangles.
  lattice_solid solid;
  solid.axes[0] = {{peen_end, -half_handle, half_handle, face_end}, {132, 52, 103}};
  solid.axes[1] = {{-half_head, -half_handle, half_handle, half_head}, {15, 52, 15}};
  solid.axes[2] = {{handle_end, -half_head, half_head, stub_end}, {515, 82, 9}};
  solid.filled = filled;
  triangle_mesh mesh = surface_of(solid, [](const vec3& p) { return forge_head(round_head(round_handle(p))); });

  const band_noise steel(20042, 2.5e-3, 7e-3, 0.25e-3);
  const band_noise wood(20043, 2.5e-3, 6e-3, 0.15e-3);
  displace(mesh, 1.2e-3, [&](const vec3& p) {
    // Grain: the handle's waves are four times as long along it as across.
    const double below = smoothstep((-half_head - p.z) / 8e-3);
    return (1.0 - below) * steel(p) + below * wood({p.x, p.y, 0.25 * p.z});
  });
  return mesh;
}

}  // namespace asperity::models
