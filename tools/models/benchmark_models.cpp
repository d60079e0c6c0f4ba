#include "benchmark_models.hpp"

#include "shapes.hpp"

namespace asperity::models {
namespace {

/// A row of the paper's Table 1.
struct row {
  std::string_view name;
  std::size_t full_triangles;
  std::size_t coarse_triangles;
  std::size_t pieces;
};

constexpr std::array<row, all_benchmarks.size()> table_1 = {{{"block", 65536, 16, 1},
                                                             {"gear", 25600, 1600, 1},
                                                             {"hammer", 433152, 518, 210},
                                                             {"cad_part", 658432, 720, 390},
                                                             {"file", 285824, 632, 113},
                                                             {"torus", 128000, 532, 114}}};

const row& row_of(benchmark b) noexcept { return table_1[static_cast<std::size_t>(b)]; }

triangle_mesh make_shape(benchmark b) {
  switch (b) {
    case benchmark::block:
      return make_block();
    case benchmark::gear:
      return make_gear();
    case benchmark::hammer:
      return make_hammer();
    case benchmark::cad_part:
      return make_cad_part();
    case benchmark::file:
      return make_file();
    case benchmark::torus:
      return make_torus();
  }
  return {};
}

}  // namespace

std::string_view to_string(benchmark b) noexcept { return row_of(b).name; }

std::optional<benchmark> parse_benchmark(std::string_view name) noexcept {
  for (const benchmark b : all_benchmarks)
    if (to_string(b) == name) return b;
  return std::nullopt;
}

std::size_t full_triangle_count(benchmark b) noexcept { return row_of(b).full_triangles; }
std::size_t coarse_triangle_count(benchmark b) noexcept { return row_of(b).coarse_triangles; }
std::size_t paper_piece_count(benchmark b) noexcept { return row_of(b).pieces; }

triangle_mesh make_full(benchmark b) {
  triangle_mesh mesh = make_shape(b);
  // A grid instead of a cast to float and back: GCC 12 drops such a pair of casts where it vectorises them.
  for (vec3& p : mesh.positions) p = glm::round(p * 0x1p26) * position_step_m;
  return mesh;
}

std::optional<triangle_mesh> make_coarse(benchmark b) {
  switch (b) {
    case benchmark::block:
      return make_coarse_block();
    case benchmark::gear:
      return make_coarse_gear();
    default:
      return std::nullopt;
  }
}

}  // namespace asperity::models
