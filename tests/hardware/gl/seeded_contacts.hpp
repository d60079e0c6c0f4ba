// Contacts of every kind that the depth backends on OpenGL are compared with the CPU backend on, from a seed: patches
// of 2 to 40 triangles, tilted, partly beside each other, in windows of several sizes, over textures of several scales.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "asperity/window/cpu_depth.hpp"
#include "support/height_models.hpp"

namespace asperity::test_support {

/// A probe, a fixed body and contacts between them, each at poses of its own.
struct seeded_contacts {
  scene bodies;
  std::vector<pose> T_wa, T_wb;
  contact_set contacts;
  std::uint32_t triangles = 0;  ///< of a patch, facing the window
};

/// @param cells_x, cells_y  quads of a patch; two triangles each
/// @param texels            per side of a patch of 2 cm
[[nodiscard]] inline seeded_contacts make_seeded_contacts(std::uint64_t seed, std::uint32_t cells_x,
                                                          std::uint32_t cells_y, std::uint32_t texels,
                                                          std::size_t count) {
  std::mt19937_64 bits(seed);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * (static_cast<double>(bits() >> 11) * 0x1p-53);
  };
  const auto plate = [&](bool charts) {
    plate_spec s;
    s.cells_x = cells_x;
    s.cells_y = cells_y;
    s.texels = texels;
    s.chart_per_cell = charts;
    const double k = 6.28 / uniform(8.0, 30.0) * texels / 0.02;  // waves of 8 to 30 texels
    const double amplitude = uniform(0.05, 0.15) / k, turn = uniform(0.0, 3.0), bend = uniform(-8.0, 8.0);
    // The textured surface lies some texels off the coarse one, so that a tilted lookup ends in the next chart.
    const double lift = uniform(-15.0, 15.0) * 0.02 / texels;
    s.coarse_height = [=](double x, double y) { return 0.5 * bend * (x * x + 0.6 * y * y); };
    s.height = [=](double x, double y) {
      const double u = std::cos(turn) * x + std::sin(turn) * y, v = -std::sin(turn) * x + std::cos(turn) * y;
      return lift + 0.5 * bend * (x * x + 0.6 * y * y) + amplitude * (std::cos(k * u) + 0.7 * std::sin(1.3 * k * v));
    };
    s.T_body_plate = {exp_rotation(vec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1))),
                      vec3(uniform(-0.1, 0.1), uniform(-0.1, 0.1), uniform(-0.1, 0.1))};
    s.centre_of_mass = {uniform(-0.02, 0.02), uniform(-0.02, 0.02), uniform(-0.03, 0.0)};
    return std::pair{make_plate(s), s.T_body_plate};
  };
  const auto [probe, T_probe_plate] = plate(false);
  const auto [fixed, T_fixed_plate] = plate(cells_x > 1);
  seeded_contacts out{
      {probe, {fixed}}, {}, {}, contact_set({.contacts = count, .triangles = 1U << 20}), 2 * cells_x * cells_y};
  const auto patch_a = all_triangles(*probe), patch_b = all_triangles(*fixed);
  for (std::size_t i = 0; i < count; ++i) {
    // The plates face each other somewhere in the world, the probe shifted as far as half beside the fixed body.
    const pose T_w_here{exp_rotation(vec3(uniform(-2, 2), uniform(-2, 2), uniform(-2, 2))),
                        vec3(uniform(-0.5, 0.5), uniform(-0.5, 0.5), uniform(-0.5, 0.5))};
    const pose T_probe{exp_rotation(vec3(uniform(-0.15, 0.15), uniform(-0.15, 0.15), uniform(-3, 3))) * face_down(),
                       vec3(uniform(-0.012, 0.012), uniform(-0.012, 0.012), uniform(-4e-4, 1e-4))};
    const pose T_fixed{exp_rotation(vec3(uniform(-0.15, 0.15), uniform(-0.15, 0.15), 0.0)), vec3(0.0)};
    out.T_wa.push_back(T_w_here * T_probe * inverse(T_probe_plate));
    out.T_wb.push_back(T_w_here * T_fixed * inverse(T_fixed_plate));
    contact c;
    contact_window w =
        window_downwards(uniform(0.002, 0.008), vec3(uniform(-0.008, 0.008), uniform(-0.008, 0.008), 0.0));
    c.window = w;
    c.window.centre_w = T_w_here * w.centre_w;
    c.window.u_w = T_w_here.rotation * w.u_w;
    c.window.v_w = T_w_here.rotation * w.v_w;
    c.window.n_ab_w = T_w_here.rotation * w.n_ab_w;
    EXPECT_TRUE(out.contacts.add(c, patch_a, patch_b));
  }
  return out;
}

/// What the CPU backend says about each of them.
[[nodiscard]] inline std::vector<penetration> measure_one_by_one(cpu_depth& backend, const seeded_contacts& s) {
  std::vector<penetration> out(s.contacts.size());
  contact_set one({.contacts = 1, .triangles = 1U << 12});
  for (std::size_t i = 0; i < out.size(); ++i) {
    const contact& c = s.contacts.contacts()[i];
    one.clear();
    EXPECT_TRUE(one.add(c, s.contacts.patch_a(c), s.contacts.patch_b(c)));
    EXPECT_EQ(backend.measure({s.T_wa[i], std::span(&s.T_wb[i], 1)}, one, std::span(&out[i], 1)), status::ok);
  }
  return out;
}

}  // namespace asperity::test_support
