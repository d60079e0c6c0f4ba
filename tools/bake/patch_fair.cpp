#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <tuple>

#include "bake/geometry.hpp"
#include "bake/hole_patch.hpp"

namespace asperity::bake {
namespace {

constexpr double least_weight = 1e-3;  // of an edge: two obtuse angles across from it would push its ends apart

// A symmetric positive definite matrix: of each row what lies between its first entry and the diagonal.
class envelope_matrix {
 public:
  /// @param first  column of the first entry of each row
  explicit envelope_matrix(std::vector<std::size_t> first) : first_(std::move(first)), begin_(first_.size() + 1, 0) {
    for (std::size_t i = 0; i < first_.size(); ++i) begin_[i + 1] = begin_[i] + i - first_[i] + 1;
    value_.assign(begin_.back(), 0.0);
  }

  [[nodiscard]] double& at(std::size_t i, std::size_t j) { return value_[begin_[i] + j - first_[i]]; }

  /// Becomes its own Cholesky factor. @return false where it is not positive definite
  [[nodiscard]] bool factorise() {
    for (std::size_t i = 0; i < first_.size(); ++i) {
      double* const row = value_.data() + begin_[i];
      for (std::size_t j = first_[i]; j <= i; ++j) {
        const double* const other = value_.data() + begin_[j];
        double s = row[j - first_[i]];
        for (std::size_t k = std::max(first_[i], first_[j]); k < j; ++k) s -= row[k - first_[i]] * other[k - first_[j]];
        if (j == i && !(s > 0.0)) return false;
        row[j - first_[i]] = j == i ? std::sqrt(s) : s / other[j - first_[j]];
      }
    }
    return true;
  }

  void solve(std::vector<vec3>& x) {
    for (std::size_t i = 0; i < x.size(); ++i) {
      for (std::size_t k = first_[i]; k < i; ++k) x[i] -= at(i, k) * x[k];
      x[i] /= at(i, i);
    }
    for (std::size_t i = x.size(); i-- > 0;) {
      x[i] /= at(i, i);
      for (std::size_t k = first_[i]; k < i; ++k) x[k] -= at(i, k) * x[i];
    }
  }

 private:
  std::vector<std::size_t> first_;
  std::vector<std::size_t> begin_;
  std::vector<double> value_;
};

struct entry {
  std::uint32_t row, column;
  double weight;
};

// Of every vertex of the patch, its neighbours with their weights, and its share of the area.
struct plate {
  std::vector<vec3> positions;  // of the patch, then of the surroundings
  std::vector<entry> entries;   // by row
  std::vector<std::size_t> begin;
  std::vector<double> area;
};

plate plate_of(const hole_patch& patch, const patch_surroundings& around) {
  plate out;
  out.positions = patch.positions;
  out.positions.insert(out.positions.end(), around.positions.begin(), around.positions.end());
  const auto rows = static_cast<std::uint32_t>(patch.positions.size());
  const auto shift = rows - static_cast<std::uint32_t>(patch.rim);
  std::vector<index_triangle> all = patch.triangles;
  for (index_triangle t : around.triangles) {
    for (std::uint32_t& v : t) v += v < patch.rim ? 0U : shift;
    all.push_back(t);
  }
  out.area.assign(out.positions.size(), 0.0);
  for (const index_triangle& t : all) {
    const auto c = corners(out.positions, t);
    const double twice = glm::length(area_normal(c));
    if (!(twice > 0.0)) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t i = t[(k + 1) % 3], j = t[(k + 2) % 3];
      const double cotangent = glm::dot(c[(k + 1) % 3] - c[k], c[(k + 2) % 3] - c[k]) / twice;
      if (i < rows) out.entries.push_back({i, j, 0.5 * cotangent});
      if (j < rows) out.entries.push_back({j, i, 0.5 * cotangent});
      out.area[t[k]] += twice / 6.0;
    }
  }
  std::ranges::stable_sort(out.entries, {}, [](const entry& e) { return std::pair(e.row, e.column); });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < out.entries.size(); ++i) {
    const entry& e = out.entries[i];
    if (kept > 0 && out.entries[kept - 1].row == e.row && out.entries[kept - 1].column == e.column) {
      out.entries[kept - 1].weight += e.weight;
    } else {
      out.entries[kept++] = e;
    }
  }
  out.entries.resize(kept);
  for (entry& e : out.entries) e.weight = std::max(e.weight, least_weight);
  out.begin.assign(rows + 1, 0);
  for (const entry& e : out.entries) ++out.begin[e.row + 1];
  for (std::size_t i = 0; i < rows; ++i) out.begin[i + 1] += out.begin[i];
  return out;
}

// The added vertices in the order of their distance from the first of them, so that neighbours have near numbers.
std::vector<std::uint32_t> breadth_first(const plate& p, std::size_t rim) {
  const std::size_t rows = p.begin.size() - 1;
  std::vector<std::uint32_t> order;
  std::vector<bool> seen(rows, false);
  const auto walk = [&](std::uint32_t start) {
    const std::size_t from = order.size();
    order.push_back(start);
    seen[start] = true;
    for (std::size_t at = from; at < order.size(); ++at)
      for (std::size_t e = p.begin[order[at]]; e < p.begin[order[at] + 1]; ++e) {
        const std::uint32_t v = p.entries[e].column;
        if (v < rim || v >= rows || seen[v]) continue;
        seen[v] = true;
        order.push_back(v);
      }
    return from;
  };
  for (auto v = static_cast<std::uint32_t>(rim); v < rows; ++v) {
    if (seen[v]) continue;
    const std::size_t from = walk(v);
    // Once more from the last one: it lies at an end of the patch, and fewer have the same distance from there.
    const std::uint32_t end = order.back();
    for (std::size_t i = from; i < order.size(); ++i) seen[order[i]] = false;
    order.resize(from);
    walk(end);
  }
  return order;
}

}  // namespace

bool fair_patch(hole_patch& patch, const patch_surroundings& around) {
  const std::size_t rows = patch.positions.size();
  if (rows == patch.rim) return true;
  const plate p = plate_of(patch, around);
  const std::vector<std::uint32_t> order = breadth_first(p, patch.rim);
  constexpr std::size_t fixed = static_cast<std::size_t>(-1);
  std::vector<std::size_t> unknown(p.positions.size(), fixed);
  for (std::size_t i = 0; i < order.size(); ++i) unknown[order[i]] = i;

  // One row of the Laplacian: its neighbours, and last the vertex itself.
  std::vector<std::pair<std::uint32_t, double>> row;
  const auto read_row = [&](std::uint32_t v) {
    row.clear();
    double sum = 0.0;
    for (std::size_t e = p.begin[v]; e < p.begin[v + 1]; ++e) {
      row.emplace_back(p.entries[e].column, p.entries[e].weight);
      sum += p.entries[e].weight;
    }
    row.emplace_back(v, -sum);
  };
  std::vector<std::size_t> first(order.size());
  for (std::size_t i = 0; i < first.size(); ++i) first[i] = i;
  for (std::uint32_t v = 0; v < rows; ++v) {
    read_row(v);
    std::size_t least = fixed;
    for (const auto& [u, weight] : row) least = std::min(least, unknown[u]);
    for (const auto& [u, weight] : row)
      if (unknown[u] != fixed) first[unknown[u]] = std::min(first[unknown[u]], least);
  }
  envelope_matrix matrix(std::move(first));
  std::vector<vec3> x(order.size(), vec3(0.0));
  for (std::uint32_t v = 0; v < rows; ++v) {
    if (!(p.area[v] > 0.0)) return false;
    read_row(v);
    vec3 known{0.0};
    for (const auto& [u, weight] : row)
      if (unknown[u] == fixed) known += weight * (p.positions[u] - p.positions[0]);
    for (const auto& [u, weight] : row) {
      const std::size_t i = unknown[u];
      if (i == fixed) continue;
      x[i] -= weight / p.area[v] * known;
      for (const auto& [w, other] : row)
        if (unknown[w] <= i) matrix.at(i, unknown[w]) += weight * other / p.area[v];
    }
  }
  if (!matrix.factorise()) return false;
  matrix.solve(x);
  if (!std::ranges::all_of(x, [](const vec3& at) { return is_finite(at); })) return false;
  for (std::size_t i = 0; i < order.size(); ++i) patch.positions[order[i]] = x[i] + p.positions[0];
  return true;
}

}  // namespace asperity::bake
