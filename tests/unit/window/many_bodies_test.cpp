// Scenes of many bodies, most of them far away or of one model: what the finder does not look at, what bodies share.
#include <cmath>
#include <cstring>
#include <gtest/gtest.h>
#include <memory>
#include <string>
#include <vector>

#include "asperity/window/convex_piece_finder.hpp"
#include "support/fresh_seed.hpp"
#include "support/piece_models.hpp"
#include "unit/control/drawn.hpp"

namespace asperity {
namespace {

using test::cut_into;
using test::make_piece_model;

model_ptr torus(std::uint32_t around) {
  return make_piece_model(test::torus_mesh(0.05, 0.02, around, 8), cut_into::triangles);
}

/// Contacts of two finders are the same but for the body's index, to the bit.
void expect_same(const contact_set& x, const contact_set& y) {
  ASSERT_EQ(x.size(), y.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    const contact &a = x.contacts()[i], &b = y.contacts()[i];
    EXPECT_EQ(a.id, b.id);
    EXPECT_EQ(a.held, b.held);
    EXPECT_EQ(std::memcmp(&a.window, &b.window, sizeof a.window), 0);
    EXPECT_EQ(std::memcmp(&a.p_a_w, &b.p_a_w, sizeof a.p_a_w), 0);
    EXPECT_EQ(std::memcmp(&a.p_b_w, &b.p_b_w, sizeof a.p_b_w), 0);
    EXPECT_EQ(a.separation_m, b.separation_m);
  }
}

pose turned(test_support::drawn& d, double about, const vec3& position) {
  return {exp_rotation(d.inside(about)), position};
}

TEST(many_bodies, far_ones_are_not_looked_into) {
  test_support::drawn d(test_support::seed_of(test_support::fresh_seed("many_bodies", "200 poses"), "far"));
  const model_ptr probe = torus(12), near = torus(13), other = torus(11);
  scene many{probe, {}};
  std::vector<pose> T_wb;
  // 50 bodies of the near one's model and 50 of another, all beyond the probe's reach; the near one among them.
  for (int i = 0; i < 101; ++i) {
    many.fixed.push_back(i == 37 ? near : (i % 2 == 0 ? near : other));
    const vec3 way = glm::normalize(d.inside(1.0) + vec3(0.0, 0.0, 0.01));
    T_wb.push_back(turned(d, 1.0, i == 37 ? vec3(0.0) : d.between(0.4, 2.0) * way));
  }
  const scene alone{probe, {near}};
  const std::vector<pose> T_wb_alone{T_wb[37]};
  convex_piece_finder with(many), without(alone);
  contact_set found, expected;
  std::size_t contacts = 0;
  for (int k = 0; k < 200; ++k) {
    const pose T_wa = turned(d, 0.3, {0.06, 1e-4 * k, 0.038 - 3e-5 * k});
    EXPECT_EQ(with.find({T_wa, T_wb}, found), without.find({T_wa, T_wb_alone}, expected));
    expect_same(found, expected);
    EXPECT_EQ(with.statistics().near_bodies, 1U);
    EXPECT_EQ(with.statistics().candidate_pairs, without.statistics().candidate_pairs);
    EXPECT_EQ(with.statistics().close_pairs, without.statistics().close_pairs);
    for (const contact& c : found.contacts()) EXPECT_EQ(c.body, 37U);
    contacts += found.size();
  }
  EXPECT_GT(contacts, 100U);
}

// The sphere leaves nothing out that touches: every body is met in its turn, from the side that the probe comes from.
TEST(many_bodies, are_met_one_after_another) {
  test_support::drawn d(test_support::seed_of(test_support::fresh_seed("many_bodies_row", "12 bodies"), "row"));
  const model_ptr probe = torus(12), model = torus(13);
  constexpr int count = 12;
  constexpr double apart_m = 0.3;
  scene of_one{probe, {}}, of_their_own{probe, {}};
  std::vector<pose> T_wb;
  for (int i = 0; i < count; ++i) {
    of_one.fixed.push_back(model);
    of_their_own.fixed.push_back(std::make_shared<const textured_model>(*model));
    T_wb.push_back(turned(d, 0.1, {apart_m * i, 0.0, 0.0}));
  }
  convex_piece_finder one(of_one), own(of_their_own);
  contact_set found, expected;
  for (int i = 0; i < count; ++i) {
    std::size_t contacts = 0;
    for (int k = 0; k < 40; ++k) {
      const pose T_wa = turned(d, 0.1, {apart_m * i + 0.06, 0.0, 0.042 - 2e-4 * k});
      EXPECT_EQ(one.find({T_wa, T_wb}, found), own.find({T_wa, T_wb}, expected));
      // What a body learned of the probe's pieces is not another's: the same bits as with models of their own.
      expect_same(found, expected);
      // A body that was touched in the tick before is asked whether it still is.
      EXPECT_LE(one.statistics().near_bodies, k == 0 ? 2U : 1U);
      for (const contact& c : found.contacts()) EXPECT_EQ(c.body, static_cast<std::uint32_t>(i));
      contacts += found.size();
    }
    EXPECT_GT(contacts, 20U) << i;
  }
  EXPECT_LT(one.heap_bytes(), own.heap_bytes() / 4);
}

TEST(many_bodies, of_one_model_cost_next_to_nothing_each) {
  const model_ptr probe = torus(24), model = torus(23);
  const auto bytes = [&](std::size_t count) {
    return convex_piece_finder({probe, std::vector<model_ptr>(count, model)}).heap_bytes();
  };
  // Room for the contacts of two bodies at once; from there on, what says where a body's model is kept.
  EXPECT_LT(bytes(100) - bytes(2), 98U * 256U);
  EXPECT_LT(static_cast<double>(bytes(100)), 1.25 * static_cast<double>(bytes(1)));
  EXPECT_LT(bytes(1), bytes(2));
}

}  // namespace
}  // namespace asperity
