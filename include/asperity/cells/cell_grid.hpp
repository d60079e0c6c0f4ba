// The plane grid of one relief map, and the two operations on it that everything else is made of.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "asperity/cells/surface_cells.hpp"

namespace asperity::detail {

/// Nodes of a cell's map while it is made. Values are arrays of columns * rows, row-major.
struct cell_grid {
  const surface_cell* cell;

  [[nodiscard]] std::size_t size() const noexcept { return std::size_t{cell->columns} * cell->rows; }
  [[nodiscard]] vec2 position(std::size_t i) const noexcept {
    const std::size_t column = i % cell->columns, row = i / cell->columns;
    return cell->low + cell->pitch_m * vec2(static_cast<double>(column), static_cast<double>(row));
  }
  /// Body point in units of the grid: x and y in nodes, z in metres.
  [[nodiscard]] vec3 to_grid(const vec3& p_b) const noexcept {
    const vec3 c = cell->to_cell(p_b);
    return {(c.x - cell->low.x) / cell->pitch_m, (c.y - cell->low.y) / cell->pitch_m, c.z};
  }

  /// Calls put(node, height) for every node under a triangle given in units of the grid.
  template <class Put>
  void fill(const vec3& a, const vec3& b, const vec3& c, Put&& put) const {
    const double det = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
    if (!(std::fabs(det) > 1e-12)) return;
    constexpr double slack = 1e-9;  // nodes on a shared edge belong to both triangles rather than to none
    // Clamped before the conversion: a texel outside of all charts may lie anywhere.
    const auto first = [](double x, std::uint32_t n) {
      return static_cast<std::int64_t>(std::ceil(std::clamp<double>(x - slack, 0.0, n)));
    };
    const auto last = [](double x, std::uint32_t n) {
      return static_cast<std::int64_t>(std::floor(std::clamp(x + slack, -1.0, n - 1.0)));
    };
    const std::int64_t i1 = last(std::max({a.x, b.x, c.x}), cell->columns);
    const std::int64_t j1 = last(std::max({a.y, b.y, c.y}), cell->rows);
    for (std::int64_t j = first(std::min({a.y, b.y, c.y}), cell->rows); j <= j1; ++j) {
      for (std::int64_t i = first(std::min({a.x, b.x, c.x}), cell->columns); i <= i1; ++i) {
        const double x = static_cast<double>(i) - a.x, y = static_cast<double>(j) - a.y;
        const double s = (x * (c.y - a.y) - (c.x - a.x) * y) / det;
        const double t = ((b.x - a.x) * y - x * (b.y - a.y)) / det;
        if (s < -slack || t < -slack || s + t > 1.0 + slack) continue;
        put(static_cast<std::size_t>(j) * cell->columns + static_cast<std::size_t>(i),
            a.z + s * (b.z - a.z) + t * (c.z - a.z));
      }
    }
  }

  /// Lowers or raises every node until no step to a neighbour exceeds `slope`, by two sweeps of a chamfer.
  /// @param sign +1: the largest field below `f` with that slope; -1: the smallest above
  void limit_slope(std::vector<float>& f, double slope, float sign) const {
    const auto straight = static_cast<float>(slope * cell->pitch_m);
    const float diagonal = straight * 1.41421356F;
    const std::size_t nx = cell->columns, ny = cell->rows;
    const auto pulled = [sign](float own, float other, float step) {
      return sign * std::min(sign * own, sign * other + step);
    };
    // From the row before, all nodes of a row alike; along a row each node waits for the one before it.
    const auto from_row = [&](float* row, const float* before) {
      for (std::size_t i = 0; i < nx; ++i) row[i] = pulled(row[i], before[i], straight);
      for (std::size_t i = 1; i < nx; ++i) row[i] = pulled(row[i], before[i - 1], diagonal);
      for (std::size_t i = 0; i + 1 < nx; ++i) row[i] = pulled(row[i], before[i + 1], diagonal);
    };
    for (std::size_t j = 0; j < ny; ++j) {
      float* const row = f.data() + j * nx;
      if (j > 0) from_row(row, row - nx);
      for (std::size_t i = 1; i < nx; ++i) row[i] = pulled(row[i], row[i - 1], straight);
    }
    for (std::size_t j = ny; j-- > 0;) {
      float* const row = f.data() + j * nx;
      if (j + 1 < ny) from_row(row, row + nx);
      for (std::size_t i = nx; i-- > 1;) row[i - 1] = pulled(row[i - 1], row[i], straight);
    }
  }

  /// Euclidean distance, m, from every node to the nearest node of a set; `far` where the set is empty.
  /// @source Felzenszwalb and Huttenlocher, "Distance Transforms of Sampled Functions" (2012): lower envelope of
  /// parabolas, one dimension after the other
  [[nodiscard]] std::vector<float> distance_to(const std::vector<char>& set, double far) const {
    const std::size_t nx = cell->columns, ny = cell->rows;
    constexpr double infinite = 1e20;
    std::vector<double> d(size());
    for (std::size_t i = 0; i < d.size(); ++i) d[i] = set[i] != 0 ? 0.0 : infinite;
    const std::size_t longest = std::max(nx, ny);
    std::vector<double> line(longest), bound(longest + 1);
    std::vector<std::size_t> apex(longest);
    const auto pass = [&](std::size_t start, std::size_t step, std::size_t n) {
      for (std::size_t i = 0; i < n; ++i) line[i] = d[start + i * step];
      const auto meet = [&](std::size_t p, std::size_t q) {  // where parabola q overtakes parabola p
        const auto x = static_cast<double>(p), y = static_cast<double>(q);
        return ((line[q] + y * y) - (line[p] + x * x)) / (2.0 * (y - x));
      };
      std::size_t k = 0;
      apex[0] = 0;
      bound[0] = -infinite;
      bound[1] = infinite;
      for (std::size_t q = 1; q < n; ++q) {
        double s = meet(apex[k], q);
        while (k > 0 && s <= bound[k]) s = meet(apex[--k], q);
        if (s > bound[k]) ++k;
        apex[k] = q;
        bound[k] = s;
        bound[k + 1] = infinite;
      }
      for (std::size_t q = 0, at = 0; q < n; ++q) {
        while (bound[at + 1] < static_cast<double>(q)) ++at;
        const double x = static_cast<double>(q) - static_cast<double>(apex[at]);
        d[start + q * step] = x * x + line[apex[at]];
      }
    };
    for (std::size_t i = 0; i < nx; ++i) pass(i, nx, ny);
    for (std::size_t j = 0; j < ny; ++j) pass(j * nx, 1, nx);
    std::vector<float> out(size());
    for (std::size_t i = 0; i < out.size(); ++i) {
      out[i] = static_cast<float>(d[i] < infinite ? std::min(far, cell->pitch_m * std::sqrt(d[i])) : far);
    }
    return out;
  }

  /// Mean over 3 x 3 nodes, `passes` times; the border repeats.
  void blur(std::vector<float>& f, int passes) const {
    const std::size_t nx = cell->columns, ny = cell->rows;
    std::vector<float> t(f.size());
    const auto smear = [](const std::vector<float>& from, std::vector<float>& to, std::size_t start, std::size_t step,
                          std::size_t n) {
      for (std::size_t i = 0; i < n; ++i) {
        const std::size_t a = i > 0 ? i - 1 : i, b = i + 1 < n ? i + 1 : i;
        to[start + i * step] = (from[start + a * step] + from[start + i * step] + from[start + b * step]) / 3.0F;
      }
    };
    for (int p = 0; p < passes; ++p) {
      for (std::size_t j = 0; j < ny; ++j) smear(f, t, j * nx, 1, nx);
      for (std::size_t i = 0; i < nx; ++i) smear(t, f, i, nx, ny);
    }
  }
};

}  // namespace asperity::detail
