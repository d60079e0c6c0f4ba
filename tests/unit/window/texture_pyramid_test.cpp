// The bounds that the search for the deepest line stands on: every point of the surface is where its block says.
#include "exact/texture_pyramid.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>

#include "exact/pair_bound.hpp"
#include "support/height_models.hpp"

namespace asperity::detail {
namespace {

using namespace test_support;

class dice {
 public:
  explicit dice(std::uint64_t seed) : bits_(seed) {}
  double between(double low, double high) { return low + (high - low) * static_cast<double>(bits_() >> 11) * 0x1p-53; }
  std::int32_t below(std::int32_t n) { return static_cast<std::int32_t>(bits_() % static_cast<std::uint64_t>(n)); }

 private:
  std::mt19937_64 bits_;
};

haptic_texture rough_texture(std::uint32_t width, std::uint32_t height, double hole_share, std::uint64_t seed) {
  dice d(seed);
  haptic_texture t;
  t.width = width;
  t.height = height;
  for (std::uint32_t j = 0; j < height; ++j) {
    for (std::uint32_t i = 0; i < width; ++i) {
      const vec3 p(1e-4 * i + 3e-5 * j + d.between(-1e-5, 1e-5), 8e-5 * j + d.between(-1e-5, 1e-5),
                   2e-3 * std::sin(0.05 * i) + 1e-5 * j + d.between(-1e-5, 1e-5));
      t.texels.emplace_back(d.between(0.0, 1.0) < hole_share ? vec3(std::numeric_limits<double>::quiet_NaN()) : p);
    }
  }
  return t;
}

/// A place of the level that lies, at least in part, on the texture.
texture_place any_place(dice& d, const haptic_texture& t, int level) {
  const auto count = [&](std::uint32_t size) {
    return level >= 0 ? static_cast<std::int32_t>(size >> level) + 1 : (static_cast<std::int32_t>(size) + 1) << -level;
  };
  return {static_cast<std::int8_t>(level), d.below(count(t.width)), d.below(count(t.height))};
}

TEST(TexturePyramid, ABlockHoldsAllItsTexelsAndAllBetweenThem) {
  dice d(1);
  std::size_t points = 0, tight = 0;
  for (const auto& [width, height, holes] :
       {std::tuple{64U, 64U, 0.0}, {100U, 37U, 0.0}, {5U, 3U, 0.0}, {1U, 9U, 0.0}, {1U, 1U, 0.0}, {60U, 60U, 0.05}}) {
    const haptic_texture t = rough_texture(width, height, holes, width);
    const texture_pyramid pyramid(t);
    EXPECT_EQ(1, std::max(t.width >> pyramid.top(), t.height >> pyramid.top()) + 1) << "one block at the top";
    for (int level = -6; level <= pyramid.top(); ++level) {
      for (int i = 0; i < 60; ++i) {
        const texture_place at = any_place(d, t, level);
        const texture_block block = pyramid.block(at);
        for (int k = 0; k < 40; ++k) {
          // Corners too: texels are where a bound is met.
          const auto coordinate = [&] { return k % 4 == 0 ? d.below(2) * 2.0 - 1.0 : d.between(-1.0, 1.0); };
          const vec2 w(at.half() * coordinate(), at.half() * coordinate());
          const vec2 z = at.middle() + w;
          if (z.x > t.width || z.y > t.height) continue;
          const vec3 point = read(t, z).point;
          if (!is_finite(point)) continue;
          const bool on_border = std::fabs(w.x) == at.half() || std::fabs(w.y) == at.half();
          // On a torn cell's border the whole cell beyond it is read.
          if (block.empty && on_border && holes > 0.0) continue;
          ASSERT_FALSE(block.empty);
          const vec3 error = glm::abs(point - (block.centre + w.x * block.along_x + w.y * block.along_y));
          for (int axis = 0; axis < 3; ++axis) {
            ASSERT_LE(error[axis], std::fabs(block.spare[axis]) + 1e-15)
                << "level " << level << " at " << z.x << ", " << z.y;
            tight += error[axis] > 0.5 * std::fabs(block.spare[axis]) ? 1U : 0U;
          }
          ++points;
        }
      }
    }
  }
  EXPECT_GT(points, 50000U);
  EXPECT_GT(tight, points / 10) << "the boxes are far too large";
}

TEST(TexturePyramid, ABlockOfAPlaneHasNoSpareHoweverItLeans) {
  haptic_texture t;
  t.width = t.height = 64;
  for (std::uint32_t j = 0; j < 64; ++j) {
    for (std::uint32_t i = 0; i < 64; ++i) t.texels.emplace_back(vec3(0.25 * i, 0.125 * j, 0.5 * i - 0.75 * j));
  }
  const texture_pyramid pyramid(t);
  for (int level = -3; level <= 4; ++level) {
    // Away from the image's border, whose repeated texels are no part of the plane.
    const texture_block block =
        pyramid.block({static_cast<std::int8_t>(level), level > 0 ? 1 : 40, level > 0 ? 1 : 40});
    ASSERT_FALSE(block.empty);
    for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(block.spare[axis], 0.0);
  }
}

TEST(TexturePyramid, AHoleMakesItsFourCellsEmptyAndNoOther) {
  haptic_texture t = rough_texture(32, 32, 0.0, 5);
  t.texels[10 * 32 + 20].y = std::numeric_limits<float>::quiet_NaN();
  const texture_pyramid pyramid(t);
  for (std::int32_t y = 0; y <= 32; ++y) {
    for (std::int32_t x = 0; x <= 32; ++x) {
      EXPECT_EQ(pyramid.block({0, x, y}).empty, (x == 20 || x == 21) && (y == 10 || y == 11)) << x << ", " << y;
    }
  }
  for (int level = 1; level <= pyramid.top(); ++level) {
    EXPECT_FALSE(pyramid.block({static_cast<std::int8_t>(level), 20 >> level, 10 >> level}).empty);
  }
  EXPECT_TRUE(pyramid.block({3, 9, 0}).empty) << "beyond the texture";
  EXPECT_TRUE(pyramid.block({0, -1, 0}).empty) << "beyond the texture";
}

/// A bumpy plate, leaning in its body and against the window, cut in charts.
struct looked_at {
  model_ptr model;
  surface_index index;
  texture_pyramid pyramid;
  chart_blocks charts;
  contact_window window = window_downwards(4e-3);
  window_map map;
  patch_projection patch;
  body_view view;

  static plate_spec spec(bool cut) {
    plate_spec s;
    s.half_x = s.half_y = 5e-3;
    s.cells_x = s.cells_y = 3;
    s.texels = 96;
    s.chart_per_cell = cut;
    s.T_body_plate = {exp_rotation(vec3(0.4, -1.1, 0.7)), {0.01, 0.02, -0.03}};
    s.height = [](double x, double y) { return 2e-4 * std::cos(1500.0 * x) * std::cos(1200.0 * y); };
    s.coarse_height = [](double x, double y) { return 3e-4 * std::cos(300.0 * x + 200.0 * y); };
    return s;
  }
  explicit looked_at(bool cut)
      : model(make_plate(spec(cut))),
        index(*model),
        pyramid(model->texture),
        charts(*model, index),
        map(window, pose{exp_rotation(vec3(0.2, 0.1, 0.5)), vec3(0.0)} * inverse(spec(cut).T_body_plate)),
        patch(model->mesh.triangles.size()),
        view{model->texture, index, patch, map} {
    const std::vector<std::uint32_t> all = all_triangles(*model);
    patch.project(model->mesh, index, all, map, layer::lowest, 0.1);
  }
};

TEST(ChartBlocks, HoldAllOfAChartAndAreAsThickAsItsRelief) {
  dice d(8);
  const looked_at s(true);
  for (std::uint32_t t = 0; t < s.index.texels.size(); ++t) {
    const texel_triangle& chart = s.index.texels[t];
    for (int k = 0; k < 50; ++k) {
      double a = d.between(0.0, 1.0), b = d.between(0.0, 1.0);
      if (a + b > 1.0) a = 1.0 - a, b = 1.0 - b;
      const vec2 z =
          chart.corner[0] + a * (chart.corner[1] - chart.corner[0]) + b * (chart.corner[2] - chart.corner[0]);
      const texture_block block = s.charts.block(t, z);
      ASSERT_FALSE(block.empty);
      const vec3 off = glm::abs(read(s.model->texture, z).point - block.centre);
      ASSERT_TRUE(glm::all(glm::lessThanEqual(off, block.spare + 1e-12))) << "triangle " << t;
      ASSERT_LT(glm::length(block.spare), 2e-3) << "the plate is 10 mm wide";
    }
  }
}

TEST(WindowPiece, HoldsEveryPointOfItsPartOfTheSurface) {
  dice d(7);
  std::size_t points = 0, graphs = 0, pieces = 0;
  for (const bool charts : {false, true}) {
    const looked_at s(charts);
    const auto slots = static_cast<std::int32_t>(s.patch.triangles().size());
    ASSERT_GE(slots, 18);
    for (const parallax_mode mode : {parallax_mode::paper_lookup, parallax_mode::exact}) {
      const searched_body body{s.view, s.pyramid, s.charts, mode};
      for (int i = 0; i < 4000; ++i) {
        const auto slot = static_cast<std::uint32_t>(d.below(slots));
        const texture_place at = any_place(d, s.model->texture, d.below(9) - 4);
        const surface_part part{slot, at};
        window_piece piece;
        const bool made = make_piece(body, part, piece);
        pieces += made ? 1U : 0U;
        for (int k = 0; k < 10; ++k) {
          const vec2 z = at.middle() + at.half() * vec2(d.between(-1.0, 1.0), d.between(-1.0, 1.0));
          const vec3 bary = body.chart(slot).barycentric(z);
          if (std::min({bary.x, bary.y, bary.z}) < 0.0) continue;
          const haptic_texture& image = s.model->texture;
          if (z.x < 0.0 || z.y < 0.0 || z.x > image.width - 1.0 || z.y > image.height - 1.0) continue;
          vec3 point = s.map.point(read(s.model->texture, z).point);
          if (mode == parallax_mode::paper_lookup) {
            const auto& c = body.triangle(slot).corner;
            point = {vec2(bary.x * c[0] + bary.y * c[1] + bary.z * c[2]), point.z};
          } else {  // a part that is turned away, or beyond the patch's border, need not be held
            const surface_hit h = read_surface(body, part, vec2(point), z, 1e-13);
            if (!h.found || std::fabs(h.height - point.z) > 1e-9) continue;
          }
          ASSERT_TRUE(made);
          ASSERT_TRUE(glm::all(glm::lessThanEqual(piece.low, point)) &&
                      glm::all(glm::lessThanEqual(point, piece.high)));
          for (std::uint32_t side = 0; side < piece.sides; ++side) ASSERT_GE(piece.side[side].at(vec2(point)), 0.0);
          if (piece.is_graph) {
            ASSERT_LE(std::fabs(point.z - piece.plane(vec2(point))), piece.above_plane);
            ++graphs;
          }
          ++points;
        }
      }
    }
  }
  EXPECT_GT(points, 1000U);
  EXPECT_GT(graphs, points / 2);
  EXPECT_GT(pieces, 400U);
}

TEST(PairBound, AWindowPolygonIsWhatHalfPlanesLeave) {
  window_polygon square({-1.0, -1.0}, {1.0, 1.0});
  square.cut({1.0, 1.0, -1.0});  // u + v >= 1: a corner's triangle
  ASSERT_EQ(square.corners().size(), 3U);
  EXPECT_NEAR(square.middle().x, 2.0 / 3.0, 1e-15);
  EXPECT_NEAR(square.middle().y, 2.0 / 3.0, 1e-15);
  square.cut({-1.0, -1.0, 0.5});
  EXPECT_TRUE(square.corners().empty());
}

}  // namespace
}  // namespace asperity::detail
