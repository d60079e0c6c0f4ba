// Which coarse triangle is seen over each sample.
#include <algorithm>
#include <gtest/gtest.h>
#include <iterator>
#include <random>
#include <utility>

#include "support/height_models.hpp"
#include "window/height_field.hpp"

namespace asperity::detail {
namespace {

using namespace test_support;

struct raster {
  model_ptr model;
  surface_index index{*model};
  patch_projection patch{model->mesh.triangles.size()};
  height_field field{64 * 64};

  void run(const contact_window& w, const pose& T, layer which) {
    patch.project(model->mesh, index, all_triangles(*model), window_map(w, T), which, 0.1);
    rasterise(patch, sample_grid(64, w.half_size_m), which, field);
  }
};

/// What rasterise() has to find, decided sample by sample.
void rasterise_plainly(const patch_projection& patch, const sample_grid& grid, layer which, height_field& out) {
  std::fill(out.kind.begin(), out.kind.end(), hit::none);
  const double s = sign(which);
  for (std::uint32_t t = 0; t < patch.triangles().size(); ++t) {
    const projected_triangle& tri = patch.triangles()[t];
    const edge_side edges[] = {edge_side(tri, 0, s), edge_side(tri, 1, s), edge_side(tri, 2, s)};
    for (std::size_t i = 0; i < grid.size(); ++i) {
      const vec2 p = grid.position(i);
      if (std::any_of(std::begin(edges), std::end(edges),
                      [&](const edge_side& e) { return e(p.x, e.row(p.y)) < 0.0; })) {
        continue;
      }
      const double h = tri.height(p.x, p.y);
      if (out.kind[i] != hit::none && s * (h - out.height[i]) <= 0.0) continue;
      out.kind[i] = hit::coarse;
      out.height[i] = h;
      out.owner[i] = t;
    }
  }
}

/// @return samples that are covered, the largest owner
std::pair<std::size_t, std::uint32_t> expect_plain_decisions(const patch_projection& patch, const sample_grid& grid,
                                                             layer which) {
  height_field wanted(grid.size()), found(grid.size());
  rasterise_plainly(patch, grid, which, wanted);
  rasterise(patch, grid, which, found);
  EXPECT_EQ(found.kind, wanted.kind);
  std::pair<std::size_t, std::uint32_t> seen{0, 0};
  for (std::size_t k = 0; k < grid.size(); ++k) {
    if (wanted.kind[k] == hit::none) continue;
    EXPECT_EQ(found.owner[k], wanted.owner[k]) << k;
    EXPECT_EQ(found.height[k], wanted.height[k]) << k;
    ++seen.first;
    seen.second = std::max(seen.second, wanted.owner[k]);
  }
  return seen;
}

TEST(Raster, DecidesARowAsItWouldDecideEachSample) {
  plate_spec spec;
  spec.half_x = spec.half_y = 0.004;
  spec.texels = 64;
  // Walls seen nearly from the side stand before the top, and samples of the unturned plate lie exactly on edges.
  std::mt19937_64 bits(5);
  const auto uniform = [&] { return static_cast<double>(bits() >> 11) * 0x1p-52 - 1.0; };
  std::size_t covered = 0;
  std::uint32_t owner = 0;
  for (const std::uint32_t cells : {1U, 3U, 4U}) {
    spec.cells_x = spec.cells_y = cells;
    const model_ptr plate = make_plate(spec);
    const surface_index index(*plate);
    patch_projection patch(plate->mesh.triangles.size());
    for (int i = 0; i < 60; ++i) {
      const contact_window w = window_downwards(i % 2 == 0 ? 4e-3 : 2.5e-3);
      const double turn = i < 6 ? 0.0 : 1.2;
      const sample_grid grid(i % 3 == 0 ? 8 : 33, w.half_size_m);
      const vec3 shift =
          i < 6 ? 0.5 * i * grid.pitch_m * vec3(1.0, 1.0, 0.0) : 2e-3 * vec3{uniform(), uniform(), uniform()};
      const pose T{exp_rotation(turn * vec3{uniform(), uniform(), 2.0 * uniform()}) * face_down(), shift};
      for (const layer which : {layer::highest, layer::lowest}) {
        const pose seen = which == layer::highest ? T : pose{glm::conjugate(face_down()) * T.rotation, T.position};
        patch.project(plate->mesh, index, all_triangles(*plate), window_map(w, seen), which, 0.02);
        const auto [samples, largest] = expect_plain_decisions(patch, grid, which);
        covered += samples;
        owner = std::max(owner, largest);
      }
    }
  }
  EXPECT_GT(covered, 50'000U);
  EXPECT_GT(owner, 20U);
}

TEST(Raster, LeavesNoHoleBetweenTrianglesInAnyPose) {
  plate_spec spec;
  spec.cells_x = 7;
  spec.cells_y = 5;
  spec.texels = 70;
  raster r{make_plate(spec)};
  std::mt19937_64 bits(11);
  const auto uniform = [&] { return static_cast<double>(bits() >> 11) * 0x1p-52 - 1.0; };
  for (int i = 0; i < 200; ++i) {
    const pose T{exp_rotation(vec3{0.4 * uniform(), 0.4 * uniform(), 3.0 * uniform()}) * face_down(),
                 1e-3 * vec3{uniform(), uniform(), uniform()}};
    r.run(window_downwards(5e-3), T, layer::highest);  // inside the face, whatever the pose
    EXPECT_EQ(std::count(r.field.kind.begin(), r.field.kind.end(), hit::none), 0) << "pose " << i;
  }
}

TEST(Raster, SamplesOnEdgesAreSeen) {
  plate_spec spec;
  spec.cells_x = spec.cells_y = 8;
  spec.texels = 64;
  raster r{make_plate(spec)};
  // Edges, diagonals and vertices of the face fall on sample centres: cells of 2.5 mm, samples every 0.3125 mm.
  const contact_window w = window_downwards(10e-3, 0.5 * 0.3125e-3 * vec3(1.0, 1.0, 0.0));
  r.run(w, {face_down(), vec3(0.0)}, layer::highest);
  const sample_grid grid(64, w.half_size_m);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const vec3 p = to_world(w, vec3(grid.position(i), 0.0));
    const bool inside = std::max(std::fabs(p.x), std::fabs(p.y)) < 10e-3 - 1e-9;
    if (!inside) continue;
    EXPECT_NE(r.field.kind[i], hit::none) << p.x << ' ' << p.y;
  }
}

TEST(Raster, SeesTheLayerThatComesFirst) {
  // Coarse steps: 2 mm higher where x > 0. Seen at a slant, the step hides a strip of the lower face.
  plate_spec spec;
  spec.cells_x = 40;
  spec.cells_y = 2;
  spec.texels = 80;
  spec.coarse_height = [](double x, double) { return x > 1e-4 ? 2e-3 : 0.0; };
  raster r{make_plate(spec)};
  for (const layer which : {layer::highest, layer::lowest}) {
    // As the probe the face looks down at the window, as the fixed body up.
    const quat tilt = exp_rotation(vec3(0.0, 0.5, 0.0));
    const pose T{which == layer::highest ? tilt * face_down() : tilt, vec3(0.0)};
    const contact_window w = window_downwards(4e-3);
    r.run(w, T, which);
    const sample_grid grid(64, w.half_size_m);
    const window_map map(w, T);
    for (std::size_t i = 0; i < grid.size(); ++i) {
      ASSERT_NE(r.field.kind[i], hit::none);
      const vec2 uv = grid.position(i);
      for (const projected_triangle& t : r.patch.triangles()) {
        const auto side = [&](std::size_t k) {
          const edge_side e(t, k, sign(which));
          return e(uv.x, e.row(uv.y)) >= 0.0;
        };
        if (!side(0) || !side(1) || !side(2)) continue;
        EXPECT_GE(sign(which) * (r.field.height[i] - t.height(uv.x, uv.y)), 0.0);
      }
    }
  }
}

TEST(Raster, TakesOnlyTrianglesThatFaceTheOtherBody) {
  raster r{make_plate({})};
  r.run(window_downwards(5e-3), {face_down(), vec3(0.0)}, layer::highest);
  EXPECT_EQ(r.patch.triangles().size(), 2U);  // the top, not the bottom, not the walls
  r.run(window_downwards(5e-3), {quat(1, 0, 0, 0), vec3(0.0)}, layer::lowest);
  EXPECT_EQ(r.patch.triangles().size(), 2U);
  // Tilted by a little more than the threshold's angle a wall comes into view.
  r.run(window_downwards(5e-3), {exp_rotation(vec3(0.11, 0.0, 0.0)) * face_down(), vec3(0.0)}, layer::highest);
  EXPECT_EQ(r.patch.triangles().size(), 4U);
  r.run(window_downwards(5e-3), {exp_rotation(vec3(0.09, 0.0, 0.0)) * face_down(), vec3(0.0)}, layer::highest);
  EXPECT_EQ(r.patch.triangles().size(), 2U);
}

TEST(SurfaceIndex, KnowsTheNeighbourAcrossEveryEdge) {
  plate_spec spec;
  spec.cells_x = 3;
  spec.cells_y = 2;
  spec.texels = 60;
  const model_ptr m = make_plate(spec);
  const surface_index index(*m);
  for (std::uint32_t t = 0; t < m->mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t other = index.neighbour[t][k];
      ASSERT_NE(other, surface_index::none) << "the plate is closed";
      const auto& v = m->mesh.triangles[t].vertex;
      const auto& o = m->mesh.triangles[other].vertex;
      const auto has_vertex = [&](std::uint32_t x) { return std::find(o.begin(), o.end(), x) != o.end(); };
      EXPECT_TRUE(has_vertex(v[k]) && has_vertex(v[(k + 1) % 3]));
    }
  }
}

}  // namespace
}  // namespace asperity::detail
