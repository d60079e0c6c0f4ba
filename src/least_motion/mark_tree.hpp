// A hierarchy over a body's samples: of every branch, a ball and two planes that its samples lie between.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "asperity/core/math.hpp"
#include "asperity/core/memory.hpp"
#include "asperity/field/sample_tree.hpp"

namespace asperity::exits {

/// A branch: its samples lie within radius_m of centre_b, and within half_m of the plane through centre_b across
/// axis_b. Next to a smooth surface half_m is far below radius_m, and a slope that is known bounds the depth by it.
struct branch {
  glm::vec3 centre_b{0.0F}, axis_b{0.0F, 0.0F, 1.0F};
  float radius_m = 0.0F, half_m = 0.0F;
  std::uint32_t first = 0, count = 0;  ///< of the samples
  std::uint32_t right = 0;             ///< the second child; 0 for a leaf. The first child follows its parent
};

/// Branches over the samples of a sample_tree: its balls, and halves of its leaves, where neighbours in the list are
/// neighbours in space. Made once, beside the samples; never changed.
class mark_tree {
 public:
  /// Most samples of a leaf.
  static constexpr std::size_t leaf_samples = 6;

  mark_tree() = default;
  explicit mark_tree(const sample_tree& tree) : samples_(tree.samples()) {
    if (samples_.empty()) return;
    branches_.reserve(samples_.size());
    build(tree.at(0));
    branches_.shrink_to_fit();
  }

  [[nodiscard]] std::span<const branch> branches() const noexcept { return branches_; }
  [[nodiscard]] std::span<const field_sample> samples() const noexcept { return samples_; }
  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(branches_); }

 private:
  void build(const sample_tree::branch& of) {
    const std::span<const field_sample> part = of.samples();
    const auto first = static_cast<std::size_t>(part.data() - samples_.data());
    if (of.is_leaf()) {
      build(first, part.size());
      return;
    }
    const std::size_t self = branches_.size();
    branches_.push_back(around(first, part.size()));
    build(of.of->at(of.left));
    branches_[self].right = static_cast<std::uint32_t>(branches_.size());
    build(of.of->at(of.right));
  }

  void build(std::size_t first, std::size_t count) {
    const std::size_t self = branches_.size();
    branches_.push_back(around(first, count));
    if (count <= leaf_samples) return;
    const std::size_t half = count / 2;
    build(first, half);
    branches_[self].right = static_cast<std::uint32_t>(branches_.size());
    build(first + half, count - half);
  }

  [[nodiscard]] branch around(std::size_t first, std::size_t count) const {
    const std::span<const field_sample> part = samples_.subspan(first, count);
    vec3 low(part[0].position_b), high = low, mean(0.0);
    for (const field_sample& s : part) {
      low = glm::min(low, vec3(s.position_b));
      high = glm::max(high, vec3(s.position_b));
      mean += vec3(s.position_b) / static_cast<double>(count);
    }
    const vec3 axis = thinnest(part, mean);
    double bottom = 1e30, top = -1e30;
    const vec3 middle = 0.5 * (low + high);
    for (const field_sample& s : part) {
      const double z = glm::dot(vec3(s.position_b) - middle, axis);
      bottom = std::min(bottom, z);
      top = std::max(top, z);
    }
    branch out;
    out.centre_b = glm::vec3(middle + 0.5 * (bottom + top) * axis);
    out.axis_b = glm::vec3(axis);
    double far = 0.0, off = 0.0;
    for (const field_sample& s : part) {
      const vec3 d = vec3(s.position_b) - vec3(out.centre_b);
      far = std::max(far, glm::length(d));
      off = std::max(off, std::fabs(glm::dot(d, vec3(out.axis_b))));
    }
    out.radius_m = std::nextafter(static_cast<float>(far), 1e30F);
    out.half_m = std::nextafter(static_cast<float>(off), 1e30F);
    out.first = static_cast<std::uint32_t>(first);
    out.count = static_cast<std::uint32_t>(count);
    return out;
  }

  // The direction along which samples spread least, by the power method on the trace of their covariance less the
  // covariance. A direction that is not quite the best makes the bounds a little wider, not wrong.
  [[nodiscard]] static vec3 thinnest(std::span<const field_sample> part, const vec3& mean) noexcept {
    mat3 rest(0.0);
    double trace = 1e-30;
    for (const field_sample& s : part) {
      const vec3 d = vec3(s.position_b) - mean;
      rest -= glm::outerProduct(d, d);
      trace += glm::dot(d, d);
    }
    for (int k = 0; k < 3; ++k) rest[k][k] += trace;
    vec3 axis = glm::normalize(vec3(0.48, 0.6, 0.64));
    for (int i = 0; i < 20; ++i) axis = glm::normalize(rest * axis);
    return axis;
  }

  std::span<const field_sample> samples_;
  std::vector<branch> branches_;
};

}  // namespace asperity::exits
