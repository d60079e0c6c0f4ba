// The joint step of bodies whose planes are told by the test itself.
#include "bodies/body_step.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>
#include <vector>

#include "support/fresh_seed.hpp"
#include "unit/control/drawn.hpp"

namespace {

using namespace asperity;
using namespace asperity::test_support;

// A cube of 24 mm on four planes below its corners.
struct cube_on_planes {
  std::vector<detail::mover> movers{1};
  std::vector<detail::mover_contacts> contacts{1};
  std::vector<vec3> standing_w{vec3(0.0)};
  free_bodies_settings settings{};
  detail::body_step step{settings, virtual_coupling({}, 1.0, 1e-4), 1, 1, false};

  explicit cube_on_planes(double mass_kg) {
    constexpr double half_m = 0.012;
    movers[0].mass_kg = mass_kg;
    movers[0].inertia_kg_m2 = mat3(mass_kg * 2.0 * half_m * half_m / 3.0);
    movers[0].radius_m = 0.021;
    detail::mover_contacts& of = contacts[0];
    of.others = {{.number = 1}};
    of.springs.resize(1);
    of.T_wb.resize(1);
    const vec3 down(0.0, 0.0, -1.0);
    for (const double x : {-half_m, half_m}) {
      for (const double y : {-half_m, half_m}) {
        const vec3 r(x, y, -half_m);
        EXPECT_TRUE(of.contact.planes.push_back({.gradient = {down, glm::cross(r, down)}, .n_ab_w = down, .r_w = r}));
      }
    }
  }

  // Tells the planes where the cube is now, one of them deeper by so much.
  void tell(std::size_t deeper, double by_m) {
    linear_contact& c = contacts[0].contact;
    const vec6 gone = pose_difference(movers[0].T_wc, c.T_wc);
    for (support_plane& p : c.planes) p.depth_m += dot(p.gradient, gone);
    c.planes[deeper].depth_m += by_m;
    c.T_wc = movers[0].T_wc;
    movers[0].known_m = 1e-3;
    movers[0].known_from_T_wc = movers[0].T_wc;
  }
  void advance() { ASSERT_EQ(step.step(1e-3, movers, contacts, standing_w, {}), status::ok); }
};

// A plane that comes with a depth at once, as one that was not told before, pushes the body out and gives it no speed.
TEST(body_step, takes_out_what_new_planes_bring) {
  drawn d(seed_of(fresh_seed("body_step", "20 cubes on planes that change"), "calm"));
  for (int i = 0; i < 20; ++i) {
    cube_on_planes on(d.log_between(0.1, 4.0));
    on.tell(0, 0.0);
    for (int n = 0; n < 500; ++n) on.advance();
    const double at_rest_j = on.step.energy().kinetic_j;
    ASSERT_LT(at_rest_j, 1e-12);
    const double by_m = d.log_between(1e-5, 5e-5);
    const double before_j = on.step.energy().by_rendering_j;
    on.tell(static_cast<std::size_t>(d.between(0.0, 4.0)), by_m);
    double fastest_j = 0.0;
    for (int n = 0; n < 200; ++n) {
      on.advance();
      fastest_j = std::max(fastest_j, on.step.energy().kinetic_j);
    }
    const double made_j = on.step.energy().by_rendering_j - before_j;
    std::printf("  %.2f kg, %.0f um: %.2e J made, %.2e J in motion\n", on.movers[0].mass_kg, 1e6 * by_m, made_j,
                fastest_j);
    ASSERT_GT(made_j, 0.0);
    EXPECT_LT(fastest_j, 0.015 * made_j);
    // In 0.2 s of the 0.3 s in which it is forgotten, and what was damped is no longer owed.
    EXPECT_LT(on.contacts[0].springs[0].made_j, 0.98 * std::exp(-0.2 / 0.3) * made_j);
    for (int n = 0; n < 1500; ++n) on.advance();
    EXPECT_LT(on.contacts[0].springs[0].made_j, 0.01 * made_j) << "the planes damp on for ever";
  }
}

}  // namespace
