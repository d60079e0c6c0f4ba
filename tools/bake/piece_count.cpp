// Convex pieces to a number that the caller chose.
#include <algorithm>
#include <cmath>
#include <utility>

#include "bake/pieces.hpp"

namespace asperity::bake {

result<std::vector<convex_piece>> decompose_into(const triangle_mesh& mesh, std::size_t count, stage_monitor& monitor) {
  constexpr double widest = 16.0;
  constexpr int widening_tries = 6;
  auto best = decompose(mesh, piece_limits{}, monitor);
  if (!best) return best;
  const auto away = [count](std::size_t n) { return n > count ? n - count : count - n; };
  // @return the number of pieces with these limits, 0 where the bake was cancelled
  const auto attempt = [&](const piece_limits& limits) -> std::size_t {
    auto pieces = decompose(mesh, limits, monitor);
    if (!pieces) return 0;
    const std::size_t n = pieces->size();
    if (away(n) < away(best->size())) best = std::move(pieces);
    return n;
  };
  const error cancelled{error_code::cancelled, "the bake was cancelled"};
  if (best->size() < count) {
    std::size_t small = 0;  // sizes of a piece, in triangles
    std::size_t large = mesh.triangles.size();
    while (large - small > 1 && best->size() != count) {
      piece_limits limits;
      limits.triangles = small + (large - small) / 2;
      const std::size_t n = attempt(limits);
      if (n == 0) return cancelled;
      (n < count ? large : small) = limits.triangles;
    }
    return best;
  }
  double narrow = 0.0;  // powers of two
  double wide = std::log2(widest);
  double power = wide;
  for (int i = 0; i < widening_tries && best->size() != count; ++i) {
    piece_limits limits;
    limits.tolerance *= std::exp2(power);
    limits.bridged_air *= std::exp2(power);
    const std::size_t n = attempt(limits);
    if (n == 0) return cancelled;
    if (n > count && power == wide) break;  // the widest are not enough
    (n > count ? narrow : wide) = power;
    power = 0.5 * (narrow + wide);
  }
  return best;
}

}  // namespace asperity::bake
