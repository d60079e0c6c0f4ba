// Where the tiles of a contact lie: side by side in one row of an atlas, and rows of contacts one above the other, in
// as many columns as it takes.
//
// A device goes over everything that is bound, drawn to or not: software does it with every flush. So there are several
// atlases, each for four times as many contacts as the one before, and a tick takes the smallest that holds its own.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "asperity/gl/names.hpp"

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

  /// The same tiles for fewer contacts.
  [[nodiscard]] tile_atlas with_room(std::uint32_t contacts) const noexcept {
    tile_atlas out = *this;
    out.across = std::min(across, contacts);
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

/// Numbers of contacts that there are atlases for, the largest first.
[[nodiscard]] inline std::vector<std::uint32_t> atlas_rooms(std::uint32_t contacts) {
  std::vector<std::uint32_t> out{contacts};
  std::uint32_t fewer = 1;
  while (4 * fewer < contacts) fewer *= 4;
  for (; fewer > 0 && fewer < contacts; fewer /= 4) out.push_back(fewer);
  return out;
}

/// An atlas with the textures that hold it; `colour` is empty where nothing but depth is drawn.
struct drawn_atlas {
  std::uint32_t contacts = 0;  ///< most that it holds
  tile_atlas tiles{};
  owned_name colour{}, depth{}, framebuffer{};
};

/// @param atlases  the largest first   @return index of the smallest that holds so many contacts
[[nodiscard]] inline std::size_t smallest_of(const std::vector<drawn_atlas>& atlases, std::size_t contacts) noexcept {
  std::size_t at = 0;
  while (at + 1 < atlases.size() && atlases[at + 1].contacts >= contacts) ++at;
  return at;
}

[[nodiscard]] inline std::size_t bytes_of(const std::vector<drawn_atlas>& atlases) noexcept {
  std::size_t bytes = 0;
  for (const drawn_atlas& a : atlases) bytes += a.colour.bytes() + a.depth.bytes();
  return bytes;
}

}  // namespace asperity::gl
