#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include "asperity/model/textured_model.hpp"
#include "model/surface_index.hpp"

namespace asperity {

result<void> check_materials(const textured_model& model) {
  if (model.surface) {
    if (const result<void> ok = check(*model.surface); !ok) return ok;
  }
  const material_map& map = model.surface_map;
  const auto bad = [](std::string what) { return error{error_code::bad_texture, "the map of materials " + what}; };
  if (map.empty()) {
    return map.texels.empty() ? result<void>{} : bad("names no material; list at least one besides the first");
  }
  if (!model.surface) return bad("has no first material, which is what holds where the map is 0; set `surface`");
  if (material_count(model) > most_materials) {
    return bad("lists " + std::to_string(material_count(model)) + " materials with the first, more than the " +
               std::to_string(most_materials) + " that a body can have");
  }
  for (const material& m : map.others) {
    if (const result<void> ok = check(m); !ok) return ok;
  }
  if (map.texels.size() != model.texture.texels.size()) {
    return bad("has " + std::to_string(map.texels.size()) + " texels and the haptic texture " +
               std::to_string(model.texture.texels.size()) + "; they must be as many");
  }
  const auto beyond =
      std::find_if(map.texels.begin(), map.texels.end(), [&](std::uint8_t i) { return i >= material_count(model); });
  if (beyond == map.texels.end()) return {};
  const auto at = static_cast<std::size_t>(beyond - map.texels.begin());
  return bad("names material " + std::to_string(*beyond) + " of " + std::to_string(material_count(model)) +
             " in column " + std::to_string(at % model.texture.width) + ", row " +
             std::to_string(at / model.texture.width));
}

std::vector<double> material_shares(const textured_model& model) {
  std::vector<double> out(material_count(model), 0.0);
  if (model.surface_map.empty()) return {1.0};
  const detail::surface_index index(model);
  const double last_column = model.texture.width - 1.0, last_row = model.texture.height - 1.0;
  double whole = 0.0;
  for (std::size_t t = 0; t < model.mesh.triangles.size(); ++t) {
    const vec3 doubled = area_normal(corners(model.mesh, t));
    const double area = 0.5 * std::sqrt(glm::dot(doubled, doubled));
    const auto& c = index.texels[t].corner;
    // The R2 sequence, folded into the triangle: even coverage. A point stands for a hundredth of a percent at most.
    const auto points = static_cast<int>(64 + 20'000 / model.mesh.triangles.size());
    for (int i = 0; i < points; ++i) {
      double a = std::fmod(0.5 + 0.7548776662466927 * i, 1.0), b = std::fmod(0.5 + 0.5698402909980532 * i, 1.0);
      if (a + b > 1.0) {
        a = 1.0 - a;
        b = 1.0 - b;
      }
      const vec2 z = (1.0 - a - b) * c[0] + a * c[1] + b * c[2];
      const auto column = static_cast<std::size_t>(std::clamp(std::round(z.x), 0.0, last_column));
      const auto row = static_cast<std::size_t>(std::clamp(std::round(z.y), 0.0, last_row));
      out[model.surface_map.texels[row * model.texture.width + column]] += area / points;
    }
    whole += area;
  }
  for (double& share : out) share /= whole;
  return out;
}

}  // namespace asperity
