#include "law/truth/originals_depth.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <numbers>

namespace asperity::truth {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr std::size_t cells_along = 48;

double squared(const vec3& v) { return glm::dot(v, v); }

double to_segment2(const vec3& p, const vec3& a, const vec3& b) {
  const vec3 e = b - a;
  const double l = squared(e);
  return squared(p - a - (l > 0.0 ? std::clamp(glm::dot(p - a, e) / l, 0.0, 1.0) : 0.0) * e);
}

double to_triangle2(const vec3& p, const std::array<vec3, 3>& t) {
  const vec3 n = glm::cross(t[1] - t[0], t[2] - t[0]);
  bool over = squared(n) > 0.0;
  for (std::size_t k = 0; k < 3; ++k) over = over && glm::dot(glm::cross(t[(k + 1) % 3] - t[k], p - t[k]), n) >= 0.0;
  if (over) {
    const double height = glm::dot(p - t[0], n);
    return height * height / squared(n);
  }
  return std::min({to_segment2(p, t[0], t[1]), to_segment2(p, t[1], t[2]), to_segment2(p, t[2], t[0])});
}

// One surface near a place, seen along n: z is the way along n, from the asked point.
struct seen_surface {
  std::vector<std::array<vec3, 3>> triangles;  // those that look along n (of A) or against it (of B)
  double side = 1.0;                           // 1: the highest counts; -1: the lowest
  double radius_m = 0.0;

  // Height over (x, y), as far as it is within the ball; minus infinity times the side where there is none.
  [[nodiscard]] double at(double x, double y) const {
    double best = -infinity;
    for (const auto& t : triangles) {
      const double w0 = cross2(x, y, t[1], t[2]), w1 = cross2(x, y, t[2], t[0]), w2 = cross2(x, y, t[0], t[1]);
      const double sum = w0 + w1 + w2;
      if (sum == 0.0) continue;
      const double slack = -1e-9 * std::fabs(sum);
      if (std::min({w0 / sum, w1 / sum, w2 / sum}) * std::fabs(sum) < slack) continue;
      keep(x, y, (w0 * t[0].z + w1 * t[1].z + w2 * t[2].z) / sum, best);
    }
    return side * best;
  }
  void keep(double x, double y, double z, double& best) const {
    if (x * x + y * y + z * z <= radius_m * radius_m) best = std::max(best, side * z);
  }
  static double cross2(double x, double y, const vec3& a, const vec3& b) {
    return (a.x - x) * (b.y - y) - (a.y - y) * (b.x - x);
  }
};

struct axes {
  vec3 u, v, n;
  [[nodiscard]] vec3 of(const vec3& p) const { return {glm::dot(p, u), glm::dot(p, v), glm::dot(p, n)}; }
};

axes axes_along(const vec3& n) {
  const vec3 other = std::fabs(n.x) < 0.6 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0);
  const vec3 u = glm::normalize(glm::cross(other, n));
  return {u, glm::cross(n, u), n};
}

seen_surface look(const near_triangles& body, const pose& T_w, const vec3& point_w, double radius_m, const axes& along,
                  double side, vec3& mean) {
  std::vector<std::uint32_t> near;
  body.collect(inverse(T_w) * point_w, radius_m, near);
  const mat3 turn = glm::mat3_cast(T_w.rotation);
  seen_surface out;
  out.side = side;
  out.radius_m = radius_m;
  mean = vec3(0.0);
  for (const std::uint32_t i : near) {
    const auto& v = body.mesh().triangles[i];
    std::array<vec3, 3> t;
    for (std::size_t k = 0; k < 3; ++k) t[k] = along.of(turn * body.mesh().positions[v[k]] + T_w.position - point_w);
    const vec3 n = glm::cross(t[1] - t[0], t[2] - t[0]);
    const double length = glm::length(n);
    if (!(length > 0.0) || to_triangle2(vec3(0.0), t) > radius_m * radius_m) continue;
    if (to_triangle2(vec3(0.0), t) < 0.25 * radius_m * radius_m) mean += n;
    if (side * n.z > 1e-9 * length) out.triangles.push_back(t);
  }
  if (squared(mean) > 0.0) {
    mean = glm::normalize(mean);
    mean = mean.x * along.u + mean.y * along.v + mean.z * along.n;
  }
  return out;
}

}  // namespace

near_triangles::near_triangles(const triangle_mesh& mesh) : mesh_(&mesh) {
  low_ = vec3(infinity);
  vec3 high(-infinity);
  for (const vec3& p : mesh.positions) {
    low_ = glm::min(low_, p);
    high = glm::max(high, p);
  }
  const vec3 size = high - low_;
  cell_m_ = std::max({size.x, size.y, size.z, 1e-12}) / static_cast<double>(cells_along);
  for (std::size_t k = 0; k < 3; ++k) {
    cells_[k] = static_cast<std::size_t>(size[static_cast<int>(k)] / cell_m_) + 1;
  }
  in_cell_.resize(cells_[0] * cells_[1] * cells_[2]);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& v = mesh.triangles[t];
    const vec3 &a = mesh.positions[v[0]], &b = mesh.positions[v[1]], &c = mesh.positions[v[2]];
    const auto first = cell_of(glm::min(a, glm::min(b, c))), last = cell_of(glm::max(a, glm::max(b, c)));
    for (std::size_t k = first[2]; k <= last[2]; ++k) {
      for (std::size_t j = first[1]; j <= last[1]; ++j) {
        for (std::size_t i = first[0]; i <= last[0]; ++i) in_cell_[(k * cells_[1] + j) * cells_[0] + i].push_back(t);
      }
    }
  }
}

std::array<std::size_t, 3> near_triangles::cell_of(const vec3& p_b) const noexcept {
  std::array<std::size_t, 3> out{};
  for (std::size_t k = 0; k < 3; ++k) {
    const int axis = static_cast<int>(k);
    out[k] = static_cast<std::size_t>(
        std::clamp((p_b[axis] - low_[axis]) / cell_m_, 0.0, static_cast<double>(cells_[k]) - 1.0));
  }
  return out;
}

void near_triangles::collect(const vec3& centre_b, double radius_m, std::vector<std::uint32_t>& out) const {
  out.clear();
  const auto first = cell_of(centre_b - radius_m), last = cell_of(centre_b + radius_m);
  for (std::size_t k = first[2]; k <= last[2]; ++k) {
    for (std::size_t j = first[1]; j <= last[1]; ++j) {
      for (std::size_t i = first[0]; i <= last[0]; ++i) {
        const auto& in = in_cell_[(k * cells_[1] + j) * cells_[0] + i];
        out.insert(out.end(), in.begin(), in.end());
      }
    }
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
}

double near_triangles::distance(const vec3& p_b, double at_most_m) const {
  std::vector<std::uint32_t> near;
  collect(p_b, at_most_m, near);
  double best = at_most_m * at_most_m;
  for (const std::uint32_t i : near) {
    const auto& v = mesh_->triangles[i];
    best = std::min(best, to_triangle2(p_b, {mesh_->positions[v[0]], mesh_->positions[v[1]], mesh_->positions[v[2]]}));
  }
  return std::sqrt(best);
}

double near_triangles::turn_rad(const vec3& centre_b, double radius_m) const {
  std::vector<std::uint32_t> near;
  collect(centre_b, radius_m, near);
  std::vector<vec3> normals;
  vec3 mean(0.0);
  for (const std::uint32_t i : near) {
    const auto& v = mesh_->triangles[i];
    const std::array<vec3, 3> t{mesh_->positions[v[0]], mesh_->positions[v[1]], mesh_->positions[v[2]]};
    const vec3 n = glm::cross(t[1] - t[0], t[2] - t[0]);
    if (!(squared(n) > 0.0) || to_triangle2(centre_b, t) > radius_m * radius_m) continue;
    mean += n;
    normals.push_back(glm::normalize(n));
  }
  double least = -1.0;
  if (squared(mean) > 0.0) {
    mean = glm::normalize(mean);
    least = 1.0;
    for (const vec3& n : normals) least = std::min(least, glm::dot(n, mean));
  }
  return std::acos(std::clamp(least, -1.0, 1.0));
}

place_depth depth_near(const near_triangles& a, const pose& T_wa, const near_triangles& b, const pose& T_wb,
                       const asked_place& at) {
  const axes along = axes_along(at.n_ab_w);
  place_depth out;
  const seen_surface on_a = look(a, T_wa, at.point_a_w, at.radius_m, along, 1.0, out.out_a_w);
  const seen_surface on_b = look(b, T_wb, at.point_b_w, at.radius_m, along, -1.0, out.out_b_w);
  // Heights are from either point; the two differ by this.
  const double apart = glm::dot(at.point_a_w - at.point_b_w, at.n_ab_w);
  double best = -infinity, nearest2 = infinity;
  const auto ask = [&](double x, double y, double least_a, double most_b) {
    const double za = std::max(least_a, on_a.at(x, y)), zb = std::min(most_b, on_b.at(x, y));
    const double depth = std::isfinite(za) && std::isfinite(zb) ? za - zb + apart : -infinity;
    best = std::max(best, depth);
    const double aside2 = x * x + y * y;
    if (std::isfinite(depth) && aside2 < nearest2) {
      nearest2 = aside2;
      out.at_place_m = depth;
    }
  };
  const auto within = [&](const vec3& p) { return squared(p) <= at.radius_m * at.radius_m; };
  ask(0.0, 0.0, -infinity, infinity);
  for (const auto& t : on_a.triangles) {
    for (const vec3& p : t) {
      if (within(p)) ask(p.x, p.y, p.z, infinity);
    }
  }
  for (const auto& t : on_b.triangles) {
    for (const vec3& p : t) {
      if (within(p)) ask(p.x, p.y, -infinity, p.z);
    }
  }
  for (const auto& s : on_a.triangles) {
    for (const auto& t : on_b.triangles) {
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
          const vec3 &p = s[i], &q = t[j], u = s[(i + 1) % 3] - p, v = t[(j + 1) % 3] - q;
          const double det = u.x * v.y - u.y * v.x;
          if (det == 0.0) continue;
          const double f = ((q.x - p.x) * v.y - (q.y - p.y) * v.x) / det;
          const double g = ((q.x - p.x) * u.y - (q.y - p.y) * u.x) / det;
          if (!(f >= 0.0 && f <= 1.0 && g >= 0.0 && g <= 1.0)) continue;
          const vec3 on_s = p + f * u, on_t = q + g * v;
          if (within(on_s) && within(on_t)) ask(on_s.x, on_s.y, on_s.z, on_t.z);
        }
      }
    }
  }
  constexpr int rings = 4, spokes = 16;
  for (int r = 1; r <= rings; ++r) {
    for (int k = 0; k < spokes; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / spokes, far = at.radius_m * r / (rings + 0.01);
      ask(far * std::cos(angle), far * std::sin(angle), -infinity, infinity);
    }
  }
  out.found = std::isfinite(best);
  out.depth_m = out.found ? best : 0.0;
  out.aside_m = out.found && std::isfinite(nearest2) ? std::sqrt(nearest2) : 0.0;
  return out;
}

}  // namespace asperity::truth
