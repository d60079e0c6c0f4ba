// Where the tiles of a contact lie: side by side in one row of an atlas, and rows of contacts one above the other, in
// as many columns as it takes.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace asperity::gl {

/// Tiles of the same size, so many per contact.
struct tile_atlas {
  std::uint32_t tile = 0;  ///< pixels per side of a tile
  std::uint32_t per_contact = 0;
  std::uint32_t across = 1;  ///< contacts side by side
  std::uint32_t rows = 0;    ///< contacts one above the other

  /// The narrowest one that holds `contacts`; rows is 0 where `largest` pixels per side are too few.
  [[nodiscard]] static tile_atlas fit(std::uint32_t tile, std::uint32_t per_contact, std::uint32_t contacts,
                                      std::uint32_t largest) noexcept {
    tile_atlas out{tile, per_contact};
    const std::uint32_t most_rows = largest / tile;
    if (most_rows == 0) return out;
    out.across = (contacts + most_rows - 1) / most_rows;
    if (out.width() > largest) return out;
    out.rows = (contacts + out.across - 1) / out.across;
    return out;
  }

  [[nodiscard]] std::uint32_t width() const noexcept { return across * per_contact * tile; }
  [[nodiscard]] std::uint32_t height() const noexcept { return rows * tile; }
  /// First pixel of a tile.
  [[nodiscard]] std::uint32_t x(std::size_t contact, std::size_t tile_index) const noexcept {
    return static_cast<std::uint32_t>((contact % across) * per_contact + tile_index) * tile;
  }
  [[nodiscard]] std::uint32_t y(std::size_t contact) const noexcept {
    return static_cast<std::uint32_t>(contact / across) * tile;
  }
  /// Rows of pixels that hold the first `contacts`.
  [[nodiscard]] std::uint32_t used_height(std::size_t contacts) const noexcept {
    return static_cast<std::uint32_t>((contacts + across - 1) / across) * tile;
  }
};

}  // namespace asperity::gl
