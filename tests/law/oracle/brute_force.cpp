#include "law/oracle/brute_force.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace asperity::oracle {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double facing = 0.1;  // science, section 2: a coarse triangle counts where |N . n| exceeds this

struct sample_grid {
  contact_window window;
  int side;  // samples per side

  [[nodiscard]] double pitch() const { return 2.0 * window.half_size_m / side; }
  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(side) * static_cast<std::size_t>(side); }
  [[nodiscard]] double coordinate(int i) const { return (i + 0.5) * pitch() - window.half_size_m; }
  [[nodiscard]] vec3 to_uvn(const vec3& p_w) const {
    const vec3 r = p_w - window.centre_w;
    return {glm::dot(r, window.u_w), glm::dot(r, window.v_w), glm::dot(r, window.n_ab_w)};
  }
};

// Calls visit(sample index, height) for every sample whose line crosses the triangle, borders included.
template <class Visit>
void draw(const sample_grid& g, const std::array<vec3, 3>& t, Visit&& visit) {
  const double det = (t[1].x - t[0].x) * (t[2].y - t[0].y) - (t[2].x - t[0].x) * (t[1].y - t[0].y);
  if (det == 0.0) return;
  const auto range = [&](double lo, double hi) {
    const double first = std::ceil((lo + g.window.half_size_m) / g.pitch() - 0.5);
    const double last = std::floor((hi + g.window.half_size_m) / g.pitch() - 0.5);
    return std::pair{static_cast<int>(std::max(first, 0.0)), static_cast<int>(std::min(last, g.side - 1.0))};
  };
  const auto [u0, u1] = range(std::min({t[0].x, t[1].x, t[2].x}), std::max({t[0].x, t[1].x, t[2].x}));
  const auto [v0, v1] = range(std::min({t[0].y, t[1].y, t[2].y}), std::max({t[0].y, t[1].y, t[2].y}));
  for (int j = v0; j <= v1; ++j) {
    for (int i = u0; i <= u1; ++i) {
      const double x = g.coordinate(i) - t[0].x;
      const double y = g.coordinate(j) - t[0].y;
      const double b = (x * (t[2].y - t[0].y) - y * (t[2].x - t[0].x)) / det;
      const double c = (y * (t[1].x - t[0].x) - x * (t[1].y - t[0].y)) / det;
      constexpr double slack = -1e-12;  // a line through a shared edge belongs to both triangles
      if (b < slack || c < slack || b + c > 1.0 - slack) continue;
      visit(static_cast<std::size_t>(j) * static_cast<std::size_t>(g.side) + static_cast<std::size_t>(i),
            t[0].z + b * (t[1].z - t[0].z) + c * (t[2].z - t[0].z));
    }
  }
}

// The coarse patch over a sample: NaN where there is none.
struct coarse_sample {
  double height = nan;
  double reach = 0.0;  // how far along n the fine surface may be
};

// sign: +1 for A (the highest crossing counts), -1 for B (the lowest).
std::vector<coarse_sample> coarse_samples(const sample_grid& g, const body& b, double sign) {
  std::vector<coarse_sample> out(g.size());
  for (const std::uint32_t index : b.patch) {
    auto t = corners(*b.coarse, index);
    for (vec3& p : t) p = g.to_uvn(b.T_w * p);
    const vec3 n = area_normal(t);
    const double cosine = sign * n.z / glm::length(n);
    if (!(cosine > facing)) continue;
    draw(g, t, [&](std::size_t k, double height) {
      if (!(sign * out[k].height >= sign * height)) out[k] = {height, b.displacement_m / cosine};
    });
  }
  return out;
}

// Height of the full-resolution surface over each sample: of the crossing nearest to the coarse height.
std::vector<double> full_heights(const sample_grid& g, const body& b, double sign,
                                 const std::vector<coarse_sample>& coarse) {
  std::vector<vec3> points;
  points.reserve(b.full->positions.size());
  for (const vec3& p : b.full->positions) points.push_back(g.to_uvn(b.T_w * p));
  std::vector<double> h(g.size(), nan);
  for (const auto& v : b.full->triangles) {
    const std::array<vec3, 3> t{points[v[0]], points[v[1]], points[v[2]]};
    if (!(sign * area_normal(t).z > 0.0)) continue;
    draw(g, t, [&](std::size_t k, double height) {
      const double away = std::fabs(height - coarse[k].height);
      if (away <= coarse[k].reach && !(std::fabs(h[k] - coarse[k].height) <= away)) h[k] = height;
    });
  }
  return h;
}

double slope_at(const sample_grid& g, const std::vector<double>& h, int i, int j) {
  const auto at = [&](int x, int y) {
    x = std::clamp(x, 0, g.side - 1);
    y = std::clamp(y, 0, g.side - 1);
    const double v = h[static_cast<std::size_t>(y) * static_cast<std::size_t>(g.side) + static_cast<std::size_t>(x)];
    return std::isnan(v)
               ? h[static_cast<std::size_t>(j) * static_cast<std::size_t>(g.side) + static_cast<std::size_t>(i)]
               : v;
  };
  return std::hypot(at(i + 1, j) - at(i - 1, j), at(i, j + 1) - at(i, j - 1)) / (2.0 * g.pitch());
}

}  // namespace

brute_force_depth measure_brute_force(const body& a, const body& b, const contact_window& window, int grid,
                                      int refinement) {
  const sample_grid dense{window, grid * refinement};
  const auto a_h = full_heights(dense, a, +1.0, coarse_samples(dense, a, +1.0));
  const auto b_h = full_heights(dense, b, -1.0, coarse_samples(dense, b, -1.0));

  brute_force_depth out;
  out.dense.depth_m = out.grid.depth_m = -std::numeric_limits<double>::infinity();
  const auto keep_deepest = [&](deepest_place& best, double depth, int i, int j) {
    if (depth > best.depth_m) best = {depth, slope_at(dense, a_h, i, j), slope_at(dense, b_h, i, j)};
  };
  for (int j = 0; j < dense.side; ++j) {
    for (int i = 0; i < dense.side; ++i) {
      const std::size_t k =
          static_cast<std::size_t>(j) * static_cast<std::size_t>(dense.side) + static_cast<std::size_t>(i);
      const double d = a_h[k] - b_h[k];
      if (std::isnan(d)) continue;
      keep_deepest(out.dense, d, i, j);
      if (i % refinement == refinement / 2 && j % refinement == refinement / 2) {
        keep_deepest(out.grid, d, i, j);
        ++out.samples;
      }
    }
  }
  return out;
}

}  // namespace asperity::oracle
