// What earlier ticks know of how deep samples lie: upper bounds that grow with the way that samples have gone since.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "asperity/core/memory.hpp"
#include "asperity/field/field_scene.hpp"
#include "asperity/planes/near_samples.hpp"
#include "field/lanes.hpp"
#include "planes/patch_slopes.hpp"

namespace asperity {

/// Upper bounds of the depths of a tick's near samples. A sample that was near in the tick before brings its bound
/// along; of the others nothing is known. Bounds spare readings and decide nothing: a sample that may be deep by its
/// bound is read, with the same result as without bounds. Memory goes with the limit of leaves, not with the
/// scene.
class known_depths {
 public:
  static constexpr float rounding_m = 1e-9F;

  /// @param leaves most of a tick
  explicit known_depths(std::size_t leaves) {
    for (list* l : {&now_, &before_}) {
      detail::reserve_resident(l->leaves, leaves);
      detail::reserve_resident(l->most_m, leaves * sample_tree::leaf_places);
    }
    detail::reserve_resident(brought_m_, leaves);
    detail::reserve_resident(asked_m_, leaves * sample_tree::leaf_places);
    detail::reserve_resident(asked_, leaves);
    detail::reserve_resident(near_, leaves);
    for (std::vector<float>* of : {&deepest_m_, &since_m_, &arm_m_}) detail::reserve_resident(*of, leaves);
  }

  /// Begins a tick with these leaves: brings the bounds of the tick before, which grow() brings up to date. Leaves come in
  /// the order of body, whose samples they are and sample, as plane_finder lists them; what comes in another order is not
  /// known.   @rt safe
  void begin(const near_samples& found) noexcept {
    std::swap(now_, before_);
    now_.leaves.clear();
    now_.most_m.clear();
    brought_m_.clear();
    std::size_t last = 0;  // leaf of before_
    for (const near_patch& patch : found.patches()) {
      float most_m = -std::numeric_limits<float>::infinity();
      for (const near_leaf& leaf : found.leaves_of(patch)) {
        const std::size_t count = std::min<std::size_t>(leaf.count, now_.most_m.capacity() - now_.most_m.size());
        const bool complete = count == leaf.count && (now_.leaves.empty() || now_.leaves.back().complete);
        const place at{patch.body, !patch.of_probe, leaf.first, static_cast<std::uint32_t>(now_.most_m.size()),
                       complete};
        now_.leaves.push_back(at);
        now_.most_m.resize(at.offset + count, std::numeric_limits<float>::infinity());
        while (last < before_.leaves.size() && is_before(before_.leaves[last], at)) ++last;
        if (last == before_.leaves.size() || is_before(at, before_.leaves[last])) continue;
        const std::size_t from = before_.leaves[last].offset;
        for (std::size_t i = 0; i < std::min(count, before_.most_m.size() - from); ++i) {
          now_.most_m[at.offset + i] = before_.most_m[from + i];
          most_m = std::max(most_m, before_.most_m[from + i]);
        }
      }
      brought_m_.push_back(most_m);
    }
  }
  /// The largest bound that begin() brought for a patch, m; -infinity: none.
  [[nodiscard]] double brought_m(std::size_t patch) const noexcept { return static_cast<double>(brought_m_[patch]); }
  /// The samples of a patch can be deeper by so much than in the tick before. From several threads, for patches of their
  /// own.   @rt safe
  void grow(const near_patch& patch, double by_m) noexcept {
    const float grown_m = static_cast<float>(by_m) + rounding_m;
    for (float& m : part_of(patch, now_.most_m)) m += grown_m;
  }

  /// Nothing is known of a body's samples any more: another one is in its place. @rt safe
  void forget(std::uint32_t body) noexcept {
    for (std::size_t l = 0; l < now_.leaves.size(); ++l) {
      if (now_.leaves[l].body != body) continue;
      for (float& m : now_.range(l, now_.most_m)) m = std::numeric_limits<float>::infinity();
    }
  }

  /// Bounds of a leaf's samples, m; +infinity where nothing is known. Fewer than the leaf has where a leaf is larger
  /// than the tree's, or the list is full.
  [[nodiscard]] std::span<float> of(std::size_t leaf) noexcept { return now_.range(leaf, std::span(now_.most_m)); }

  /// None of a patch's samples is deeper, m; +infinity where not all of them have a bound.
  [[nodiscard]] float most_m(const near_patch& patch) noexcept { return largest_of(patch, now_.most_m); }

  /// What is known of a patch at the pose that was asked for last, beside how deep it is.
  struct asked_patch {
    vec3 middle_y{0.0};    ///< of its ball in the other body's frame at the tick's pose
    vec3 asked_y{0.0};     ///< the middle at the last pose of which more is known
    vec3 turned{0.0};      ///< from the tick's pose to that one, rotation vector
    float grown_m = 0.0F;  ///< by what the bounds of its samples have grown since they were written
    bool has_slopes = false;
    patch_slopes slopes{};  ///< about it, once they were needed
  };

  /// Ends the tick: from here on questions are for poses near by, and bounds those of the pose that was asked for last.
  /// Each patch is then placed, see ask_of().   @rt safe
  void ask(const near_samples& found) noexcept {
    const std::size_t patches = found.patches().size();
    asked_m_.assign(now_.most_m.begin(), now_.most_m.end());
    asked_.resize(patches);
    deepest_m_.resize(patches);
    since_m_.assign(patches, 0.0F);
    arm_m_.resize(patches);
    near_.resize(patches);
  }
  /// @param middle_y of its ball in the other body's frame
  /// @param arm_m from the probe's centre of mass to its furthest sample. From several threads, for patches of their
  /// own.   @rt safe
  void ask_of(std::size_t patch, const near_patch& of, const vec3& middle_y, double arm_m) noexcept {
    asked_[patch] = {.middle_y = middle_y, .asked_y = middle_y};
    arm_m_[patch] = static_cast<float>(arm_m);
    close(patch, of);
  }
  [[nodiscard]] asked_patch& asked(std::size_t patch) noexcept { return asked_[patch]; }
  /// None of a patch's samples is deeper at the pose that is asked for, m; before come_to() with what every sample can
  /// have come deeper since, afterwards by its own way.
  [[nodiscard]] double asked_most_m(std::size_t patch) const noexcept {
    return static_cast<double>(deepest_m_[patch] + since_m_[patch]);
  }
  /// The bounds of a leaf's samples, of a patch that is open.
  [[nodiscard]] std::span<float> asked_of(std::size_t leaf) noexcept { return now_.range(leaf, std::span(asked_m_)); }

  /// The pose that is asked for has slid and turned so much further. Calls visit(patch) for each patch from begin to end
  /// that can be deeper than above_m() there, the one that may be the deepest first: what it tells may raise above_m(),
  /// so that others need no look. Most patches are too far away for any motion of this length, so they are compared four
  /// at a time. From several threads, for patches of their own.   @rt safe
  template <class Above, class Visit>
  void move_on(std::size_t begin, std::size_t end, double slid_m, double turned_rad, Above&& above_m,
               Visit&& visit) noexcept {
    using detail::lanes;
    const auto slid = static_cast<float>(steepest_depth * slid_m) + rounding_m;
    const auto turned = static_cast<float>(steepest_depth * turned_rad);
    const auto above = static_cast<float>(above_m()) - rounding_m;
    std::size_t last = begin;  // the patches that may be that deep are near_[begin] to near_[last - 1]
    std::size_t p = begin;
    for (; p + 4 <= end; p += 4) {
      const lanes since = detail::load_lanes(&since_m_[p]) + turned * detail::load_lanes(&arm_m_[p]) + slid;
      detail::store_lanes(since, &since_m_[p]);
      const auto is_near = detail::load_lanes(&deepest_m_[p]) + since > above;
      if ((is_near[0] | is_near[1] | is_near[2] | is_near[3]) == 0) continue;
      for (std::size_t i = 0; i < 4; ++i) {
        if (is_near[i] != 0) near_[last++] = static_cast<std::uint32_t>(p + i);
      }
    }
    for (; p < end; ++p) {
      since_m_[p] += turned * arm_m_[p] + slid;
      if (deepest_m_[p] + since_m_[p] > above) near_[last++] = static_cast<std::uint32_t>(p);
    }
    const auto first_near = near_.begin() + static_cast<std::ptrdiff_t>(begin);
    auto last_near = near_.begin() + static_cast<std::ptrdiff_t>(last);
    const auto is_less_deep = [this](std::uint32_t a, std::uint32_t b) noexcept {
      return asked_most_m(a) < asked_most_m(b);
    };
    std::make_heap(first_near, last_near, is_less_deep);
    while (first_near != last_near && asked_most_m(*first_near) > above_m()) {
      std::pop_heap(first_near, last_near, is_less_deep);
      visit(*--last_near);
    }
  }
  /// A patch's samples can have come deeper by this on the way to the pose that is asked for, by their own way.
  void come_to(std::size_t patch, double by_m) noexcept {
    const float grown_m = std::min(static_cast<float>(by_m) + rounding_m, std::exchange(since_m_[patch], 0.0F));
    asked_[patch].grown_m += grown_m;
    deepest_m_[patch] += grown_m;
  }
  /// Brings the bounds of a patch's samples up to date.
  void open(std::size_t patch, const near_patch& of) noexcept {
    for (float& m : part_of(of, asked_m_)) m += asked_[patch].grown_m;
    asked_[patch].grown_m = 0.0F;
  }
  /// Notes the largest of the bounds.
  void close(std::size_t patch, const near_patch& of) noexcept { deepest_m_[patch] = largest_of(of, asked_m_); }

  [[nodiscard]] std::size_t heap_bytes() const noexcept {
    return asperity::heap_bytes(now_.leaves, now_.most_m, before_.leaves, before_.most_m, brought_m_, asked_m_, asked_,
                                near_, deepest_m_, since_m_, arm_m_);
  }

 private:
  struct place {
    std::uint32_t body;
    bool of_fixed;
    const field_sample* first;
    std::uint32_t offset;
    bool complete;  // it and all before it
  };
  struct list {
    std::vector<place> leaves;
    std::vector<float> most_m;

    // A leaf's part of one number per sample.
    [[nodiscard]] std::span<float> range(std::size_t leaf, std::span<float> of_samples) const noexcept {
      const std::size_t end = leaf + 1 < leaves.size() ? leaves[leaf + 1].offset : of_samples.size();
      return of_samples.subspan(leaves[leaf].offset, end - leaves[leaf].offset);
    }
  };

  [[nodiscard]] static bool is_before(const place& a, const place& b) noexcept {
    if (a.body != b.body) return a.body < b.body;
    if (a.of_fixed != b.of_fixed) return b.of_fixed;
    return std::less<>{}(a.first, b.first);
  }

  // A patch's part of one number per sample.
  [[nodiscard]] std::span<float> part_of(const near_patch& patch, std::span<float> of_samples) const noexcept {
    if (patch.leaf_count == 0) return {};
    const std::span<float> first = now_.range(patch.first_leaf, of_samples);
    const std::span<float> last = now_.range(patch.first_leaf + patch.leaf_count - 1, of_samples);
    return {first.data(), static_cast<std::size_t>(last.data() + last.size() - first.data())};
  }
  // Whether every sample of a patch has a bound: not where leaves are larger than a tree's, and the list was full.
  [[nodiscard]] bool complete(const near_patch& patch) const noexcept {
    return patch.leaf_count == 0 || now_.leaves[patch.first_leaf + patch.leaf_count - 1].complete;
  }

  [[nodiscard]] float largest_of(const near_patch& patch, std::span<float> of_samples) const noexcept {
    if (!complete(patch)) return std::numeric_limits<float>::infinity();
    float most_m = -std::numeric_limits<float>::infinity();
    for (const float m : part_of(patch, of_samples)) most_m = std::max(most_m, m);
    return most_m;
  }

  list now_, before_;
  std::vector<float> brought_m_;  // per patch
  std::vector<float> asked_m_;
  std::vector<asked_patch> asked_;
  std::vector<std::uint32_t> near_;  // of move_on()
  // Per patch: none of its samples was deeper at the last pose of which more is known, how much deeper they can have come
  // on the poses since, and how far they are from the probe's centre of mass.
  std::vector<float> deepest_m_, since_m_, arm_m_;
};

}  // namespace asperity
