// Where on a body which material is: a look-up by a point of its surface.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "asperity/core/memory.hpp"
#include "asperity/model/textured_model.hpp"

namespace asperity {

/// An octree over a body's texels, which ends where all that is in a cell is of one material: it is deep along seams
/// alone. A cell without texels is of the material of the texel nearest to its middle. Built once, never changed.
class material_places {
 public:
  /// @pre check_materials(model), and it has a map
  explicit material_places(const textured_model& model) {
    std::vector<spot> spots;
    glm::vec3 low(std::numeric_limits<float>::max()), high(std::numeric_limits<float>::lowest());
    for (std::size_t i = 0; i < model.texture.texels.size(); ++i) {
      const glm::vec3& p = model.texture.texels[i];
      if (!is_finite(vec3(p))) continue;
      spots.push_back({p, model.surface_map.texels[i]});
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
    if (spots.empty()) return;
    const vec3 size = vec3(high) - vec3(low);
    centre_b_ = vec3(low) + 0.5 * size;
    half_m_ = 0.5 * std::max({size.x, size.y, size.z});
    root_ = build(spots, centre_b_, half_m_, most_levels);
  }

  /// The one of a model; null where it has no map.
  [[nodiscard]] static std::shared_ptr<const material_places> of(const textured_model& model) {
    return model.surface_map.empty() ? nullptr : std::make_shared<const material_places>(model);
  }

  /// Number of the material at a point of the surface. @rt safe: at most 16 steps
  [[nodiscard]] std::uint8_t at(const vec3& p_b) const noexcept {
    std::uint32_t here = root_;
    vec3 centre = centre_b_;
    for (double half = half_m_; (here & leaf) == 0;) {
      const std::size_t octant = octant_of(p_b, centre);
      half *= 0.5;
      centre = middle_of(centre, half, octant);
      here = cells_[here][octant];
    }
    return static_cast<std::uint8_t>(here & 0xffU);
  }

  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(cells_); }

 private:
  static constexpr std::uint32_t leaf = 0x80000000U;  // with it a number of a material, without it one of a cell
  static constexpr int most_levels = 16;              // finer than the texels of any texture

  struct spot {
    glm::vec3 position_b;
    std::uint8_t material;
  };

  template <class Point>
  [[nodiscard]] static std::size_t octant_of(const Point& p, const vec3& centre) noexcept {
    const auto bit = [&](int k) -> std::size_t { return static_cast<double>(p[k]) >= centre[k] ? 1U << k : 0U; };
    return bit(0) | bit(1) | bit(2);
  }
  [[nodiscard]] static vec3 middle_of(const vec3& centre, double half, std::size_t octant) noexcept {
    return centre + half * vec3((octant & 1U) != 0 ? 1 : -1, (octant & 2U) != 0 ? 1 : -1, (octant & 4U) != 0 ? 1 : -1);
  }

  std::uint32_t build(std::span<spot> spots, const vec3& centre, double half, int levels) {
    const std::uint8_t first = spots.front().material;
    const bool one = std::all_of(spots.begin(), spots.end(), [&](const spot& s) { return s.material == first; });
    if (one || levels == 0) return leaf | first;
    const auto cell = static_cast<std::uint32_t>(cells_.size());
    cells_.emplace_back();
    // Sorted by octant, in their order within each.
    std::array<std::size_t, 9> begin{};
    for (const spot& s : spots) ++begin[octant_of(s.position_b, centre) + 1];
    for (std::size_t o = 0; o < 8; ++o) begin[o + 1] += begin[o];
    {
      std::vector<spot> sorted(spots.size());
      std::array<std::size_t, 9> next = begin;
      for (const spot& s : spots) sorted[next[octant_of(s.position_b, centre)]++] = s;
      std::copy(sorted.begin(), sorted.end(), spots.begin());
    }
    for (std::size_t o = 0; o < 8; ++o) {
      const vec3 middle = middle_of(centre, 0.5 * half, o);
      const std::span<spot> in = spots.subspan(begin[o], begin[o + 1] - begin[o]);
      const std::uint32_t child =
          in.empty() ? leaf | nearest(spots, middle) : build(in, middle, 0.5 * half, levels - 1);
      cells_[cell][o] = child;
    }
    return cell;
  }

  [[nodiscard]] static std::uint8_t nearest(std::span<const spot> spots, const vec3& to) noexcept {
    const auto far2 = [&](const spot& s) {
      const vec3 off = vec3(s.position_b) - to;
      return glm::dot(off, off);
    };
    return std::min_element(spots.begin(), spots.end(), [&](const spot& a, const spot& b) { return far2(a) < far2(b); })
        ->material;
  }

  vec3 centre_b_{0.0};
  double half_m_ = 0.0;
  std::uint32_t root_ = leaf;
  std::vector<std::array<std::uint32_t, 8>> cells_;
};

}  // namespace asperity
