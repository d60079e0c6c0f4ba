// Which nodes of a grid lie inside a fine surface, and how thick the body is: straight lines through the grid.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "asperity/field/coarse_grid.hpp"
#include "field/fine_surface.hpp"
#include "field/threads.hpp"

namespace asperity::detail {

/// Where a line of nodes passes through the surface.
struct line_crossing {
  std::uint32_t line;  ///< its number
  float place;         ///< along it, in units of the pitch
  float n[3];          ///< unit normal of the surface there
  int step;            ///< of the winding number: 1 on the way in
};

/// Crossings of the lines of nodes along x, y and z with a surface.
using axis_crossings = std::array<std::vector<line_crossing>, 3>;

/// Crossings of the lines of a grid with a part of a surface, triangle by triangle.
[[nodiscard]] inline axis_crossings cross_part(std::span<const fine_triangle> surface, const coarse_grid& grid) {
  axis_crossings out;
  const double per_pitch = 1.0 / grid.pitch_m;
  for (const fine_triangle& t : surface) {
    const vec3 p = (t[0] - grid.low) * per_pitch, q = (t[1] - grid.low) * per_pitch, r = (t[2] - grid.low) * per_pitch;
    const vec3 n = glm::cross(q - p, r - p), least = glm::min(p, glm::min(q, r)), most = glm::max(p, glm::max(q, r));
    vec3 low, high;  // of the nodes' numbers
    for (int k = 0; k < 3; ++k) {
      low[k] = std::max(0.0, std::ceil(least[k]));
      high[k] = std::min(static_cast<double>(grid.nodes[static_cast<std::size_t>(k)]) - 1.0, most[k]);
    }
    for (int a = 0; a < 3; ++a) {
      const int b = (a + 1) % 3, c = (a + 2) % 3;
      const double det = n[a], lines = static_cast<double>(grid.nodes[static_cast<std::size_t>(b)]);
      if (low[b] > high[b] || low[c] > high[c] || !(std::fabs(det) > 1e-12)) continue;
      for (double y = low[c]; y <= high[c]; y += 1.0) {
        for (double x = low[b]; x <= high[b]; x += 1.0) {
          const double u = ((x - p[b]) * (r[c] - p[c]) - (r[b] - p[b]) * (y - p[c])) / det;
          const double v = ((q[b] - p[b]) * (y - p[c]) - (x - p[b]) * (q[c] - p[c])) / det;
          if (u < 0.0 || v < 0.0 || u + v > 1.0) continue;
          const vec3 unit = n / std::sqrt(glm::dot(n, n));
          out[static_cast<std::size_t>(a)].push_back(
              {static_cast<std::uint32_t>(y * lines + x),
               static_cast<float>(p[a] + u * (q[a] - p[a]) + v * (r[a] - p[a])),
               {static_cast<float>(unit.x), static_cast<float>(unit.y), static_cast<float>(unit.z)},
               det > 0.0 ? -1 : 1});
        }
      }
    }
  }
  return out;
}

/// Crossings of all lines of a grid, in order along each line. Line c * nodes[b] + b for the axes a, b, c in turn.
[[nodiscard]] inline axis_crossings cross_lines(std::span<const fine_triangle> surface, const coarse_grid& grid,
                                                unsigned threads) {
  const std::size_t parts = parts_for(surface.size(), threads);
  std::vector<axis_crossings> made(parts);
  for_each_task(parts, threads, [&](std::size_t i) {
    const std::size_t begin = part_begin(surface.size(), parts, i), end = part_begin(surface.size(), parts, i + 1);
    made[i] = cross_part(surface.subspan(begin, end - begin), grid);
  });
  axis_crossings out;
  for_each_task(out.size(), threads, [&](std::size_t a) {
    std::vector<std::vector<line_crossing>> lists(parts);
    for (std::size_t i = 0; i < parts; ++i) lists[i] = std::move(made[i][a]);
    out[a] = joined(std::move(lists));
    std::sort(out[a].begin(), out[a].end(), [](const line_crossing& x, const line_crossing& y) {
      return x.line != y.line ? x.line < y.line : x.place < y.place;
    });
  });
  return out;
}

/// Calls visit(crossings of one line) for each line whose crossings cancel. The crossings of a line that passes through
/// a narrow gap at a seam of the atlas, or hits a corner twice, do not cancel: it is left out.
template <class Visit>
void for_each_closed_line(std::span<const line_crossing> all, Visit&& visit) {
  for (std::size_t i = 0; i < all.size();) {
    std::size_t end = i;
    int winding = 0;
    while (end < all.size() && all[end].line == all[i].line) winding += all[end++].step;
    if (winding == 0) visit(all.subspan(i, end - i));
    i = end;
  }
}

/// Of every node: above zero inside, below zero outside, zero where the lines disagree. Each node is asked along three
/// axes, so that a line lost at a seam is outvoted.
/// @param crossings of the grid's lines
[[nodiscard]] inline std::vector<std::int8_t> vote_inside(const axis_crossings& crossings, const coarse_grid& grid) {
  std::vector<std::int8_t> votes(grid.nodes[0] * grid.nodes[1] * grid.nodes[2], -3);
  const std::array<std::size_t, 3> stride{1, grid.nodes[0], grid.nodes[0] * grid.nodes[1]};
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
    const std::vector<line_crossing>& all = crossings[a];
    // Every line votes outside at first: right for one without crossings. One that does not close loses its vote.
    for (std::size_t i = 0; i < all.size();) {
      std::size_t end = i;
      int total = 0;
      while (end < all.size() && all[end].line == all[i].line) total += all[end++].step;
      const std::size_t line = all[i].line, first = line % grid.nodes[b] * stride[b] + line / grid.nodes[b] * stride[c];
      int winding = 0;
      std::size_t next = i;
      for (std::size_t n = 0; n < grid.nodes[a]; ++n) {
        while (next < end && static_cast<double>(all[next].place) < static_cast<double>(n)) winding += all[next++].step;
        const int change = total != 0 ? 1 : (winding > 0 ? 2 : 0);
        std::int8_t& vote = votes[first + n * stride[a]];
        vote = static_cast<std::int8_t>(vote + change);
      }
      i = end;
    }
  }
  return votes;
}

/// Thickness of the body's thinnest parts, m: a fiftieth of the surface has its other side nearer than this. 0 where no
/// two walls face each other.
///
/// Measured along the grid's lines between walls that face away from each other, so that the wedge at a sharp edge,
/// which is thin wherever there is an edge, does not count.
/// @param crossings of the grid's lines
[[nodiscard]] inline double measure_thickness(const axis_crossings& crossings, const coarse_grid& grid) {
  struct way {
    double thickness, weight;
  };
  std::vector<way> ways;
  double total = 0.0;
  for (std::size_t a = 0; a < 3; ++a) {
    for_each_closed_line(crossings[a], [&](std::span<const line_crossing> line) {
      int winding = 0;
      for (std::size_t i = 0; i + 1 < line.size(); ++i) {
        const int before = winding;
        winding += line[i].step;
        const line_crossing &in = line[i], &out = line[i + 1];
        if (before != 0 || winding != 1 || out.step != -1) continue;
        const double across =
            0.5 * (std::fabs(static_cast<double>(in.n[a])) + std::fabs(static_cast<double>(out.n[a])));
        if (across < 0.5) continue;
        const double facing = static_cast<double>(in.n[0] * out.n[0] + in.n[1] * out.n[1] + in.n[2] * out.n[2]);
        total += 1.0 / across;
        if (facing > -0.8) continue;
        ways.push_back({static_cast<double>(out.place - in.place) * across * grid.pitch_m, 1.0 / across});
      }
    });
  }
  std::sort(ways.begin(), ways.end(), [](const way& x, const way& y) { return x.thickness < y.thickness; });
  double sum = 0.0;
  for (const way& w : ways) {
    sum += w.weight;
    if (sum >= 0.02 * total) return w.thickness;
  }
  return 0.0;
}

}  // namespace asperity::detail
