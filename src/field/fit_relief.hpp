// Fits the relief of a depth field to the fine surface.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "asperity/field/body_field.hpp"
#include "field/fine_surface.hpp"
#include "field/lanes.hpp"
#include "field/threads.hpp"

namespace asperity::detail {

/// Least squares over points of the fine surface: at the foot of each, the relief is what the smooth part lacks there.
///
/// A B-spline with samples as coefficients would smooth the texture away; the fit does not. It goes by simultaneous
/// iteration (SIRT: residuals, averaged at the nodes by their weights, correct the coefficients). The first pass
/// averages, and counts each point above and below the surface along its normal, so that the relief does not change
/// across the surface. The others correct what is read at the feet, with Chebyshev's step lengths for wavelengths from
/// three pitches up, and go on where residuals are left: beside sharp edges.
///
/// All passes go brick by brick, over a dense copy of a brick with what lies around it. A thread has a slab of bricks for
/// itself. It goes through the points in their order, those of the bricks beside its slab as well, and adds to its own
/// bricks alone: whatever the slabs, each sum has the same addends in the same order.
/// @source Gilbert, Iterative methods for the three-dimensional reconstruction of an object from projections, 1972
class relief_fit {
 public:
  /// @param fine_enough_m  residuals that need no further pass
  relief_fit(relief_bricks& out, const body_field& field, double fine_enough_m, unsigned threads)
      : out_(out), field_(field), fine_enough_(static_cast<float>(fine_enough_m)), threads_(threads) {
    out_.index.assign(out_.bricks_along[0] * out_.bricks_along[1] * out_.bricks_along[2], 0);
  }

  /// Takes the points of a model's fine surface. @param step_m  how far apart   @param count  about how many there are
  void take_points(const textured_model& model, double step_m, double count) {
    const std::size_t triangles = model.mesh.triangles.size(), parts = parts_for(triangles, threads_);
    taken_.resize(parts);
    for_each_task(parts, threads_, [&](std::size_t i) {
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
  }

  void solve() {
    sort();
    lay_slabs();
    const std::size_t count = cells_.size();
    work_.assign(count, {});
    residual_.assign(count, 0.0F);
    rows_.assign(count, 0);
    for_each_brick([&](std::size_t b, const slab& own) noexcept { average(b, own); });
    correct(1.0F, true);
    for_each_brick([&](std::size_t b, const slab& own) noexcept { compare(b, true, own); });
    correct(1.816F, false);
    for (int pass = 0; pass < most_passes; ++pass) {
      const std::vector<float> before = std::exchange(residual_, std::vector<float>(count, 0.0F));
      std::atomic<bool> any{false};
      for_each_brick([&](std::size_t b, const slab& own) noexcept {
        if (!unsettled(b, before)) return;
        any.store(true, std::memory_order_relaxed);
        compare(b, false, own);
      });
      if (!any) break;
      constexpr std::array<float, 4> steps{2.669F, 1.251F, 1.026F, 1.816F};
      correct(steps[static_cast<std::size_t>(pass) % 4], false);
    }
    finish();
  }

  /// How many points were taken.
  [[nodiscard]] std::size_t points() const noexcept { return points_.size(); }

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
  static constexpr double off_surface = 0.6;  // pitches: reaches all nodes within two pitches of the surface
  static constexpr int most_passes = 2;

  struct point {
    glm::vec3 place;  // of the foot in its brick, in pitches from the brick's first node: -0.5 to 3.5
    glm::vec3 along;  // to the place above, pitches
    float relief_m;
    std::uint32_t cell;  // of its brick in the index
  };

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

  /// Four nodes of a brick along x, stored together because they are read together.
  struct work_row {
    lanes value{}, sum{}, weight{};
  };
  using work_brick = std::array<work_row, side * side>;

  /// The bricks that a thread adds to: from one to before another along the box's longest side.
  struct slab {
    std::size_t begin = 0, end = 0;
  };

  /// A brick and two nodes around it, x fastest.
  static constexpr std::size_t reach = 2, across = side + 2 * reach, lanes_across = across / 4;
  struct dense {
    std::array<lanes, across * across * lanes_across> at{};
  };

  /// Weights of the three nodes around a place along each axis.
  struct stencil {
    std::size_t first;                  // its first row in a dense copy, in lanes
    std::array<lanes, lanes_across> x;  // of the nodes of a row, most of them 0
    std::array<float, 9> yz;

    explicit stencil(const glm::vec3& place) noexcept {
      const float g = place.x + static_cast<float>(reach);
      const lanes zero{}, node{0.0F, 1.0F, 2.0F, 3.0F};
      for (std::size_t h = 0; h < lanes_across; ++h) {
        const lanes from = node + (static_cast<float>(4 * h) - g), d = from > zero ? from : -from;
        const lanes outer = d < 1.5F ? 1.5F - d : zero, inner = d < 0.5F ? 0.5F - d : zero;
        x[h] = 0.5F * outer * outer - 1.5F * inner * inner;
      }
      std::array<std::int32_t, 2> from{};
      std::array<std::array<float, 3>, 2> w{};
      for (std::size_t k = 0; k < 2; ++k) {
        const float c = place[static_cast<int>(k) + 1] + (static_cast<float>(reach) + 0.5F);
        const auto middle = static_cast<std::int32_t>(c);
        const float f = c - 0.5F - static_cast<float>(middle);
        from[k] = middle - 1;
        w[k] = {0.5F * (0.5F - f) * (0.5F - f), 0.75F - f * f, 0.5F * (0.5F + f) * (0.5F + f)};
      }
      first = (static_cast<std::size_t>(from[1]) * across + static_cast<std::size_t>(from[0])) * lanes_across;
      for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t j = 0; j < 3; ++j) yz[3 * k + j] = w[1][k] * w[0][j];
      }
    }

    /// Its rows of a dense copy, a bit each.
    [[nodiscard]] std::uint64_t rows() const noexcept { return std::uint64_t{0x070707} << (first / lanes_across); }

    [[nodiscard]] float read(const dense& from) const noexcept {
      lanes low{}, high{};
      const lanes* layer = from.at.data() + first;
      for (std::size_t k = 0; k < 3; ++k, layer += across * lanes_across) {
        for (std::size_t j = 0; j < 3; ++j) {
          low += yz[3 * k + j] * layer[lanes_across * j];
          high += yz[3 * k + j] * layer[lanes_across * j + 1];
        }
      }
      return sum_of(low * x[0] + high * x[1]);
    }

    /// Adds a number by the weights.
    void add(dense& to, float number) const noexcept {
      const lanes low = number * x[0], high = number * x[1];
      lanes* layer = to.at.data() + first;
      for (std::size_t k = 0; k < 3; ++k, layer += across * lanes_across) {
        for (std::size_t j = 0; j < 3; ++j) {
          layer[lanes_across * j] += yz[3 * k + j] * low;
          layer[lanes_across * j + 1] += yz[3 * k + j] * high;
        }
      }
    }
  };

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

  /// Cuts the box of bricks across its longest side into slabs of about as many points.
  void lay_slabs() {
    const auto& along = out_.bricks_along;
    const std::size_t axis = along[0] >= along[1] && along[0] >= along[2] ? 0 : (along[1] >= along[2] ? 1 : 2),
                      layers = along[axis];
    const std::size_t step = axis == 0 ? 1 : (axis == 1 ? along[0] : along[0] * along[1]);
    layer_.resize(cells_.size());
    std::vector<std::size_t> before(layers + 1, 0);  // points in layers before
    for (std::size_t b = 1; b < cells_.size(); ++b) {
      layer_[b] = static_cast<std::uint32_t>(cells_[b] / step % layers);
      before[layer_[b] + 1] += first_[b + 1] - first_[b];
    }
    for (std::size_t l = 0; l < layers; ++l) before[l + 1] += before[l];
    const std::size_t most = threads_ > 1 ? std::size_t{2} * threads_ : 1;
    slabs_.assign(1, {0, layers});
    for (std::size_t i = 1; i < most; ++i) {
      const auto cut = static_cast<std::size_t>(
          std::lower_bound(before.begin(), before.end(), part_begin(before[layers], most, i)) - before.begin());
      // Thinner ones would go through more points of others than of their own.
      constexpr std::size_t thinnest = 4;
      if (cut < slabs_.back().begin + thinnest || cut + thinnest > layers) continue;
      slabs_.back().end = cut;
      slabs_.push_back({cut, layers});
    }
  }

  /// Calls visit(brick, slab) for the bricks with points whose sums reach into a slab, in their order.
  template <class Visit>
  void for_each_brick(const Visit& visit) const {
    for_each_task(slabs_.size(), threads_, [&](std::size_t s) {
      const slab& own = slabs_[s];
      for (std::size_t b = 1; b < cells_.size(); ++b) {
        if (layer_[b] + 1 < own.begin || layer_[b] > own.end || first_[b] == first_[b + 1]) continue;
        visit(b, own);
      }
    });
  }

  [[nodiscard]] bool owns(const slab& own, std::size_t brick) const noexcept {
    return layer_[brick] >= own.begin && layer_[brick] < own.end;
  }

  /// Calls visit(brick, number) for a brick and the 26 around it; number 0 to 26, x fastest.
  template <class Visit>
  void for_each_beside(std::size_t brick, Visit&& visit) const noexcept {
    const auto [nx, ny, nz] = out_.bricks_along;
    const std::size_t cell = cells_[brick], x = cell % nx, y = cell / nx % ny, z = cell / (nx * ny);
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t j = 0; j < 3; ++j) {
        for (std::size_t i = 0; i < 3; ++i) {
          const bool inside = x + i >= 1 && x + i <= nx && y + j >= 1 && y + j <= ny && z + k >= 1 && z + k <= nz;
          visit(inside ? out_.index[((z + k - 1) * ny + y + j - 1) * nx + x + i - 1] : 0U, (3 * k + j) * 3 + i);
        }
      }
    }
  }

  [[nodiscard]] std::array<std::uint32_t, 27> beside(std::size_t brick) const noexcept {
    std::array<std::uint32_t, 27> out{};
    for_each_beside(brick, [&](std::uint32_t b, std::size_t number) noexcept { out[number] = b; });
    return out;
  }

  /// Calls visit(three bricks, row in each of them, dense row) for rows around a brick, by their bits.
  template <class Visit>
  static void for_each_row(const std::array<std::uint32_t, 27>& around, std::uint64_t rows, Visit&& visit) noexcept {
    for (; rows != 0; rows &= rows - 1) {
      const auto at = static_cast<std::size_t>(std::countr_zero(rows));
      const std::size_t z = at / across + side - reach, y = at % across + side - reach;
      visit(around.data() + (3 * (z / side) + y / side) * 3, z % side * side + y % side, at * lanes_across);
    }
  }

  /// The bricks around one that are a thread's own; 0 for all others.
  [[nodiscard]] std::array<std::uint32_t, 27> own_of(std::array<std::uint32_t, 27> around,
                                                     const slab& own) const noexcept {
    for (std::uint32_t& b : around) {
      if (!owns(own, b)) b = 0;
    }
    return around;
  }

  void scatter(const dense& from, const std::array<std::uint32_t, 27>& around, std::uint64_t rows,
               lanes work_row::*to) noexcept {
    for_each_row(around, rows, [&](const std::uint32_t* bricks, std::size_t row, std::size_t at) noexcept {
      const lanes &a = from.at[at], &b = from.at[at + 1];
      if (bricks[1] != 0) work_[bricks[1]][row].*to += lanes{a[2], a[3], b[0], b[1]};
      if (bricks[0] != 0 && (a[0] != 0.0F || a[1] != 0.0F)) {
        work_[bricks[0]][row].*to += lanes{0.0F, 0.0F, a[0], a[1]};
      }
      if (bricks[2] != 0 && (b[2] != 0.0F || b[3] != 0.0F)) {
        work_[bricks[2]][row].*to += lanes{b[2], b[3], 0.0F, 0.0F};
      }
    });
  }

  /// Sums of the relief that the points of a brick ask for, above and below the surface.
  void average(std::size_t brick, const slab& own) noexcept {
    dense sum, weight;
    std::uint64_t rows = 0, at_feet = 0;
    for (std::size_t i = first_[brick]; i < first_[brick + 1]; ++i) {
      const point& p = points_[i];
      for (const float way : {-1.0F, 1.0F}) {
        const stencil at(p.place + way * p.along);
        at.add(weight, 1.0F);
        at.add(sum, p.relief_m);
        rows |= at.rows();
      }
      at_feet |= stencil(p.place).rows();
    }
    if (owns(own, brick)) rows_[brick] = at_feet;
    const auto around = own_of(beside(brick), own);
    scatter(sum, around, rows, &work_row::sum);
    scatter(weight, around, rows, &work_row::weight);
  }

  /// Sums of the residuals of a brick's points: their relief less what is read at their feet.
  void compare(std::size_t brick, bool weigh, const slab& own) noexcept {
    const auto around = beside(brick);
    dense value, sum, weight;
    for_each_row(around, rows_[brick], [&](const std::uint32_t* bricks, std::size_t row, std::size_t at) noexcept {
      const lanes &low = work_[bricks[0]][row].value, &middle = work_[bricks[1]][row].value;
      value.at[at] = lanes{0.0F, low[3], middle[0], middle[1]};
      value.at[at + 1] = lanes{middle[2], middle[3], work_[bricks[2]][row].value[0], 0.0F};
    });
    float most = 0.0F;
    for (std::size_t i = first_[brick]; i < first_[brick + 1]; ++i) {
      const point& p = points_[i];
      const stencil at(p.place);
      const float rest = p.relief_m - at.read(value);
      most = std::max(most, std::fabs(rest));
      at.add(sum, rest);
      if (weigh) at.add(weight, 1.0F);
    }
    if (owns(own, brick)) residual_[brick] = most;
    const auto to = own_of(around, own);
    scatter(sum, to, rows_[brick], &work_row::sum);
    if (weigh) scatter(weight, to, rows_[brick], &work_row::weight);
  }

  /// Whether points of a brick or beside it still have residuals. @param residual by brick
  [[nodiscard]] bool unsettled(std::size_t brick, const std::vector<float>& residual) const noexcept {
    bool out = false;
    for_each_beside(brick, [&](std::uint32_t b, std::size_t) noexcept { out = out || residual[b] > fine_enough_; });
    return out;
  }

  // The first brick stands for all places without one and stays zero.
  void correct(float step, bool forget_weights) {
    for_each_part(work_.size(), threads_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b) {
        for (work_row& row : work_[b]) {
          row.value += step * row.sum / (row.weight + 1e-30F);  // no weight, no sum
          row.sum = lanes{};
          if (forget_weights) row.weight = lanes{};
        }
      }
    });
  }

  /// Hands the coefficients over. Leaves out bricks whose coefficients are next to zero, on flat faces.
  void finish() {
    const float nothing = 0.01F * fine_enough_;
    std::uint32_t kept = 1;
    std::vector<char> keeps(work_.size());
    for_each_part(work_.size(), threads_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b) {
        float most = 0.0F;
        for (const work_row& row : work_[b]) {
          for (std::size_t i = 0; i < side; ++i) most = std::max(most, std::fabs(row.value[i]));
        }
        keeps[b] = most > nothing;
      }
    });
    for (std::size_t b = 1; b < work_.size(); ++b) out_.index[cells_[b]] = keeps[b] != 0 ? kept++ : 0;
    out_.bricks.assign(kept, relief_bricks::brick{});
    for_each_part(work_.size(), threads_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b) {
        if (b == 0 || out_.index[cells_[b]] == 0) continue;
        relief_bricks::brick& to = out_.bricks[out_.index[cells_[b]]];
        for (std::size_t row = 0; row < side * side; ++row) {
          for (std::size_t i = 0; i < side; ++i) {
            // At sharp corners few points determine a coefficient; it is limited because coefficients bound the relief.
            to[row * side + i] = std::min(std::max(1.25F * lowest_, work_[b][row].value[i]), 1.25F * highest_);
          }
        }
      }
    });
    work_ = std::vector<work_brick>();
  }

  relief_bricks& out_;
  const body_field& field_;
  float fine_enough_;
  unsigned threads_;
  std::vector<taken> taken_;             // until they are sorted by their bricks
  std::vector<point> points_;            // sorted
  std::vector<std::uint32_t> cells_{0};  // of the bricks, in the index
  std::vector<std::uint32_t> layer_;     // of the bricks, along the box's longest side
  std::vector<std::uint32_t> first_;     // of each brick's points
  std::vector<slab> slabs_;
  std::vector<work_brick> work_;
  std::vector<std::uint64_t> rows_;       // of each brick's dense copy, that its points' feet reach
  std::vector<float> residual_;           // the largest of each brick's points
  float lowest_ = 0.0F, highest_ = 0.0F;  // of the points' relief, and zero
};

}  // namespace asperity::detail
