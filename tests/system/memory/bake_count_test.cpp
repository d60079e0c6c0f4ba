// What a bake asks of the allocator for each triangle of the mesh.
#include <cstdint>
#include <gtest/gtest.h>
#include <utility>

#include "asperity/bake/bake.hpp"
#include "counted_heap.hpp"
#include "unit/bake/shapes.hpp"

namespace asperity::bake {
namespace {

struct cost {
  std::size_t triangles;
  std::size_t most_bytes;  // beyond what was there before, the mesh itself included
};

cost bake_torus(std::uint32_t around, std::uint32_t across, bool keep) {
  bake_settings options;
  options.triangles = 100;
  options.texture_size = 64;
  options.threads = 1;
  const std::size_t before = test_support::bytes_on_loan();
  test_support::watch_from_here();
  triangle_mesh mesh = shapes::wavy_torus{}.mesh(around, across);
  const std::size_t triangles = mesh.triangles.size();
  mesh.positions.shrink_to_fit();
  mesh.triangles.shrink_to_fit();
  test_support::watch_from_here();
  const auto model = keep ? bake(mesh, options) : bake(std::move(mesh), options);
  EXPECT_TRUE(model.has_value()) << model.error().message;
  return {triangles, test_support::most_bytes_on_loan() - before};
}

double bytes_per_triangle(bool keep) {
  const cost few = bake_torus(160, 80, keep);
  const cost many = bake_torus(320, 160, keep);
  const double bytes = static_cast<double>(many.most_bytes) - static_cast<double>(few.most_bytes);
  const double each = bytes / static_cast<double>(many.triangles - few.triangles);
  std::printf("%zu triangles: %.1f MB, %zu: %.1f MB; %.0f bytes for each more\n", few.triangles,
              1e-6 * static_cast<double>(few.most_bytes), many.triangles, 1e-6 * static_cast<double>(many.most_bytes),
              each);
  return each;
}

// About three times a binary STL. What the texture takes comes on top and does not grow with the mesh.
TEST(BakeCount, TakesAtMost160BytesForEachTriangle) { EXPECT_LE(bytes_per_triangle(false), 160.0); }

// 12 bytes for the triangle and 12 for its half of a vertex.
TEST(BakeCount, AMeshThatTheCallerKeepsComesOnTop) {
  const double each = bytes_per_triangle(true);
  EXPECT_GT(each, 160.0);
  EXPECT_LE(each, 160.0 + 24.0);
}

}  // namespace
}  // namespace asperity::bake
