// What the plane finder hands on: which samples of one body may touch the other.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "asperity/core/math.hpp"
#include "asperity/core/memory.hpp"
#include "asperity/field/sample_tree.hpp"
#include "asperity/render/support_plane.hpp"

namespace asperity {

/// The support plane of the deepest of a few neighbouring samples, and where that sample is.
struct near_plane {
  support_plane plane{.depth_m = -std::numeric_limits<double>::infinity()};  ///< -infinity: there is none
  vec3 point_w{0.0};                                                         ///< the sample, world
};

/// What one reading of a depth field bounds around it: depths of points within a ball. In the field's body's frame.
struct depth_bound {
  static constexpr double unknown = std::numeric_limits<double>::infinity();

  double most_m = unknown;        ///< no point of the ball is deeper
  double smooth_m = 0.0;          ///< the smooth part at the ball's centre
  vec3 slope{0.0};                ///< its slope there
  mat3 hessian_per_m{0.0};        ///< and second derivatives
  double third_per_m2 = unknown;  ///< no third derivative in the ball is larger
  double relief_m = unknown;      ///< no relief in the ball is higher

  /// No point of the ball is deeper at this place, seen from its centre. @rt safe
  [[nodiscard]] double most_at(const vec3& off) const noexcept {
    if (!(third_per_m2 < unknown)) return most_m;
    const double far2 = glm::dot(off, off);
    return smooth_m + glm::dot(slope + 0.5 * (hessian_per_m * off), off) + third_per_m2 * far2 * std::sqrt(far2) / 6.0 +
           relief_m;
  }
};

/// A patch of one body's surface that may touch the other body: a few leaves of its sample_tree that are neighbours.
struct near_patch {
  std::uint32_t body = 0;  ///< index of B in scene::fixed
  bool of_probe = false;   ///< whose samples: the probe's, met by B's field; or B's, met by the probe's
  sample_ball ball{};      ///< around them, in the frame of the body that has them
  depth_bound in_other{};  ///< of that ball in the other body's field
  std::uint32_t first_leaf = 0, leaf_count = 0;  ///< in near_samples::leaves()
  std::uint32_t branch = 0;                      ///< its ball's number in the sample_tree
};

/// A few neighbouring samples of a patch.
struct near_leaf {
  const field_sample* first = nullptr;  ///< in that body's sample_tree
  std::uint32_t count = 0;
  sample_ball ball{};  ///< around them, in the same frame

  [[nodiscard]] std::span<const field_sample> samples() const noexcept { return {first, count}; }
};

/// Fixed size of a near_samples.
struct near_sample_limits {
  std::size_t leaves = 16384;

  /// Most readings that a depth backend makes of a set of this size.
  [[nodiscard]] std::size_t readings() const noexcept { return leaves; }
};

/// The near patches of one tick and their leaves, sorted by body. All memory is taken when it is made.
/// A superset of what touches is harmless: what is too far away gives no plane.
class near_samples {
 public:
  using limits_type = near_sample_limits;

  explicit near_samples(near_sample_limits limits = {}) : limits_(limits) {
    detail::reserve_resident(leaves_, limits.leaves);
    detail::reserve_resident(patches_, limits.leaves);
  }

  /// @rt safe
  void clear() noexcept {
    leaves_.clear();
    patches_.clear();
    dropped_ = 0;
    looked_at_ = 0;
    most_left_m_ = -std::numeric_limits<double>::infinity();
  }
  /// Notes that samples which are no deeper than this are not listed, or are listed and may get no plane. @rt safe
  void leave(double most_m) noexcept { most_left_m_ = std::max(most_left_m_, most_m); }
  /// No sample that may get no plane is deeper, m; -infinity: there is none.
  [[nodiscard]] double most_left_m() const noexcept { return most_left_m_; }
  /// Counts a ball of samples that a finder has looked at. @rt safe
  void look_at() noexcept { ++looked_at_; }
  [[nodiscard]] std::uint32_t looked_at() const noexcept { return looked_at_; }
  /// Begins a patch; the leaves that are added next belong to it.
  /// @return false where the limit was hit: its leaves will be dropped   @rt safe
  bool begin(const near_patch& patch) noexcept {
    if (leaves_.size() == limits_.leaves) return false;
    if (!patches_.empty() && patches_.back().leaf_count == 0) patches_.pop_back();
    patches_.push_back(patch);
    patches_.back().first_leaf = static_cast<std::uint32_t>(leaves_.size());
    patches_.back().leaf_count = 0;
    return true;
  }
  /// Adds a leaf to the last patch; where none was begun, to one that says nothing.
  /// @return false where the limit was hit: the leaf is dropped and counted   @rt safe
  bool add(const near_leaf& leaf) noexcept {
    if (leaves_.size() == limits_.leaves) {
      ++dropped_;
      return false;
    }
    if (patches_.empty()) static_cast<void>(begin({}));
    leaves_.push_back(leaf);
    ++patches_.back().leaf_count;
    return true;
  }

  /// Adds what another list has, behind what is here. @rt safe
  void append(const near_samples& other) noexcept {
    if (!patches_.empty() && patches_.back().leaf_count == 0) patches_.pop_back();
    const std::size_t first = leaves_.size(), count = std::min(other.leaves_.size(), limits_.leaves - first);
    leaves_.insert(leaves_.end(), other.leaves_.begin(), other.leaves_.begin() + static_cast<std::ptrdiff_t>(count));
    for (const near_patch& patch : other.patches_) {
      if (patch.first_leaf >= count) break;
      patches_.push_back(patch);
      patches_.back().leaf_count = std::min(patch.leaf_count, static_cast<std::uint32_t>(count) - patch.first_leaf);
      patches_.back().first_leaf += static_cast<std::uint32_t>(first);
    }
    dropped_ += other.dropped_ + (other.leaves_.size() - count);
    looked_at_ += other.looked_at_;
    leave(other.most_left_m_);
  }

  [[nodiscard]] std::span<const near_patch> patches() const noexcept { return patches_; }
  [[nodiscard]] std::span<const near_leaf> leaves_of(const near_patch& patch) const noexcept {
    return leaves().subspan(patch.first_leaf, patch.leaf_count);
  }
  [[nodiscard]] std::span<const near_leaf> leaves() const noexcept { return leaves_; }
  /// How many readings a depth backend makes of it: one per leaf.
  [[nodiscard]] std::size_t size() const noexcept { return leaves_.size(); }
  /// Leaves that did not fit since clear(): raise near_sample_limits.
  [[nodiscard]] std::size_t dropped() const noexcept { return dropped_; }
  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(leaves_, patches_); }

 private:
  near_sample_limits limits_;
  std::vector<near_leaf> leaves_;
  std::vector<near_patch> patches_;
  std::size_t dropped_ = 0;
  std::uint32_t looked_at_ = 0;
  double most_left_m_ = -std::numeric_limits<double>::infinity();
};

}  // namespace asperity
