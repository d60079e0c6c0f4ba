// The force model on its own numbers, and together with the depth backend on real contacts.
#include "asperity/window/gradient_penalty.hpp"

#include <gtest/gtest.h>

#include "asperity/window/cpu_depth.hpp"
#include "support/height_models.hpp"

namespace asperity {
namespace {

using namespace test_support;

status feel(const gradient_penalty& model, const contact_set& contacts, std::span<const penetration> depths,
            contact_force& out) {
  force_report report;
  const status s = model.accumulate({}, contacts, depths, report);
  out = report.force;
  return s;
}

constexpr double k = 2000.0;

/// A contact on `body` along n with depth, area and gradient (n; 0).
struct made {
  vec3 n;
  double depth, area;
  std::uint32_t body = 0;
};

contact_force feel(std::initializer_list<made> list, const gradient_penalty& model = gradient_penalty{}) {
  contact_set contacts;
  std::vector<penetration> depths;
  for (const made& m : list) {
    contact c;
    c.window.n_ab_w = m.n;
    c.body = m.body;
    EXPECT_TRUE(contacts.add(c, {}, {}));
    penetration p;
    p.depth_m = p.soft_depth_m = m.depth;
    p.gradient.linear = m.n;
    p.area_m2 = m.area;
    depths.push_back(p);
  }
  contact_force out;
  EXPECT_EQ(feel(model, contacts, depths, out), status::ok);
  return out;
}

vec3 down_tilted(double angle) { return {std::sin(angle), 0.0, -std::cos(angle)}; }

TEST(GradientPenalty, OneContactIsThePapersSpring) {
  penetration p;
  p.depth_m = 3e-4;
  p.soft_depth_m = 2.5e-4;
  p.gradient = {{0.1, -0.2, -1.0}, {0.003, 0.002, -0.001}};
  add_outer(p.curvature, 50.0, {{1.0, 0.0, 0.0}, {0.0, 0.01, 0.0}});
  p.area_m2 = 1e-5;
  contact_set contacts;
  ASSERT_TRUE(contacts.add(contact{}, {}, {}));
  for (const depth_value value : {depth_value::soft, depth_value::hard}) {
    const double d = value == depth_value::soft ? p.soft_depth_m : p.depth_m;
    contact_force out;
    ASSERT_EQ(feel(gradient_penalty({.stiffness_n_per_m = 1500.0, .value = value}), contacts, std::span(&p, 1), out),
              status::ok);
    for (std::size_t i = 0; i < 6; ++i) {
      EXPECT_DOUBLE_EQ(to_vec6(out.on_probe_w)[i], -1500.0 * d * p.gradient[i]);
      for (std::size_t j = 0; j < 6; ++j) {
        EXPECT_NEAR(out.stiffness(i, j), -1500.0 * (p.gradient[i] * p.gradient[j] + d * p.curvature(i, j)), 1e-9);
      }
    }
  }
}

TEST(GradientPenalty, ContactsOfOneDirectionShareOneSpring) {
  const vec3 n = down_tilted(0.0);
  EXPECT_NEAR(feel({{n, 4e-4, 1e-5}}).on_probe_w.force.z, k * 4e-4, 1e-12);
  EXPECT_NEAR(feel({{n, 4e-4, 1e-5}, {n, 4e-4, 3e-5}}).on_probe_w.force.z, k * 4e-4, 1e-12);
  EXPECT_NEAR(feel({{n, 4e-4, 1e-5}, {n, 4e-4, 3e-5}}).stiffness(2, 2), -k, 1e-9);
  // Within 25 degrees it stays one spring.
  const double angle = 0.4;
  EXPECT_NEAR(feel({{n, 4e-4, 1e-5}, {down_tilted(angle), 4e-4, 1e-5}}).on_probe_w.force.z,
              0.5 * k * 4e-4 * (1.0 + std::cos(angle)), 1e-12);
}

TEST(GradientPenalty, DirectionsAndBodiesThatDifferHaveTheirOwn) {
  const vec3 n = down_tilted(0.0);
  const contact_force corner = feel({{n, 4e-4, 1e-5}, {{1, 0, 0}, 3e-4, 1e-5}, {{0, 1, 0}, 2e-4, 1e-5}});
  EXPECT_NEAR(corner.on_probe_w.force.z, k * 4e-4, 1e-12);
  EXPECT_NEAR(corner.on_probe_w.force.x, -k * 3e-4, 1e-12);
  EXPECT_NEAR(corner.on_probe_w.force.y, -k * 2e-4, 1e-12);
  EXPECT_NEAR(feel({{n, 4e-4, 1e-5, 0}, {n, 4e-4, 1e-5, 1}}).on_probe_w.force.z, 2.0 * k * 4e-4, 1e-12);
}

TEST(GradientPenalty, TheShareGoesSmoothlyWithTheAngle) {
  double last = feel({{down_tilted(0.0), 4e-4, 1e-5}, {down_tilted(0.0), 4e-4, 1e-5}}).on_probe_w.force.z;
  for (double angle = 0.005; angle < 1.5; angle += 0.005) {
    const double force = feel({{down_tilted(0.0), 4e-4, 1e-5}, {down_tilted(angle), 4e-4, 1e-5}}).on_probe_w.force.z;
    EXPECT_LT(std::fabs(force - last), 0.02 * k * 4e-4) << angle;
    last = force;
  }
}

TEST(GradientPenalty, AContactFadesInWithItsDepthAndWithItsArea) {
  const vec3 n = down_tilted(0.0), m = down_tilted(0.3);
  const vec3 alone = feel({{n, 4e-4, 1e-5}}).on_probe_w.force;
  EXPECT_LT(glm::length(feel({{n, 4e-4, 1e-5}, {m, 1e-7, 1e-5}}).on_probe_w.force - alone), 1e-6);
  EXPECT_LT(glm::length(feel({{n, 4e-4, 1e-5}, {m, 4e-4, 1e-12}}).on_probe_w.force - alone), 1e-6);
  // Without shares, as the paper adds up, a second contact of the same depth would double the force.
  EXPECT_GT(glm::length(feel({{n, 4e-4, 1e-5, 0}, {n, 4e-4, 1e-5, 1}}).on_probe_w.force - alone), 0.9 * k * 4e-4);
}

scene flat_faces() {
  plate_spec a, b;
  a.half_x = a.half_y = 0.005;
  a.cells_x = a.cells_y = 4;
  a.texels = 64;
  b.half_x = b.half_y = 0.02;
  b.texels = 64;
  return {make_plate(a), {make_plate(b)}};
}

/// Contacts of a probe cut in `pieces` strips of triangles and windows, side by side along x.
contact_set cut_contact(const scene& s, int pieces) {
  contact_set out;
  for (int i = 0; i < pieces; ++i) {
    const double low = -0.005 + 0.010 * i / pieces, high = low + 0.010 / pieces;
    std::vector<std::uint32_t> strip;
    for (std::uint32_t t = 0; t < s.probe->mesh.triangles.size(); ++t) {
      const auto c = corners(s.probe->mesh, t);
      const double x = (c[0].x + c[1].x + c[2].x) / 3.0;
      if (x > low && x < high && area_normal(c).z > 0.0) strip.push_back(t);
    }
    contact c;
    c.window = window_downwards(0.0055, vec3(0.5 * (low + high), 0.0, 0.0));
    EXPECT_TRUE(out.add(c, strip, all_triangles(*s.fixed[0])));
  }
  return out;
}

TEST(GradientPenalty, CuttingAContactDoesNotChangeTheStiffness) {
  const scene s = flat_faces();
  window_depth_settings settings;
  settings.tau_m = 1e-6;  // 0.25 % of the depth: the soft depth depends on the area by tau times its logarithm
  settings.taper_m = 2e-4;
  cpu_depth backend(s, settings);
  const pose T_wb, T_wa{face_down(), {0.0, 0.0, -4e-4}};
  double whole = 0.0;
  for (const int pieces : {1, 2, 4}) {
    const contact_set contacts = cut_contact(s, pieces);
    std::vector<penetration> depths(contacts.size());
    contact_force out;
    ASSERT_EQ(backend.measure({T_wa, std::span(&T_wb, 1)}, contacts, depths), status::ok);
    ASSERT_EQ(feel(gradient_penalty{}, contacts, depths, out), status::ok);
    if (pieces == 1) whole = out.on_probe_w.force.z;
    std::printf("%d contacts: force %.6f N, stiffness %.3f N/m\n", pieces, out.on_probe_w.force.z,
                -out.stiffness(2, 2));
    EXPECT_NEAR(out.on_probe_w.force.z, whole, 0.01 * whole);
    EXPECT_NEAR(out.stiffness(2, 2), -k, 0.01 * k);
    EXPECT_NEAR(out.on_probe_w.torque.x, 0.0, 1e-9);
    EXPECT_NEAR(out.on_probe_w.torque.y, 0.0, 1e-9);
  }
}

TEST(GradientPenalty, FlatOnFlatHasNoTorqueWithEitherScheme) {
  const scene s = flat_faces();
  for (const gradient_scheme g : {gradient_scheme::soft_max, gradient_scheme::central_difference}) {
    window_depth_settings settings;
    settings.gradient = g;
    cpu_depth backend(s, settings);
    const contact_set contacts = whole_contact(s, window_downwards(0.006));
    const pose T_wb, T_wa{face_down(), {0.0, 0.0, -4e-4}};
    penetration p;
    contact_force out;
    ASSERT_EQ(backend.measure({T_wa, std::span(&T_wb, 1)}, contacts, std::span(&p, 1)), status::ok);
    ASSERT_EQ(feel(gradient_penalty{}, contacts, std::span(&p, 1), out), status::ok);
    EXPECT_GT(out.on_probe_w.force.z, 0.5);
    EXPECT_LT(glm::length(out.on_probe_w.torque), 1e-9 * out.on_probe_w.force.z);
    EXPECT_LT(std::hypot(out.on_probe_w.force.x, out.on_probe_w.force.y), 1e-9 * out.on_probe_w.force.z);
  }
}

TEST(GradientPenalty, StiffnessIsTheDerivativeOfTheWrench) {
  const scene s = flat_faces();
  window_depth_settings settings;
  settings.tau_m = 2e-5;
  cpu_depth backend(s, settings);
  const contact_window w = window_downwards(0.006);
  const pose T{exp_rotation(vec3(1e-3, -2e-3, 0.1)) * face_down(), {1e-4, 0.0, -4e-4}};
  const vec3 centre = centre_of_mass_w(s, T);
  const contact_set contacts = whole_contact(s, w);
  const auto wrench_at = [&](const vec6& q) {
    contact_force out;
    const penetration p = measure_whole(backend, s, w, moved(T, centre, q));
    EXPECT_EQ(feel(gradient_penalty{}, contacts, std::span(&p, 1), out), status::ok);
    return out;
  };
  const contact_force here = wrench_at({});
  const auto arm = [](std::size_t i) { return i < 3 ? 1.0 : 0.01; };
  double size = 0.0, worst = 0.0;
  for (std::size_t j = 0; j < 6; ++j) {
    vec6 q;
    q[j] = 1e-7 / arm(j);
    const vec6 plus = to_vec6(wrench_at(q).on_probe_w), minus = to_vec6(wrench_at(-1.0 * q).on_probe_w);
    for (std::size_t i = 0; i < 6; ++i) {
      const double scale = arm(i) * arm(j);
      worst = std::max(worst, std::fabs(here.stiffness(i, j) - (plus[i] - minus[i]) / (2.0 * q[j])) / scale);
      size = std::max(size, std::fabs(here.stiffness(i, j)) / scale);
    }
  }
  std::printf("stiffness against the derivative of the wrench: difference %.2g of the largest entry\n", worst / size);
  EXPECT_LT(worst, 0.03 * size);
}

}  // namespace
}  // namespace asperity
