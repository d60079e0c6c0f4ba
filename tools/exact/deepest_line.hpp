// Search for the line of a window along which two textured surfaces are deepest in each other: branch and bound.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "asperity/core/memory.hpp"
#include "exact/pair_bound.hpp"

namespace asperity::detail {

/// A line along n and where it crosses both surfaces.
struct crossing_line {
  bool found = false;
  double depth_m = 0.0;  ///< h_A - h_B
  vec2 uv{0.0};
  std::uint32_t slot_a = 0, slot_b = 0;  ///< coarse triangles, as patch_projection::triangles() has them
  vec2 texel_a{0.0}, texel_b{0.0};
};

/// What a search knows when it stops: the largest depth of any line is at least `deepest.depth_m`, if any was found,
/// and at most upper_m, if any line may exist.
struct search_result {
  crossing_line deepest;
  bool bounded = false;  ///< a line may exist
  double upper_m = 0.0;
  std::size_t nodes = 0;  ///< pairs of pieces that were kept for a closer look
  bool capped = false;    ///< stopped because there was no room for more of them
};

/// Best-first branch and bound over pairs of pieces, one of either surface. All memory is taken when it is made.
///
/// The pair that may be deepest is looked at next: a line through it is read, which raises the lower bound, and its
/// looser piece is cut in four. A pair that cannot be deeper than the lower bound by more than epsilon is dropped.
/// Pairs are taken in the order of their bounds, equal ones in the order they were made, so the same input gives the
/// same bits.
class deepest_line {
 public:
  /// @param max_nodes  pairs that may be kept, over the whole search
  /// @param max_triangles  largest number of coarse triangles of a body
  deepest_line(std::size_t max_nodes, std::size_t max_triangles) : max_nodes_(max_nodes) {
    reserve_resident(heap_, max_nodes);
    reserve_resident(roots_, 4 * max_triangles);
  }
  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(heap_, roots_); }

  /// @param seed  a line to start from, or one that was not found   @rt safe, but its time has no useful bound
  [[nodiscard]] search_result find(const searched_body& a, const searched_body& b, double half_m, double epsilon_m,
                                   const crossing_line& seed) noexcept {
    begin(half_m, epsilon_m, seed);
    collect_roots(b);
    for (std::uint32_t slot = 0; slot < a.view.patch.triangles().size(); ++slot) {
      for_each_root(a, slot, [&](const surface_part& part, const window_piece& piece) {
        for (const root& r : roots_) {
          if (r.low.x > piece.high.x || r.high.x < piece.low.x || r.low.y > piece.high.y || r.high.y < piece.low.y) {
            continue;
          }
          window_piece other;
          if (make_piece(b, r.part, other))
            offer({std::numeric_limits<double>::infinity(), 0, part, r.part}, piece, other);
        }
      });
    }
    while (!heap_.empty() && !result_.capped) {
      const node n = heap_.front();
      if (result_.deepest.found && n.upper_m <= result_.deepest.depth_m + epsilon_m_) break;
      std::pop_heap(heap_.begin(), heap_.end(), later);
      heap_.pop_back();
      open(a, b, n);
    }
    if (!heap_.empty()) settle(heap_.front().upper_m);
    if (result_.deepest.found) settle(result_.deepest.depth_m);
    return result_;
  }

 private:
  /// Parts of a cell 1/4096 wide are some nanometres: nothing finer is worth a look.
  static constexpr int finest_level = -12;

  struct node {
    double upper_m;
    std::uint32_t number;
    surface_part a, b;
  };
  struct root {
    surface_part part;
    vec2 low, high;
  };
  [[nodiscard]] static bool later(const node& x, const node& y) noexcept {
    return x.upper_m < y.upper_m || (x.upper_m == y.upper_m && x.number > y.number);
  }

  void begin(double half_m, double epsilon_m, const crossing_line& seed) noexcept {
    half_m_ = half_m;
    epsilon_m_ = epsilon_m;
    tolerance_m_ = 1e-10 * half_m;
    result_ = {.deepest = seed};
    heap_.clear();
    roots_.clear();
  }

  /// The parts of a triangle's chart, at most four, that are first looked at, and what the window sees of them.
  template <class Take>
  void for_each_root(const searched_body& body, std::uint32_t slot, Take take) const noexcept {
    const std::array<vec2, 3>& z = body.chart(slot).corner;
    const double margin = 1e-6;
    // In cells: cell k lies between texels k - 1 and k.
    const vec2 low = glm::floor(glm::min(z[0], glm::min(z[1], z[2])) + (1.0 - margin));
    const vec2 high = glm::floor(glm::max(z[0], glm::max(z[1], z[2])) + (1.0 + margin));
    const auto cell = [](double k) { return static_cast<std::int32_t>(std::clamp(k, 0.0, 1e6)); };
    const std::int32_t x0 = cell(low.x), x1 = cell(high.x), y0 = cell(low.y), y1 = cell(high.y);
    int level = 0;
    const int top = body.pyramid.top();
    while (level < top && ((x1 >> level) - (x0 >> level) > 1 || (y1 >> level) - (y0 >> level) > 1)) ++level;
    for (std::int32_t y = y0 >> level; y <= y1 >> level; ++y) {
      for (std::int32_t x = x0 >> level; x <= x1 >> level; ++x) {
        const surface_part part{slot, {static_cast<std::int8_t>(level), x, y}};
        window_piece piece;
        if (!make_piece(body, part, piece)) continue;
        if (piece.low.x > half_m_ || piece.high.x < -half_m_ || piece.low.y > half_m_ || piece.high.y < -half_m_) {
          continue;
        }
        take(part, piece);
      }
    }
  }

  void collect_roots(const searched_body& b) noexcept {
    for (std::uint32_t slot = 0; slot < b.view.patch.triangles().size(); ++slot) {
      for_each_root(b, slot, [&](const surface_part& part, const window_piece& piece) {
        roots_.push_back({part, vec2(piece.low), vec2(piece.high)});
      });
    }
  }

  void settle(double upper_m) noexcept {
    result_.upper_m = result_.bounded ? std::max(result_.upper_m, upper_m) : upper_m;
    result_.bounded = true;
  }

  /// Keeps a pair for later, if it can matter.
  void offer(node n, const window_piece& a, const window_piece& b) noexcept {
    if (result_.deepest.found && a.high.z - b.low.z <= result_.deepest.depth_m) return;
    const pair_bound bound = bound_pair(a, b, half_m_);
    if (!bound.shared) return;
    n.upper_m = std::min(n.upper_m, bound.upper_m);
    if (result_.deepest.found && n.upper_m <= result_.deepest.depth_m + epsilon_m_) {
      settle(n.upper_m);
      return;
    }
    if (result_.nodes == max_nodes_) {
      result_.capped = true;
      settle(n.upper_m);
      return;
    }
    n.number = static_cast<std::uint32_t>(result_.nodes++);
    heap_.push_back(n);
    std::push_heap(heap_.begin(), heap_.end(), later);
  }

  /// Looks at a pair, and cuts it.
  void open(const searched_body& a, const searched_body& b, const node& n) noexcept {
    window_piece piece_a, piece_b;
    if (!make_piece(a, n.a, piece_a) || !make_piece(b, n.b, piece_b)) return;
    const pair_bound bound = bound_pair(piece_a, piece_b, half_m_);
    // The bound's own place first; it may lie just outside of what is really shared.
    for (const double inwards : {0.0, 1e-3, 0.1, 1.0}) {
      if (read(a, b, n, piece_a, piece_b, bound.best + inwards * (bound.middle - bound.best))) break;
    }
    if (result_.deepest.found && n.upper_m <= result_.deepest.depth_m + epsilon_m_) {
      settle(n.upper_m);
      return;
    }

    const double loose_a = looseness(piece_a), loose_b = looseness(piece_b);
    const double gap = result_.deepest.found ? n.upper_m - result_.deepest.depth_m : loose_a + loose_b;
    bool cut_a = loose_a >= loose_b;
    // Where planes say it all, the pieces are too large across the window instead.
    if (loose_a + loose_b < 0.1 * gap) cut_a = extent(piece_a) >= extent(piece_b);
    if ((cut_a ? n.a : n.b).at.level == finest_level) cut_a = !cut_a;
    if ((cut_a ? n.a : n.b).at.level == finest_level) {
      settle(n.upper_m);
      return;
    }
    for (std::uint32_t i = 0; i < 4; ++i) {
      node child = n;
      surface_part& smaller = cut_a ? child.a : child.b;
      smaller.at = smaller.at.child(i);
      window_piece part;
      if (!make_piece(cut_a ? a : b, smaller, part)) continue;
      cut_a ? offer(child, part, piece_b) : offer(child, piece_a, part);
    }
  }

  /// Reads the line over uv. @return true where it crosses both surfaces
  [[nodiscard]] bool read(const searched_body& a, const searched_body& b, const node& n, const window_piece& piece_a,
                          const window_piece& piece_b, const vec2& uv) noexcept {
    const auto start = [&](const window_piece& piece, const texture_place& at) {
      if (!piece.is_graph) return at.middle();
      const vec3 way = piece.to_texels * vec3(uv - vec2(piece.centre), 0.0);
      const double half = at.half();
      return at.middle() + glm::clamp(vec2(way), vec2(-half), vec2(half));
    };
    const surface_hit over_a = read_surface(a, n.a, uv, start(piece_a, n.a.at), tolerance_m_);
    if (!over_a.found) return false;
    const surface_hit over_b = read_surface(b, n.b, uv, start(piece_b, n.b.at), tolerance_m_);
    if (!over_b.found) return false;
    const double depth_m = over_a.height - over_b.height;
    if (!result_.deepest.found || depth_m > result_.deepest.depth_m) {
      result_.deepest = {true, depth_m, uv, n.a.slot, n.b.slot, over_a.texel, over_b.texel};
    }
    return true;
  }

  [[nodiscard]] static double looseness(const window_piece& p) noexcept {
    return p.is_graph ? std::min(2.0 * p.above_plane, p.high.z - p.low.z) : p.high.z - p.low.z;
  }
  [[nodiscard]] static double extent(const window_piece& p) noexcept {
    return std::max(p.high.x - p.low.x, p.high.y - p.low.y);
  }

  std::size_t max_nodes_;
  std::vector<node> heap_;
  std::vector<root> roots_;
  search_result result_;
  double half_m_ = 0.0, epsilon_m_ = 0.0, tolerance_m_ = 0.0;
};

}  // namespace asperity::detail
