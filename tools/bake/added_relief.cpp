#include "bake/added_relief.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <vector>

#include "bake/cage.hpp"
#include "bake/geometry.hpp"
#include "bake/halfedges.hpp"
#include "bake/refine.hpp"
#include "bake/surface_points.hpp"

namespace asperity::bake {
namespace {

constexpr std::size_t relief_samples = 65536;
constexpr double finest_per_texel = 1.5;  // texels up to this many times a relief's detail are not worth a word
constexpr double reference_edge_texels = 1.4;
constexpr std::size_t most_reference_triangles = 1'000'000;

}  // namespace

double added_relief::at(std::uint32_t t, const vec3& p) const {
  const auto c = corners(original.positions, original.triangles[t]);
  const vec3 up = area_normal(c);
  const double whole = glm::dot(up, up);
  const double b1 = std::clamp(glm::dot(up, glm::cross(p - c[0], c[2] - c[0])) / whole, 0.0, 1.0);
  const double b2 = std::clamp(glm::dot(up, glm::cross(c[1] - c[0], p - c[0])) / whole, 0.0, 1.0 - b1);
  return heights.height_m({p, glm::normalize(up), t, uv_on(original, t, {1.0 - b1 - b2, b1, b2})});
}

result<void> check_relief(const added_relief& added, double diagonal_m) {
  if (!added.heights) return {};
  if (added.heights.reads_uvs && added.original.uvs.empty())
    return error{error_code::bad_mesh,
                 "the mesh has no texture coordinates, so the relief's map cannot be laid on it; export it with its "
                 "UVs (OBJ, glTF)"};
  double highest = 0.0;
  for (const relief_point& p : spread_points(added.original, relief_samples)) {
    const double h = std::abs(added.at(p.triangle, p.position));
    if (!std::isfinite(h))
      return error{error_code::bad_texture, "the relief has a height that is not finite; mend its source"};
    highest = std::max(highest, h);
  }
  if (highest <= widest_cage_in_diagonals * diagonal_m) return {};
  std::ostringstream text;
  text << "the relief reaches " << highest << " m, more than " << 100.0 * widest_cage_in_diagonals
       << " % of the mesh's diagonal of " << diagonal_m << " m: its heights or the mesh are not in metres, or it "
       << "describes a shape, which belongs into the mesh";
  return error{error_code::bad_texture, text.str()};
}

std::string too_coarse_remark(const relief& heights, double texel_m, std::uint32_t texture_size) {
  const double finest_m = heights.finest_m;
  if (!heights || !(finest_m > 0.0) || texel_m <= finest_m * finest_per_texel) return {};
  std::ostringstream text;
  text << "the haptic texture has texels of " << texel_m << " m, too coarse for a relief whose detail is " << finest_m
       << " m: what is finer is lost or distorted; ask for about "
       << static_cast<std::uint64_t>(std::ceil(texture_size * texel_m / finest_m)) << " texels per side";
  return text.str();
}

triangle_mesh raise(const added_relief& added, double texel_m, stage_monitor& monitor) {
  const refined_mesh fine =
      refine(added.original, reference_edge_texels * texel_m, most_reference_triangles, [&] { return monitor.ask(); });
  triangle_mesh raised;
  raised.triangles.reserve(fine.triangles.size());
  // A vertex stands once for each triangle of the original that it belongs to; the parts of one follow one another.
  std::vector<std::uint32_t> number(fine.positions.size(), no_halfedge);
  std::vector<std::uint32_t> number_is_of(fine.positions.size(), no_halfedge);
  for (std::size_t t = 0; t < fine.triangles.size(); ++t) {
    if (t % 4096 == 0 && !monitor.ask()) return {};
    const std::uint32_t source = fine.source[t];
    const vec3 n = unit_normal(corners(added.original.positions, added.original.triangles[source]));
    index_triangle corner_numbers{};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = fine.triangles[t][k];
      if (number_is_of[v] != source) {
        number_is_of[v] = source;
        number[v] = static_cast<std::uint32_t>(raised.positions.size());
        raised.positions.push_back(fine.positions[v] + added.at(source, fine.positions[v]) * n);
      }
      corner_numbers[k] = number[v];
    }
    raised.triangles.push_back(corner_numbers);
  }
  return raised;
}

}  // namespace asperity::bake
