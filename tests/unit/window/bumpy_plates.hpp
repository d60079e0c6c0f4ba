// Two bumpy plates on each other, with body axes of no special direction: a scene that has no closed form.
#pragma once

#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <memory>
#include <random>
#include <span>

#include "asperity/window/cpu_depth.hpp"
#include "support/height_models.hpp"

namespace asperity::test_support {

class dice {
 public:
  explicit dice(std::uint64_t seed) : bits_(seed) {}
  double between(double low, double high) { return low + (high - low) * static_cast<double>(bits_() >> 11) * 0x1p-53; }

 private:
  std::mt19937_64 bits_;
};

/// Bumpy plate; `charts` cuts it and bends its coarse mesh, so that fine points lie beside coarse ones.
inline plate_spec bumps(double half, std::uint32_t texels, double amplitude, double k, bool charts) {
  plate_spec s;
  s.half_x = s.half_y = half;
  s.texels = texels;
  s.cells_x = s.cells_y = 3;
  s.height = [=](double x, double y) {
    return amplitude * (std::cos(k * x) * std::cos(0.8 * k * y) + 0.5 * std::sin(0.45 * k * (x + y)));
  };
  s.centre_of_mass = {0.004, -0.003, -0.012};
  s.chart_per_cell = charts;
  if (charts) s.coarse_height = [=](double x, double y) { return 0.5 * amplitude * std::cos(300.0 * x + 200.0 * y); };
  return s;
}

inline scene bumpy_scene(bool charts) {
  plate_spec a = bumps(0.004, 200, 1e-4, 4000.0, charts), b = bumps(0.006, 240, 8e-5, 5200.0, charts);
  // Body axes of no special direction: a box of the pyramid never lies along the window.
  a.T_body_plate = {exp_rotation(vec3(0.4, -1.1, 0.7)), {0.01, 0.02, -0.03}};
  b.T_body_plate = {exp_rotation(vec3(-0.9, 0.3, 1.2)), {-0.02, 0.01, 0.01}};
  return {make_plate(a), {make_plate(b)}};
}

struct placed {
  contact_set contacts;
  pose T_wa, T_wb;
};

/// The bumpy scene's plates on each other, seen in `window`.
inline placed place(const scene& s, const contact_window& window, const pose& plate_a) {
  const pose a = {exp_rotation(vec3(0.4, -1.1, 0.7)), {0.01, 0.02, -0.03}};
  const pose b = {exp_rotation(vec3(-0.9, 0.3, 1.2)), {-0.02, 0.01, 0.01}};
  return {whole_contact(s, window), plate_a * inverse(a), inverse(b)};
}

template <class Backend>
penetration measure(Backend& backend, const placed& p) {
  penetration out;
  EXPECT_EQ(backend.measure({p.T_wa, std::span(&p.T_wb, 1)}, p.contacts, std::span(&out, 1)), status::ok);
  return out;
}

inline pose some_pose(dice& d) {
  return {exp_rotation(vec3{d.between(-0.06, 0.06), d.between(-0.06, 0.06), d.between(-1.0, 1.0)}) * face_down(),
          {d.between(-5e-4, 5e-4), d.between(-5e-4, 5e-4), d.between(-2e-4, 1e-4)}};
}

inline cpu_depth grid_backend(const scene& s, parallax_mode mode, std::uint32_t grid) {
  window_depth_settings settings;
  settings.parallax = mode;
  settings.grid = grid;
  return cpu_depth(s, settings);
}

}  // namespace asperity::test_support
