#include "view/shown_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "picture/fine_surface.hpp"
#include "picture/surface_panels.hpp"

namespace asperity::view {
namespace {

// Every machine that this is built for is little endian, and so is every browser.
template <class T>
void append(std::string& to, const T& value) {
  to.append(reinterpret_cast<const char*>(&value), sizeof value);
}

double area_m2(const coarse_mesh& mesh) {
  double twice = 0.0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) twice += glm::length(area_normal(corners(mesh, t)));
  return 0.5 * twice;
}

std::uint16_t share16(double value, double low, double high) {
  const double share = high > low ? (value - low) / (high - low) : 0.0;
  return static_cast<std::uint16_t>(std::lround(65535.0 * std::clamp(share, 0.0, 1.0)));
}

std::int8_t normal8(float x) { return static_cast<std::int8_t>(std::lround(127.0F * std::clamp(x, -1.0F, 1.0F))); }

// Which colour each patch has: that of its piece.
std::vector<std::uint8_t> patch_colours(const textured_model& model) {
  std::vector<std::uint8_t> out(model.mesh.triangles.size(), 0);
  const std::vector<std::uint32_t> of_piece = picture::colour_pieces(model);
  for (std::size_t p = 0; p < model.pieces.size(); ++p) {
    for (const std::uint32_t t : model.pieces[p].triangles) out[t] = static_cast<std::uint8_t>(of_piece[p]);
  }
  return out;
}

// As on the picture of `inspect`: least differences are rounding, and single points far out would leave all others one
// colour.
shown_mesh::distances describe(std::vector<float>& apart, const picture::fine_surface& surface, double diagonal_m) {
  constexpr double rounding = 1e-5, usual = 0.98;
  shown_mesh::distances out;
  double squares = 0.0, area = 0.0;
  for (std::size_t i = 0; i < apart.size(); ++i) {
    const double a = static_cast<double>(surface.areas[i]), d = static_cast<double>(apart[i]);
    squares += a * d * d;
    area += a;
    out.largest_m = std::max(out.largest_m, d);
    if (d < rounding * diagonal_m) apart[i] = 0.0F;
  }
  out.rms_m = area > 0.0 ? std::sqrt(squares / area) : 0.0;
  out.high_m = std::max(picture::quantile(apart, surface.areas, usual), rounding * diagonal_m);
  return out;
}

}  // namespace

shown_mesh show_mesh(const textured_model& model, std::size_t most_points, const triangle_mesh* original) {
  constexpr double coarser = 1.25;
  constexpr int most_tries = 24;
  shown_mesh out;
  picture::fine_surface surface = picture::sample_fine_surface(
      model, out.step_m = std::sqrt(area_m2(model.mesh) / static_cast<double>(most_points)));
  // Each patch rounds up: with many small ones there are more points than the area says.
  for (int i = 0; i < most_tries && surface.points.size() > most_points; ++i) {
    out.step_m *= coarser;
    surface = picture::sample_fine_surface(model, out.step_m);
  }
  out.points = surface.points.size();

  std::array<float, 3> low, high;
  low.fill(std::numeric_limits<float>::max());
  high.fill(std::numeric_limits<float>::lowest());
  for (const glm::vec3& p : surface.points) {
    for (int k = 0; k < 3; ++k) {
      low[static_cast<std::size_t>(k)] = std::min(low[static_cast<std::size_t>(k)], p[k]);
      high[static_cast<std::size_t>(k)] = std::max(high[static_cast<std::size_t>(k)], p[k]);
    }
  }
  // Single texels far out would leave all others one colour.
  constexpr double usual = 0.01;
  out.low_m = std::min(0.0, picture::quantile(surface.heights, surface.areas, usual));
  out.high_m = std::max(0.0, picture::quantile(surface.heights, surface.areas, 1.0 - usual));

  std::vector<float> apart;
  if (original != nullptr) {
    const bake::triangle_bvh tree(original->positions, original->triangles);
    bake::stage_monitor nobody_waits(nullptr);
    if (result<std::vector<float>> measured = picture::distances(surface, tree, 0, nobody_waits)) {
      apart = std::move(measured).value();
      out.errors = describe(apart, surface, model.box.diagonal());
    }
  }

  std::string& to = out.bytes;
  to.reserve(56 + 20 * surface.patches.size() + 12 * model.mesh.positions.size() + 14 * surface.points.size());
  to += "ASPM";
  append(to, static_cast<std::uint32_t>(surface.points.size()));
  append(to, static_cast<std::uint32_t>(surface.patches.size()));
  append(to, static_cast<std::uint32_t>(model.mesh.positions.size()));
  append(to, low);
  append(to, high);
  append(to, static_cast<float>(out.low_m));
  append(to, static_cast<float>(out.high_m));
  append(to, static_cast<float>(out.errors ? out.errors->high_m : -1.0));
  append(to, 0.0F);
  for (const picture::fine_patch& p : surface.patches) {
    append(to, p.columns);
    append(to, p.rows);
    out.triangles += p.columns * (2 * std::size_t{p.rows} - 1);
  }
  for (const vec3& p : model.mesh.positions) {
    for (int k = 0; k < 3; ++k) append(to, static_cast<float>(p[k]));
  }
  for (const coarse_triangle& t : model.mesh.triangles) append(to, t.vertex);
  for (std::size_t i = 0; i < surface.points.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      const auto at = static_cast<std::size_t>(k);
      append(to, share16(static_cast<double>(surface.points[i][k]), static_cast<double>(low[at]),
                         static_cast<double>(high[at])));
    }
    append(to, share16(static_cast<double>(surface.heights[i]), out.low_m, out.high_m));
  }
  const std::vector<std::uint8_t> colour = patch_colours(model);
  for (std::size_t p = 0; p < surface.patches.size(); ++p) {
    const std::size_t end = p + 1 < surface.patches.size() ? surface.patches[p + 1].first : surface.points.size();
    for (std::size_t i = surface.patches[p].first; i < end; ++i) {
      for (int k = 0; k < 3; ++k) append(to, normal8(surface.normals[i][k]));
      append(to, colour[p]);
    }
  }
  for (const float d : apart) append(to, share16(static_cast<double>(d), 0.0, out.errors->high_m));
  return out;
}

}  // namespace asperity::view
