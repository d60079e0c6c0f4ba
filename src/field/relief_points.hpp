// Points of the fine surface that the relief of a depth field is fitted to, brick by brick.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "asperity/field/body_field.hpp"
#include "field/fine_surface.hpp"
#include "field/lanes.hpp"
#include "field/threads.hpp"

namespace asperity::detail {

/// Takes points, and numbers the bricks in which relief is needed for them: the first brick stands for all places without
/// one. The points lie sorted by their bricks, and in the order of the surface within one, whatever the threads.
class relief_points {
 public:
  /// A point of the fine surface, by its foot on S = 0.
  struct point {
    glm::vec3 place;  // of the foot in its brick, in pitches from the brick's first node: -0.5 to 3.5
    glm::vec3 along;  // to the place above, pitches
    float relief_m;
    std::uint32_t cell;  // of its brick in the index
  };

  static constexpr double off_surface = 0.6;  // pitches: reaches all nodes within two pitches of the surface

  /// @param out  gets the bricks' numbers   @param field  with its smooth part
  relief_points(relief_bricks& out, const body_field& field) : out_(out), field_(field) {
    out_.index.assign(out_.bricks_along[0] * out_.bricks_along[1] * out_.bricks_along[2], 0);
  }

  /// Takes the points of a model's fine surface. @param step_m  how far apart   @param count  about how many there are
  void take(const textured_model& model, double step_m, double count, unsigned threads) {
    const std::size_t triangles = model.mesh.triangles.size(), parts = parts_for(triangles, threads);
    taken_.resize(parts);
    for_each_task(parts, threads, [&](std::size_t i) {
      const triangle_range which{part_begin(triangles, parts, i), part_begin(triangles, parts, i + 1)};
      taken_[i].points.reserve(static_cast<std::size_t>(count / static_cast<double>(parts)));
      for_each_fine_point(model, which, step_m, [&](const vec3& p_b) { add(p_b, taken_[i]); });
    });
    for (taken& part : taken_) {
      for (const brick_range& bricks : part.needed) number(bricks);
      part.needed = std::vector<brick_range>();
      lowest_ = std::min(lowest_, part.lowest);
      highest_ = std::max(highest_, part.highest);
    }
    sort();
  }

  /// How many points were taken.
  [[nodiscard]] std::size_t points() const noexcept { return points_.size(); }
  /// A brick's, by its number; none for the first.
  [[nodiscard]] std::span<const point> of(std::size_t brick) const noexcept {
    return std::span(points_).subspan(first_[brick], first_[brick + 1] - first_[brick]);
  }
  /// Places of the numbered bricks in the index.
  [[nodiscard]] const std::vector<std::uint32_t>& cells() const noexcept { return cells_; }
  /// The least and the largest relief of a point, and zero.
  [[nodiscard]] float lowest_m() const noexcept { return lowest_; }
  [[nodiscard]] float highest_m() const noexcept { return highest_; }

  /// Calls visit(number, foot_b, inwards) for the feet of some points, brick by brick, with the unit slope of the smooth
  /// part.
  template <class Visit>
  void for_each_foot(std::size_t begin, std::size_t end, Visit&& visit) const {
    const auto [nx, ny, nz] = out_.bricks_along;
    for (std::size_t i = begin; i < end; ++i) {
      const point& p = points_[i];
      const vec3 brick(static_cast<double>(p.cell % nx), static_cast<double>(p.cell / nx % ny),
                       static_cast<double>(p.cell / (nx * ny)));
      visit(i, out_.low + out_.pitch_m * (static_cast<double>(side) * brick + vec3(p.place)),
            vec3(p.along) / off_surface);
    }
  }

 private:
  static constexpr std::size_t side = relief_bricks::side;

  /// A brick, and by the bits of x, y and z the ones after it.
  struct brick_range {
    std::uint32_t first = 0, more = 0;
    friend bool operator==(const brick_range&, const brick_range&) = default;
  };

  /// Points of some triangles, and the bricks that they need.
  struct taken {
    std::vector<point> points;
    std::vector<brick_range> needed;
    std::array<brick_range, 2> latest{};  // by side
    float lowest = 0.0F, highest = 0.0F;  // of the points' relief, and zero
  };

  /// Takes a point of the fine surface. Leaves out points that the smooth part has lost or covered (folds).
  void add(const vec3& p_b, taken& to) const {
    const coarse_reading at = read_smooth(p_b);
    if (!(std::fabs(at.value_m) < 1.25 * field_.smooth.pitch_m)) return;
    const foot_and_fade foot = field_.foot(p_b, at);
    const double length = std::sqrt(glm::dot(at.slope, at.slope));
    if (!(length > 0.05) || !(foot.fade > 0.25)) return;
    const vec3 q = (foot.foot_b - out_.low) / out_.pitch_m;
    const vec3 along = off_surface / length * at.slope;
    const auto wanted = static_cast<float>(-at.value_m / foot.fade);
    point p{{}, glm::vec3(along), wanted, 0};
    std::array<std::size_t, 3> brick{};
    std::array<std::array<std::size_t, 3>, 2> first{};  // bricks, by side
    std::array<brick_range, 2> needed{};
    for (std::size_t k = 0; k < 3; ++k) {
      const int axis = static_cast<int>(k);
      // Three nodes around the places above and below.
      if (!(q[axis] >= 3.0 && q[axis] < static_cast<double>(side * out_.bricks_along[k]) - 3.0)) return;
      brick[k] = static_cast<std::size_t>(std::floor(q[axis] + 0.5)) / side;
      p.place[axis] = static_cast<float>(q[axis] - static_cast<double>(side * brick[k]));
      for (std::size_t s = 0; s < 2; ++s) {
        const auto middle = static_cast<std::size_t>(q[axis] + 0.5 + (s == 0 ? -along[axis] : along[axis]));
        first[s][k] = (middle - 1) / side;
        if ((middle + 1) / side != first[s][k]) needed[s].more |= 1U << k;
      }
    }
    p.cell = cell_of(brick);
    for (std::size_t s = 0; s < 2; ++s) {
      needed[s].first = cell_of(first[s]);
      if (needed[s] == to.latest[s]) continue;
      to.latest[s] = needed[s];
      to.needed.push_back(needed[s]);
    }
    to.points.push_back(p);
    to.lowest = std::min(to.lowest, wanted);
    to.highest = std::max(to.highest, wanted);
  }

  /// Value and slope of the smooth part, in single precision: some 1e-6 pitches.
  [[nodiscard]] coarse_reading read_smooth(const vec3& p_b) const noexcept {
    const coarse_grid& grid = field_.smooth;
    coarse_reading out;
    std::array<std::size_t, 3> first{};
    std::array<std::array<float, 4>, 3> value{}, slope{};
    for (std::size_t k = 0; k < 3; ++k) {
      const int axis = static_cast<int>(k);
      const double g = (p_b[axis] - grid.low[axis]) / grid.pitch_m;
      if (!(g >= 1.0 && g < static_cast<double>(grid.nodes[k]) - 2.0)) {
        out.value_m = -1e30;
        return out;
      }
      first[k] = static_cast<std::size_t>(g) - 1;
      const cubic_weights w(g - 1.0 - static_cast<double>(first[k]));
      for (std::size_t i = 0; i < 4; ++i) {
        value[k][i] = static_cast<float>(w.value[i]);
        slope[k][i] = static_cast<float>(w.slope[i]);
      }
    }
    lanes s{}, sy{}, sz{};
    for (std::size_t k = 0; k < 4; ++k) {
      for (std::size_t j = 0; j < 4; ++j) {
        const lanes row = load_lanes(grid.value.data() + grid.at(first[0], first[1] + j, first[2] + k));
        s += value[1][j] * value[2][k] * row;
        sy += slope[1][j] * value[2][k] * row;
        sz += value[1][j] * slope[2][k] * row;
      }
    }
    const lanes x = load_lanes(value[0].data());
    const glm::vec3 by(sum_of(load_lanes(slope[0].data()) * s), sum_of(x * sy), sum_of(x * sz));
    const float v = sum_of(x * s);
    out.value_m = static_cast<double>(v);
    out.slope = vec3(by) / grid.pitch_m;
    return out;
  }

  [[nodiscard]] std::uint32_t cell_of(const std::array<std::size_t, 3>& brick) const noexcept {
    return static_cast<std::uint32_t>((brick[2] * out_.bricks_along[1] + brick[1]) * out_.bricks_along[0] + brick[0]);
  }

  /// Numbers the bricks that points need.
  void number(const brick_range& needed) {
    const std::size_t row = out_.bricks_along[0], layer = row * out_.bricks_along[1];
    for (std::size_t n = 0; n < 8; ++n) {
      if ((n & ~std::size_t{needed.more}) != 0) continue;
      const std::size_t cell = needed.first + (n & 1) + (n >> 1 & 1) * row + (n >> 2) * layer;
      if (out_.index[cell] != 0) continue;
      out_.index[cell] = static_cast<std::uint32_t>(cells_.size());
      cells_.push_back(static_cast<std::uint32_t>(cell));
    }
  }

  /// Sorts the points by their bricks.
  void sort() {
    first_.assign(cells_.size() + 1, 0);
    for (const taken& part : taken_) {
      for (const point& p : part.points) ++first_[out_.index[p.cell] + 1];
    }
    for (std::size_t b = 1; b < first_.size(); ++b) first_[b] += first_[b - 1];
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    points_.resize(first_.back());
    for (const taken& part : taken_) {
      for (const point& p : part.points) points_[next[out_.index[p.cell]]++] = p;
    }
    taken_ = std::vector<taken>();
  }

  relief_bricks& out_;
  const body_field& field_;
  std::vector<taken> taken_;             // until they are sorted by their bricks
  std::vector<point> points_;            // sorted
  std::vector<std::uint32_t> cells_{0};  // of the bricks, in the index
  std::vector<std::uint32_t> first_;     // of each brick's points
  float lowest_ = 0.0F, highest_ = 0.0F;
};

}  // namespace asperity::detail
