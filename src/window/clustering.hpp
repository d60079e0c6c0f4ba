// Joins close pairs to clusters: pairs that push in similar directions at the same place are one contact.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "asperity/core/memory.hpp"
#include "window/aabb_tree.hpp"
#include "window/close_pair.hpp"

namespace asperity {

/// Pairs of one contact. Frame of A.
struct pair_cluster {
  std::uint32_t first = 0, count = 0;  ///< range of its pairs in pair_clustering::members(): active, then passive
  std::uint32_t active = 0;            ///< how many of them are active
  vec3 n_ab{0.0};                      ///< unit: mean of the pairs' directions by weight
  vec3 place{0.0};                     ///< mean of the regions' centres by weight; it does not jump between flat faces
  vec3 p_a{0.0}, p_b{0.0};             ///< witness points of the heaviest pair
  double height_a_m = 0.0;             ///< mean of n . p_a by weight
  double height_b_m = 0.0;             ///< mean of n . p_b by weight
  double weight = 0.0;                 ///< sum over its pairs
};

/// Greedy clustering around the heaviest pairs.
///
/// The heaviest free pair is a seed. Active pairs within the merge angle of the seed's direction join while their
/// region touches that of a member. What is left gives the next seed. Passive pairs join every cluster that they
/// touch. Directions are compared with the seed's and not from pair to pair, because inside a bore neighbouring pairs
/// would join one after the other until one contact held opposite directions. Where two seeds are equally heavy a small
/// motion may exchange them: this is the known jump of the paper's contacts.
/// @source paper section 6.4 (104 close pairs, up to 7 contacts); the rule is our choice
class pair_clustering {
 public:
  pair_clustering(std::size_t max_pairs, std::size_t max_clusters) : max_clusters_(max_clusters) {
    detail::reserve_resident(clusters_, max_clusters);
    detail::reserve_resident(order_, max_pairs);
    detail::reserve_resident(taken_, max_pairs);
    // A passive pair may be listed once per cluster.
    detail::reserve_resident(members_, max_pairs * (1 + max_clusters));
  }

  /// Clusters of these pairs, heaviest first.
  /// @param min_cosine of the merge angle
  /// @rt safe: at most square in the number of pairs
  /// @return false where there were more clusters than capacity: the lightest are left out and counted
  bool build(std::span<const close_pair> pairs, double min_cosine) noexcept {
    clusters_.clear();
    members_.clear();
    order_.clear();
    taken_.assign(pairs.size(), 0);
    left_out_ = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      if (pairs[i].kind == pair_kind::active) order_.push_back(static_cast<std::uint32_t>(i));
    }
    std::sort(order_.begin(), order_.end(), [&](std::uint32_t i, std::uint32_t j) {
      return pairs[i].weight > pairs[j].weight || (pairs[i].weight == pairs[j].weight && i < j);
    });
    for (const std::uint32_t seed : order_) {
      if (taken_[seed] != 0) continue;
      if (clusters_.size() == max_clusters_) {
        ++left_out_;
        grow(pairs, seed, min_cosine);
        continue;
      }
      pair_cluster c;
      c.first = static_cast<std::uint32_t>(members_.size());
      c.active = grow(pairs, seed, min_cosine);
      c.count = c.active + add_passive(pairs, c);
      summarise(pairs, c);
      clusters_.push_back(c);
    }
    return left_out_ == 0;
  }

  [[nodiscard]] std::span<const pair_cluster> clusters() const noexcept { return clusters_; }
  /// Indices of a cluster's pairs, active ones first.
  [[nodiscard]] std::span<const std::uint32_t> members(const pair_cluster& c) const noexcept {
    return std::span(members_).subspan(c.first, c.count);
  }
  /// Clusters that did not fit in the last build().
  [[nodiscard]] std::size_t left_out() const noexcept { return left_out_; }
  [[nodiscard]] std::size_t heap_bytes() const noexcept {
    return asperity::heap_bytes(clusters_, order_, members_, taken_);
  }

 private:
  /// Appends the seed's cluster to members_; drops it again where the clusters are full. @return its active pairs
  std::uint32_t grow(std::span<const close_pair> pairs, std::uint32_t seed, double min_cosine) noexcept {
    const std::size_t first = members_.size();
    taken_[seed] = 1;
    members_.push_back(seed);
    for (std::size_t front = first; front < members_.size(); ++front) {
      const bounds& region = pairs[members_[front]].region;
      for (const std::uint32_t i : order_) {
        if (taken_[i] != 0 || glm::dot(pairs[i].n_ab, pairs[seed].n_ab) < min_cosine ||
            !overlap(pairs[i].region, region)) {
          continue;
        }
        taken_[i] = 1;
        members_.push_back(i);
      }
    }
    const auto count = static_cast<std::uint32_t>(members_.size() - first);
    if (clusters_.size() == max_clusters_) members_.resize(first);
    return count;
  }

  std::uint32_t add_passive(std::span<const close_pair> pairs, const pair_cluster& c) noexcept {
    std::uint32_t added = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      if (pairs[i].kind != pair_kind::passive) continue;
      const auto touches = [&](std::uint32_t m) { return overlap(pairs[m].region, pairs[i].region); };
      const auto active = std::span<const std::uint32_t>(members_).subspan(c.first, c.active);
      if (std::any_of(active.begin(), active.end(), touches)) {
        members_.push_back(static_cast<std::uint32_t>(i));
        ++added;
      }
    }
    return added;
  }

  void summarise(std::span<const close_pair> pairs, pair_cluster& c) noexcept {
    const auto active = std::span<const std::uint32_t>(members_).subspan(c.first, c.active);
    vec3 n(0.0);
    for (const std::uint32_t i : active) {
      c.weight += pairs[i].weight;
      n += pairs[i].weight * pairs[i].n_ab;
      c.place += pairs[i].weight * (0.5 * (pairs[i].region.low + pairs[i].region.high));
    }
    // Every direction is within the merge angle (< 90 degrees) of the seed's, so their sum is not zero.
    c.n_ab = glm::normalize(n);
    c.place /= c.weight;
    const close_pair& heaviest = pairs[active.front()];
    c.p_a = heaviest.p_a;
    c.p_b = heaviest.p_b;
    for (const std::uint32_t i : active) {
      const double share = pairs[i].weight / c.weight;
      c.height_a_m += share * glm::dot(c.n_ab, pairs[i].p_a);
      c.height_b_m += share * glm::dot(c.n_ab, pairs[i].p_b);
    }
  }

  std::size_t max_clusters_;
  std::size_t left_out_ = 0;
  std::vector<pair_cluster> clusters_;
  std::vector<std::uint32_t> order_, members_;
  std::vector<std::uint8_t> taken_;
};

}  // namespace asperity
