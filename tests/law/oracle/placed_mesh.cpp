#include "law/oracle/placed_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <numeric>
#include <utility>

namespace asperity::oracle {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr std::uint32_t leaf_size = 4;

using corners3 = std::array<vec3, 3>;

/// Twice the area of (p, a, b) seen along `axis`; of (p, b, a) it is exactly the negative, so that a line next to an
/// edge crosses exactly one of its two triangles.
double area_about(const vec3& p, const vec3& a, const vec3& b, int axis) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  return (a[u] - p[u]) * (b[v] - p[v]) - (a[v] - p[v]) * (b[u] - p[u]);
}

/// Weights of the corners where the line through p along `axis` crosses the triangle; false where it does not.
bool crosses(const vec3& p, const corners3& t, int axis, std::array<double, 3>& weights) {
  const double w0 = area_about(p, t[1], t[2], axis), w1 = area_about(p, t[2], t[0], axis),
               w2 = area_about(p, t[0], t[1], axis);
  if (!((w0 >= 0.0 && w1 >= 0.0 && w2 >= 0.0) || (w0 <= 0.0 && w1 <= 0.0 && w2 <= 0.0))) return false;
  const double sum = w0 + w1 + w2;
  if (sum == 0.0) return false;
  weights = {w0 / sum, w1 / sum, w2 / sum};
  return true;
}

double along(const corners3& t, const std::array<double, 3>& w, int axis) {
  return w[0] * t[0][axis] + w[1] * t[1][axis] + w[2] * t[2][axis];
}

double squared(const vec3& v) { return glm::dot(v, v); }

double segment_distance2(const vec3& p, const vec3& a, const vec3& b) {
  const vec3 e = b - a;
  const double l = squared(e);
  return squared(p - a - (l > 0.0 ? std::clamp(glm::dot(p - a, e) / l, 0.0, 1.0) : 0.0) * e);
}

/// Infinity where it is surely `at_most` or more.
double point_triangle2(const vec3& p, const corners3& t, double at_most) {
  const vec3 n = glm::cross(t[1] - t[0], t[2] - t[0]);
  const double n2 = squared(n);
  if (n2 > 0.0) {
    const double height = glm::dot(p - t[0], n);
    if (height * height >= at_most * n2) return infinity;
    bool over = true;
    for (std::size_t k = 0; k < 3; ++k) over = over && glm::dot(glm::cross(t[(k + 1) % 3] - t[k], p - t[k]), n) >= 0.0;
    if (over) return height * height / n2;
  }
  return std::min(
      {segment_distance2(p, t[0], t[1]), segment_distance2(p, t[1], t[2]), segment_distance2(p, t[2], t[0])});
}

/// Between the insides of two segments only; their ends are points of the other triangle's distance.
double edges2(const vec3& a, const vec3& b, const vec3& c, const vec3& d) {
  const vec3 u = b - a, v = d - c, w = c - a;
  const double uu = squared(u), vv = squared(v), uv = glm::dot(u, v), det = uu * vv - uv * uv;
  if (det <= 1e-14 * uu * vv) return infinity;
  const double s = (glm::dot(w, u) * vv - glm::dot(w, v) * uv) / det;
  const double r = (glm::dot(w, u) * uv - glm::dot(w, v) * uu) / det;
  if (s < 0.0 || s > 1.0 || r < 0.0 || r > 1.0) return infinity;
  return squared(w + r * v - s * u);
}

double box_distance2(const vec3& low_a, const vec3& high_a, const vec3& low_b, const vec3& high_b) {
  return squared(glm::max(glm::max(low_a - high_b, low_b - high_a), vec3(0.0)));
}

void triangles_distance2(const corners3& a, const corners3& b, double& best) {
  if (box_distance2(glm::min(a[0], glm::min(a[1], a[2])), glm::max(a[0], glm::max(a[1], a[2])),
                    glm::min(b[0], glm::min(b[1], b[2])), glm::max(b[0], glm::max(b[1], b[2]))) >= best) {
    return;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    best = std::min(best, point_triangle2(a[i], b, best));
    best = std::min(best, point_triangle2(b[i], a, best));
    for (std::size_t j = 0; j < 3; ++j) best = std::min(best, edges2(a[i], a[(i + 1) % 3], b[j], b[(j + 1) % 3]));
  }
}

/// Of a triangle's face, unit; zero where it has no area.
vec3 face_normal(const corners3& t) {
  const vec3 n = glm::cross(t[1] - t[0], t[2] - t[0]);
  const double length = glm::length(n);
  return length > 0.0 ? n / length : vec3(0.0);
}

/// The first touch so far, and the first one of a vertex with a face.
struct touch_so_far {
  first_touch best;
  double by_face_m = infinity;
  vec3 face{0.0};

  void keep(double way, const vec3& point, const vec3& normal) {
    // What is met lies above, so that its normal points down.
    if (way < best.way_m) best = {way, point, normal.z > 0.0 ? -normal : normal};
  }
  void keep_face(double way, const vec3& point, const vec3& normal) {
    keep(way, point, normal);
    if (way >= by_face_m) return;
    by_face_m = way;
    face = normal.z > 0.0 ? -normal : normal;
  }
  /// A vertex on an edge within a flat face touches both: the face says which way is out.
  [[nodiscard]] first_touch found() const {
    constexpr double same_m = 1e-9;
    return by_face_m < best.way_m + same_m ? first_touch{best.way_m, best.point, face} : best;
  }
};

/// The least of b's height minus a's over all lines along z that cross both triangles.
void touch(const corners3& a, const corners3& b, touch_so_far& so_far) {
  std::array<double, 3> w;
  for (std::size_t i = 0; i < 3; ++i) {
    if (crosses(a[i], b, 2, w)) {
      so_far.keep_face(along(b, w, 2) - a[i].z, {a[i].x, a[i].y, along(b, w, 2)}, face_normal(b));
    }
    if (crosses(b[i], a, 2, w)) so_far.keep_face(b[i].z - along(a, w, 2), b[i], face_normal(a));
    for (std::size_t j = 0; j < 3; ++j) {
      const vec3 &p = a[i], &q = b[j], u = a[(i + 1) % 3] - p, v = b[(j + 1) % 3] - q;
      const double det = u.x * v.y - u.y * v.x;
      if (det == 0.0) continue;
      const double s = ((q.x - p.x) * v.y - (q.y - p.y) * v.x) / det;
      const double r = ((q.x - p.x) * u.y - (q.y - p.y) * u.x) / det;
      if (s >= 0.0 && s <= 1.0 && r >= 0.0 && r <= 1.0) {
        so_far.keep(q.z + r * v.z - p.z - s * u.z, q + r * v, glm::normalize(glm::cross(u, v)));
      }
    }
  }
}

/// Whether the segment from p to q goes through the triangle.
bool goes_through(const vec3& p, const vec3& q, const corners3& t) {
  const vec3 n = glm::cross(t[1] - t[0], t[2] - t[0]);
  const double from = glm::dot(p - t[0], n), to = glm::dot(q - t[0], n);
  if ((from > 0.0) == (to > 0.0) || from == to) return false;
  const vec3 at = p + from / (from - to) * (q - p);
  for (std::size_t k = 0; k < 3; ++k) {
    if (glm::dot(glm::cross(t[(k + 1) % 3] - t[k], at - t[k]), n) < 0.0) return false;
  }
  return true;
}

bool triangles_cross(const corners3& a, const corners3& b) {
  const auto on_one_side = [](const corners3& of, const corners3& t) {
    const vec3 n = glm::cross(of[1] - of[0], of[2] - of[0]);
    const double x = glm::dot(t[0] - of[0], n), y = glm::dot(t[1] - of[0], n), z = glm::dot(t[2] - of[0], n);
    return (x > 0.0 && y > 0.0 && z > 0.0) || (x < 0.0 && y < 0.0 && z < 0.0);
  };
  if (on_one_side(a, b) || on_one_side(b, a)) return false;
  for (std::size_t k = 0; k < 3; ++k) {
    if (goes_through(a[k], a[(k + 1) % 3], b) || goes_through(b[k], b[(k + 1) % 3], a)) return true;
  }
  return false;
}

}  // namespace

placed_mesh::placed_mesh(const triangle_mesh& mesh) : rest_(mesh.positions), triangles_(mesh.triangles) {
  std::vector<vec3> centres;
  centres.reserve(triangles_.size());
  for (const auto& t : triangles_) centres.push_back((rest_[t[0]] + rest_[t[1]] + rest_[t[2]]) / 3.0);
  nodes_.reserve(triangles_.size());
  static_cast<void>(cut(0, static_cast<std::uint32_t>(triangles_.size()), centres));
  place({1.0, 0.0, 0.0, 0.0}, vec3(0.0));
}

std::uint32_t placed_mesh::cut(std::uint32_t first, std::uint32_t count, std::vector<vec3>& centres) {
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  nodes_.emplace_back();
  if (count <= leaf_size) {
    nodes_[index].first = first;
    nodes_[index].count = count;
    return index;
  }
  vec3 low = centres[first], high = low;
  for (std::uint32_t i = first; i < first + count; ++i) {
    low = glm::min(low, centres[i]);
    high = glm::max(high, centres[i]);
  }
  const vec3 size = high - low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), first);
  std::nth_element(order.begin(), order.begin() + count / 2, order.end(),
                   [&](std::uint32_t i, std::uint32_t j) { return centres[i][axis] < centres[j][axis]; });
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<vec3> moved;
  for (const std::uint32_t i : order) {
    triangles.push_back(triangles_[i]);
    moved.push_back(centres[i]);
  }
  std::copy(triangles.begin(), triangles.end(), triangles_.begin() + first);
  std::copy(moved.begin(), moved.end(), centres.begin() + first);
  static_cast<void>(cut(first, count / 2, centres));
  const std::uint32_t right = cut(first + count / 2, count - count / 2, centres);
  nodes_[index].right = right;
  return index;
}

void placed_mesh::place(const quat& rotation, const vec3& shift) {
  points_.resize(rest_.size());
  const mat3 turn = glm::mat3_cast(rotation);
  for (std::size_t i = 0; i < rest_.size(); ++i) points_[i] = turn * rest_[i] + shift;
  for (std::size_t i = nodes_.size(); i-- > 0;) {  // children come after their parents
    node& n = nodes_[i];
    if (n.count == 0) {
      const node &l = nodes_[i + 1], &r = nodes_[n.right];
      n.low = glm::min(l.low, r.low);
      n.high = glm::max(l.high, r.high);
      continue;
    }
    n.low = vec3(infinity);
    n.high = vec3(-infinity);
    for (std::uint32_t t = n.first; t < n.first + n.count; ++t) {
      for (const std::uint32_t v : triangles_[t]) {
        n.low = glm::min(n.low, points_[v]);
        n.high = glm::max(n.high, points_[v]);
      }
    }
  }
}

double placed_mesh::distance_to(const vec3& p, double at_most) const noexcept {
  double best = at_most * at_most;
  const auto look = [&](const auto& again, std::uint32_t index) -> void {
    const node& n = nodes_[index];
    if (n.count > 0) {
      for (std::uint32_t t = n.first; t < n.first + n.count; ++t)
        best = std::min(best, point_triangle2(p, corners_of(t), best));
      return;
    }
    const auto far = [&](std::uint32_t i) { return box_distance2(p, p, nodes_[i].low, nodes_[i].high); };
    std::uint32_t near = index + 1, other = n.right;
    double d = far(near), e = far(other);
    if (e < d) {
      std::swap(near, other);
      std::swap(d, e);
    }
    if (d < best) again(again, near);
    if (e < best) again(again, other);
  };
  look(look, 0);
  return std::sqrt(best);
}

template <class Misses, class Found>
void placed_mesh::each_crossing(const vec3& p, int axis, const Misses& misses, const Found& found) const noexcept {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  std::array<double, 3> w;
  const auto look = [&](const auto& again, std::uint32_t index) -> void {
    const node& n = nodes_[index];
    if (p[u] < n.low[u] || p[u] > n.high[u] || p[v] < n.low[v] || p[v] > n.high[v]) return;
    if (misses(n)) return;
    if (n.count == 0) {
      again(again, index + 1);
      again(again, n.right);
      return;
    }
    for (std::uint32_t t = n.first; t < n.first + n.count; ++t) {
      const corners3 c = corners_of(t);
      if (crosses(p, c, axis, w)) found(along(c, w, axis));
    }
  };
  look(look, 0);
}

int placed_mesh::crossings_beyond(const vec3& p, int axis) const noexcept {
  int found = 0;
  each_crossing(
      p, axis, [&](const node& n) { return p[axis] > n.high[axis]; },
      [&](double at) { found += at > p[axis] ? 1 : 0; });
  return found;
}

bool placed_mesh::contains(const vec3& p) const noexcept {
  const bool z = crossings_beyond(p, 2) % 2 == 1, x = crossings_beyond(p, 0) % 2 == 1;
  return z == x ? z : crossings_beyond(p, 1) % 2 == 1;
}

double placed_mesh::crossing(double x, double y, double sign) const noexcept {
  double best = -infinity;  // of sign * z
  each_crossing(
      vec3(x, y, 0.0), 2, [&](const node& n) { return std::max(sign * n.low.z, sign * n.high.z) <= best; },
      [&](double at) { best = std::max(best, sign * at); });
  return sign * best;
}

double placed_mesh::crossing_along(const vec3& p, const vec3& direction, double beyond) const noexcept {
  double best = infinity;
  // Where the ray enters a box; infinite where it misses it.
  const auto enters = [&](std::uint32_t i) {
    const node& n = nodes_[i];
    double from = beyond, to = best;
    for (int k = 0; k < 3; ++k) {
      if (direction[k] == 0.0) {
        if (p[k] < n.low[k] || p[k] > n.high[k]) return infinity;
        continue;
      }
      const double x = (n.low[k] - p[k]) / direction[k], y = (n.high[k] - p[k]) / direction[k];
      from = std::max(from, std::min(x, y) - 1e-12);
      to = std::min(to, std::max(x, y) + 1e-12);
    }
    return from <= to ? from : infinity;
  };
  const auto look = [&](const auto& again, std::uint32_t index) -> void {
    const node& n = nodes_[index];
    if (n.count == 0) {
      std::uint32_t near = index + 1, other = n.right;
      if (enters(other) < enters(near)) std::swap(near, other);
      if (enters(near) < infinity) again(again, near);
      if (enters(other) < infinity) again(again, other);
      return;
    }
    for (std::uint32_t t = n.first; t < n.first + n.count; ++t) {
      const corners3 c = corners_of(t);
      const vec3 normal = glm::cross(c[1] - c[0], c[2] - c[0]);
      const double slope = glm::dot(direction, normal);
      if (slope == 0.0) continue;
      const double way = glm::dot(c[0] - p, normal) / slope;
      if (way <= beyond || way >= best) continue;
      const vec3 at = p + way * direction;
      bool inside = true;
      for (std::size_t k = 0; k < 3; ++k) {
        inside = inside && glm::dot(glm::cross(c[(k + 1) % 3] - c[k], at - c[k]), normal) >= -1e-12 * squared(normal);
      }
      if (inside) best = way;
    }
  };
  if (enters(0) < infinity) look(look, 0);
  return best;
}

first_touch touch_along_z(const placed_mesh& a, const placed_mesh& b) noexcept {
  touch_so_far so_far;
  // The least way that the boxes allow; infinite where no line along z meets both.
  const auto least = [&](std::uint32_t i, std::uint32_t j) {
    const auto &m = a.nodes_[i], &n = b.nodes_[j];
    const bool apart = m.low.x > n.high.x || n.low.x > m.high.x || m.low.y > n.high.y || n.low.y > m.high.y;
    return apart ? infinity : n.low.z - m.high.z;
  };
  const auto look = [&](const auto& again, std::uint32_t i, std::uint32_t j) -> void {
    const auto &m = a.nodes_[i], &n = b.nodes_[j];
    if (m.count > 0 && n.count > 0) {
      for (std::uint32_t s = m.first; s < m.first + m.count; ++s) {
        for (std::uint32_t t = n.first; t < n.first + n.count; ++t) touch(a.corners_of(s), b.corners_of(t), so_far);
      }
      return;
    }
    const bool cut_a = n.count > 0 || (m.count == 0 && squared(m.high - m.low) > squared(n.high - n.low));
    std::array<std::pair<std::uint32_t, std::uint32_t>, 2> next{cut_a ? std::pair{i + 1, j} : std::pair{i, j + 1},
                                                                cut_a ? std::pair{m.right, j} : std::pair{i, n.right}};
    if (least(next[1].first, next[1].second) < least(next[0].first, next[0].second)) std::swap(next[0], next[1]);
    for (const auto& [k, l] : next) {
      if (least(k, l) < so_far.best.way_m) again(again, k, l);
    }
  };
  if (least(0, 0) < infinity) look(look, 0, 0);
  return so_far.found();
}

double surface_distance(const placed_mesh& a, const placed_mesh& b, double shift_z, double at_most) noexcept {
  double best = at_most * at_most;
  const vec3 shift(0.0, 0.0, shift_z);
  const auto far = [&](std::uint32_t i, std::uint32_t j) {
    const auto &m = a.nodes_[i], &n = b.nodes_[j];
    return box_distance2(m.low + shift, m.high + shift, n.low, n.high);
  };
  const auto look = [&](const auto& again, std::uint32_t i, std::uint32_t j) -> void {
    const auto &m = a.nodes_[i], &n = b.nodes_[j];
    if (m.count > 0 && n.count > 0) {
      for (std::uint32_t s = m.first; s < m.first + m.count; ++s) {
        corners3 moved = a.corners_of(s);
        for (vec3& p : moved) p += shift;
        for (std::uint32_t t = n.first; t < n.first + n.count; ++t) triangles_distance2(moved, b.corners_of(t), best);
      }
      return;
    }
    const bool cut_a = n.count > 0 || (m.count == 0 && squared(m.high - m.low) > squared(n.high - n.low));
    std::array<std::pair<std::uint32_t, std::uint32_t>, 2> next{cut_a ? std::pair{i + 1, j} : std::pair{i, j + 1},
                                                                cut_a ? std::pair{m.right, j} : std::pair{i, n.right}};
    if (far(next[1].first, next[1].second) < far(next[0].first, next[0].second)) std::swap(next[0], next[1]);
    for (const auto& [k, l] : next) {
      if (far(k, l) < best) again(again, k, l);
    }
  };
  look(look, 0, 0);
  return std::sqrt(best);
}

bool surfaces_cross(const placed_mesh& a, const placed_mesh& b, const vec3& shift) noexcept {
  const auto look = [&](const auto& again, std::uint32_t i, std::uint32_t j) -> bool {
    const auto &m = a.nodes_[i], &n = b.nodes_[j];
    const vec3 low = m.low + shift, high = m.high + shift;
    if (low.x > n.high.x || n.low.x > high.x || low.y > n.high.y || n.low.y > high.y || low.z > n.high.z ||
        n.low.z > high.z) {
      return false;
    }
    if (m.count > 0 && n.count > 0) {
      for (std::uint32_t s = m.first; s < m.first + m.count; ++s) {
        corners3 moved = a.corners_of(s);
        for (vec3& p : moved) p += shift;
        for (std::uint32_t t = n.first; t < n.first + n.count; ++t) {
          if (triangles_cross(moved, b.corners_of(t))) return true;
        }
      }
      return false;
    }
    if (n.count > 0 || (m.count == 0 && squared(m.high - m.low) > squared(n.high - n.low))) {
      return again(again, i + 1, j) || again(again, m.right, j);
    }
    return again(again, i, j + 1) || again(again, i, n.right);
  };
  return look(look, 0, 0);
}

double deepest_vertex(const placed_mesh& a, const placed_mesh& b, const vec3& shift) noexcept {
  const auto& whole = b.nodes_.front();
  double best = 0.0;
  // No point of a ball is deeper than its centre by more than the radius: most promising balls first, until none can be
  // deeper than the deepest vertex by more than a fiftieth.
  struct ball {
    double most;
    std::uint32_t node;
    bool operator<(const ball& other) const noexcept { return most < other.most; }
  };
  std::vector<ball> heap;
  const auto enough = [&](double most) { return most <= 1.02 * best; };
  const auto add = [&](std::uint32_t index) {
    const auto& n = a.nodes_[index];
    if (box_distance2(n.low + shift, n.high + shift, whole.low, whole.high) > 0.0) return;
    const vec3 centre = 0.5 * (n.low + n.high) + shift;
    const double radius = 0.5 * glm::length(n.high - n.low), away = b.distance_to(centre);
    const double most = away + radius;
    if (enough(most)) return;
    // Nearer to the surface than its radius a ball has parts on both sides.
    if (away > radius && !b.contains(centre)) return;
    heap.push_back({away > radius || b.contains(centre) ? most : radius - away, index});
    std::push_heap(heap.begin(), heap.end());
  };
  add(0);
  while (!heap.empty() && !enough(heap.front().most)) {
    std::pop_heap(heap.begin(), heap.end());
    const std::uint32_t index = heap.back().node;
    heap.pop_back();
    const auto& n = a.nodes_[index];
    if (n.count == 0) {
      add(index + 1);
      add(n.right);
      continue;
    }
    for (std::uint32_t t = n.first; t < n.first + n.count; ++t) {
      for (const std::uint32_t v : a.triangles_[t]) {
        const vec3 p = a.points_[v] + shift;
        const double deep = b.distance_to(p);
        if (deep > best && b.contains(p)) best = deep;
      }
    }
  }
  return best;
}

}  // namespace asperity::oracle
