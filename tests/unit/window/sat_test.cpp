// Penetration depth and the real directions of pieces.
#include "window/sat.hpp"

#include <gtest/gtest.h>
#include <vector>

#include "support/piece_models.hpp"
#include "support/random_hulls.hpp"
#include "window/close_pair.hpp"

namespace asperity {
namespace {

convex_shape shape_of(const model_ptr& m, std::size_t piece = 0) {
  return make_convex_shape(m->mesh, make_mesh_features(m->mesh), m->pieces[piece]);
}

TEST(separating_axes, equal_brute_force_on_overlapping_hulls) {
  test::uniform_source uniform(21);
  std::size_t compared = 0;
  for (std::size_t k = 0; k < 800; ++k) {
    std::vector<vec3> points_a, points_b;
    for (std::size_t i = 0; i < 5 + k % 6; ++i) points_a.push_back(uniform.in_box(1.0));
    for (std::size_t i = 0; i < 5 + k % 5; ++i) points_b.push_back(uniform.in_box(1.0));
    const model_ptr a = test::make_piece_model(test::brute_hull(points_a), test::cut_into::one_piece);
    const model_ptr b = test::make_piece_model(test::brute_hull(points_b), test::cut_into::one_piece);
    const pose T{exp_rotation(uniform(0.0, 3.0) * uniform.direction()), uniform.in_box(1.0)};
    coarse_mesh moved = b->mesh;
    for (vec3& p : moved.positions) p = T * p;
    const double expected = test::brute_separation(a->mesh, moved);
    if (expected > -1e-6) continue;
    separating_directions found;
    find_separating_directions(shape_of(a), shape_of(b), placement(T), found);
    ASSERT_FALSE(found.empty());
    EXPECT_NEAR(found[0].separation_m, expected, 1e-12) << "pair " << k;
    for (std::size_t i = 1; i < found.size(); ++i) EXPECT_LE(found[i].separation_m, found[i - 1].separation_m);
    // Moved apart by its depth along its direction, the pair no longer overlaps.
    pose apart = T;
    apart.position -= (found[0].separation_m - 1e-9) * found[0].n_ab;
    gjk_cache cold;
    EXPECT_EQ(gjk_distance(shape_of(a), shape_of(b), placement(apart), 1.0, cold).outcome, gjk_outcome::separated);
    ++compared;
  }
  EXPECT_GT(compared, 300U);
}

TEST(normal_cone, is_whole_for_real_directions_and_gone_for_ghosts) {
  // The top of a box, cut in triangles: flat pieces whose inner borders are no edges of the surface.
  const model_ptr box = test::make_piece_model(test::box_mesh(vec3(1.0), 3), test::cut_into::triangles);
  const mesh_features features = make_mesh_features(box->mesh);
  constexpr double slack = 0.1;
  int inside = 0;
  for (const convex_piece& p : box->pieces) {
    const convex_shape s = make_convex_shape(box->mesh, features, p);
    const vec3 n = s.faces[0].normal;
    EXPECT_DOUBLE_EQ(normal_cone_share(s, n, slack), 1.0);
    EXPECT_DOUBLE_EQ(normal_cone_share(s, -n, slack), 0.0);
    bool inner = true;
    for (std::size_t i = 0; i < s.size(); ++i) {
      const vec3 v = glm::abs(s.vertex(i));
      inner = inner && v.x + v.y + v.z < 1.7;  // no corner or edge of the box
    }
    if (!inner) continue;
    ++inside;
    const vec3 side = any_orthogonal(n);
    EXPECT_DOUBLE_EQ(normal_cone_share(s, std::cos(0.2) * n + std::sin(0.2) * side, slack), 0.0);
    const double partial = normal_cone_share(s, std::cos(0.05) * n + std::sin(0.05) * side, slack);
    EXPECT_GT(partial, 0.3);
    EXPECT_LT(partial, 0.7);
  }
  EXPECT_GE(inside, 6);  // one of each face at least
}

TEST(normal_cone, a_box_edge_and_a_corner_open_theirs) {
  const model_ptr box = test::make_piece_model(test::box_mesh(vec3(1.0)), test::cut_into::one_piece);
  const convex_shape s = shape_of(box);
  EXPECT_DOUBLE_EQ(normal_cone_share(s, glm::normalize(vec3(1.0, 2.0, 0.0)), 0.1), 1.0);
  EXPECT_DOUBLE_EQ(normal_cone_share(s, glm::normalize(vec3(1.0, -2.0, 3.0)), 0.1), 1.0);
}

TEST(normal_cone, a_concave_edge_opens_none) {
  // An L: both faces of the inner corner are seen along their normals only.
  coarse_mesh l = test::prism_mesh({{2, -1}, {2, 0.5}, {0.5, 0.5}, {0.5, 2}, {-1, 2}, {-1, -1}}, 1.0);
  const model_ptr m = test::make_piece_model(l, test::cut_into::triangles);
  const mesh_features features = make_mesh_features(m->mesh);
  int inner_walls = 0;
  std::size_t other_edges = 0;
  for (const convex_piece& p : m->pieces) {
    const convex_shape s = make_convex_shape(m->mesh, features, p);
    const vec3 n = s.faces[0].normal;
    const bool inner_wall = (n.x > 0.9 && s.box.high.x < 1.0) || (n.y > 0.9 && s.box.high.y < 1.0);
    if (!inner_wall) continue;
    ++inner_walls;
    other_edges += s.edges.size();
    // The far ends of the walls are convex; only the shared corner edge must not count.
    EXPECT_DOUBLE_EQ(normal_cone_share(s, n, 0.1), 1.0);
    for (const shape_edge& e : s.edges) {
      EXPECT_FALSE(std::fabs(e.point.x - 0.5) < 1e-12 && std::fabs(e.point.y - 0.5) < 1e-12 &&
                   std::fabs(e.direction.z) > 0.9);
    }
  }
  EXPECT_EQ(inner_walls, 4);  // two walls of two triangles
  EXPECT_GT(other_edges, 0U);
}

TEST(pair, a_flat_piece_pushes_out_along_its_outward_side_only) {
  // A box sunk 0.03 into a plate of flat pieces. Its bottom is further from the plate's top than the tolerance, seen
  // from behind; the way out is up all the same.
  const model_ptr plate = test::make_piece_model(test::box_mesh({1.0, 1.0, 0.2}), test::cut_into::flat_faces);
  const model_ptr box = test::make_piece_model(test::box_mesh(vec3(0.3)), test::cut_into::flat_faces);
  const pose T{{1.0, 0.0, 0.0, 0.0}, {0.0, 0.0, -0.47}};  // the plate in the box's frame: top at -0.27
  const mesh_features fa = make_mesh_features(box->mesh), fb = make_mesh_features(plate->mesh);
  std::size_t active = 0;
  for (const distance_shell shell : {distance_shell{-1.0, 0.01}, distance_shell{0.01, 0.2}}) {
    for (const convex_piece& p : box->pieces) {
      for (const convex_piece& q : plate->pieces) {
        close_pair pair;
        narrow_phase_cost cost;
        gjk_cache cache;
        evaluate_pair(make_convex_shape(box->mesh, fa, p), make_convex_shape(plate->mesh, fb, q), placement(T),
                      {0.01, 0.2}, shell, cache, pair, cost);
        if (pair.kind != pair_kind::active) continue;
        ++active;
        EXPECT_NEAR(pair.n_ab.z, -1.0, 1e-12);
        EXPECT_NEAR(pair.separation_m, -0.03, 1e-12);
        EXPECT_NEAR(glm::dot(pair.p_b - pair.p_a, pair.n_ab), -0.03, 1e-9);
      }
    }
  }
  EXPECT_EQ(active, 5U);  // four walls that cross the top, and the bottom that passed through it
}

TEST(pair, a_cut_between_coplanar_pieces_pushes_nobody_sideways) {
  // A box stands 0.001 deep in a floor of triangles, its side a hair inside an inner cut of the floor.
  const model_ptr floor = test::make_piece_model(test::box_mesh({1.0, 1.0, 0.2}, 4), test::cut_into::triangles);
  const model_ptr box = test::make_piece_model(test::box_mesh(vec3(0.2)), test::cut_into::one_piece);
  const convex_shape A = shape_of(box);
  const mesh_features features = make_mesh_features(floor->mesh);
  const pose T{{1.0, 0.0, 0.0, 0.0}, {-0.7 + 1e-4, 0.03, -0.399}};
  std::size_t active = 0;
  for (const convex_piece& q : floor->pieces) {
    close_pair pair;
    narrow_phase_cost cost;
    gjk_cache cache;
    evaluate_pair(A, make_convex_shape(floor->mesh, features, q), placement(T), {0.01, 0.05}, {-1.0, 0.01}, cache, pair,
                  cost);
    if (pair.kind != pair_kind::active) continue;
    ++active;
    EXPECT_NEAR(pair.n_ab.z, -1.0, 1e-12);
    EXPECT_NEAR(pair.separation_m, -0.001, 1e-12);
  }
  EXPECT_GT(active, 1U);
}

}  // namespace
}  // namespace asperity
