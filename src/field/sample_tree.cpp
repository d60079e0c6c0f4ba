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

#include "field/thinnest.hpp"
#include "field/threads.hpp"

namespace asperity {
namespace {

/// Where a place is, and which one it is.
struct numbered_place {
  glm::vec3 at;
  std::uint32_t place;
};

}  // namespace

/// Splits places at the median of their longest side, again and again. They are sorted once along each axis: a half
/// takes its own out of the three orders, and these stay sorted. The layout follows from counts alone, so branches can
/// be built at the same time.
class sample_tree::builder {
 public:
  builder(const placed_samples& samples, unsigned threads)
      : samples_(samples.all),
        threads_(threads),
        first_at_(first_of_places(samples)),
        balls_(balls_of(places())),
        sorted_(samples_.size()),
        in_first_half_(places()),
        moved_(places()),
        positions_(samples_.size()) {
    detail::for_each_task(3, threads, [&](std::size_t axis) { sort_along(axis); });
  }

  void build() {
    std::vector<std::uint32_t> given(places());
    for (std::size_t i = 0; i < given.size(); ++i) given[i] = static_cast<std::uint32_t>(i);
    std::vector<part> open{part{0, places(), 0, 0, given.data()}};
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

  [[nodiscard]] std::size_t places() const noexcept { return first_at_.size() - 1; }
  std::vector<ball>&& balls() noexcept { return std::move(balls_); }
  std::vector<field_sample>&& sorted() noexcept { return std::move(sorted_); }

 private:
  /// Places from `first` on, of which the first sample has this number, the number of their ball, and the order in which
  /// their sums are taken.
  struct part {
    std::size_t first = 0, count = 0, sample = 0, self = 0;
    const std::uint32_t* order = nullptr;
  };

  // The first sample of each place, and the end of the last one.
  [[nodiscard]] static std::vector<std::uint32_t> first_of_places(const placed_samples& samples) {
    const bool own = samples.at_place.empty();
    std::vector<std::uint32_t> out{0};
    out.reserve((own ? samples.all.size() : samples.at_place.size()) + 1);
    while (out.back() < samples.all.size()) out.push_back(out.back() + (own ? 1U : samples.at_place[out.size() - 1]));
    return out;
  }
  [[nodiscard]] std::span<const field_sample> at(std::uint32_t place) const noexcept {
    return std::span(samples_).subspan(first_at_[place], first_at_[place + 1] - first_at_[place]);
  }
  // Which stands for a place in orders.
  [[nodiscard]] const field_sample& middle_of(std::uint32_t place) const noexcept {
    const std::span<const field_sample> all = at(place);
    return all[all.size() / 2];
  }

  // Ties by the other axes: the layout must not depend on the standard library's sort.
  void sort_along(std::size_t axis) {
    const int x = static_cast<int>(axis), y = (x + 1) % 3, z = (x + 2) % 3;
    std::vector<numbered_place> all(places());
    for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = {middle_of(i).position_b, i};
    std::sort(all.begin(), all.end(), [&](const numbered_place& a, const numbered_place& b) {
      if (a.at[x] != b.at[x]) return a.at[x] < b.at[x];
      if (a.at[y] != b.at[y]) return a.at[y] < b.at[y];
      if (a.at[z] != b.at[z]) return a.at[z] < b.at[z];
      const field_sample &s = middle_of(a.place), &t = middle_of(b.place);
      return std::tie(s.axis_b.x, s.axis_b.y, s.axis_b.z, s.cone_rad) <
             std::tie(t.axis_b.x, t.axis_b.y, t.axis_b.z, t.cone_rad);
    });
    orders_[axis].resize(all.size());
    for (std::size_t i = 0; i < all.size(); ++i) orders_[axis][i] = all[i].place;
  }

  void build(const part& whole) noexcept {
    for (const part& half : split(whole)) {
      if (half.count > 0) build(half);
    }
  }

  /// Makes a part's ball. @return its halves, empty ones for a leaf
  std::array<part, 2> split(const part& of) noexcept {
    const auto [first, count, sample, self, order] = of;
    std::size_t end = sample;
    glm::vec3 low = middle_of(order[0]).position_b, high = low;
    for (std::size_t i = 0; i < count; ++i) {
      for (const field_sample& s : at(order[i])) {
        positions_[end++] = s.position_b;
        low = glm::min(low, s.position_b);
        high = glm::max(high, s.position_b);
      }
    }
    ball& made = balls_[self];
    made = around(std::span(positions_).subspan(sample, end - sample), 0.5F * (low + high));
    made.first = static_cast<std::uint32_t>(sample);
    made.count = static_cast<std::uint32_t>(end - sample);
    if (count <= leaf_places) {
      end = sample;
      for (std::size_t i = 0; i < count; ++i) {
        for (const field_sample& s : at(order[i])) sorted_[end++] = s;
      }
      return {};
    }
    const glm::vec3 size = high - low;
    const std::size_t axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
    const std::size_t half = count / 2;
    const std::uint32_t* const along = orders_[axis].data() + first;
    if (count - half > leaf_places) halve_others(along, first, count, axis);
    const std::size_t right = self + 1 + balls_of(half);
    made.right = static_cast<std::uint32_t>(right);
    std::size_t middle = sample;
    for (std::size_t i = 0; i < half; ++i) middle += at(along[i]).size();
    return {part{first, half, sample, self + 1, along}, part{first + half, count - half, middle, right, along + half}};
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
  [[nodiscard]] static ball around(std::span<const glm::vec3> points, const glm::vec3& middle_b) noexcept {
    ball out;
    out.axis_b = glm::vec3(detail::thinnest(points, vec3(middle_b)));
    double bottom = 1e30, top = -1e30;
    for (const glm::vec3& p : points) {
      const double z = glm::dot(vec3(p) - vec3(middle_b), vec3(out.axis_b));
      bottom = std::min(bottom, z);
      top = std::max(top, z);
    }
    out.centre_b = glm::vec3(vec3(middle_b) + 0.5 * (bottom + top) * vec3(out.axis_b));
    double far2 = 0.0, off = 0.0;
    for (const glm::vec3& p : points) {
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
  std::vector<std::uint32_t> first_at_;  // by place
  std::vector<ball> balls_;
  std::vector<field_sample> sorted_;
  std::array<std::vector<std::uint32_t>, 3> orders_;  // places, part by part, sorted along each axis
  std::vector<std::uint8_t> in_first_half_;           // by place
  std::vector<std::uint32_t> moved_;                  // room for what halve_others() moves
  std::vector<glm::vec3> positions_;                  // of a part's samples, in the order of its sums
};

sample_tree::sample_tree(placed_samples samples, unsigned threads) {
  if (samples.all.empty()) return;
  builder made(samples, detail::resolve_threads(threads));
  made.build();
  places_ = made.places();
  samples_ = made.sorted();
  balls_ = made.balls();
}

}  // namespace asperity
