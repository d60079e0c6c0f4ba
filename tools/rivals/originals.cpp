#include "originals.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>
#include <utility>

#include "asperity/core/spatial.hpp"

namespace asperity::rivals {
namespace {

using oracle::placed_mesh;

struct span3 {
  vec3 low, high;
};

span3 box_of(const placed_mesh& mesh) {
  span3 out{mesh.points().front(), mesh.points().front()};
  for (const vec3& p : mesh.points()) {
    out.low = glm::min(out.low, p);
    out.high = glm::max(out.high, p);
  }
  return out;
}

/// The triangles of `mesh`, as it is placed, that come within `reach_m` of the other surface, and a few beside them.
triangle_mesh near_part(const placed_mesh& mesh, const placed_mesh& other, double reach_m) {
  const span3 box = box_of(other);
  std::vector<std::uint32_t> number(mesh.points().size(), 0);  // of a point in the part, from 1
  triangle_mesh out;
  for (const auto& t : mesh.triangles()) {
    const vec3 &a = mesh.points()[t[0]], &b = mesh.points()[t[1]], &c = mesh.points()[t[2]];
    const vec3 low = glm::min(a, glm::min(b, c)), high = glm::max(a, glm::max(b, c));
    if (glm::any(glm::greaterThan(low, box.high + reach_m)) || glm::any(glm::lessThan(high, box.low - reach_m)))
      continue;
    const double within = reach_m + 0.5 * glm::length(high - low);
    if (other.distance_to(0.5 * (low + high), 1.001 * within) > within) continue;
    std::array<std::uint32_t, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint32_t& n = number[t[k]];
      if (n == 0) {
        out.positions.push_back(mesh.points()[t[k]]);
        n = static_cast<std::uint32_t>(out.positions.size());
      }
      corners[k] = n - 1;
    }
    out.triangles.push_back(corners);
  }
  return out;
}

/// Turns n to +z.
quat turn_up(const vec3& n) {
  const vec3 axis(n.y, -n.x, 0.0);  // n x z
  const double sine = glm::length(axis);
  if (sine > 1e-12) return exp_rotation(std::atan2(sine, n.z) / sine * axis);
  return n.z > 0.0 ? quat(1.0, 0.0, 0.0, 0.0) : quat(0.0, 1.0, 0.0, 0.0);
}

/// A way out: straight against n, and the face that it ends at.
struct way_out {
  vec3 n_ab_w{0.0};
  double length_m = std::numeric_limits<double>::infinity();
  vec3 face_w{0.0};  ///< like n_ab: into the fixed body
};

class search {
 public:
  search(const placed_mesh& probe, const placed_mesh& fixed, double reach_m)
      : triangles_{near_part(probe, fixed, reach_m), near_part(fixed, probe, reach_m)} {
    if (triangles_.first.triangles.empty() || triangles_.second.triangles.empty()) return;
    probe_.emplace_back(triangles_.first);
    fixed_.emplace_back(triangles_.second);
  }
  [[nodiscard]] bool empty() const noexcept { return probe_.empty(); }
  [[nodiscard]] std::size_t triangles() const noexcept {
    return triangles_.first.triangles.size() + triangles_.second.triangles.size();
  }

  way_out along(const vec3& n) {
    const quat up = turn_up(n);
    probe_.front().place(up, vec3(0.0));
    fixed_.front().place(up, vec3(0.0));
    const oracle::first_touch met = touch_along_z(probe_.front(), fixed_.front());
    way_out out{n, -met.way_m, -(glm::conjugate(up) * met.normal)};
    tried_.push_back(out);
    return out;
  }

  /// From face to face, as long as the way out along its normal is shorter.
  way_out settle(way_out at) {
    for (int i = 0; i < 30 && glm::length(at.face_w) > 0.5; ++i) {
      const way_out next = along(glm::normalize(at.face_w));
      if (next.length_m >= at.length_m) break;
      at = next;
    }
    return at;
  }

  /// Around and nearer, until nothing within a fiftieth of a degree is shorter.
  way_out refine(way_out at) {
    constexpr int spokes = 8;
    for (double step = 0.1; step > 3e-4; step *= 0.5) {
      const vec3 other = std::fabs(at.n_ab_w.x) < 0.6 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0);
      const vec3 u = glm::normalize(glm::cross(other, at.n_ab_w)), v = glm::cross(at.n_ab_w, u);
      const vec3 middle = at.n_ab_w;
      for (int k = 0; k < spokes; ++k) {
        const double angle = 2.0 * std::numbers::pi * (k + 0.37 * step) / spokes;
        const way_out next = along(glm::normalize(middle + step * (std::cos(angle) * u + std::sin(angle) * v)));
        if (next.length_m < at.length_m) at = settle(next);
      }
    }
    return at;
  }

  [[nodiscard]] const std::vector<way_out>& tried() const noexcept { return tried_; }

 private:
  std::pair<triangle_mesh, triangle_mesh> triangles_;
  std::vector<placed_mesh> probe_, fixed_;  // one each, where the surfaces come near each other
  std::vector<way_out> tried_;
};

}  // namespace

originals::originals(const triangle_mesh& probe, const triangle_mesh& fixed) : probe_(probe), fixed_(fixed) {}

double originals::way_down_m(const pose& T_wa) {
  probe_.place(T_wa.rotation, T_wa.position);
  return touch_along_z(fixed_, probe_).way_m;
}

bool originals::cross(const pose& T_wa, const vec3& shift_w) {
  probe_.place(T_wa.rotation, T_wa.position);
  return surfaces_cross(probe_, fixed_, shift_w);
}

parting originals::part(const pose& T_wa, double at_most_m) {
  parting out;
  if (!cross(T_wa, vec3(0.0))) return out;
  out.at_least_m = overlap_at_least(probe_, fixed_, 0.0);

  search ways(probe_, fixed_, at_most_m);
  out.triangles = ways.triangles();
  if (ways.empty()) return out;
  constexpr int spread = 120;
  constexpr double golden = 2.399963229728653, lowest = -0.17;  // cosine of 100 degrees
  std::vector<way_out> starts{ways.along({0.0, 0.0, -1.0})};
  for (int k = 0; k < spread; ++k) {
    const double down = 1.0 + (lowest - 1.0) * (k + 0.5) / spread, across = std::sqrt(1.0 - down * down);
    starts.push_back(ways.along({across * std::cos(golden * k), across * std::sin(golden * k), -down}));
  }
  std::sort(starts.begin(), starts.end(), [](const way_out& a, const way_out& b) { return a.length_m < b.length_m; });
  constexpr std::size_t settled = 12, refined = 3;
  std::vector<way_out> ends;
  for (std::size_t i = 0; i < settled; ++i) ends.push_back(ways.settle(starts[i]));
  std::sort(ends.begin(), ends.end(), [](const way_out& a, const way_out& b) { return a.length_m < b.length_m; });
  for (std::size_t i = 0; i < refined; ++i) ends[i] = ways.refine(ends[i]);
  const way_out best = *std::min_element(ends.begin(), ends.end(),
                                         [](const way_out& a, const way_out& b) { return a.length_m < b.length_m; });

  out.depth_m = best.length_m;
  out.n_ab_w = best.n_ab_w;
  for (const way_out& w : ways.tried()) {
    if (glm::dot(w.n_ab_w, best.n_ab_w) < std::cos(elsewhere_rad)) {
      out.elsewhere_m = std::min(out.elsewhere_m, w.length_m);
    }
  }
  return out;
}

}  // namespace asperity::rivals
