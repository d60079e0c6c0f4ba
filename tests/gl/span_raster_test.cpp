#include "span_raster.hpp"

#include <gtest/gtest.h>

#include "asperity/depth/patch_projection.hpp"
#include "gl/seeded_contacts.hpp"

namespace asperity::gl {
namespace {

TEST(SpanRaster, DecidesAsTheCpuBackendsRasterDoes) {
  std::size_t covered = 0, overlapped = 0;
  for (const std::uint32_t cells : {1U, 3U, 5U}) {
    const auto s = test_support::make_seeded_contacts(40 + cells, cells, cells, 64, 60);
    for (std::size_t i = 0; i < s.contacts.size(); ++i) {
      const contact& c = s.contacts.contacts()[i];
      for (const bool fixed : {false, true}) {
        const textured_model& model = fixed ? *s.bodies.fixed[0] : *s.bodies.probe;
        const detail::surface_index index(model);
        const detail::layer which = fixed ? detail::layer::lowest : detail::layer::highest;
        const detail::window_map map(c.window, fixed ? s.T_wb[i] : s.T_wa[i]);
        detail::patch_projection patch(model.mesh.triangles.size());
        // From the side, walls stand before the top: then there is more than one layer.
        patch.project(model.mesh, index, test_support::all_triangles(model), map, which, 0.02);
        const detail::sample_grid grid(i % 2 == 0 ? 64 : 33, c.window.half_size_m);
        detail::height_field wanted(grid.size()), found(grid.size());
        rasterise(patch, grid, which, wanted);
        rasterise_spans(patch, grid, which, found);
        ASSERT_EQ(found.kind, wanted.kind);
        for (std::size_t k = 0; k < grid.size(); ++k) {
          if (wanted.kind[k] == detail::hit::none) continue;
          ASSERT_EQ(found.owner[k], wanted.owner[k]);
          ASSERT_EQ(found.height[k], wanted.height[k]);
          ++covered;
          if (wanted.owner[k] > 0) ++overlapped;
        }
      }
    }
  }
  EXPECT_GT(covered, 100'000U);
  EXPECT_GT(overlapped, 10'000U);
}

/// Samples that lie exactly on the edges and corners of triangles.
TEST(SpanRaster, DecidesTheSameOnEdges) {
  test_support::plate_spec spec;
  spec.half_x = spec.half_y = 0.004;
  spec.cells_x = spec.cells_y = 4;
  const model_ptr plate = test_support::make_plate(spec);
  const detail::surface_index index(*plate);
  contact_window w = test_support::window_downwards(0.004);
  w.n_ab_w = {0.0, 0.0, 1.0};
  w.v_w = {0.0, 1.0, 0.0};
  for (const double shift : {0.0, 0.5, 0.25}) {
    const detail::sample_grid grid(8, 0.004);
    const detail::window_map map(w, {quat(1, 0, 0, 0), vec3(shift * grid.pitch_m, shift * grid.pitch_m, 0.0)});
    detail::patch_projection patch(plate->mesh.triangles.size());
    patch.project(plate->mesh, index, test_support::all_triangles(*plate), map, detail::layer::highest, 0.1);
    detail::height_field wanted(grid.size()), found(grid.size());
    rasterise(patch, grid, detail::layer::highest, wanted);
    rasterise_spans(patch, grid, detail::layer::highest, found);
    EXPECT_EQ(found.kind, wanted.kind);
    for (std::size_t k = 0; k < grid.size(); ++k) {
      if (wanted.kind[k] == detail::hit::none) continue;
      EXPECT_EQ(found.owner[k], wanted.owner[k]) << k;
    }
  }
}

}  // namespace
}  // namespace asperity::gl
