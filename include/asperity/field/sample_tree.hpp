// Samples of a body in a tree of balls.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <utility>
#include <vector>

#include "asperity/core/export.hpp"
#include "asperity/core/math.hpp"
#include "asperity/core/memory.hpp"

namespace asperity {

namespace detail {
class field_parts;
}

/// A point of a body's fine surface, and the directions that the surface looks to there: one on a plain face, a fan on an
/// edge, a cone on a vertex or where the surface leans or bends within the distance between samples. Body frame.
struct field_sample {
  glm::vec3 position_b{0.0F};
  glm::vec3 axis_b{0.0F, 0.0F, 1.0F};  ///< unit, outwards: the middle of the cone
  float cone_rad = 0.0F;               ///< half its opening: 0 on a plain face
};

/// Samples place by place. Those of one place lie within the distance between samples of each other and look alike, as
/// four in a row on a sharp edge do: a leaf of a tree holds all of a place or none of it.
struct placed_samples {
  std::vector<field_sample> all;
  std::vector<std::uint8_t> at_place;  ///< how many of them, from 1 to most; empty: each has a place of its own
  static constexpr std::size_t most = 4;
};

/// Where a few samples lie: within radius_m of a centre, and within half_m of the plane through it across an axis. On a
/// smooth surface half_m is far below radius_m, and a slope that is known bounds a depth by it. Body frame.
struct sample_ball {
  vec3 centre_b{0.0}, axis_b{0.0, 0.0, 1.0};
  double radius_m = 0.0, half_m = 0.0;

  /// How much a function of this slope can grow from the centre to a sample. @rt safe
  [[nodiscard]] double growth(const vec3& slope_b) const noexcept {
    const double along = std::fabs(glm::dot(axis_b, slope_b));
    const double across = glm::dot(slope_b, slope_b) - along * along;
    return along * half_m + std::sqrt(std::max(0.0, across)) * radius_m;
  }
};

/// Samples of one body in a binary tree of balls. A ball keeps its size however the body is turned, so a field of
/// another body can bound what a whole branch holds by one reading. Built once, never changed.
class sample_tree {
 public:
  /// Most places of a leaf. A leaf tells one plane at most, so denser samples at a place make no more planes.
  static constexpr std::size_t leaf_places = 8;
  /// Most samples of a leaf.
  static constexpr std::size_t leaf_samples = leaf_places * placed_samples::most;

  sample_tree() = default;

  /// @param samples  positions finite   @param threads  that build it; 0: as many as the machine has
  /// @pre fewer than 2^31; the numbers of samples at places add up to all
  ASPERITY_API explicit sample_tree(placed_samples samples, unsigned threads = 1);
  /// Each sample has a place of its own.
  explicit sample_tree(std::vector<field_sample> samples, unsigned threads = 1)
      : sample_tree(placed_samples{std::move(samples), {}}, threads) {}

  [[nodiscard]] std::span<const field_sample> samples() const noexcept { return samples_; }

  /// What a visitor answers about a ball.
  enum class branch_answer : std::uint8_t {
    away,   ///< leave it out
    open,   ///< ask about its halves
    taken,  ///< visit all of its leaves without asking again
  };

  /// A ball of the tree and its number. Balls are numbered from the largest down: halves have higher numbers than their
  /// whole, and `right` is 0 for a leaf.
  struct branch {
    std::uint32_t number = 0, left = 0, right = 0;
    const sample_tree* of = nullptr;

    [[nodiscard]] bool is_leaf() const noexcept { return right == 0; }
    [[nodiscard]] sample_ball ball() const noexcept { return of->balls_[number].in_double(); }
    [[nodiscard]] std::span<const field_sample> samples() const noexcept {
      return std::span(of->samples_).subspan(of->balls_[number].first, of->balls_[number].count);
    }
  };

  /// A ball by its number; 0 is the largest. @pre number < balls()
  [[nodiscard]] branch at(std::uint32_t number) const noexcept {
    return {number, number + 1, balls_[number].right, this};
  }
  /// How many balls are numbered.
  [[nodiscard]] std::size_t balls() const noexcept { return balls_.size(); }
  /// How many a tree of so many places has.
  [[nodiscard]] static constexpr std::size_t balls_of(std::size_t places) noexcept {
    if (places == 0) return 0;
    return places <= leaf_places ? 1 : 1 + balls_of(places / 2) + balls_of(places - places / 2);
  }

  /// Calls look(branch), which answers a branch_answer, from the largest ball down, and visit(sample_ball, samples) for
  /// the leaves of the balls that it takes. A leaf that it leaves open is not visited. The order is the tree's own.
  /// @rt safe: no allocation; look and visit must not throw
  template <class Look, class Visit>
  void walk(Look&& look, Visit&& visit) const noexcept {
    if (balls_.empty()) return;
    struct waiting_branch {
      std::uint32_t first, end;
    };
    // Median splits halve the count, so 2^31 points need 32 levels and one waiting sibling at each.
    std::array<waiting_branch, 64> waiting;
    std::size_t count = 0;
    waiting[count++] = {0, static_cast<std::uint32_t>(balls_.size())};
    while (count > 0) {
      const auto [i, end] = waiting[--count];
      const std::uint32_t right = balls_[i].right;
      const branch_answer answer = look(branch{i, i + 1, right, this});
      if (answer == branch_answer::taken) {
        for (std::uint32_t l = i; l < end; ++l) {
          if (balls_[l].right == 0) visit_leaf(balls_[l], visit);
        }
      } else if (answer == branch_answer::open && right != 0) {
        waiting[count++] = {right, end};
        waiting[count++] = {i + 1, right};
      }
    }
  }

  /// walk() for a visitor that needs no numbers: look(sample_ball, is_leaf).
  /// @rt safe: no allocation; look and visit must not throw
  template <class Look, class Visit>
  void query(Look&& look, Visit&& visit) const noexcept {
    walk([&](const branch& b) noexcept { return look(b.ball(), b.is_leaf()); }, visit);
  }

  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(samples_, balls_); }

 private:
  class builder;
  friend class detail::field_parts;  // reads and writes trees

  // Depth-first layout: the left child follows its parent, `right` is 0 for a leaf.
  struct ball {
    glm::vec3 centre_b{0.0F}, axis_b{0.0F, 0.0F, 1.0F};
    float radius_m = 0.0F, half_m = 0.0F;
    std::uint32_t right = 0, first = 0, count = 0;

    [[nodiscard]] sample_ball in_double() const noexcept {
      return {vec3(centre_b), vec3(axis_b), static_cast<double>(radius_m), static_cast<double>(half_m)};
    }
  };

  template <class Visit>
  void visit_leaf(const ball& b, Visit& visit) const noexcept {
    visit(b.in_double(), std::span<const field_sample>(samples_).subspan(b.first, b.count));
  }

  std::vector<field_sample> samples_;
  std::vector<ball> balls_;
  std::size_t places_ = 0;
};

}  // namespace asperity
