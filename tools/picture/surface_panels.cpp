#include "picture/surface_panels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "bake/halfedges.hpp"

namespace asperity::picture {
namespace {

constexpr std::uint32_t no_piece = ~0U;
constexpr std::size_t piece_colours = 8;

// Pale, so that edges are seen on them; they differ in lightness too.
colour piece_colour(std::uint32_t number) {
  constexpr std::array<std::array<double, 3>, piece_colours> palette{{{0.80, 0.085, 240.0},
                                                                      {0.84, 0.105, 75.0},
                                                                      {0.72, 0.085, 165.0},
                                                                      {0.78, 0.085, 350.0},
                                                                      {0.90, 0.080, 105.0},
                                                                      {0.68, 0.090, 285.0},
                                                                      {0.90, 0.040, 200.0},
                                                                      {0.70, 0.100, 45.0}}};
  const auto& [lightness, chroma, hue] = palette[number % piece_colours];
  return oklch(lightness, chroma, hue);
}

std::vector<std::uint32_t> piece_of_triangle(const textured_model& model) {
  std::vector<std::uint32_t> of(model.mesh.triangles.size(), no_piece);
  for (std::size_t p = 0; p < model.pieces.size(); ++p) {
    for (const std::uint32_t t : model.pieces[p].triangles) of[t] = static_cast<std::uint32_t>(p);
  }
  return of;
}

bake::connectivity connect(const coarse_mesh& mesh) {
  std::vector<bake::index_triangle> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const coarse_triangle& t : mesh.triangles) triangles.push_back(t.vertex);
  return bake::connect(triangles, mesh.positions.size());
}

// Share of a line of this half width that covers a point this far from its middle, both in pixels.
float ink(double distance, double half_width) {
  return static_cast<float>(std::clamp(half_width + 0.25 - distance, 0.0, 0.5) / 0.5);
}

template <class Shade>
pixmap draw_points(const fine_surface& surface, const view& from, std::size_t width, std::size_t height,
                   const Shade& shade) {
  std::vector<screen_point> on_screen;
  on_screen.reserve(surface.points.size());
  for (const glm::vec3& p : surface.points) on_screen.push_back(from.project(vec3(p)));
  std::vector<colour> colours(surface.points.size());
  for (std::size_t i = 0; i < colours.size(); ++i) {
    colours[i] = shade(i, from.turn(vec3(surface.normals[i])));
  }
  canvas to(width, height);
  for (const fine_patch& patch : surface.patches) {
    for_each_triangle(patch, [&](const std::array<std::size_t, 3>& v) {
      to.triangle({on_screen[v[0]], on_screen[v[1]], on_screen[v[2]]}, [&](const std::array<float, 3>& w) {
        return w[0] * colours[v[0]] + w[1] * colours[v[1]] + w[2] * colours[v[2]];
      });
    });
  }
  return to.finish(paper);
}

}  // namespace

std::vector<std::uint32_t> colour_pieces(const textured_model& model) {
  const std::vector<std::uint32_t> of = piece_of_triangle(model);
  const bake::connectivity net = connect(model.mesh);
  std::vector<std::vector<std::uint32_t>> beside(model.pieces.size());
  for (std::size_t h = 0; h < net.mate.size(); ++h) {
    if (net.mate[h] == bake::no_halfedge) continue;
    const std::uint32_t here = of[h / 3];
    const std::uint32_t there = of[net.mate[h] / 3];
    if (here != there && here != no_piece && there != no_piece) beside[here].push_back(there);
  }
  std::vector<std::uint32_t> number(model.pieces.size(), no_piece);
  for (std::size_t p = 0; p < number.size(); ++p) {
    std::array<std::size_t, piece_colours> taken{};
    for (const std::uint32_t q : beside[p]) {
      if (number[q] != no_piece) ++taken[number[q]];
    }
    // Beginning at another colour each time spreads them over the model.
    std::uint32_t best = static_cast<std::uint32_t>(p % piece_colours);
    for (std::uint32_t k = 0; k < piece_colours; ++k) {
      const auto candidate = static_cast<std::uint32_t>((p + k) % piece_colours);
      if (taken[candidate] < taken[best]) best = candidate;
    }
    number[p] = best;
  }
  return number;
}

pixmap draw_coarse(const textured_model& model, const view& from, std::size_t width, std::size_t height) {
  constexpr double thin = 0.35;
  constexpr double thick = 0.75;
  constexpr colour line{0.020F, 0.022F, 0.030F};
  const std::vector<std::uint32_t> of = piece_of_triangle(model);
  const std::vector<std::uint32_t> number = colour_pieces(model);
  const bake::connectivity net = connect(model.mesh);
  canvas to(width, height);
  for (std::size_t t = 0; t < model.mesh.triangles.size(); ++t) {
    const std::array<vec3, 3> c = corners(model.mesh, t);
    const std::array<screen_point, 3> p{from.project(c[0]), from.project(c[1]), from.project(c[2])};
    const double area = std::fabs(twice_area(p));
    if (area == 0.0) continue;
    std::array<double, 3> reach{};  // of each corner to the edge opposite, pixels
    std::array<double, 3> half_width{};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t a = (k + 1) % 3;
      const std::size_t b = (k + 2) % 3;
      reach[k] = area / std::hypot(p[b].x - p[a].x, p[b].y - p[a].y);
      const std::uint32_t mate = net.mate[3 * t + a];
      half_width[k] = mate != bake::no_halfedge && of[mate / 3] == of[t] ? thin : thick;
    }
    const vec3 n = area_normal(c);
    const float light = brightness(from.turn(n / std::max(glm::length(n), 1e-300)));
    const colour face = light * (of[t] == no_piece ? colour{0.6F, 0.6F, 0.6F} : piece_colour(number[of[t]]));
    to.triangle(p, [&](const std::array<float, 3>& w) {
      float covered = 0.0F;
      for (std::size_t k = 0; k < 3; ++k) {
        const float strength = half_width[k] == thin ? 0.55F : 0.9F;
        covered = std::max(covered, strength * ink(static_cast<double>(w[k]) * reach[k], half_width[k]));
      }
      return mix(face, line, covered);
    });
  }
  return to.finish(paper);
}

pixmap draw_fine(const fine_surface& surface, const view& from, std::size_t width, std::size_t height) {
  const colour clay = oklch(0.86, 0.022, 75.0);
  return draw_points(surface, from, width, height,
                     [&](std::size_t, const vec3& normal) { return brightness(normal) * clay; });
}

pixmap draw_values(const fine_surface& surface, const std::vector<float>& values, const value_range& range,
                   const colour_scale& scale, const view& from, std::size_t width, std::size_t height) {
  return draw_points(surface, from, width, height, [&](std::size_t i, const vec3& normal) {
    const float light = 0.55F + 0.45F * std::min(1.0F, brightness(normal));
    return light * scale.at(range.share(static_cast<double>(values[i])));
  });
}

}  // namespace asperity::picture
