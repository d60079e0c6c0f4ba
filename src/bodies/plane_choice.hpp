// Which of the planes that are told of a mover its steps are given.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "asperity/control/plane_selection.hpp"
#include "asperity/core/memory.hpp"
#include "bodies/mover.hpp"

namespace asperity::detail {

/// Those that small motions meet first, and others that touch while there is room.
///
/// A plane that touches and that no motion meets first is given as well: left out until one does, it came with a depth of
/// some micrometres at once; blocks on each other rocked without end, a block at rest on many points of the same height
/// trembled, and one that was pushed over a table lost a plane at its corner and hopped.
/// Between free bodies and what they lie on the samples of the larger body lie 10 um further back: a block that slides
/// takes its own corners along, and loses the table's points behind it one by one.
class plane_choice {
 public:
  /// Takes the memory. @param most planes that are told of a mover
  explicit plane_choice(std::size_t most) { reserve_resident(set_back_, most); }

  /// Puts the planes of `told` that count into of.contact, in the place of those of the telling before.
  /// @return as select_planes()   @rt safe
  [[nodiscard]] status choose(std::span<const support_plane> told, const plane_selection& selection,
                              mover_contacts& of) noexcept {
    set_back_.assign(told.begin(), told.end());
    for (support_plane& p : set_back_) p.depth_m -= set_back_m(p, of);
    before_ = of.contact.planes;
    const auto lambda_before_n = of.lambda_n;  // what a body that sleeps goes on pressing with
    of.lambda_n.fill(0.0);
    of.contact.planes.clear();
    const status out = select_planes(set_back_, selection, chosen_);
    if (out != status::ok && out != status::capacity_reached) return out;
    const auto give = [&](const support_plane& p) noexcept {
      support_planes& to = of.contact.planes;
      if (to.size() == most_support_planes || (p.sample != 0 && find(to, p) < to.size())) return;
      const std::size_t was = p.sample != 0 ? find(before_, p) : before_.size();
      if (was < before_.size()) of.lambda_n[to.size()] = lambda_before_n[was];
      static_cast<void>(to.push_back(p));
    };
    for (const support_plane& p : chosen_) give(p);
    for (const support_plane& p : set_back_) {
      if (p.depth_m > 0.0 && p.sample != 0) give(p);
    }
    return out;
  }

  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(set_back_); }

 private:
  static constexpr double further_back_m = 1e-5;

  // Where the plane of that sample is; the size where there is none.
  [[nodiscard]] static std::size_t find(const support_planes& in, const support_plane& p) noexcept {
    std::size_t i = 0;
    while (i < in.size() && !(in[i].body == p.body && in[i].sample == p.sample)) ++i;
    return i;
  }

  [[nodiscard]] static double set_back_m(const support_plane& p, const mover_contacts& of) noexcept {
    const other_body& o = of.others[p.body];
    return o.lies_back != 0 && p.sample != 0 && p.sample % 2 == o.lies_back % 2 ? further_back_m : 0.0;
  }

  support_planes chosen_{}, before_{};
  std::vector<support_plane> set_back_;
};

}  // namespace asperity::detail
