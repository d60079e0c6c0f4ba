// The nodes that a place of a relief is read from and added to, in a dense copy of a brick.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "asperity/core/math.hpp"
#include "asperity/field/body_field.hpp"
#include "field/lanes.hpp"

namespace asperity::detail {

/// A brick and two nodes around it, x fastest.
struct dense_brick {
  static constexpr std::size_t side = relief_bricks::side, reach = 2, across = side + 2 * reach,
                               lanes_across = across / 4;
  std::array<lanes, across * across * lanes_across> at{};
};

/// Weights of the three nodes around a place along each axis.
struct relief_stencil {
  static constexpr std::size_t reach = dense_brick::reach, across = dense_brick::across,
                               lanes_across = dense_brick::lanes_across;

  std::size_t first;                  // its first row in a dense copy, in lanes
  std::array<lanes, lanes_across> x;  // of the nodes of a row, most of them 0
  std::array<float, 9> yz;

  explicit relief_stencil(const glm::vec3& place) noexcept {
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

  [[nodiscard]] float read(const dense_brick& from) const noexcept {
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
  void add(dense_brick& to, float number) const noexcept {
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

}  // namespace asperity::detail
