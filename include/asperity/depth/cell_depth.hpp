// The depth backend of the shared formulation, on the CPU in double precision.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <span>
#include <utility>

#include "asperity/cells/cell_scene.hpp"
#include "asperity/cells/relief_tap.hpp"
#include "asperity/collision/near_cells.hpp"
#include "asperity/core/status.hpp"
#include "asperity/depth/cell_reading.hpp"
#include "asperity/depth/concept.hpp"
#include "asperity/depth/edge_reading.hpp"
#include "asperity/depth/shared_settings.hpp"

namespace asperity {

/// Measures samples of one body against relief maps of the other, both ways, and pairs of sharp edges.
///
/// A sample over a cell has the depth d = height of the map under it - its own height over the cell's plane. How much
/// it counts, and how deep it may appear, fades with everything that could make it come or go: its clearance from where
/// the cell ends, how squarely its surface faces the cell, and the depth limit. A depth fades in proportion to 1 /
/// sqrt(1 + (d / clearance)^4): the same shape at every scale, so no depth can vanish over a shorter way than its own.
/// @source depth of Eq. 8 of the paper along the cell's normal; the fades are ours (docs/explanation/many-contacts.md)
class cell_depth {
 public:
  using policy_tag = depth_tag;
  using found_type = near_cells;
  using reading_type = cell_reading;

  /// @param settings with tau_m filled in
  cell_depth(std::shared_ptr<const cell_scene> bodies, const scene& models, const shared_settings& settings) noexcept
      : bodies_(std::move(bodies)), centre_of_mass_a_(models.probe->mass.centre_of_mass), settings_(settings) {}

  /// Samples more than this outside have no weight, m.
  [[nodiscard]] static double reach_m(const shared_settings& s) noexcept { return 20.0 * s.tau_m; }

  /// Fills out[i] for near cell i, and behind them one for every pair of edges.
  /// @pre out.size() >= near.size()   @rt safe
  [[nodiscard]] status measure(const scene_pose& at, const near_cells& near,
                               std::span<cell_reading> out) const noexcept {
    if (out.size() < near.size() || at.T_wb.size() != bodies_->fixed.size()) return status::not_ready;
    const vec3 c_w = at.T_wa * centre_of_mass_a_;
    std::size_t n = 0;
    for (const near_cell& c : near.cells()) {
      const surface_cells &A = *bodies_->probe, &B = *bodies_->fixed[c.body];
      const pose& T_wb = at.T_wb[c.body];
      out[n++] = c.on_probe ? measure_cell({A, at.T_wa, B, T_wb, c_w}, c, near.tiles(c))
                            : measure_cell({B, T_wb, A, at.T_wa, c_w}, c, near.tiles(c));
    }
    for (const near_edges& e : near.edges()) {
      out[n++] =
          detail::read_edges(*bodies_->probe, at.T_wa, *bodies_->fixed[e.body], at.T_wb[e.body], c_w, e, settings_);
    }
    return status::ok;
  }

  [[nodiscard]] const shared_settings& settings() const noexcept { return settings_; }
  [[nodiscard]] const cell_scene& bodies() const noexcept { return *bodies_; }
  /// The cells of all bodies, which finder and depth backend share, count here.
  [[nodiscard]] std::size_t heap_bytes() const noexcept { return sizeof(cell_scene) + bodies_->heap_bytes(); }

 private:
  struct pair {
    const surface_cells& Y;  ///< whose cell it is
    const pose& T_wy;
    const surface_cells& X;  ///< whose samples they are
    const pose& T_wx;
    vec3 c_w;
  };

  // Derivatives of a sum by a motion of the samples, in cell coordinates: force-like, and its moment about the origin.
  struct slope {
    vec3 linear{0.0}, moment{0.0};
    vec3 turn_w{0.0};  ///< by a rotation of the samples' body through the fades that depend on direction alone, world
    void add(const vec3& g, const vec3& at) noexcept {
      linear += g;
      moment += glm::cross(at, g);
    }
    void scale(double s) noexcept {
      linear *= s;
      moment *= s;
      turn_w *= s;
    }
  };
  struct sums {
    double reference = -1e9;
    double mass = 0.0, moment = 0.0, overlap = 0.0;
    slope mass_slope, moment_slope, overlap_slope;
    std::array<double, 6> slope_sum{};
    std::array<double, 21> slope_product{};  ///< upper triangle by rows
    vec3 centre{0.0};
    double square = 0.0;
    double deepest = -1e9, area = 0.0;
    vec3 witness{0.0};
    std::uint32_t samples = 0;
    bool too_deep = false;

    void rebase(double to, double tau) noexcept {
      const double s = std::exp((reference - to) / tau);
      reference = to;
      mass *= s;
      moment *= s;
      mass_slope.scale(s);
      moment_slope.scale(s);
      for (double& x : slope_sum) x *= s;
      for (double& x : slope_product) x *= s;
      centre *= s;
      square *= s;
    }
  };
  /// How much direction alone lets a tile count, and how that changes as its body turns (world axes).
  struct facing {
    double factor = 0.0;
    vec3 turn_w{0.0};
  };

  [[nodiscard]] facing facing_of(const surface_cells& X, const sample_origin& origin, const mat3& R_wx,
                                 const vec3& n_w) const noexcept {
    if (origin.outgoing == 0) {
      const vec3 m_w = R_wx * origin.normal_b;
      const double width = settings_.facing_full - settings_.facing_none;
      const double x = (-glm::dot(m_w, n_w) - settings_.facing_none) / width;
      return {smoothstep(x), -smoothstep_slope(x) / width * glm::cross(m_w, n_w)};
    }
    facing out{1.0, vec3(0.0)};
    const double width = settings_.leaving_none - settings_.leaving_full;
    for (const vec3& t_b : std::span(X.outgoing).subspan(origin.first_outgoing, origin.outgoing)) {
      const vec3 t_w = R_wx * t_b;
      const double x = (settings_.leaving_none + glm::dot(t_w, n_w)) / width;
      if (x >= 1.0) continue;
      const double s = smoothstep(x);
      out.turn_w = s * out.turn_w + out.factor * smoothstep_slope(x) / width * glm::cross(t_w, n_w);
      out.factor *= s;
      if (!(out.factor > 0.0)) return {};
    }
    return out;
  }

  [[nodiscard]] cell_reading measure_cell(const pair& p, const near_cell& c,
                                          std::span<const std::uint32_t> tiles) const noexcept {
    const surface_cell& cell = p.Y.cells[c.cell];
    const mat3 R_wy = glm::mat3_cast(p.T_wy.rotation), R_wx = glm::mat3_cast(p.T_wx.rotation);
    const mat3 R_wc = R_wy * mat3(cell.u_b, cell.v_b, cell.n_b);
    const mat3 R_cx = glm::transpose(R_wc) * R_wx;
    const vec3 origin_w = p.T_wy * cell.origin_b;
    const vec3 x_origin = glm::transpose(R_wc) * (p.T_wx.position - origin_w);
    const relief_reader reader{{p.Y, cell}, cell, p.Y.settings.taper_m, 2.0 * p.Y.settings.steepest * cell.pitch_m};

    sums s;
    std::uint32_t known = 0xffffffffU;
    facing face;
    for (const std::uint32_t t : tiles) {
      const sample_tile& tile = p.X.tiles[t];
      if (tile.origin != known) {
        known = tile.origin;
        face = facing_of(p.X, p.X.origins[known], R_wx, R_wc[2]);
      }
      if (!(face.factor > 0.0)) continue;
      for (const surface_sample& sample : std::span(p.X.samples).subspan(tile.first, tile.count)) {
        add_sample(reader, R_cx * vec3(sample.position_b) + x_origin, sample.area_m2, face, s);
      }
    }
    return finish(s, c, R_wc, origin_w - p.c_w, origin_w);
  }

  struct relief_reader {
    detail::relief_map map;
    const surface_cell& cell;
    double taper_m;
    double most_rise_m;
  };

  // One sample at x, in cell coordinates.
  void add_sample(const relief_reader& y, const vec3& x, double area, const facing& face, sums& s) const noexcept {
    const double tau = settings_.tau_m, cut = -reach_m(settings_);
    if (y.cell.highest_m - x.z < cut) return;
    detail::relief_map::place place;
    if (!y.map.find(x.x, x.y, place)) return;
    // The relief of a map has a limited slope, and so has its clearance: one node tells of most samples that they do
    // not count. Twice the steepest slope is more than a surface gains from a node to any point of its square, the
    // spline's overshoot included.
    const relief_node& node = y.map.near_node(place);
    if (node.height_m + y.most_rise_m - x.z < cut || node.clearance_m < -3.0 * y.cell.pitch_m) return;

    const detail::relief_tap tap = y.map.read(place);
    const double d = tap.height_m - x.z, limit = y.cell.depth_limit_m;
    if (d < cut || !(tap.clearance_m > 0.0)) return;
    if (d >= limit) {
      s.too_deep = true;
      return;
    }
    const vec3 d_slope(tap.height_slope.x, tap.height_slope.y, -1.0);
    const vec3 clearance_slope(tap.clearance_slope.x, tap.clearance_slope.y, 0.0);

    // Fades: m of depth and direction, the taper at the cell's end on top of it.
    const double to_limit = 2.0 * (limit - d) / limit;
    const double m = face.factor * smoothstep(to_limit);
    const vec3 m_slope = (face.factor * smoothstep_slope(to_limit) * -2.0 / limit) * d_slope;
    const double across = tap.clearance_m / y.taper_m;
    const double sigma = smoothstep(across);
    const double weight = area * m * sigma;
    if (!(weight > 0.0)) return;
    const vec3 weight_slope = area * (sigma * m_slope + (m * smoothstep_slope(across) / y.taper_m) * clearance_slope);

    // Effective depth e. Outside, e = d; within 2 tau of the surface the fade itself fades in, or e would have a kink.
    double e = d, e_by_face = 0.0;
    vec3 e_slope = d_slope;
    if (d > 0.0) {
      const double r = d / tap.clearance_m, r4 = r * r * r * r;
      const double G = 1.0 / std::sqrt(1.0 + r4), G_by_log_r = -2.0 * r4 * G * G * G;
      const double q = m * G;
      const vec3 q_slope = G * m_slope + m * G_by_log_r * (d_slope / d - clearance_slope / tap.clearance_m);
      const double x_ramp = d / (2.0 * tau), ramp = smoothstep(x_ramp);
      const double ramp_slope = smoothstep_slope(x_ramp) / (2.0 * tau);
      const double kept = 1.0 - (1.0 - q) * ramp;
      e = d * kept;
      e_slope = (kept - d * (1.0 - q) * ramp_slope) * d_slope + d * ramp * q_slope;
      e_by_face = d * ramp * q / face.factor;
    }
    ++s.samples;
    if (e > s.deepest) {
      s.deepest = e;
      s.witness = x;
    }
    const double weight_by_face = weight / face.factor;
    if (e > 0.0) {
      s.area += area;
      s.overlap += weight * e * e;
      s.overlap_slope.add((e * e) * weight_slope + (2.0 * weight * e) * e_slope, x);
      s.overlap_slope.turn_w += (e * (weight_by_face * e + 2.0 * weight * e_by_face)) * face.turn_w;
    }
    if (e > s.reference) s.rebase(e, tau);
    if (e < s.reference - 30.0 * tau) return;  // e^-30: below the last digit of the sum
    const double b = std::exp((e - s.reference) / tau), w = b * weight;
    s.mass += w;
    s.moment += w * e;
    const vec3 mass_slope = b * weight_slope + (w / tau) * e_slope;
    s.mass_slope.add(mass_slope, x);
    s.moment_slope.add(e * mass_slope + w * e_slope, x);
    const double mass_by_face = b * weight_by_face + w / tau * e_by_face;
    s.mass_slope.turn_w += mass_by_face * face.turn_w;
    s.moment_slope.turn_w += (e * mass_by_face + w * e_by_face) * face.turn_w;
    s.centre += w * x;
    s.square += w * glm::dot(x, x);
    if (b < 1e-6) return;  // the stiffness needs no more digits than that
    const vec3 moment = glm::cross(x, e_slope);
    const std::array<double, 6> g{e_slope.x, e_slope.y, e_slope.z, moment.x, moment.y, moment.z};
    for (std::size_t i = 0, n = 0; i < 6; ++i) {
      s.slope_sum[i] += w * g[i];
      for (std::size_t j = i; j < 6; ++j) s.slope_product[n++] += w * g[i] * g[j];
    }
  }

  // From cell coordinates and a motion of the samples to the world and a motion of the probe.
  [[nodiscard]] static cell_reading finish(const sums& s, const near_cell& c, const mat3& R_wc, const vec3& lever_w,
                                           const vec3& origin_w) noexcept {
    cell_reading out;
    out.body = c.body;
    out.samples = s.samples;
    out.too_deep = s.too_deep;
    if (s.samples == 0) return out;
    // Where the samples are B's, a motion of the probe moves the cell instead: the other way round.
    const double sign = c.on_probe ? -1.0 : 1.0;
    const auto lift = [&](const vec3& linear, const vec3& moment, const vec3& turn_w) {
      const vec3 l = R_wc * linear;
      return sign * vec6{l, R_wc * moment + glm::cross(lever_w, l) + turn_w};
    };
    const auto lift_slope = [&](const slope& d) { return lift(d.linear, d.moment, d.turn_w); };
    out.n_ab_w = -sign * R_wc[2];
    if (c.on_probe) out.turn = -skew(out.n_ab_w);
    out.reference_m = s.reference;
    out.mass = s.mass;
    out.moment = s.moment;
    out.overlap = s.overlap;
    out.mass_slope = lift_slope(s.mass_slope);
    out.moment_slope = lift_slope(s.moment_slope);
    out.overlap_slope = lift_slope(s.overlap_slope);
    out.slope_sum = lift({s.slope_sum[0], s.slope_sum[1], s.slope_sum[2]},
                         {s.slope_sum[3], s.slope_sum[4], s.slope_sum[5]}, vec3(0.0));
    mat6 to_world;
    set_block(to_world, 0, 0, R_wc);
    set_block(to_world, 3, 3, R_wc);
    set_block(to_world, 3, 0, skew(lever_w) * R_wc);
    out.slope_product = congruent(to_world, s.slope_product);
    out.depth_m = s.deepest;
    out.witness_w = origin_w + R_wc * s.witness;
    const vec3 centre = s.centre / s.mass;
    out.centre_w = origin_w + R_wc * centre;
    out.spread_m = std::sqrt(std::max(0.0, s.square / s.mass - glm::dot(centre, centre)));
    out.area_m2 = s.area;
    return out;
  }

  // T S T^T of a symmetric S given by its upper triangle.
  [[nodiscard]] static mat6 congruent(const mat6& T, const std::array<double, 21>& upper) noexcept {
    mat6 S, TS, out;
    for (std::size_t i = 0, n = 0; i < 6; ++i) {
      for (std::size_t j = i; j < 6; ++j, ++n) S(i, j) = S(j, i) = upper[n];
    }
    for (std::size_t i = 0; i < 6; ++i) {
      for (std::size_t j = 0; j < 6; ++j) {
        for (std::size_t k = 0; k < 6; ++k) TS(i, j) += T(i, k) * S(k, j);
      }
    }
    for (std::size_t i = 0; i < 6; ++i) {
      for (std::size_t j = i; j < 6; ++j) {
        double sum = 0.0;
        for (std::size_t k = 0; k < 6; ++k) sum += TS(i, k) * T(j, k);
        out(i, j) = out(j, i) = sum;
      }
    }
    return out;
  }

  std::shared_ptr<const cell_scene> bodies_;
  vec3 centre_of_mass_a_;
  shared_settings settings_;
};

static_assert(depth_backend<cell_depth>);

}  // namespace asperity
