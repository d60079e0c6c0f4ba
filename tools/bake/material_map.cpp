#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "asperity/bake/map_materials.hpp"
#include "bake/geometry.hpp"
#include "bake/map_lookup.hpp"
#include "bake/parallel.hpp"
#include "bake/triangle_bvh.hpp"

namespace asperity::bake {
namespace {

result<void> check_colours(std::span<const material_colour> colours) {
  const auto bad = [](std::string what) { return error{error_code::invalid_argument, std::move(what)}; };
  if (colours.size() < 2 || colours.size() > most_materials) {
    return bad("a map of materials needs 2 to " + std::to_string(most_materials) + " colours, and " +
               std::to_string(colours.size()) + " are listed");
  }
  for (std::size_t i = 0; i < colours.size(); ++i) {
    if (const result<void> ok = check(colours[i].is); !ok) return ok;
    for (std::size_t j = 0; j < i; ++j) {
      if (colours[i].rgb == colours[j].rgb) return bad("a colour of the map of materials is listed twice");
    }
  }
  return {};
}

/// Largest difference of a pixel from a colour in any channel, of 1.
double difference(const map_image& image, std::size_t pixel, const std::array<std::uint8_t, 3>& rgb) noexcept {
  double most = 0.0;
  for (std::size_t c = 0; c < 3; ++c) {
    const double is = static_cast<double>(image.samples[pixel * image.channels + (image.channels == 3 ? c : 0)]);
    most = std::max(most, std::fabs(is - rgb[c] / 255.0));
  }
  return most;
}

/// The last pixel of a map and not the first of the next tile, where the map ends with the mesh.
double within_map(double x) noexcept { return x >= 1.0 && x < 1.0 + 1e-6 ? 1.0 - 1e-6 : x; }

vec2 uv_at(const triangle_mesh& mesh, std::uint32_t t, const vec3& p) noexcept {
  const auto c = corners(mesh.positions, mesh.triangles[t]);
  const vec3 n = area_normal(c);
  const double square = glm::dot(n, n);
  if (!(square > 0.0)) return mesh.uvs[t][0];
  const double b1 = glm::dot(glm::cross(p - c[0], c[2] - c[0]), n) / square;
  const double b2 = glm::dot(glm::cross(c[1] - c[0], p - c[0]), n) / square;
  return mixed(mesh.uvs[t], {1.0 - b1 - b2, b1, b2});
}

}  // namespace

result<laid_materials> lay_materials(const textured_model& model, const triangle_mesh& full, const map_image& image,
                                     std::span<const material_colour> colours, const material_map_settings& settings) {
  if (full.uvs.size() != full.triangles.size() || full.triangles.empty()) {
    return error{error_code::bad_mesh,
                 "the mesh has no texture coordinates, so a map of materials cannot be laid on it; export it with its "
                 "UVs (OBJ, glTF)"};
  }
  const std::size_t pixels = std::size_t{image.width} * image.height;
  if (pixels == 0 || (image.channels != 1 && image.channels != 3) || image.samples.size() != pixels * image.channels) {
    return error{error_code::bad_texture,
                 "the map of materials holds no image of one or three channels; load it again"};
  }
  if (const result<void> ok = check_colours(colours); !ok) return ok.error();

  // Of each pixel once.
  std::vector<std::uint8_t> number(pixels), far(pixels);
  for (std::size_t i = 0; i < pixels; ++i) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t m = 0; m < colours.size(); ++m) {
      const double d = difference(image, i, colours[m].rgb);
      if (!(d < least)) continue;
      least = d;
      number[i] = static_cast<std::uint8_t>(m);
    }
    far[i] = least > 0.1 ? 1 : 0;
  }

  stage_monitor monitor([&](std::string_view, double) { return !settings.keep_going || settings.keep_going(); });
  const unsigned threads = resolve_threads(settings.threads);
  const triangle_bvh tree(full.positions, full.triangles, threads, &monitor);
  if (monitor.cancelled()) return cancelled_map();
  laid_materials out{.surface = colours[0].is, .map = {}};
  for (const material_colour& c : colours.subspan(1)) out.map.others.push_back(c.is);
  out.map.texels.assign(model.texture.texels.size(), 0);
  std::atomic<std::size_t> used{0}, used_far{0};
  const auto lay = [&](std::size_t, std::size_t begin, std::size_t end) {
    std::size_t mine = 0, mine_far = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const vec3 p(model.texture.texels[i]);
      if (!is_finite(p)) continue;
      const triangle_bvh::nearest at = tree.closest(p);
      const vec2 uv = uv_at(full, at.triangle, at.point);
      const std::size_t column = wrapped(std::floor(within_map(uv.x) * image.width), image.width, settings.wrap_u);
      const std::size_t row = wrapped(std::floor(within_map(uv.y) * image.height), image.height, settings.wrap_v);
      const std::size_t pixel = row * image.width + column;
      out.map.texels[i] = number[pixel];
      ++mine;
      mine_far += far[pixel];
    }
    used += mine;
    used_far += mine_far;
  };
  if (!parallel_blocks(out.map.texels.size(), threads, monitor, 0.0, 1.0, lay)) return cancelled_map();
  if (used > 0) out.far_share = static_cast<double>(used_far) / static_cast<double>(used);
  return out;
}

}  // namespace asperity::bake
