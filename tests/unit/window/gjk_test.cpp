// GJK against slow answers, against itself warm and cold, and against Bullet where that is installed.
#include "window/gjk.hpp"

#include <gtest/gtest.h>
#include <limits>
#include <vector>

#include "support/piece_models.hpp"
#include "support/random_hulls.hpp"

#ifdef ASPERITY_TEST_WITH_BULLET
#include <BulletCollision/CollisionShapes/btConvexHullShape.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpaPenetrationDepthSolver.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkPairDetector.h>
#include <BulletCollision/NarrowPhaseCollision/btPointCollector.h>
#include <BulletCollision/NarrowPhaseCollision/btVoronoiSimplexSolver.h>
#endif

namespace asperity {
namespace {

constexpr double no_limit = std::numeric_limits<double>::infinity();

struct body {
  coarse_mesh mesh;
  convex_shape shape;
};

body make_body(coarse_mesh mesh) {
  const model_ptr m = test::make_piece_model(std::move(mesh), test::cut_into::one_piece);
  return {m->mesh, make_convex_shape(m->mesh, make_mesh_features(m->mesh), m->pieces[0])};
}

/// Every fourth body is a single triangle.
body random_body(test::uniform_source& uniform, std::size_t number) {
  if (number % 4 == 3) {
    return make_body(test::triangle_mesh_of({uniform.in_box(1.0), uniform.in_box(1.0), uniform.in_box(1.0)}));
  }
  std::vector<vec3> points;
  for (std::size_t i = 0; i < 5 + number % 6; ++i) points.push_back(uniform.in_box(1.0));
  return make_body(test::brute_hull(points));
}

pose random_pose(test::uniform_source& uniform, double reach) {
  return {exp_rotation(uniform(0.0, 3.0) * uniform.direction()), uniform.in_box(reach)};
}

coarse_mesh moved(const coarse_mesh& mesh, const pose& T) {
  coarse_mesh out = mesh;
  for (vec3& p : out.positions) p = T * p;
  return out;
}

gjk_result cold(const body& a, const body& b, const pose& T, double limit = no_limit) {
  gjk_cache cache;
  return gjk_distance(a.shape, b.shape, placement(T), limit, cache);
}

TEST(gjk, equals_brute_force_on_random_hulls_and_triangles) {
  test::uniform_source uniform(11);
  std::size_t apart = 0, overlapping = 0;
  for (std::size_t k = 0; k < 1500; ++k) {
    const body a = random_body(uniform, k);
    const body b = random_body(uniform, k / 3);
    const pose T = random_pose(uniform, 1.8);
    const coarse_mesh at = moved(b.mesh, T);
    const gjk_result g = cold(a, b, T);
    if (test::brute_separation(a.mesh, at) < 0.0) {
      EXPECT_EQ(g.outcome, gjk_outcome::overlapping) << "pair " << k;
      ++overlapping;
      continue;
    }
    ++apart;
    ASSERT_EQ(g.outcome, gjk_outcome::separated) << "pair " << k;
    EXPECT_NEAR(g.distance, test::brute_distance(a.mesh, at), 1e-12) << "pair " << k;
    EXPECT_NEAR(glm::distance(g.p_a, g.p_b), g.distance, 1e-12);
    EXPECT_NEAR(glm::dot(g.p_b - g.p_a, g.n_ab), g.distance, 1e-12);
    // The direction separates the bodies by the whole distance: no other plane could do better.
    EXPECT_NEAR(glm::dot(g.n_ab, placement(T) * b.shape.vertex(b.shape.support(placement(T).to_local(-g.n_ab)))) -
                    glm::dot(g.n_ab, a.shape.vertex(a.shape.support(g.n_ab))),
                g.distance, 1e-10);
  }
  EXPECT_GT(apart, 500U);
  EXPECT_GT(overlapping, 200U);
}

TEST(gjk, warm_start_changes_the_cost_and_not_the_result) {
  test::uniform_source uniform(12);
  std::size_t warm_iterations = 0, cold_iterations = 0;
  for (std::size_t k = 0; k < 100; ++k) {
    const body a = random_body(uniform, k);
    const body b = random_body(uniform, k + 1);
    pose T = random_pose(uniform, 2.5);
    const vec3 step = 0.01 * uniform.direction();
    gjk_cache cache;
    for (int i = 0; i < 50; ++i) {
      T.position += step;
      T.rotation = glm::normalize(exp_rotation(step) * T.rotation);
      const gjk_result warm = gjk_distance(a.shape, b.shape, placement(T), no_limit, cache);
      const gjk_result again = cold(a, b, T);
      ASSERT_EQ(warm.outcome, again.outcome);
      EXPECT_NEAR(warm.distance, again.distance, 1e-12);
      warm_iterations += warm.iterations;
      cold_iterations += again.iterations;
    }
  }
  EXPECT_LT(2 * warm_iterations, cold_iterations);
}

TEST(gjk, a_wrong_cache_costs_only_iterations) {
  test::uniform_source uniform(13);
  for (std::size_t k = 0; k < 200; ++k) {
    const body a = random_body(uniform, 4 * k);
    const body b = random_body(uniform, 4 * k + 1);
    const pose T = random_pose(uniform, 3.0);
    gjk_cache wrong{3, {0, 0, 1}, {0, 0, 2}};
    const gjk_result g = gjk_distance(a.shape, b.shape, placement(T), no_limit, wrong);
    const gjk_result right = cold(a, b, T);
    ASSERT_EQ(g.outcome, right.outcome);
    EXPECT_NEAR(g.distance, right.distance, 1e-12);
  }
}

TEST(gjk, gives_up_beyond_the_limit_and_only_there) {
  const body a = make_body(test::box_mesh(vec3(1.0)));
  const pose T{{1.0, 0.0, 0.0, 0.0}, {3.0, 0.0, 0.0}};
  EXPECT_EQ(cold(a, a, T, 0.999).outcome, gjk_outcome::beyond);
  EXPECT_EQ(cold(a, a, T, 1.001).outcome, gjk_outcome::separated);
  EXPECT_DOUBLE_EQ(cold(a, a, T, 1.001).distance, 1.0);
}

TEST(gjk, parallel_faces_have_an_exact_direction) {
  const body a = make_body(test::box_mesh(vec3(1.0)));
  for (const double gap : {1e-9, 1e-6, 1e-3, 0.5}) {
    const gjk_result g = cold(a, a, {exp_rotation({0.0, 0.0, 0.3}), {0.2, 0.1, 2.0 + gap}});
    ASSERT_EQ(g.outcome, gjk_outcome::separated);
    EXPECT_NEAR(g.distance, gap, 1e-14);
    EXPECT_NEAR(g.n_ab.z, 1.0, 1e-12);
  }
}

TEST(gjk, touching_is_overlapping) {
  const body a = make_body(test::box_mesh(vec3(1.0)));
  EXPECT_EQ(cold(a, a, {{1.0, 0.0, 0.0, 0.0}, {2.0, 0.0, 0.0}}).outcome, gjk_outcome::overlapping);
}

TEST(gjk, equals_bullet) {
#ifdef ASPERITY_TEST_WITH_BULLET
  test::uniform_source uniform(14);
  const auto to_bullet = [](const convex_shape& s) {
    btConvexHullShape hull;
    for (std::size_t i = 0; i < s.size(); ++i) hull.addPoint(btVector3(s.x[i], s.y[i], s.z[i]), false);
    hull.setMargin(0.0);
    hull.recalcLocalAabb();
    return hull;
  };
  std::size_t compared = 0;
  for (std::size_t k = 0; compared < 1000; ++k) {
    const body a = random_body(uniform, k);
    const body b = random_body(uniform, k / 2);
    const pose T = random_pose(uniform, 3.0);
    const gjk_result g = cold(a, b, T);
    if (g.outcome != gjk_outcome::separated || g.distance < 1e-3) continue;
    const btConvexHullShape hull_a = to_bullet(a.shape), hull_b = to_bullet(b.shape);
    btVoronoiSimplexSolver solver;
    btGjkEpaPenetrationDepthSolver depth;
    btGjkPairDetector detector(&hull_a, &hull_b, &solver, &depth);
    btGjkPairDetector::ClosestPointInput input;
    input.m_transformA.setIdentity();
    input.m_transformB = btTransform(btQuaternion(T.rotation.x, T.rotation.y, T.rotation.z, T.rotation.w),
                                     btVector3(T.position.x, T.position.y, T.position.z));
    btPointCollector found;
    detector.getClosestPoints(input, found, nullptr);
    ASSERT_TRUE(found.m_hasResult) << "pair " << k;
    EXPECT_NEAR(g.distance, found.m_distance, 1e-6) << "pair " << k;
    ++compared;
  }
#else
  GTEST_SKIP() << "Bullet in double precision (pkg-config bullet-float64) was not found";
#endif
}

}  // namespace
}  // namespace asperity
