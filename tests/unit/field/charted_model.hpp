// Textured models from any closed mesh: a chart for every triangle, and a fine surface by formula.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "asperity/core/float32.hpp"
#include "asperity/model/textured_model.hpp"

namespace asperity::test_support {

/// Fine surface point of a coarse one.
using fine_function = std::function<vec3(const vec3& coarse_b)>;

/// A mesh by its vertices and triangles, counter-clockwise seen from outside.
struct plain_mesh {
  std::vector<vec3> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Gives every triangle a chart: half a square of texels, gutters of two texels filled by going on in its plane.
/// @pre texture_size / ceil(sqrt(triangles)) >= 8
[[nodiscard]] inline textured_model make_charted_model(const plain_mesh& mesh, std::uint32_t texture_size,
                                                       const fine_function& fine) {
  textured_model out;
  out.name = "charted";
  for (const vec3& p : mesh.positions) out.mesh.positions.push_back(round_to_float32(p));
  out.texture.width = out.texture.height = texture_size;
  out.texture.texels.assign(std::size_t{texture_size} * texture_size,
                            glm::vec3(std::numeric_limits<float>::quiet_NaN()));
  const auto across = static_cast<std::uint32_t>(std::ceil(std::sqrt(static_cast<double>(mesh.triangles.size()))));
  const std::uint32_t cell = texture_size / across;
  const double gutter = 2.0, side = cell - 5.5, size = texture_size;  // the slanted side needs its gutter too
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::uint32_t left = t % across * cell, low = t / across * cell;
    coarse_triangle triangle;
    triangle.vertex = mesh.triangles[t];
    triangle.uv = {vec2(left + gutter, low + gutter) / size, vec2(left + gutter + side, low + gutter) / size,
                   vec2(left + gutter, low + gutter + side) / size};
    for (vec2& uv : triangle.uv) uv = round_to_float32(uv);
    out.mesh.triangles.push_back(triangle);
    const auto c = corners(out.mesh, t);
    for (std::uint32_t j = 0; j < cell; ++j) {
      for (std::uint32_t i = 0; i < cell; ++i) {
        const double u = (i + 0.5 - gutter) / side, v = (j + 0.5 - gutter) / side;
        out.texture.texels[std::size_t{low + j} * texture_size + left + i] =
            glm::vec3(fine((1.0 - u - v) * c[0] + u * c[1] + v * c[2]));
      }
    }
  }
  out.box = {out.mesh.positions[0], out.mesh.positions[0]};
  for (const vec3& p : out.mesh.positions) {
    out.box.low = glm::min(out.box.low, p);
    out.box.high = glm::max(out.box.high, p);
  }
  out.mass = compute_mass_properties(out.mesh);
  return out;
}

/// A ball of triangles: an icosahedron cut `times` times, its vertices on the sphere.
[[nodiscard]] inline plain_mesh make_icosphere(double radius_m, int times) {
  const double g = std::numbers::phi;
  plain_mesh m;
  m.positions = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                 {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  m.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                 {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                 {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int n = 0; n < times; ++n) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middle;
    const auto between = [&](std::uint32_t a, std::uint32_t b) {
      const auto [it, fresh] =
          middle.try_emplace({std::min(a, b), std::max(a, b)}, static_cast<std::uint32_t>(m.positions.size()));
      if (fresh) m.positions.push_back(m.positions[a] + m.positions[b]);
      return it->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& t : m.triangles) {
      const std::uint32_t a = between(t[0], t[1]), b = between(t[1], t[2]), c = between(t[2], t[0]);
      finer.insert(finer.end(), {{t[0], a, c}, {a, t[1], b}, {c, b, t[2]}, {a, b, c}});
    }
    m.triangles = finer;
    for (vec3& p : m.positions) p = glm::normalize(p);
  }
  for (vec3& p : m.positions) p = radius_m * glm::normalize(p);
  return m;
}

/// A body turned about z: a closed outline of (radius, z), anticlockwise in the (radius, z) plane; radius 0 at both of
/// its ends.
[[nodiscard]] inline plain_mesh turn_outline(const std::vector<vec2>& outline, std::uint32_t sides) {
  plain_mesh m;
  const auto count = static_cast<std::uint32_t>(outline.size());
  std::vector<std::uint32_t> first(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    first[i] = static_cast<std::uint32_t>(m.positions.size());
    const bool tip = i == 0 || i + 1 == count;
    for (std::uint32_t s = 0; s < (tip ? 1 : sides); ++s) {
      const double angle = 2.0 * std::numbers::pi * s / sides;
      m.positions.emplace_back(outline[i].x * std::cos(angle), outline[i].x * std::sin(angle), outline[i].y);
    }
  }
  for (std::uint32_t i = 0; i + 1 < count; ++i) {
    for (std::uint32_t s = 0; s < sides; ++s) {
      const std::uint32_t next = (s + 1) % sides;
      const std::uint32_t a = i == 0 ? first[0] : first[i] + s, b = i == 0 ? first[0] : first[i] + next;
      const std::uint32_t c = i + 2 == count ? first[i + 1] : first[i + 1] + s;
      const std::uint32_t d = i + 2 == count ? first[i + 1] : first[i + 1] + next;
      if (a != b) m.triangles.push_back({a, b, c});
      if (c != d) m.triangles.push_back({b, d, c});
    }
  }
  return m;
}

}  // namespace asperity::test_support
