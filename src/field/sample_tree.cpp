#include "asperity/field/sample_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "field/threads.hpp"

namespace asperity {
namespace {

/// A sample's place, and which one it is.
struct numbered_place {
  glm::vec3 at;
  std::uint32_t sample;
};

/// The direction along which points spread least, by the power method on the trace of their covariance less the
/// covariance. A direction that is not quite the best makes bounds a little wider, not wrong.
vec3 thinnest(std::span<const glm::vec3> points, const vec3& middle_b) noexcept {
  vec3 sum(0.0), squares(0.0), mixed(0.0);  // xx, yy, zz; xy, xz, yz
  double trace = 1e-30;
  for (const glm::vec3& p : points) {
    const vec3 d = vec3(p) - middle_b, square = d * d;
    sum += d;
    squares += square;
    mixed += vec3(d.x * d.y, d.x * d.z, d.y * d.z);
    trace += square.x + square.y + square.z;
  }
  mat3 rest(-squares.x, -mixed.x, -mixed.y, -mixed.x, -squares.y, -mixed.z, -mixed.y, -mixed.z, -squares.z);
  const double per_sample = 1.0 / static_cast<double>(points.size());
  rest += per_sample * glm::outerProduct(sum, sum);
  trace -= per_sample * glm::dot(sum, sum);
  for (int k = 0; k < 3; ++k) rest[k][k] += trace;
  constexpr int steps = 20;
  vec3 axis(0.48, 0.6, 0.64);
  for (int i = 0; i < steps; ++i) {
    const vec3 next = rest * axis;
    const double squared = glm::dot(next, next);
    if (!(squared > 0.0)) break;
    axis = next / std::sqrt(squared);
  }
  return axis;
}

}  // namespace

/// Splits samples at the median of their longest side, again and again. They are sorted once along each axis: a half
/// takes its own out of the three orders, and these stay sorted. The layout follows from counts alone, so branches can
/// be built at the same time.
class sample_tree::builder {
 public:
  builder(const std::vector<field_sample>& samples, unsigned threads)
      : samples_(samples),
        threads_(threads),
        balls_(balls_of(samples.size())),
        sorted_(samples.size()),
        in_first_half_(samples.size()),
        moved_(samples.size()),
        places_(samples.size()) {
    detail::for_each_task(3, threads, [&](std::size_t axis) { sort_along(axis); });
  }

  void build() {
    std::vector<std::uint32_t> given(samples_.size());
    for (std::size_t i = 0; i < given.size(); ++i) given[i] = static_cast<std::uint32_t>(i);
    std::vector<part> open{part{0, samples_.size(), 0, given.data()}};
    // Halves, until there are enough for all threads.
    while (threads_ > 1 && !open.empty() && open.size() < std::size_t{4} * threads_) {
      std::vector<std::array<part, 2>> halves(open.size());
      detail::for_each_task(open.size(), threads_, [&](std::size_t i) { halves[i] = split(open[i]); });
      open.clear();
      for (const auto& both : halves) {
        for (const part& half : both) {
          if (half.count > 0) open.push_back(half);
        }
      }
    }
    detail::for_each_task(open.size(), threads_, [&](std::size_t i) { build(open[i]); });
  }

  std::vector<ball>&& balls() noexcept { return std::move(balls_); }
  std::vector<field_sample>&& sorted() noexcept { return std::move(sorted_); }

 private:
  /// Samples from `first` on, the number of their ball, and the order in which their sums are taken.
  struct part {
    std::size_t first = 0, count = 0, self = 0;
    const std::uint32_t* order = nullptr;
  };

  // Ties by the other axes: the layout must not depend on the standard library's sort.
  void sort_along(std::size_t axis) {
    const int x = static_cast<int>(axis), y = (x + 1) % 3, z = (x + 2) % 3;
    std::vector<numbered_place> all(samples_.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = {samples_[i].position_b, static_cast<std::uint32_t>(i)};
    std::sort(all.begin(), all.end(), [&](const numbered_place& a, const numbered_place& b) {
      if (a.at[x] != b.at[x]) return a.at[x] < b.at[x];
      if (a.at[y] != b.at[y]) return a.at[y] < b.at[y];
      if (a.at[z] != b.at[z]) return a.at[z] < b.at[z];
      const field_sample &s = samples_[a.sample], &t = samples_[b.sample];
      return std::tie(s.axis_b.x, s.axis_b.y, s.axis_b.z, s.cone_rad) <
             std::tie(t.axis_b.x, t.axis_b.y, t.axis_b.z, t.cone_rad);
    });
    orders_[axis].resize(all.size());
    for (std::size_t i = 0; i < all.size(); ++i) orders_[axis][i] = all[i].sample;
  }

  void build(const part& whole) noexcept {
    for (const part& half : split(whole)) {
      if (half.count > 0) build(half);
    }
  }

  /// Makes a part's ball. @return its halves, empty ones for a leaf
  std::array<part, 2> split(const part& of) noexcept {
    const auto [first, count, self, order] = of;
    const std::span<glm::vec3> places = std::span(places_).subspan(first, count);
    glm::vec3 low = samples_[order[0]].position_b, high = low;
    for (std::size_t i = 0; i < count; ++i) {
      places[i] = samples_[order[i]].position_b;
      low = glm::min(low, places[i]);
      high = glm::max(high, places[i]);
    }
    ball& made = balls_[self];
    made = around(places, 0.5F * (low + high));
    made.first = static_cast<std::uint32_t>(first);
    made.count = static_cast<std::uint32_t>(count);
    if (count <= leaf_samples) {
      for (std::size_t i = 0; i < count; ++i) sorted_[first + i] = samples_[order[i]];
      return {};
    }
    const glm::vec3 size = high - low;
    const std::size_t axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
    const std::size_t half = count / 2;
    const std::uint32_t* const along = orders_[axis].data() + first;
    if (count - half > leaf_samples) halve_others(along, first, count, axis);
    const std::size_t right = self + 1 + balls_of(half);
    made.right = static_cast<std::uint32_t>(right);
    return {part{first, half, self + 1, along}, part{first + half, count - half, right, along + half}};
  }

  /// Brings the first half along an axis before the second one in the orders along the other axes.
  void halve_others(const std::uint32_t* along, std::size_t first, std::size_t count, std::size_t axis) noexcept {
    const std::size_t half = count / 2;
    for (std::size_t i = 0; i < count; ++i) in_first_half_[along[i]] = i < half ? 1 : 0;
    for (const std::size_t other : {(axis + 1) % 3, (axis + 2) % 3}) {
      std::uint32_t* const order = orders_[other].data() + first;
      std::uint32_t* const second = moved_.data() + first;
      std::size_t kept = 0, moved = 0;
      for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t s = order[i];
        const std::size_t stays = in_first_half_[s];
        order[kept] = s;
        second[moved] = s;
        kept += stays;
        moved += 1 - stays;
      }
      std::copy(second, second + moved, order + kept);
    }
  }

  // Rounding a radius down would leave a sample outside, so both extents are rounded up.
  [[nodiscard]] static ball around(std::span<const glm::vec3> places, const glm::vec3& middle_b) noexcept {
    ball out;
    out.axis_b = glm::vec3(thinnest(places, vec3(middle_b)));
    double bottom = 1e30, top = -1e30;
    for (const glm::vec3& p : places) {
      const double z = glm::dot(vec3(p) - vec3(middle_b), vec3(out.axis_b));
      bottom = std::min(bottom, z);
      top = std::max(top, z);
    }
    out.centre_b = glm::vec3(vec3(middle_b) + 0.5 * (bottom + top) * vec3(out.axis_b));
    double far2 = 0.0, off = 0.0;
    for (const glm::vec3& p : places) {
      const vec3 d = vec3(p) - vec3(out.centre_b);
      far2 = std::max(far2, glm::dot(d, d));
      off = std::max(off, std::fabs(glm::dot(d, vec3(out.axis_b))));
    }
    out.radius_m = std::nextafter(static_cast<float>(std::sqrt(far2)), 1e30F);
    out.half_m = std::nextafter(static_cast<float>(off), 1e30F);
    return out;
  }

  const std::vector<field_sample>& samples_;
  unsigned threads_;
  std::vector<ball> balls_;
  std::vector<field_sample> sorted_;
  std::array<std::vector<std::uint32_t>, 3> orders_;  // samples, part by part, sorted along each axis
  std::vector<std::uint8_t> in_first_half_;           // by sample
  std::vector<std::uint32_t> moved_;                  // room for what halve_others() moves
  std::vector<glm::vec3> places_;                     // of a part's samples, in the order of its sums
};

sample_tree::sample_tree(std::vector<field_sample> samples, unsigned threads) {
  if (samples.empty()) return;
  builder made(samples, detail::resolve_threads(threads));
  made.build();
  samples_ = made.sorted();
  balls_ = made.balls();
}

}  // namespace asperity
