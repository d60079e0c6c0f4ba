// What the cell finder reports: which samples may touch which cells.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "asperity/core/memory.hpp"
#include "asperity/core/reserve_resident.hpp"

namespace asperity {

/// A cell of one body with the tiles of the other that may touch it.
struct near_cell {
  std::uint32_t body = 0;              ///< index of B in scene::fixed
  bool on_probe = false;               ///< whose cell: the probe's, met by B's samples; or B's, met by the probe's
  std::uint32_t cell = 0;              ///< in that body's surface_cells
  std::uint32_t first = 0, count = 0;  ///< tiles of the other body: range in near_cells::tiles()
};

/// A sharp edge of the probe near one of a fixed body.
struct near_edges {
  std::uint32_t body = 0;
  std::uint32_t edge_a = 0, edge_b = 0;
};

/// Fixed sizes of a near_cells.
struct near_limits {
  std::size_t cells = 1024;
  std::size_t tiles = 65536;  ///< of all cells together
  std::size_t edges = 1024;

  /// Most readings that a depth backend makes of a set of this size.
  [[nodiscard]] std::size_t readings() const noexcept { return cells + edges; }
};

/// The near cells of one tick, sorted by body. All memory is taken when it is made.
/// A superset of what touches is harmless: what is too far away has no weight.
class near_cells {
 public:
  using limits_type = near_limits;

  explicit near_cells(near_limits limits = {}) : limits_(limits) {
    detail::reserve_resident(cells_, limits.cells);
    detail::reserve_resident(tiles_, limits.tiles);
    detail::reserve_resident(edges_, limits.edges);
  }

  /// @rt safe
  void clear() noexcept {
    cells_.clear();
    tiles_.clear();
    edges_.clear();
    dropped_ = 0;
  }

  /// Begins a cell; the tiles that add_tile() brings belong to it. One that gets none is forgotten.
  /// @return false where the limit was hit: the cell is dropped and counted
  /// @rt safe
  bool add_cell(std::uint32_t body, bool on_probe, std::uint32_t cell) noexcept {
    close();
    if (cells_.size() == limits_.cells) {
      ++dropped_;
      return false;
    }
    cells_.push_back({body, on_probe, cell, static_cast<std::uint32_t>(tiles_.size()), 0});
    return true;
  }
  /// @rt safe
  void add_tile(std::uint32_t tile) noexcept {
    if (tiles_.size() == limits_.tiles) {
      ++dropped_;
      return;
    }
    tiles_.push_back(tile);
    ++cells_.back().count;
  }
  /// Ends the last cell. @rt safe
  void close() noexcept {
    if (!cells_.empty() && cells_.back().count == 0) cells_.pop_back();
  }
  /// @rt safe
  void add_edges(const near_edges& e) noexcept {
    if (edges_.size() == limits_.edges) {
      ++dropped_;
      return;
    }
    edges_.push_back(e);
  }

  [[nodiscard]] std::span<const near_cell> cells() const noexcept { return cells_; }
  [[nodiscard]] std::span<const std::uint32_t> tiles(const near_cell& c) const noexcept {
    return std::span(tiles_).subspan(c.first, c.count);
  }
  [[nodiscard]] std::span<const near_edges> edges() const noexcept { return edges_; }
  /// How many readings a depth backend makes of it: one per cell, one per pair of edges.
  [[nodiscard]] std::size_t size() const noexcept { return cells_.size() + edges_.size(); }
  /// Cells, tiles and edges that did not fit since clear(): raise near_limits.
  [[nodiscard]] std::size_t dropped() const noexcept { return dropped_; }
  [[nodiscard]] const near_limits& limits() const noexcept { return limits_; }
  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(cells_, tiles_, edges_); }

 private:
  near_limits limits_;
  std::vector<near_cell> cells_;
  std::vector<std::uint32_t> tiles_;
  std::vector<near_edges> edges_;
  std::size_t dropped_ = 0;
};

}  // namespace asperity
