#include "asperity/bake/relief.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "bake/surface_points.hpp"

namespace asperity::bake {

relief_extent measure_relief(const triangle_mesh& mesh, const relief& heights, std::size_t samples) {
  relief_extent out{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(), 0.0, 0.0};
  std::vector<double> all;
  all.reserve(samples);
  for (const relief_point& p : spread_points(mesh, samples)) {
    const double h = heights.height_m(p);
    all.push_back(h);
    out.lowest_m = std::min(out.lowest_m, h);
    out.highest_m = std::max(out.highest_m, h);
    out.mean_m += h / static_cast<double>(samples);
  }
  double squares = 0.0;
  for (const double h : all) squares += (h - out.mean_m) * (h - out.mean_m);
  out.rms_m = std::sqrt(squares / static_cast<double>(samples));
  return out;
}

}  // namespace asperity::bake
