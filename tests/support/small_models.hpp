// Textured models made by formula, small enough to reason about: what tests compare the real bake and the real files
// to.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "asperity/core/float32.hpp"
#include "asperity/core/math.hpp"
#include "asperity/model/textured_model.hpp"

namespace asperity::test_support {

/// Height of the fine surface above the coarse surface point, along its outward normal, metres.
using relief_function = std::function<double(const vec3& point, const vec3& normal)>;

/// Texels between a face's chart and its neighbours; they hold the face's own plane and relief, carried on past its
/// edge.
inline constexpr std::uint32_t box_gutter_texels = 2;

/// Axis-aligned box about the origin with relief. Every face is a chart of its own: a rectangle whose sides lie on
/// texel borders, so on a flat box the texture repeats the coarse surface to float32 rounding. Texels of no face are
/// NaN. Twelve triangles, one convex piece; faces in the order +x -x +y -y +z -z, two triangles each.
/// @pre half_extent > 0 in every axis; texture_size >= 24
inline textured_model make_textured_box(const vec3& half_extent, std::uint32_t texture_size,
                                        const relief_function& relief) {
  textured_model model;
  model.name = "box";
  const vec3 h = round_to_float32(half_extent);
  for (int corner = 0; corner < 8; ++corner) {
    model.mesh.positions.emplace_back((corner & 1) != 0 ? h.x : -h.x, (corner & 2) != 0 ? h.y : -h.y,
                                      (corner & 4) != 0 ? h.z : -h.z);
  }
  model.texture.width = texture_size;
  model.texture.height = texture_size;
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  model.texture.texels.assign(static_cast<std::size_t>(texture_size) * texture_size, glm::vec3(nan));

  // Corners of each face, counter-clockwise from outside; bit 0, 1, 2 of a corner's number is its side in x, y, z.
  constexpr std::array<std::array<std::uint32_t, 4>, 6> faces{
      {{1, 3, 7, 5}, {0, 4, 6, 2}, {2, 6, 7, 3}, {0, 1, 5, 4}, {4, 5, 7, 6}, {0, 2, 3, 1}}};
  const std::uint32_t cell_width = texture_size / 3;
  const std::uint32_t cell_height = texture_size / 2;
  const double size = texture_size;
  for (std::uint32_t f = 0; f < 6; ++f) {
    const auto& c = faces[f];
    const std::uint32_t left = (f % 3) * cell_width;
    const std::uint32_t low = (f / 3) * cell_height;
    const std::uint32_t chart_width = cell_width - 2 * box_gutter_texels;
    const std::uint32_t chart_height = cell_height - 2 * box_gutter_texels;
    const auto uv_at = [&](std::uint32_t i, std::uint32_t j) {
      return round_to_float32(vec2((left + box_gutter_texels + i) / size, (low + box_gutter_texels + j) / size));
    };
    const std::array<vec2, 4> uv{uv_at(0, 0), uv_at(chart_width, 0), uv_at(chart_width, chart_height),
                                 uv_at(0, chart_height)};
    model.mesh.triangles.push_back({{c[0], c[1], c[2]}, {uv[0], uv[1], uv[2]}});
    model.mesh.triangles.push_back({{c[0], c[2], c[3]}, {uv[0], uv[2], uv[3]}});

    const vec3 origin = model.mesh.positions[c[0]];
    const vec3 along_u = model.mesh.positions[c[1]] - origin;
    const vec3 along_v = model.mesh.positions[c[3]] - origin;
    const vec3 normal = glm::normalize(glm::cross(along_u, along_v));
    for (std::uint32_t j = 0; j < cell_height; ++j) {
      for (std::uint32_t i = 0; i < cell_width; ++i) {
        const double s = (i + 0.5 - box_gutter_texels) / chart_width;
        const double t = (j + 0.5 - box_gutter_texels) / chart_height;
        const vec3 point = origin + s * along_u + t * along_v;
        model.texture.texels[static_cast<std::size_t>(low + j) * texture_size + left + i] =
            glm::vec3(point + relief(point, normal) * normal);
      }
    }
  }

  convex_piece piece;
  piece.vertices = model.mesh.positions;
  for (std::uint32_t t = 0; t < 12; ++t) {
    piece.hull.push_back(model.mesh.triangles[t].vertex);
    piece.triangles.push_back(t);
  }
  model.pieces.push_back(piece);
  model.mass = compute_mass_properties(model.mesh);
  model.box = {-h, h};
  model.report.full_triangles = 12;
  model.report.texels = std::size_t{6} * cell_width * cell_height;
  return model;
}

/// The same box, smooth.
inline textured_model make_flat_box(const vec3& half_extent, std::uint32_t texture_size = 64) {
  return make_textured_box(half_extent, texture_size, [](const vec3&, const vec3&) { return 0.0; });
}

/// Relief of ridges across the world x axis: amplitude * sin(2 pi x / wavelength), on every face.
inline relief_function ridges(double amplitude_m, double wavelength_m) {
  return [=](const vec3& point, const vec3&) {
    return amplitude_m * std::sin(2.0 * 3.14159265358979323846 * point.x / wavelength_m);
  };
}

}  // namespace asperity::test_support
