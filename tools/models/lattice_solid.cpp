#include "lattice_solid.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

namespace asperity::models {
namespace {

using index3 = std::array<std::uint32_t, 3>;

/// Lattice coordinates of an axis, and where each slab starts among them.
struct axis_lines {
  std::vector<double> coordinate_m;
  std::vector<std::uint32_t> start;  ///< one per slab, and the end
};

axis_lines lines_of(const lattice_axis& axis) {
  axis_lines out;
  for (std::size_t slab = 0; slab < axis.cells.size(); ++slab) {
    out.start.push_back(static_cast<std::uint32_t>(out.coordinate_m.size()));
    const double low = axis.breaks_m[slab];
    const double step = (axis.breaks_m[slab + 1] - low) / axis.cells[slab];
    for (std::uint32_t i = 0; i < axis.cells[slab]; ++i) out.coordinate_m.push_back(low + step * i);
  }
  out.start.push_back(static_cast<std::uint32_t>(out.coordinate_m.size()));
  out.coordinate_m.push_back(axis.breaks_m.back());
  return out;
}

double square_length(const vec3& v) noexcept { return glm::dot(v, v); }

class surface_builder {
 public:
  surface_builder(const lattice_solid& solid, const std::function<vec3(const vec3&)>& map)
      : solid_(solid),
        map_(map),
        lines_{lines_of(solid.axes[0]), lines_of(solid.axes[1]), lines_of(solid.axes[2])},
        vertex_of_(points(0) * points(1) * points(2), none) {}

  triangle_mesh build() {
    const index3 slabs = {slab_count(0), slab_count(1), slab_count(2)};
    for (std::uint32_t i = 0; i < slabs[0]; ++i)
      for (std::uint32_t j = 0; j < slabs[1]; ++j)
        for (std::uint32_t k = 0; k < slabs[2]; ++k)
          if (filled({i, j, k})) add_box({i, j, k});
    return std::move(mesh_);
  }

 private:
  static constexpr std::uint32_t none = ~std::uint32_t{0};

  std::size_t points(std::size_t axis) const { return lines_[axis].coordinate_m.size(); }
  std::uint32_t slab_count(std::size_t axis) const {
    return static_cast<std::uint32_t>(solid_.axes[axis].cells.size());
  }

  bool filled(const index3& slab) const {
    vec3 centre{0.0};
    for (std::uint32_t a = 0; a < 3; ++a) {
      const auto& breaks = solid_.axes[a].breaks_m;
      centre[static_cast<int>(a)] = 0.5 * (breaks[slab[a]] + breaks[slab[a] + 1]);
    }
    return solid_.filled(centre);
  }

  void add_box(const index3& slab) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      index3 next = slab;
      if (slab[axis] == 0) {
        add_face(slab, axis, false);
      } else {
        next[axis] = slab[axis] - 1;
        if (!filled(next)) add_face(slab, axis, false);
      }
      next[axis] = slab[axis] + 1;
      if (next[axis] == slab_count(axis) || !filled(next)) add_face(slab, axis, true);
    }
  }

  /// The face of a slab box whose outward normal is plus or minus `axis`.
  void add_face(const index3& slab, std::size_t axis, bool positive) {
    const std::size_t b = (axis + 1) % 3;
    const std::size_t c = (axis + 2) % 3;
    index3 at{};
    at[axis] = lines_[axis].start[slab[axis] + (positive ? 1 : 0)];
    for (std::uint32_t i = lines_[b].start[slab[b]]; i < lines_[b].start[slab[b] + 1]; ++i)
      for (std::uint32_t j = lines_[c].start[slab[c]]; j < lines_[c].start[slab[c] + 1]; ++j) {
        std::array<std::uint32_t, 4> quad{};
        constexpr std::array<std::array<std::uint32_t, 2>, 4> corner = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
        for (std::size_t n = 0; n < 4; ++n) {
          at[b] = i + corner[n][0];
          at[c] = j + corner[n][1];
          quad[positive ? n : 3 - n] = vertex(at);
        }
        add_quad(quad);
      }
  }

  std::uint32_t vertex(const index3& at) {
    std::uint32_t& id = vertex_of_[(at[0] * points(1) + at[1]) * points(2) + at[2]];
    if (id == none) {
      id = static_cast<std::uint32_t>(mesh_.positions.size());
      mesh_.positions.push_back(
          map_({lines_[0].coordinate_m[at[0]], lines_[1].coordinate_m[at[1]], lines_[2].coordinate_m[at[2]]}));
    }
    return id;
  }

  /// Cuts along the shorter diagonal: where a map turns a corner into a straight line, the other cut has no area.
  void add_quad(const std::array<std::uint32_t, 4>& q) {
    const auto& p = mesh_.positions;
    const double first = square_length(p[q[2]] - p[q[0]]);
    const double second = square_length(p[q[3]] - p[q[1]]);
    // The margin keeps rounding from deciding between the equal diagonals of a rectangle.
    if (second < (1.0 - 1e-6) * first) {
      mesh_.triangles.push_back({q[0], q[1], q[3]});
      mesh_.triangles.push_back({q[1], q[2], q[3]});
    } else {
      mesh_.triangles.push_back({q[0], q[1], q[2]});
      mesh_.triangles.push_back({q[0], q[2], q[3]});
    }
  }

  const lattice_solid& solid_;
  const std::function<vec3(const vec3&)>& map_;
  std::array<axis_lines, 3> lines_;
  std::vector<std::uint32_t> vertex_of_;
  triangle_mesh mesh_;
};

}  // namespace

triangle_mesh surface_of(const lattice_solid& solid, const std::function<vec3(const vec3&)>& map) {
  return surface_builder(solid, map).build();
}

vec2 square_to_disc(const vec2& p, double inner, double outer) noexcept {
  const double m = std::max(std::abs(p.x), std::abs(p.y));  // half side of the square through p
  if (m == 0.0 || m >= outer) return p;
  const double disc = m / std::sqrt(p.x * p.x + p.y * p.y);
  const double share = m <= inner ? 0.0 : (m - inner) / (outer - inner);
  return (disc + (1.0 - disc) * share) * p;
}

}  // namespace asperity::models
