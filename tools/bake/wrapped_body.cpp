#include "bake/wrapped_body.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "bake/geometry.hpp"
#include "bake/wrap_sheets.hpp"

namespace asperity::bake {
namespace {

// A gap of the body narrower than so many cells is filled: whether a node lies in it would be chance, and every chance
// a handle.
constexpr double narrow_gap_in_cells = 1.25;
constexpr int halvings = 9;
constexpr int distance_steps = 6;
constexpr std::size_t most_hits = 8;

// Where a segment meets triangles, by the share of its length.
struct segment_hit {
  double at = 0.0;
  bool outwards = false;  // along the segment one leaves by the triangle's front
};
struct segment_hits {
  std::array<segment_hit, most_hits> hit;
  std::size_t count = 0;  // may exceed what is kept
};

segment_hits hits_on(const triangle_bvh& tree, const vec3& p, const vec3& q) {
  segment_hits out;
  const vec3 d = q - p;
  tree.visit_box(glm::min(p, q), glm::max(p, q), [&](std::uint32_t, const std::array<vec3, 3>& c) {
    std::array<double, 3> turn{};
    for (std::size_t k = 0; k < 3; ++k) turn[k] = glm::dot(d, glm::cross(c[k] - p, c[(k + 1) % 3] - p));
    const bool through =
        (turn[0] >= 0.0 && turn[1] >= 0.0 && turn[2] >= 0.0) || (turn[0] <= 0.0 && turn[1] <= 0.0 && turn[2] <= 0.0);
    if (!through) return;
    const vec3 n = area_normal(c);
    const double along = glm::dot(n, d);
    if (along == 0.0) return;
    const double at = glm::dot(n, c[0] - p) / along;
    if (!(at >= 0.0 && at <= 1.0)) return;
    // An edge or a corner is met with each of its triangles.
    for (std::size_t i = 0; i < std::min(out.count, most_hits); ++i)
      if (std::abs(out.hit[i].at - at) < 1e-9 && out.hit[i].outwards == (along > 0.0)) return;
    if (out.count < most_hits) out.hit[out.count] = {at, along > 0.0};
    ++out.count;
  });
  return out;
}

}  // namespace

wrapped_body::wrapped_body(const triangle_mesh& body, const triangle_mesh& plates, const cell_sizes& sizes,
                           unsigned threads)
    : half_(0.5 * sizes.thickness_m), gap_(narrow_gap_in_cells * sizes.cell_m), surface_(without_long_triangles(body)) {
  if (!body.triangles.empty()) {
    body_.emplace(surface_.positions, surface_.triangles, threads);
    field_.emplace(*body_);
  }
  if (!plates.triangles.empty()) plates_.emplace(plates.positions, plates.triangles, threads);
}

float wrapped_body::value(const vec3& p) const noexcept {
  const double wound = winding(p);
  if (wound >= 0.0) return static_cast<float>(wound);
  if (const double depth = plate_depth(p); depth >= 0.0) return static_cast<float>(depth / half_);
  return static_cast<float>(in_narrow_gap(p) ? 0.0 : wound);
}

double wrapped_body::cut(const vec3& inside, const vec3& outside) const noexcept {
  if (winding(inside) < 0.0 && plate_depth(inside) >= 0.0) return cut_plate(inside, outside);
  if (!body_) return 0.5;
  const bool by_plate =
      plates_ && (plate_depth(inside) >= 0.0 ||
                  plates_->closest(inside, half_ + glm::length(outside - inside)).triangle != no_halfedge);
  const segment_hits hits = hits_on(*body_, inside, outside);
  if (!by_plate && hits.count == 1 && winding(inside) >= 0.0 && hits.hit[0].outwards) return hits.hit[0].at;
  double low = 0.0, high = 1.0;
  for (int i = 0; i < halvings; ++i) {
    const double middle = 0.5 * (low + high);
    (value(inside + middle * (outside - inside)) >= 0.0F ? low : high) = middle;
  }
  // A triangle within what is left is where the winding number jumps.
  for (std::size_t i = 0; i < std::min(hits.count, most_hits); ++i)
    if (hits.hit[i].outwards && hits.hit[i].at >= low && hits.hit[i].at <= high) return hits.hit[i].at;
  return 0.5 * (low + high);
}

double wrapped_body::winding(const vec3& p) const noexcept { return field_ ? field_->at(p) - inside_winding : -1.0; }

double wrapped_body::plate_depth(const vec3& p) const noexcept {
  if (!plates_) return -1.0;
  const auto found = plates_->closest(p, half_);
  return found.triangle == no_halfedge ? -1.0 : half_ - found.distance_m;
}

// Is there body on the other side of p too, seen from the nearest surface?
bool wrapped_body::in_narrow_gap(const vec3& p) const noexcept {
  if (!body_) return false;
  const auto wall = body_->closest(p, 0.5 * gap_);
  if (wall.triangle == no_halfedge || !(wall.distance_m > 0.0)) return false;
  return winding(wall.point + gap_ / wall.distance_m * (p - wall.point)) >= 0.0;
}

// The distance from a plate is smooth beside it: false position, and halving where that creeps.
double wrapped_body::cut_plate(const vec3& inside, const vec3& outside) const noexcept {
  const auto depth = [&](double s) { return half_ - plates_->closest(inside + s * (outside - inside)).distance_m; };
  double low = 0.0, high = 1.0, at_low = depth(0.0), at_high = depth(1.0);
  for (int i = 0; i < distance_steps && at_low > at_high; ++i) {
    const double share = std::clamp(at_low / (at_low - at_high), 0.05, 0.95);
    const double middle = low + share * (high - low);
    const double at_middle = depth(middle);
    if (at_middle >= 0.0) {
      low = middle;
      at_low = at_middle;
    } else {
      high = middle;
      at_high = at_middle;
    }
  }
  return at_low > at_high ? low + std::clamp(at_low / (at_low - at_high), 0.0, 1.0) * (high - low) : 0.5 * (low + high);
}

}  // namespace asperity::bake
