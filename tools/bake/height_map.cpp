#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "asperity/bake/map_relief.hpp"
#include "bake/geometry.hpp"
#include "bake/map_lookup.hpp"

namespace asperity::bake {
namespace {

// Compressed images return greys that differ by a step or two between the channels.
constexpr float grey_tolerance = 2.5F / 255.0F;

error bad_height_map(std::string what) { return {error_code::bad_texture, "the height map " + std::move(what)}; }

}  // namespace

double mean_texel_m(const triangle_mesh& mesh, std::uint32_t width, std::uint32_t height) {
  double surface = 0.0;
  double image = 0.0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& uv = mesh.uvs[t];
    const vec2 a = uv[1] - uv[0];
    const vec2 b = uv[2] - uv[0];
    const double pixels = 0.5 * std::abs(a.x * b.y - a.y * b.x) * width * height;
    if (!(pixels > 0.0)) continue;
    image += pixels;
    surface += 0.5 * glm::length(area_normal(corners(mesh.positions, mesh.triangles[t])));
  }
  return image > 0.0 ? std::sqrt(surface / image) : 0.0;
}

result<relief> height_map_relief(const triangle_mesh& mesh, map_image map, const height_map_settings& settings) {
  if (mesh.uvs.size() != mesh.triangles.size() || mesh.triangles.empty())
    return error{error_code::bad_mesh,
                 "the mesh has no texture coordinates, so a map cannot be laid on it; export it with its UVs (OBJ, "
                 "glTF)"};
  const std::size_t pixels = std::size_t{map.width} * map.height;
  if (pixels == 0 || (map.channels != 1 && map.channels != 3) || map.samples.size() != pixels * map.channels)
    return bad_height_map("holds no image of one or three channels; load it again");
  if (!std::isfinite(settings.offset_m) || !std::isfinite(settings.scale_m))
    return error{error_code::invalid_argument, "the heights of black and white have to be finite numbers of metres"};

  const auto height_m = [offset_m = settings.offset_m, scale_m = settings.scale_m](float sample) {
    return offset_m + scale_m * static_cast<double>(sample);
  };
  for (std::size_t i = 0; i < pixels; ++i) {
    if (i % 65536 == 0 && settings.keep_going && !settings.keep_going()) return cancelled_map();
    const float* at = &map.samples[i * map.channels];
    const auto place = [&] { return std::to_string(i % map.width) + ", row " + std::to_string(i / map.width); };
    if (map.channels == 3 && (std::fabs(at[0] - at[1]) > grey_tolerance || std::fabs(at[1] - at[2]) > grey_tolerance))
      return bad_height_map("has colours, at column " + place() +
                            ": a height map is grey; for a normal map use --normal-map");
    if (!std::isfinite(height_m(at[0])))
      return bad_height_map("has a height that is not finite, at column " + place() + "; export it again");
    map.samples[i] = at[0];  // of three channels one is kept, in place
  }
  map.samples.resize(pixels);
  map_lookup<float> grey{map.width, map.height, settings.wrap_u, settings.wrap_v, std::move(map.samples)};
  relief out;
  out.finest_m = mean_texel_m(mesh, map.width, map.height);
  out.reads_uvs = true;
  out.height_m = [shared = std::make_shared<const map_lookup<float>>(std::move(grey)),
                  height_m](const relief_point& p) { return shared->read(p.uv, height_m); };
  return out;
}

}  // namespace asperity::bake
