// The fine surface of a textured model in pieces of a chosen size: coarse triangles, cut up and moved by the texture.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "asperity/model/textured_model.hpp"
#include "field/threads.hpp"

namespace asperity::detail {

/// A piece of the fine surface, body frame, counter-clockwise seen from outside.
using fine_triangle = std::array<vec3, 3>;

/// The texture's point for a coarse surface point; that point itself where the texture has none.
[[nodiscard]] inline vec3 fine_point(const haptic_texture& texture, const vec2& uv, const vec3& coarse_b) {
  const vec3 p = texture.sample(uv);
  return is_finite(p) ? p : coarse_b;
}

/// Coarse triangles from one to before another.
struct triangle_range {
  std::size_t begin = 0, end = 0;
};

/// Does for some of the coarse triangles what cut_fine_surface() does for all.
[[nodiscard]] inline std::vector<fine_triangle> cut_triangles(const textured_model& model, const triangle_range& which,
                                                              double edge_m) {
  struct corner {
    vec3 p;
    vec2 uv;
    vec3 fine;  // read once and handed on: most corners belong to several pieces
  };
  using part = std::array<corner, 3>;
  const auto corner_at = [&](const vec3& p, const vec2& uv) { return corner{p, uv, fine_point(model.texture, uv, p)}; };
  std::vector<fine_triangle> out;
  std::vector<part> waiting;
  for (std::size_t t = which.begin; t < which.end; ++t) {
    const auto whole = corners(model.mesh, t);
    const auto& uv = model.mesh.triangles[t].uv;
    waiting.push_back({corner_at(whole[0], uv[0]), corner_at(whole[1], uv[1]), corner_at(whole[2], uv[2])});
    while (!waiting.empty()) {
      const part c = waiting.back();
      waiting.pop_back();
      std::array<bool, 3> cut{};
      std::array<corner, 3> m;
      std::size_t cuts = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const corner &from = c[k], &to = c[(k + 1) % 3];
        const vec3 e = to.p - from.p;
        cut[k] = glm::dot(e, e) > edge_m * edge_m;
        if (!cut[k]) continue;
        ++cuts;
        m[k] = corner_at(0.5 * (from.p + to.p), 0.5 * (from.uv + to.uv));
      }
      if (cuts == 0) {
        out.push_back({c[0].fine, c[1].fine, c[2].fine});
      } else if (cuts == 3) {
        for (std::size_t k = 0; k < 3; ++k) waiting.push_back({c[k], m[k], m[(k + 2) % 3]});
        waiting.push_back(m);
      } else {
        // One long edge: two halves. Two: the corner between them, and the rest halved across.
        std::size_t k = 0;
        while (!cut[k] || (cuts == 2 && !cut[(k + 1) % 3])) ++k;
        const std::size_t a = (k + 1) % 3, b = (k + 2) % 3;
        if (cuts == 1) {
          waiting.push_back({c[k], m[k], c[b]});
          waiting.push_back({m[k], c[a], c[b]});
        } else {
          waiting.push_back({m[k], c[a], m[a]});
          waiting.push_back({c[k], m[k], m[a]});
          waiting.push_back({c[k], m[a], c[b]});
        }
      }
    }
  }
  return out;
}

/// Cuts the coarse triangles until no edge is longer than `edge_m`, then moves every corner onto the fine surface.
///
/// Edges alone decide where to cut, so two neighbours cut their common edge in the same place, and only the texture's
/// own seams leave gaps. A sliver is cut along its length only.
[[nodiscard]] inline std::vector<fine_triangle> cut_fine_surface(const textured_model& model, double edge_m,
                                                                 unsigned threads = 1) {
  const std::size_t count = model.mesh.triangles.size(), parts = parts_for(count, threads);
  std::vector<std::vector<fine_triangle>> made(parts);
  for_each_task(parts, threads, [&](std::size_t i) {
    made[i] = cut_triangles(model, {part_begin(count, parts, i), part_begin(count, parts, i + 1)}, edge_m);
  });
  return joined(std::move(made));
}

/// Calls visit(point) for points of the fine surface about `step_m` apart, spread evenly over coarse triangles.
template <class Visit>
void for_each_fine_point(const textured_model& model, const triangle_range& which, double step_m, Visit&& visit) {
  for (std::size_t t = which.begin; t < which.end; ++t) {
    const auto c = corners(model.mesh, t);
    const auto& uv = model.mesh.triangles[t].uv;
    // Rows along the longest edge: a sliver gets one row, not thousands.
    std::size_t k = 0;
    double longest = -1.0;
    for (std::size_t e = 0; e < 3; ++e) {
      const vec3 d = c[(e + 1) % 3] - c[e];
      if (glm::dot(d, d) > longest) {
        longest = glm::dot(d, d);
        k = e;
      }
    }
    longest = std::sqrt(longest);
    const vec3 n = area_normal(c);
    const double altitude = longest > 0.0 ? std::sqrt(glm::dot(n, n)) / longest : 0.0;
    const std::size_t a = k, b = (k + 1) % 3, top = (k + 2) % 3;
    const auto rows = static_cast<std::size_t>(std::max(1.0, std::ceil(altitude / step_m)));
    const auto show = [&](double u, double v) {
      const vec2 at = (1.0 - u - v) * uv[a] + u * uv[b] + v * uv[top];
      visit(fine_point(model.texture, at, (1.0 - u - v) * c[a] + u * c[b] + v * c[top]));
    };
    for (std::size_t r = 0; r < rows; ++r) {
      const double v = (static_cast<double>(r) + 0.5) / static_cast<double>(rows);
      const auto columns = static_cast<std::size_t>(std::max(1.0, std::ceil((1.0 - v) * longest / step_m)));
      for (std::size_t i = 0; i < columns; ++i) {
        show((1.0 - v) * (static_cast<double>(i) + 0.5) / static_cast<double>(columns), v);
      }
    }
    // Rows end short of a needle's points by half a row, along the needle.
    const double step = longest > 0.0 ? step_m / longest : 1.0, half_row = 0.5 / static_cast<double>(rows);
    const double from_a = half_row * glm::length(c[top] - c[a]) / std::max(longest, 1e-30);
    const double from_b = half_row * glm::length(c[top] - c[b]) / std::max(longest, 1e-30);
    for (double u = 0.5 * step; from_a > step && u < from_a; u += step) show(u, 0.0);
    for (double u = 0.5 * step; from_b > step && u < from_b; u += step) show(1.0 - u, 0.0);
  }
}

}  // namespace asperity::detail
