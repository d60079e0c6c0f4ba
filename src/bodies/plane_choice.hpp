// Which of the planes that are told of a mover its steps are given.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "asperity/control/plane_selection.hpp"
#include "asperity/core/fixed_vector.hpp"
#include "asperity/core/memory.hpp"
#include "asperity/render/plane_source.hpp"
#include "bodies/mover.hpp"

namespace asperity::detail {

/// The planes that pressed, those that small motions meet first, and others that touch while there is room.
///
/// Those that press stay: a body at rest on many points of the same height would be given others in every period, and
/// tremble. Of a few neighbouring samples the deepest alone is told; where that is another one than before, the point of
/// the plane that pressed is read again, and stays while it touches. A block that was pushed over a table lost one of two
/// planes at its corner otherwise, and hopped. A plane that touches and that no motion meets first is given as well: left
/// out until one does, it came with a depth of some micrometres at once, and blocks on each other rocked without end.
/// Of those that touch, what pressed comes first: where more touch than there is room for, others in every telling let a
/// heavy block tremble by a tenth of a micrometre.
/// Between free bodies and what they lie on the samples of the larger body lie 10 um further back: a block that slides
/// takes its own corners along, and loses the table's points behind it one by one.
class plane_choice {
 public:
  /// Takes the memory. @param most planes that are told of a mover
  explicit plane_choice(std::size_t most) { reserve_resident(set_back_, most); }

  /// Puts the planes of `told` that count into of.contact, in the place of those of the telling before.
  /// @param now_T_wb the others, where they are   @param reader of the renderer that told
  /// @return as select_planes()   @rt safe
  [[nodiscard]] status choose(std::span<const support_plane> told, const plane_selection& selection, const mover& body,
                              std::span<const pose> now_T_wb, const plane_reader& reader, mover_contacts& of) noexcept {
    set_back_.assign(told.begin(), told.end());
    for (support_plane& p : set_back_) p.depth_m -= set_back_m(p, of);
    const kept_planes pressed = pressed_of(set_back_, body, now_T_wb, reader, of);
    of.lambda_n.fill(0.0);
    of.contact.planes.clear();
    const status out = select_planes(set_back_, selection, chosen_, most_support_planes - most_first);
    if (out != status::ok && out != status::capacity_reached) return out;
    const auto give = [&](const support_plane& p, double lambda_n) noexcept {
      support_planes& to = of.contact.planes;
      if (to.size() == most_support_planes || (p.sample != 0 && find({to.data(), to.size()}, p) != nullptr)) return;
      of.lambda_n[to.size()] = lambda_n;
      static_cast<void>(to.push_back(p));
    };
    const std::span<const kept_plane> kept(pressed.data(), pressed.size());
    const std::size_t first = std::min(kept.size(), most_first);
    for (const kept_plane& q : kept.first(first)) give(q.plane, q.lambda_n);
    for (const support_plane& p : chosen_) give(p, 0.0);
    for (const kept_plane& q : kept.subspan(first)) give(q.plane, q.lambda_n);
    for (const support_plane& p : set_back_) {
      if (p.depth_m > 0.0 && p.sample != 0) give(p, 0.0);
    }
    return out;
  }

  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(set_back_); }

 private:
  // So many of those that pressed come before what motions meet: room for these stays.
  static constexpr std::size_t most_first = most_support_planes / 2;
  static constexpr double further_back_m = 1e-5, lets_go_m = 1e-5;

  // A plane that pressed, as it is now.
  struct kept_plane {
    support_plane plane{};
    double lambda_n = 0.0;  // what a body that sleeps goes on pressing with
  };
  using kept_planes = fixed_vector<kept_plane, most_support_planes>;

  [[nodiscard]] static const support_plane* find(std::span<const support_plane> in, const support_plane& p) noexcept {
    const auto found = std::find_if(in.begin(), in.end(),
                                    [&](const support_plane& q) { return q.body == p.body && q.sample == p.sample; });
    return found == in.end() ? nullptr : &*found;
  }

  [[nodiscard]] static double set_back_m(const support_plane& p, const mover_contacts& of) noexcept {
    const other_body& o = of.others[p.body];
    return o.lies_back != 0 && p.sample != 0 && p.sample % 2 == o.lies_back % 2 ? further_back_m : 0.0;
  }

  [[nodiscard]] static kept_planes pressed_of(std::span<const support_plane> told, const mover& body,
                                              std::span<const pose> now_T_wb, const plane_reader& reader,
                                              const mover_contacts& of) noexcept {
    kept_planes out;
    for (std::size_t i = 0; i < of.contact.planes.size(); ++i) {
      support_plane p = of.contact.planes[i];
      if (!(of.lambda_n[i] > 0.0) || p.sample == 0) continue;
      if (const support_plane* const now = find(told, p); now != nullptr) {
        p = *now;
      } else {
        p.depth_m = -std::numeric_limits<double>::infinity();  // what the reader cannot read ends here
        reader.read(body.T_wc, now_T_wb[p.body], p.body, {&p, 1});
        p.depth_m -= set_back_m(p, of);
      }
      if (p.depth_m > -lets_go_m) static_cast<void>(out.push_back({p, of.lambda_n[i]}));
    }
    return out;
  }

  support_planes chosen_{};
  std::vector<support_plane> set_back_;
};

}  // namespace asperity::detail
