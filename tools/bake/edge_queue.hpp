// The edges of a mesh in the order in which they should go.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "bake/halfedges.hpp"

namespace asperity::bake {

/// Halfedges by cost, cheapest first; `Before` orders those of equal cost, or the result would depend on the queue's
/// inside. A heap of four branches that knows the place of each halfedge, so that a cost can change and no entry goes
/// stale: it never holds more than it was filled with. 12 bytes an entry and 4 bytes a halfedge.
template <class Before>
class edge_queue {
 public:
  /// @param halfedges all that there are; every one that is ever put in is below this
  edge_queue(std::size_t halfedges, Before before) : place_(halfedges, no_halfedge), before_(std::move(before)) {}

  [[nodiscard]] bool empty() const noexcept { return entry_.empty(); }
  [[nodiscard]] std::uint32_t top() const noexcept { return entry_.front(); }

  /// Puts in the halfedges given, each with its cost. @pre empty
  void fill(std::vector<std::uint32_t> halfedges, std::vector<double> costs) {
    entry_ = std::move(halfedges);
    cost_ = std::move(costs);
    for (std::uint32_t i = 0; i < entry_.size(); ++i) place_[entry_[i]] = i;
    for (std::size_t i = entry_.size() / branches + 1; i-- > 0;)
      if (i < entry_.size()) sink(i, entry_[i], cost_[i]);
  }

  /// Takes the halfedge out, where it is in.
  void erase(std::uint32_t h) {
    const std::uint32_t at = place_[h];
    if (at == no_halfedge) return;
    place_[h] = no_halfedge;
    const std::uint32_t last = entry_.back();
    const double cost = cost_.back();
    entry_.pop_back();
    cost_.pop_back();
    if (at < entry_.size()) settle(at, last, cost);
  }

  /// Puts the halfedge in, or gives it another cost.
  void set(std::uint32_t h, double cost) {
    std::uint32_t at = place_[h];
    if (at == no_halfedge) {
      at = static_cast<std::uint32_t>(entry_.size());
      entry_.push_back(h);
      cost_.push_back(cost);
    }
    settle(at, h, cost);
  }

 private:
  static constexpr std::size_t branches = 4;

  [[nodiscard]] bool goes_first(std::uint32_t g, double cost_g, std::uint32_t h, double cost_h) const {
    return cost_g < cost_h || (cost_g == cost_h && before_(g, h));
  }

  void put(std::size_t at, std::uint32_t h, double cost) {
    entry_[at] = h;
    cost_[at] = cost;
    place_[h] = static_cast<std::uint32_t>(at);
  }

  // Halfedge h belongs at `at`, above it, or below it.
  void settle(std::size_t at, std::uint32_t h, double cost) {
    const std::size_t from = at;
    while (at > 0) {
      const std::size_t parent = (at - 1) / branches;
      if (!goes_first(h, cost, entry_[parent], cost_[parent])) break;
      put(at, entry_[parent], cost_[parent]);
      at = parent;
    }
    if (at == from) return sink(at, h, cost);
    put(at, h, cost);
  }

  void sink(std::size_t at, std::uint32_t h, double cost) {
    for (;;) {
      const std::size_t first = branches * at + 1;
      if (first >= entry_.size()) break;
      const std::size_t end = std::min(first + branches, entry_.size());
      std::size_t least = first;
      for (std::size_t i = first + 1; i < end; ++i)
        if (goes_first(entry_[i], cost_[i], entry_[least], cost_[least])) least = i;
      if (!goes_first(entry_[least], cost_[least], h, cost)) break;
      put(at, entry_[least], cost_[least]);
      at = least;
    }
    put(at, h, cost);
  }

  std::vector<std::uint32_t> entry_;
  std::vector<double> cost_;
  std::vector<std::uint32_t> place_;  // of each halfedge among the entries; no_halfedge where it is not in
  Before before_;
};

}  // namespace asperity::bake
