// The force model of the shared formulation: one energy per body pair, and its exact gradient.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "asperity/collision/contact.hpp"
#include "asperity/collision/near_cells.hpp"
#include "asperity/core/memory.hpp"
#include "asperity/core/reserve_resident.hpp"
#include "asperity/core/status.hpp"
#include "asperity/depth/cell_reading.hpp"
#include "asperity/depth/shared_settings.hpp"
#include "asperity/force/concept.hpp"
#include "asperity/force/direction_sameness.hpp"

namespace asperity {

/// Adds the readings of all cells of a body pair up to one energy; the wrench is minus its gradient:
///
///     U = k/2 sum_g s_g max(del_g, 0)^2
///     del_g = sum_h q_gh y_gh / sum_h q_gh          depth of direction g, a soft maximum over all cells h
///     q_gh = K_gh exp((K_gh max(lam_h, 0) + min(lam_h, 0)) / tau),   y_gh = K_gh max(V_h, 0) + min(V_h, 0)
///     s_g = M_g / sum_h K_gh M_h                    its share of the spring
///
/// V_h is the Boltzmann mean depth of a reading, lam_h = tau ln(mass_h / a0), M_h its overlap; in the third line max
/// and min are rounded off within tau, or the force would jump where a reading crosses the surface. K_gh falls smoothly
/// from 1 to 0 as the angle between two directions grows from 25 to 60 degrees. So cells that face the same way share
/// one spring however many they are, cells that clearly do not have one each, and nothing in between jumps.
/// A conservative force by construction: it has a potential.
///
/// J = -k sum_g s_g (grad del_g grad del_g^T + del_g C_g), C_g the spread of the samples' slopes over tau; it leaves
/// out how shares and weights change, which has no definite sign.
/// @rt safe   @source ours; the paper adds the springs of hard clusters up (its section 5.1)
class shared_potential {
 public:
  using policy_tag = force_tag;
  using found_type = near_cells;
  using reading_type = cell_reading;

  /// @param settings with tau_m filled in   @param readings most that one call brings, over all bodies
  shared_potential(const shared_settings& settings, std::size_t readings)
      : settings_(settings), sameness_(settings.same_direction_rad, settings.other_direction_rad) {
    detail::reserve_resident(terms_, readings);
  }

  // A copy would have no room for terms, and those of its last call would point to another one's readings.
  shared_potential(const shared_potential&) = delete;
  shared_potential& operator=(const shared_potential&) = delete;
  shared_potential(shared_potential&&) noexcept = default;
  shared_potential& operator=(shared_potential&&) noexcept = default;
  ~shared_potential() = default;

  /// Adds up the readings of what was found. @pre readings.size() >= found.size()
  /// @return ok | not_ready (too few readings, or more than the constructor was told) | not_finite; the last two leave
  /// zeros
  [[nodiscard]] status accumulate(const near_cells& found, std::span<const cell_reading> readings,
                                  contact_force& out) const noexcept {
    out = {};
    terms_.clear();
    energy_j_ = 0.0;
    if (readings.size() < found.size() || found.size() > terms_.capacity()) return status::not_ready;
    readings = readings.first(found.size());
    const auto refuse = [&]() noexcept {
      terms_.clear();
      energy_j_ = 0.0;
      return status::not_finite;
    };
    for (const cell_reading& r : readings) {
      const bool finite = std::isfinite(r.mass) && std::isfinite(r.moment) && std::isfinite(r.overlap) &&
                          std::isfinite(r.reference_m) && is_finite(r.n_ab_w);
      if (!finite) return refuse();
      if (r.mass > 0.0) terms_.push_back(make_term(r));
    }
    contact_force sum;
    vec6 gradient;
    for (std::size_t g = 0; g < terms_.size(); ++g) {
      if (terms_[g].reading->overlap > 0.0) add_direction(g, gradient, sum.stiffness);
    }
    for (const term& t : terms_) {
      gradient += t.by_mass * t.reading->mass_slope;
      gradient += t.by_moment * t.reading->moment_slope;
      gradient += t.by_overlap * t.reading->overlap_slope;
    }
    sum.on_probe_w = to_wrench(-1.0 * gradient);
    if (!is_finite(sum.on_probe_w) || !is_finite(sum.stiffness)) return refuse();
    out = sum;
    return status::ok;
  }

  /// Of the last call, J.
  [[nodiscard]] double energy_j() const noexcept { return energy_j_; }

  /// What a person would call the contacts of the last call: readings of one body and nearly one direction are one.
  /// For reports and plots; the force knows nothing of it. Contacts outside, within reach, are told too, as gaps.
  /// @pre the readings of the last call are still there   @rt safe
  void describe(contact_set& contacts, std::span<penetration> depths) const noexcept {
    contacts.clear();
    for (term& t : terms_) t.told = false;
    for (;;) {
      term* first = nullptr;
      for (term& t : terms_) {
        if (!t.told && (first == nullptr || leads(t, *first))) first = &t;
      }
      if (first == nullptr || contacts.size() == depths.size()) return;
      penetration& depth = depths[contacts.size()];
      if (!contacts.add(tell(*first, depth, static_cast<std::uint32_t>(contacts.size())), {}, {})) return;
    }
  }

  [[nodiscard]] const shared_settings& settings() const noexcept { return settings_; }
  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(terms_); }

 private:
  struct term {
    const cell_reading* reading;
    double log_mass_m;  ///< lam
    double value_m;     ///< V
    vec6 log_mass_slope, value_slope;
    double by_mass = 0.0, by_moment = 0.0, by_overlap = 0.0;  ///< derivatives of the energy
    double depth_m = 0.0, share = 0.0;
    vec6 gradient{};
    mat6 curvature{};
    // Of the direction that is being added up:
    double same = 0.0, boltzmann = 0.0, shown_m = 0.0;
    bool told = false;
  };

  // Which of two readings a report begins with.
  [[nodiscard]] static bool leads(const term& a, const term& b) noexcept {
    const double x = a.reading->overlap, y = b.reading->overlap;
    return x != y ? x > y : a.value_m > b.value_m;
  }

  // Gathers what faces the way that `first` does.
  [[nodiscard]] contact tell(term& first, penetration& depth, std::uint32_t id) const noexcept {
    const vec3 n_first = first.reading->n_ab_w;
    const auto together = [&](const term& t) {
      return !t.told && t.reading->body == first.reading->body && sameness_(n_first, t.reading->n_ab_w) >= 0.5;
    };
    const bool overlaps = first.reading->overlap > 0.0;
    const auto weight_of = [&](const term& t) {
      return overlaps ? t.share : std::exp((t.log_mass_m - first.log_mass_m) / settings_.tau_m);
    };
    depth = {};
    depth.depth_m = first.reading->depth_m;
    depth.witness_w = first.reading->witness_w;
    vec3 direction(0.0), centre(0.0);
    double sum = 0.0, square = 0.0;
    for (const term& t : terms_) {
      if (!together(t)) continue;
      const cell_reading& r = *t.reading;
      const double w = weight_of(t);
      sum += w;
      direction += w * r.n_ab_w;
      centre += w * r.centre_w;
      square += w * (r.spread_m * r.spread_m + glm::dot(r.centre_w, r.centre_w));
      depth.soft_depth_m += w * (overlaps ? t.depth_m : t.value_m);
      depth.gradient += w * (overlaps ? t.gradient : t.value_slope);
      depth.curvature += w * t.curvature;
      depth.area_m2 += r.area_m2;
      depth.samples += r.samples;
      if (r.too_deep) depth.flags |= depth_flag::saturated;
      if (r.depth_m > depth.depth_m) {
        depth.depth_m = r.depth_m;
        depth.witness_w = r.witness_w;
      }
    }
    contact out;
    if (sum > 0.0) {
      centre /= sum;
      depth.soft_depth_m /= sum;
      depth.gradient = (1.0 / sum) * depth.gradient;
      depth.curvature = (1.0 / sum) * depth.curvature;
    } else {  // a reading whose weight is below the last digit
      centre = first.reading->centre_w;
      direction = n_first;
    }
    const double length = glm::length(direction);
    contact_window& window = out.window;
    window.n_ab_w = length > 0.0 ? direction / length : n_first;
    window.u_w = any_orthogonal(window.n_ab_w);
    window.v_w = glm::cross(window.n_ab_w, window.u_w);
    window.centre_w = centre;
    // A disc of constant weight reaches sqrt(2) times its root mean square radius.
    window.half_size_m = sum > 0.0 ? std::sqrt(2.0 * std::max(0.0, square / sum - glm::dot(centre, centre))) : 0.0;
    out.p_a_w = centre + 0.5 * depth.depth_m * window.n_ab_w;
    out.p_b_w = centre - 0.5 * depth.depth_m * window.n_ab_w;
    out.separation_m = -depth.depth_m;
    out.body = first.reading->body;
    out.id = id;
    for (term& t : terms_) {
      if (&t != &first && together(t)) t.told = true;
    }
    first.told = true;
    return out;
  }

  [[nodiscard]] term make_term(const cell_reading& r) const noexcept {
    // The unit that masses are counted in. Any constant would do: it moves the point where a reading that is barely
    // outside stops being held back by K.
    constexpr double unit_area_m2 = 1.6e-7;
    const double tau = settings_.tau_m;
    term t{};
    t.reading = &r;
    t.log_mass_m = r.reference_m + tau * std::log(r.mass / unit_area_m2);
    t.value_m = r.moment / r.mass;
    t.log_mass_slope = (tau / r.mass) * r.mass_slope;
    t.value_slope = (1.0 / r.mass) * (r.moment_slope - t.value_m * r.mass_slope);
    return t;
  }

  // Adds the spring of direction g to energy and stiffness, and notes how the energy changes with every reading.
  void add_direction(std::size_t g, vec6& gradient, mat6& stiffness) const noexcept {
    const double tau = settings_.tau_m, k = settings_.stiffness_n_per_m;
    term& own = terms_[g];
    const cell_reading& r = *own.reading;
    double overlap = 0.0, largest = -1e9;
    for (term& t : terms_) {
      t.same = t.reading->body != r.body ? 0.0 : (&t == &own ? 1.0 : sameness_(r.n_ab_w, t.reading->n_ab_w));
      if (!(t.same > 0.0)) continue;
      t.boltzmann = t.log_mass_m - (1.0 - t.same) * above_surface(t.log_mass_m);
      t.shown_m = t.value_m - (1.0 - t.same) * above_surface(t.value_m);
      largest = std::max(largest, t.boltzmann);
      overlap += t.same * t.reading->overlap;
    }
    double sum = 0.0, mean = 0.0;
    for (term& t : terms_) {
      if (!(t.same > 0.0)) continue;
      t.boltzmann = std::exp((t.boltzmann - largest) / tau);
      sum += t.same * t.boltzmann;
      mean += t.same * t.boltzmann * t.shown_m;
    }
    own.depth_m = mean / sum;
    own.share = r.overlap / overlap;
    if (!(own.depth_m > 0.0)) return;
    energy_j_ += 0.5 * k * own.share * own.depth_m * own.depth_m;
    const double by_share = 0.5 * k * own.depth_m * own.depth_m, by_depth = k * own.share * own.depth_m;
    own.by_overlap += by_share / overlap;

    vec6 slope, slope_mean;
    mat6 product;
    for (term& t : terms_) {
      if (!(t.same > 0.0)) continue;
      const cell_reading& h = *t.reading;
      const double p = t.same * t.boltzmann / sum, above = t.shown_m - own.depth_m;
      if (p < 1e-14 && h.overlap <= 0.0) continue;  // nothing that the sum could hold
      const double by_value = p * (1.0 - (1.0 - t.same) * above_surface_slope(t.value_m));
      const double by_log_mass = p * above * (1.0 - (1.0 - t.same) * above_surface_slope(t.log_mass_m)) / tau;
      t.by_overlap -= by_share * r.overlap * t.same / (overlap * overlap);
      t.by_mass += by_depth * (by_log_mass * tau - by_value * t.value_m) / h.mass;
      t.by_moment += by_depth * by_value / h.mass;
      slope += by_value * t.value_slope + by_log_mass * t.log_mass_slope;
      slope_mean += (p / h.mass) * h.slope_sum;
      product += (p / h.mass) * h.slope_product;
      const double by_same = -by_share * r.overlap * h.overlap / (overlap * overlap) +
                             by_depth * (t.boltzmann / sum * above + p * above * above_surface(t.log_mass_m) / tau +
                                         p * above_surface(t.value_m));
      gradient.angular += by_same * same_turn(r, h, &t == &own);
    }
    own.gradient = slope;
    add_outer(product, -1.0, slope_mean);
    for (double& x : product.m) x /= tau;
    own.curvature = product;
    add_outer(stiffness, -k * own.share, slope);
    stiffness += (-k * own.share * own.depth_m) * product;
  }

  // max(x, 0), rounded off within tau of the surface: a corner of the energy would be a jump of the force.
  [[nodiscard]] double above_surface(double x) const noexcept {
    const double tau = settings_.tau_m, lifted = x + tau;
    return x >= tau ? x : (x <= -tau ? 0.0 : lifted * lifted / (4.0 * tau));
  }
  [[nodiscard]] double above_surface_slope(double x) const noexcept {
    return std::clamp(0.5 * (x / settings_.tau_m + 1.0), 0.0, 1.0);
  }

  // d K_gh / d(rotation of the probe).
  [[nodiscard]] vec3 same_turn(const cell_reading& g, const cell_reading& h, bool same) const noexcept {
    if (same) return vec3(0.0);
    const double s = sameness_.slope(g.n_ab_w, h.n_ab_w);
    return s == 0.0 ? vec3(0.0) : s * (glm::transpose(g.turn) * h.n_ab_w + glm::transpose(h.turn) * g.n_ab_w);
  }

  shared_settings settings_;
  detail::direction_sameness sameness_;
  // Working space, and what the last call can still be asked about. No call reads what another one left.
  mutable std::vector<term> terms_;
  mutable double energy_j_ = 0.0;
};

static_assert(force_model<shared_potential>);
static_assert(describes_contacts<shared_potential>);

}  // namespace asperity
