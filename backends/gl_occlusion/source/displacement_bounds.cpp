#include "displacement_bounds.hpp"

#include <algorithm>
#include <cmath>

namespace asperity::gl {

std::vector<displacement_box> displacement_bounds(const textured_model& model, const detail::surface_index& index) {
  // Bilinear interpolation reads the corners of the cell that holds a position: the farthest lies sqrt(2) texels away.
  constexpr double reach_texels = 1.5;
  std::vector<displacement_box> out(model.mesh.triangles.size());
  for (std::size_t t = 0; t < out.size(); ++t) {
    const detail::texel_triangle& place = index.texels[t];
    if (!place.usable) continue;
    const std::array<vec3, 3> c = corners(model.mesh, t);
    const auto [x0, x1] = std::minmax({place.corner[0].x, place.corner[1].x, place.corner[2].x});
    const auto [y0, y1] = std::minmax({place.corner[0].y, place.corner[1].y, place.corner[2].y});
    const auto cut = [](double x, std::uint32_t size) {
      return static_cast<std::uint32_t>(std::clamp(x, 0.0, static_cast<double>(size - 1)));
    };
    const std::uint32_t right = cut(std::ceil(x1) + 1.0, model.texture.width);
    const std::uint32_t top = cut(std::ceil(y1) + 1.0, model.texture.height);
    for (std::uint32_t j = cut(std::floor(y0) - 1.0, model.texture.height); j <= top; ++j) {
      for (std::uint32_t i = cut(std::floor(x0) - 1.0, model.texture.width); i <= right; ++i) {
        const vec3 bary = place.barycentric(vec2(i, j));
        const std::size_t k = place.outermost(bary);
        if (bary[static_cast<int>(k)] * place.altitude[k] < -reach_texels) continue;
        const vec3 fine(model.texture.texels[std::size_t{j} * model.texture.width + i]);
        if (!is_finite(fine)) continue;
        const vec3 leaves = fine - (bary.x * c[0] + bary.y * c[1] + bary.z * c[2]);
        out[t].low = glm::min(out[t].low, leaves);
        out[t].high = glm::max(out[t].high, leaves);
      }
    }
  }
  return out;
}

}  // namespace asperity::gl
