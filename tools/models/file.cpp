// The file: a flat bar with a tang. Two families of oblique grooves cross on its faces.
#include <cmath>

#include "lattice_solid.hpp"
#include "shapes.hpp"

namespace asperity::models {
namespace {

constexpr double two_pi = 6.283185307179586;

// The bar along x: tang, blade; all metres.
constexpr double tang_end = -70e-3;
constexpr double shoulder = -40e-3;
constexpr double blade_end = 70e-3;
constexpr double half_width = 8e-3;
constexpr double half_thickness = 2.25e-3;

constexpr double groove_wavelength = 1.8e-3;
constexpr double groove_depth = 0.2e-3;     ///< of one family; where two grooves cross it is twice as deep
constexpr double overcut_angle_rad = 0.44;  ///< of the first family's wave to the blade's axis
constexpr double upcut_angle_rad = -0.70;   ///< of the second family's

/// Share of the blade's width that is left at x: a slight taper to the tip, a narrow tang behind the shoulder.
double width_at(double x) {
  const double tip = 1.0 - 0.15 * smoothstep((x - 20e-3) / 60e-3);
  const double step = smoothstep((shoulder - x) / 4e-3);
  const double tang = 0.42 - 0.2 * (shoulder - x) / (shoulder - tang_end);
  return x > shoulder ? tip : 1.0 + (tang - 1.0) * step;
}

double thickness_at(double x) {
  return x > shoulder ? 1.0 - 0.2 * smoothstep((x - 20e-3) / 60e-3) : 1.0 - 0.4 * smoothstep((shoulder - x) / 30e-3);
}

/// A groove at phase 0, narrower than the land between two grooves, without any kink; mean 3/8.
double groove(double phase) {
  const double c = 0.5 + 0.5 * std::cos(phase);
  return c * c;
}

/// Height of the teeth at (x, y) of a face. Flat near the borders, so that the bar's edges stay sharp and straight.
double teeth(double x, double y, double border_y) {
  const auto cut = [x, y](double angle) {
    return 0.375 - groove(two_pi / groove_wavelength * (x * std::cos(angle) + y * std::sin(angle)));
  };
  const double share = smoothstep((x - shoulder - 2e-3) / 2e-3) * smoothstep((blade_end - x - 1e-3) / 2e-3) *
                       smoothstep((border_y - std::abs(y) - 0.3e-3) / 1e-3);
  return share * groove_depth * (cut(overcut_angle_rad) + cut(upcut_angle_rad));
}

vec3 shape(const vec3& p) {
  const double width = width_at(p.x);
  vec3 out(p.x, p.y * width, p.z * thickness_at(p.x));
  if (std::abs(p.z) >= half_thickness) {
    const double height = teeth(out.x, out.y, half_width * width);
    out.z += p.z > 0.0 ? height : -height;
  }
  return out;
}

}  // namespace

triangle_mesh make_file() {
  // 648 x 92 + 92 x 16 + 16 x 648 cells, twice, two triangles each: 285,824. About nine edges to a groove.
  lattice_solid solid;
  solid.axes[0] = {{tang_end, shoulder, blade_end}, {139, 509}};
  solid.axes[1] = {{-half_width, half_width}, {92}};
  solid.axes[2] = {{-half_thickness, half_thickness}, {16}};
  solid.filled = [](const vec3&) { return true; };
  return surface_of(solid, shape);
}

}  // namespace asperity::models
