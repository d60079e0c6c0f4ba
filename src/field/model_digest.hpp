// A number that tells whether a model is the one that something was made of.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <glm/vec3.hpp>

#include "asperity/model/textured_model.hpp"

namespace asperity::detail {

/// Mixes words into a sum. Against accidents, not against malice.
class word_digest {
 public:
  void add(std::uint64_t word) noexcept {
    sum_ = (sum_ ^ word) * 0x9e3779b97f4a7c15ULL;
    sum_ ^= sum_ >> 29U;
  }
  void add(double x) noexcept { add(std::bit_cast<std::uint64_t>(x)); }
  void add(const vec3& v) noexcept {
    for (int k = 0; k < 3; ++k) add(v[k]);
  }
  [[nodiscard]] std::uint64_t sum() const noexcept { return sum_; }

 private:
  std::uint64_t sum_ = 0xcbf29ce484222325ULL;
};

/// Of all that a field is made of: the coarse mesh and the haptic texture, to the bit.
[[nodiscard]] inline std::uint64_t model_digest(const textured_model& model) noexcept {
  word_digest out;
  out.add(std::uint64_t{model.mesh.positions.size()});
  for (const vec3& p : model.mesh.positions) out.add(p);
  out.add(std::uint64_t{model.mesh.triangles.size()});
  for (const coarse_triangle& t : model.mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      out.add(std::uint64_t{t.vertex[k]});
      out.add(t.uv[k].x);
      out.add(t.uv[k].y);
    }
  }
  out.add(std::uint64_t{model.texture.width} << 32U | model.texture.height);
  // Two numbers of float32 at a time.
  const auto* const floats = reinterpret_cast<const char*>(model.texture.texels.data());
  const std::size_t bytes = model.texture.texels.size() * sizeof(glm::vec3);
  for (std::size_t i = 0; i < bytes; i += sizeof(std::uint64_t)) {
    std::uint64_t word = 0;
    std::memcpy(&word, floats + i, std::min(sizeof word, bytes - i));
    out.add(word);
  }
  return out.sum();
}

}  // namespace asperity::detail
