// Finds the samples in the middle of plain faces, which tell nothing that those around them do not.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <numbers>
#include <utility>
#include <vector>

#include "asperity/core/math.hpp"
#include "asperity/field/sample_tree.hpp"
#include "field/thinnest.hpp"
#include "field/threads.hpp"

namespace asperity::detail {

/// Samples that tell planes, and those that need not.
struct thinned_samples {
  placed_samples told, plain;
};

/// Takes the plain samples out of a body's. A sample is plain where it and all samples around it lie in one plane: the
/// depth in another body, over a part of a plane, is greatest at the border of that part, or where the other body stands
/// out, and a point of that body tells it there. Of plain samples one in every few pitches stays: a much larger body, whose
/// own samples lie much further apart, bends or waves between these.
class plain_thinning {
 public:
  /// @param all  of a body   @param pitch_m  distance between samples on its faces
  plain_thinning(const placed_samples& all, double pitch_m) : all_(all), pitch_m_(pitch_m) {
    if (all.all.empty()) return;
    glm::vec3 high = low_ = all.all[0].position_b;
    for (const field_sample& s : all.all) {
      low_ = glm::min(low_, s.position_b);
      high = glm::max(high, s.position_b);
    }
    const glm::vec3 size = high - low_;
    least_cell_m_ = static_cast<double>(std::max({size.x, size.y, size.z})) / most_cells;
    by_cell_.reserve(all.all.size());
    for (std::uint32_t i = 0; i < all.all.size(); ++i) by_cell_.push_back({key_of(cell_of(i, around)), i});
    std::sort(by_cell_.begin(), by_cell_.end());
  }

  /// @param threads  that look; what is found does not depend on them
  [[nodiscard]] thinned_samples apart(unsigned threads) const {
    const std::vector<std::uint8_t> out = left_out(threads);
    thinned_samples both;
    std::size_t first = 0;
    for (std::size_t place = 0; first < all_.all.size(); ++place) {
      const std::size_t count = all_.at_place.empty() ? 1 : all_.at_place[place];
      placed_samples& to = out[first] != 0 ? both.plain : both.told;
      for (std::size_t i = first; i < first + count; ++i) to.all.push_back(all_.all[i]);
      to.at_place.push_back(static_cast<std::uint8_t>(count));
      first += count;
    }
    return both;
  }

 private:
  static constexpr double around = 2.0;      // pitches within which all samples must be in the plane
  static constexpr double off_plane = 2e-3;  // pitches that they may be off it: less than what texture is felt at
  static constexpr float most_cone_rad = 0.1F;
  static constexpr double one_in = 8.0;  // pitches: one plain sample stays in a cube of them

  using cell = std::array<std::int64_t, 3>;
  struct sample_in_cell {
    std::uint64_t key;
    std::uint32_t sample;
    friend auto operator<=>(const sample_in_cell&, const sample_in_cell&) = default;
  };

  [[nodiscard]] cell cell_of(std::size_t sample, double pitches) const noexcept {
    const vec3 at = vec3(all_.all[sample].position_b - low_) / std::max(pitches * pitch_m_, least_cell_m_);
    cell out{};
    for (std::size_t k = 0; k < 3; ++k) out[k] = static_cast<std::int64_t>(at[static_cast<int>(k)]) + 1;
    return out;
  }
  [[nodiscard]] static std::uint64_t key_of(const cell& of) noexcept {
    return static_cast<std::uint64_t>(of[2]) << 42U | static_cast<std::uint64_t>(of[1]) << 21U |
           static_cast<std::uint64_t>(of[0]);
  }

  // By sample: 1 for those that tell nothing.
  [[nodiscard]] std::vector<std::uint8_t> left_out(unsigned threads) const {
    std::vector<std::uint8_t> out(all_.all.size(), 0);
    const std::vector<std::uint32_t> single = single_places();
    for_each_part(single.size(), threads, [&](std::size_t begin, std::size_t end) {
      std::vector<glm::vec3> near;
      for (std::size_t i = begin; i < end; ++i) out[single[i]] = is_plain(single[i], near) ? 1 : 0;
    });
    for (const sample_in_cell& s : first_of_cubes(out)) out[s.sample] = 0;
    return out;
  }

  // Samples that have a place of their own and look one way; others lie on edges, tips or steep relief.
  [[nodiscard]] std::vector<std::uint32_t> single_places() const {
    std::vector<std::uint32_t> out;
    std::uint32_t first = 0;
    for (std::size_t place = 0; first < all_.all.size(); ++place) {
      const std::uint32_t count = all_.at_place.empty() ? 1U : all_.at_place[place];
      if (count == 1 && all_.all[first].cone_rad < most_cone_rad) out.push_back(first);
      first += count;
    }
    return out;
  }

  // Of every cube the plain sample that was laid out first.
  [[nodiscard]] std::vector<sample_in_cell> first_of_cubes(const std::vector<std::uint8_t>& is_plain) const {
    std::vector<sample_in_cell> out;
    for (std::uint32_t i = 0; i < is_plain.size(); ++i) {
      if (is_plain[i] != 0) out.push_back({key_of(cell_of(i, one_in)), i});
    }
    std::sort(out.begin(), out.end());
    const auto same_cube = [](const sample_in_cell& a, const sample_in_cell& b) { return a.key == b.key; };
    out.erase(std::unique(out.begin(), out.end(), same_cube), out.end());
    return out;
  }

  // @param near room for what is around it
  [[nodiscard]] bool is_plain(std::uint32_t sample, std::vector<glm::vec3>& near) const {
    near.clear();
    const field_sample& of = all_.all[sample];
    const double far2 = around * around * pitch_m_ * pitch_m_;
    const cell c = cell_of(sample, around);
    vec3 mean(0.0);
    for (std::int64_t z = c[2] - 1; z <= c[2] + 1; ++z) {
      for (std::int64_t y = c[1] - 1; y <= c[1] + 1; ++y) {
        const sample_in_cell least{key_of({c[0] - 1, y, z}), 0};
        const std::uint64_t last = key_of({c[0] + 1, y, z});
        for (auto i = std::lower_bound(by_cell_.begin(), by_cell_.end(), least); i != by_cell_.end() && i->key <= last;
             ++i) {
          const field_sample& other = all_.all[i->sample];
          const vec3 d = vec3(other.position_b) - vec3(of.position_b);
          // Those of the other side of a thin sheet are of another face.
          if (!(glm::dot(d, d) < far2) || glm::dot(other.axis_b, of.axis_b) < -0.5F) continue;
          near.push_back(other.position_b);
          mean += vec3(other.position_b);
        }
      }
    }
    mean /= static_cast<double>(near.size());
    const vec3 normal = thinnest(near, mean);
    const double most_m = off_plane * pitch_m_;
    const auto is_in_plane = [&](const glm::vec3& p) { return std::fabs(glm::dot(vec3(p) - mean, normal)) < most_m; };
    return near.size() > sectors && std::all_of(near.begin(), near.end(), is_in_plane) &&
           is_surrounded(vec3(of.position_b), normal, near);
  }

  static constexpr std::size_t sectors = 6;

  // Whether there is a sample in every sixth of the circle around one.
  [[nodiscard]] bool is_surrounded(const vec3& middle, const vec3& normal,
                                   const std::vector<glm::vec3>& near) const noexcept {
    const vec3 u = any_orthogonal(normal), v = glm::cross(normal, u);
    std::array<bool, sectors> has{};
    const double own_m = 0.1 * pitch_m_;
    for (const glm::vec3& p : near) {
      const vec3 d = vec3(p) - middle;
      const double x = glm::dot(d, u), y = glm::dot(d, v);
      if (!(x * x + y * y > own_m * own_m)) continue;
      const double turn = std::atan2(y, x) / (2.0 * std::numbers::pi) + 0.5;  // 0 to 1
      has[std::min(sectors - 1, static_cast<std::size_t>(turn * static_cast<double>(sectors)))] = true;
    }
    return std::all_of(has.begin(), has.end(), [](bool one) { return one; });
  }

  static constexpr double most_cells = 1e6;  // along an axis: a key has 21 bits for each
  const placed_samples& all_;
  double pitch_m_, least_cell_m_ = 0.0;
  glm::vec3 low_{0.0F};
  std::vector<sample_in_cell> by_cell_;
};

}  // namespace asperity::detail
