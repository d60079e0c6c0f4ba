#include "tile_writer.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace asperity::gl {

using detail::affine;
using detail::edge_side;
using detail::layer;
using detail::projected_triangle;
using detail::window_map;

namespace {

/// a u + b v + c >= 0 is inside; half sizes of the window.
struct half_plane {
  double a, b, c;
  [[nodiscard]] double operator()(const vec2& p) const noexcept { return a * p.x + b * p.y + c; }
};

half_plane edge_of(const projected_triangle& t, std::size_t k, double orientation, double half_m) noexcept {
  // The double-precision raster's own edge, so that its two triangles see the same line here as well.
  const edge_side e(t, k, orientation);
  const double length = std::sqrt(e.per_u * e.per_u + e.per_v * e.per_v);
  return {e.per_u / length, e.per_v / length, e.constant / (length * half_m)};
}

/// Convex polygon of at most seven corners: a rectangle that three half planes were cut from.
struct outline {
  std::array<vec2, 8> corner;
  std::size_t count = 0;

  outline(const vec2& low, const vec2& high) noexcept
      : corner{low, vec2(high.x, low.y), high, vec2(low.x, high.y)}, count(4) {}

  void cut(const half_plane& h) noexcept {
    std::array<vec2, 8> kept{};
    std::size_t n = 0;
    const auto keep = [&](const vec2& p) {
      if (n < kept.size()) kept[n++] = p;
    };
    for (std::size_t i = 0; i < count; ++i) {
      const vec2& p = corner[i];
      const vec2& q = corner[(i + 1) % count];
      const double hp = h(p), hq = h(q);
      if (hp >= 0.0) keep(p);
      if ((hp >= 0.0) != (hq >= 0.0)) keep(p + hp / (hp - hq) * (q - p));
    }
    corner = kept;
    count = n;
  }
};

std::array<float, 4> narrow(double a, double b, double c, double d) noexcept {
  return {static_cast<float>(a), static_cast<float>(b), static_cast<float>(c), static_cast<float>(d)};
}

/// Smallest and largest value over a box of a direction's component.
std::pair<double, double> extent(const displacement_box& box, const vec3& direction) noexcept {
  double low = 0.0, high = 0.0;
  for (int i = 0; i < 3; ++i) {
    const double a = direction[i] * box.low[i], b = direction[i] * box.high[i];
    low += std::min(a, b);
    high += std::max(a, b);
  }
  return {low, high};
}

}  // namespace

tile_writer::tile_writer(scene s, const window_depth_settings& settings, std::uint32_t margin, bool packed)
    : scene_(std::move(s)), settings_(settings), margin_(margin), packed_(packed), patch_([&] {
        std::size_t most = scene_.probe->mesh.triangles.size();
        for (const model_ptr& m : scene_.fixed) most = std::max(most, m->mesh.triangles.size());
        return most;
      }()) {
  std::vector<detail::texture_scale> scales;
  const auto add = [&](const textured_model& m) {
    indices_.emplace_back(m);
    displacements_.push_back(displacement_bounds(m, indices_.back()));
    scales.push_back(measure_texture(m, indices_.back()));
    bad_.push_back(std::any_of(m.texture.texels.begin(), m.texture.texels.end(),
                               [](const glm::vec3& p) { return !is_finite(vec3(p)); })
                       ? 1
                       : 0);
  };
  add(*scene_.probe);
  for (const model_ptr& m : scene_.fixed) {
    add(*m);
    pairs_.push_back(
        scale_of(settings_, scales.front(), scales.back(), std::min(scene_.probe->box.diagonal(), m->box.diagonal())));
  }
}

height_range tile_writer::add(std::span<record_list> lists, std::size_t body_index,
                              std::span<const std::uint32_t> patch, const contact_window& window, const pose& T_w_body,
                              std::array<std::uint32_t, 2> tile) noexcept {
  const layer which = body_index == 0 ? layer::highest : layer::lowest;
  const textured_model& model = body_index == 0 ? *scene_.probe : *scene_.fixed[body_index - 1];
  const double half = window.half_size_m;
  const window_map map(window, T_w_body);
  patch_.project(model.mesh, indices_[body_index], patch, map, which, settings_.facing_cosine);

  triangle_record common{};
  common.tile = {static_cast<float>(tile[0]), static_cast<float>(tile[1])};
  const vec3 axis = map.n_b / half;
  const vec3 centre_b = glm::conjugate(T_w_body.rotation) * (window.centre_w - T_w_body.position);
  const glm::vec3 near(centre_b);
  common.axis = narrow(axis.x, axis.y, axis.z, 0.0);
  common.near = narrow(near.x, near.y, near.z, glm::dot(axis, centre_b - vec3(near)));

  height_range range;
  const double reach = half * tile_samples() / settings_.grid;
  for (const projected_triangle& t : patch_.triangles()) {
    if (include(range, t, displacements_[body_index][t.triangle], map.n_b, reach)) write(lists, t, common, which, half);
  }
  return range;
}

bool tile_writer::include(height_range& to, const projected_triangle& t, const displacement_box& displacement,
                          const vec3& n_b, double reach_m) const noexcept {
  vec3 low = t.corner[0], high = t.corner[0];
  for (const vec3& c : t.corner) {
    low = glm::min(low, c);
    high = glm::max(high, c);
  }
  if (low.x > reach_m || low.y > reach_m || high.x < -reach_m || high.y < -reach_m) return false;
  const double slope = reach_m * (std::fabs(t.height.per_u) + std::fabs(t.height.per_v));
  const auto [leaves_low, leaves_high] = extent(displacement, n_b);
  to.include(std::max(low.z, t.height.at_centre - slope) + leaves_low,
             std::min(high.z, t.height.at_centre + slope) + leaves_high);
  return true;
}

void tile_writer::write(std::span<record_list> lists, const projected_triangle& t, const triangle_record& common,
                        layer which, double half_m) const noexcept {
  triangle_record r = common;
  const double s = detail::sign(which);
  const std::array edges{edge_of(t, 0, s, half_m), edge_of(t, 1, s, half_m), edge_of(t, 2, s, half_m)};
  const vec3 middle = (t.corner[0] + t.corner[1] + t.corner[2]) / 3.0;
  const double u = std::clamp(middle.x, -half_m, half_m), v = std::clamp(middle.y, -half_m, half_m);
  // Texel positions are counted from one near the samples, so that they are small.
  const auto base_of = [&](const affine& f) { return std::clamp(std::floor(f(u, v)), -1e6, 1e6); };
  const double base_x = base_of(t.texel_x), base_y = base_of(t.texel_y);
  r.edge_0 = narrow(edges[0].a, edges[0].b, edges[0].c, base_x);
  r.edge_1 = narrow(edges[1].a, edges[1].b, edges[1].c, base_y);
  r.edge_2 = narrow(edges[2].a, edges[2].b, edges[2].c, s);
  const auto at = [&](const affine& f, double base, double last) {
    return narrow(f.per_u * half_m, f.per_v * half_m, f.at_centre - base, last);
  };
  r.texel_x = at(t.texel_x, base_x, t.height.at_centre / half_m);
  r.texel_y = at(t.texel_y, base_y, t.height.per_u);
  r.axis[3] = static_cast<float>(t.height.per_v);

  const double extent = static_cast<double>(tile_samples()) / settings_.grid;
  const double pixels = 0.5 * settings_.grid;  // per half size
  for (std::size_t quarter = 0; quarter < quarters(); ++quarter) {
    const bool far_u = (quarter & 1) != 0, far_v = (quarter & 2) != 0;
    outline o(vec2(-extent), vec2(extent));
    if (packed_) {
      o = outline({far_u ? 0.0 : -extent, far_v ? 0.0 : -extent}, {far_u ? extent : 0.0, far_v ? extent : 0.0});
    }
    // An eighth of a pixel beyond the edges, far more than a rasteriser's fixed-point corners lose.
    for (const half_plane& e : edges) o.cut({e.a, e.b, e.c + 0.125 / pixels});
    if (o.count < 3) continue;
    for (std::size_t k = 0; k < r.corner.size(); ++k) {
      const vec2 p = (o.corner[std::min(k, o.count - 1)] + extent) * pixels;
      r.corner[k] = {static_cast<float>(far_u ? 2.0 * extent * pixels - p.x : p.x),
                     static_cast<float>(far_v ? 2.0 * extent * pixels - p.y : p.y)};
    }
    lists[quarter].add(r);
  }
}

std::size_t tile_writer::heap_bytes() const noexcept {
  std::size_t bytes = asperity::heap_bytes(scene_.fixed, indices_, pairs_, patch_, bad_);
  for (const auto& r : displacements_) bytes += asperity::heap_bytes(r);
  return bytes + displacements_.capacity() * sizeof(decltype(displacements_)::value_type);
}

}  // namespace asperity::gl
