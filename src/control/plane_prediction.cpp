#include "asperity/control/plane_prediction.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>

#include "asperity/control/plane_selection.hpp"
#include "control/rest_of.hpp"

namespace asperity {

void rest_prediction::complete(const plane_source& planes_near, const coupling_pull& pull, const pose& T_wc,
                               support_planes& planes) noexcept {
  const bool known = known_;
  known_ = false;
  if (!planes_near || planes.empty()) return;
  if (!(pull.stiffness_n_per_m > 0.0) || !(pull.stiffness_n_m_per_rad > 0.0) || !is_finite(pull.on_probe_w)) return;
  pull_ = pull;
  if (!begin(planes_near, known, known ? pose_difference(rest_T_wc_, T_wc) : vec6{})) return;
  search(planes_near);
  rest_T_wc_ = {glm::normalize(exp_rotation(here().moved.angular) * T_wc.rotation),
                T_wc.position + here().moved.linear};
  known_ = true;
  if (come_near(planes_near)) report(planes);
}

double rest_prediction::depth_at(const support_plane& reported_at_0, const vec6& moved) noexcept {
  return reported_at_0.depth_m + dot(reported_at_0.gradient, moved);
}

bool rest_prediction::look(const plane_source& planes_near, const vec6& moved, place& out) noexcept {
  const status answer = planes_near(moved, -gap_m, out.planes);
  if (answer != status::ok && answer != status::capacity_reached) return false;
  if (!std::all_of(out.planes.begin(), out.planes.end(), [](const support_plane& p) { return is_finite(p); })) {
    return false;
  }
  out.moved = moved;
  out.complete_to_m = -gap_m;
  if (out.planes.full()) {
    const auto by_depth = [](const support_plane& p, const support_plane& q) { return p.depth_m < q.depth_m; };
    out.complete_to_m = std::min_element(out.planes.begin(), out.planes.end(), by_depth)->depth_m;
  }
  const vec6 f = to_vec6(pull_.on_probe_w);
  double energy_j = -dot(f, moved);
  energy_j += 0.5 * pull_.stiffness_n_per_m * glm::dot(moved.linear, moved.linear) +
              0.5 * pull_.stiffness_n_m_per_rad * glm::dot(moved.angular, moved.angular);
  for (const support_plane& p : out.planes) {
    energy_j += 0.5 * laws_.stiffness_n_per_m(p) * std::max(0.0, p.depth_m) * std::max(0.0, p.depth_m);
  }
  out.energy_j = energy_j;
  return std::isfinite(energy_j);
}

bool rest_prediction::begin(const plane_source& planes_near, bool known, const vec6& rest) noexcept {
  constexpr double here_share = 0.02;
  const double share = detail::share_of_furthest(rest);
  if (known && share < here_share) return look(planes_near, rest, here());
  if (!look(planes_near, {}, here())) return false;
  if (!known || share > detail::most_ways) return true;
  if (!look(planes_near, rest, there())) return false;
  if (there().energy_j < here().energy_j) here_ = 1 - here_;
  return true;
}

const support_plane* rest_prediction::same_in(std::span<const support_plane> planes, const support_plane& p) noexcept {
  const auto found =
      std::find_if(planes.begin(), planes.end(), [&](const support_plane& q) { return detail::same_point(p, q); });
  return found == planes.end() ? nullptr : &*found;
}

support_plane rest_prediction::as_from_here(const support_plane& p, const vec6& from) noexcept {
  support_plane out = p;
  out.depth_m -= dot(p.gradient, from);
  return out;
}

void rest_prediction::search(const plane_source& planes_near) noexcept {
  constexpr int most_trials = 6;
  constexpr double still_m = 5e-8, still_rad = 2.5e-6;
  double reach = 1.0;
  cuts_.clear();
  for (int trial = 0; trial < most_trials; ++trial) {
    all_.clear();
    for (const support_plane& p : here().planes) static_cast<void>(all_.push_back(as_from_here(p, here().moved)));
    for (const support_plane& p : cuts_) static_cast<void>(all_.push_back(p));
    const vec6 way = detail::rest_of(pull_, {all_.data(), all_.size()}, laws_) - here().moved;
    const double share = detail::share_of_furthest(way);
    if (share * detail::furthest_rest_m < still_m && share * detail::furthest_rest_rad < still_rad) return;
    const vec6 step = share > reach ? (reach / share) * way : way;
    if (!look(planes_near, here().moved + step, there())) return;
    if (there().energy_j < here().energy_j) {
      go_there();
    } else if (!add_cuts()) {
      reach = 0.25 * std::min(reach, share);
    }
  }
}

void rest_prediction::go_there() noexcept {
  cuts_.clear();
  for (const support_plane& p : all_) {
    const support_plane* const now = same_in({there().planes.data(), there().planes.size()}, p);
    const double said_m = depth_at(p, there().moved);
    if (now != nullptr && said_m > -gap_m && said_m < now->depth_m - kink_m) keep(p);
  }
  here_ = 1 - here_;
}

bool rest_prediction::add_cuts() noexcept {
  bool added = false;
  for (const support_plane& p : there().planes) {
    const support_plane from_here = as_from_here(p, there().moved);
    const support_plane* const now = same_in({here().planes.data(), here().planes.size()}, p);
    const double most_m = now != nullptr ? now->depth_m + agrees_m : here().complete_to_m;
    if (depth_at(from_here, here().moved) > most_m) continue;
    if (now != nullptr && depth_at(as_from_here(*now, here().moved), there().moved) > p.depth_m - kink_m) continue;
    const bool is_cut = std::any_of(cuts_.begin(), cuts_.end(), [&](const support_plane& q) {
      return detail::same_point(p, q) && depth_at(q, there().moved) > p.depth_m - kink_m;
    });
    if (is_cut) continue;
    added = keep(from_here) || added;
  }
  return added;
}

bool rest_prediction::keep(const support_plane& p) noexcept {
  if (cuts_.size() == most_cuts) return false;
  return cuts_.push_back(p);
}

bool rest_prediction::come_near(const plane_source& planes_near) noexcept {
  const double ways = detail::share_of_furthest(here().moved);
  if (!(ways > 1.0)) return true;
  cuts_.clear();
  return look(planes_near, (1.0 / ways) * here().moved, here());
}

double rest_prediction::choose(support_planes& out) const noexcept {
  constexpr plane_selection small_motions{.tilt_rad = 5e-4, .slide_m = 1e-5};
  const plane_list& planes = here().planes;
  out.clear();
  if (planes.size() <= most_of_a_contact) {
    for (const support_plane& p : planes) static_cast<void>(out.push_back(p));
    return here().complete_to_m;
  }
  static_cast<void>(select_planes({planes.data(), planes.size()}, small_motions, out, most_of_a_contact));
  std::array<std::uint16_t, plane_list::capacity()> order;
  const auto end = order.begin() + static_cast<std::ptrdiff_t>(planes.size());
  std::iota(order.begin(), end, std::uint16_t{0});
  std::sort(order.begin(), end, [&](std::uint16_t i, std::uint16_t j) {
    return planes[i].depth_m != planes[j].depth_m ? planes[i].depth_m > planes[j].depth_m : i < j;
  });
  for (auto i = order.begin(); i != end; ++i) {
    const support_plane& p = planes[*i];
    if (same_in({out.data(), out.size()}, p) != nullptr) continue;
    if (out.size() == most_of_a_contact) return p.depth_m;
    static_cast<void>(out.push_back(p));
  }
  return here().complete_to_m;
}

void rest_prediction::report(support_planes& planes) noexcept {
  const support_planes own = planes;
  const double complete_to_m = choose(planes);
  const std::size_t chosen = planes.size();
  for (support_plane& p : planes) p = as_from_here(p, here().moved);
  for (const support_plane& p : cuts_) static_cast<void>(planes.push_back(p));
  for (const support_plane& p : own) {
    const double said_m = depth_at(p, here().moved);
    const support_plane* const now = same_in({planes.data(), chosen}, p);
    const double most_m = now != nullptr ? std::min(0.0, depth_at(*now, here().moved) - agrees_m) : complete_to_m;
    const bool replaced = said_m > most_m && (now != nullptr || p.sample != 0);
    if (!replaced) static_cast<void>(planes.push_back(p));
  }
}

}  // namespace asperity
