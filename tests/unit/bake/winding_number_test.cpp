#include "bake/winding_number.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "bake/geometry.hpp"
#include "bake/triangle_bvh.hpp"
#include "even_ball.hpp"
#include "shapes.hpp"
#include "support/fresh_seed.hpp"

namespace asperity::bake {
namespace {

using shapes::ball;
using shapes::dice;

TEST(WindingField, IsTheSumOfTheSolidAngles) {
  dice draw(test_support::fresh_seed("WindingField.IsTheSumOfTheSolidAngles", "200 points"));
  const triangle_mesh soup = shapes::both(shapes::without_some(ball(0.05, 4), draw, 0.3),
                                          shapes::turned_at_random(ball(0.03, 4, {0.02, 0.05, 0.0}), draw, 0.2));
  const triangle_bvh tree(soup.positions, soup.triangles);
  const winding_field field(tree);
  for (int i = 0; i < 200; ++i) {
    const vec3 p{draw(-0.15, 0.15), draw(-0.15, 0.15), draw(-0.15, 0.15)};
    double sum = 0.0;
    for (const auto& t : soup.triangles) sum += winding_of(corners(soup.positions, t), p);
    EXPECT_NEAR(field.at(p), sum, 0.005);
  }
}

TEST(WindingField, OfAClosedSurfaceIsOneInsideAndNoneOutside) {
  dice draw(test_support::fresh_seed("WindingField.OfAClosedSurface", "300 points"));
  const triangle_mesh mesh = ball(0.05, 5);
  const triangle_bvh tree(mesh.positions, mesh.triangles);
  const winding_field field(tree);
  for (int i = 0; i < 300; ++i) {
    const vec3 n = glm::normalize(vec3(draw(-1, 1), draw(-1, 1), draw(-1, 1)));
    const double r = draw(0.0, 2.0);
    if (std::abs(r - 1.0) < 0.003) continue;  // between the sphere and its triangles
    EXPECT_NEAR(field.at(0.05 * r * n), r < 1.0 ? 1.0 : 0.0, 0.005) << r;
  }
}

}  // namespace
}  // namespace asperity::bake
