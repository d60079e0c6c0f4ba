// The tiles of differences, and the pass that writes them as levels of a depth buffer.
#pragma once

#include <array>
#include <span>

#include "asperity/gl/functions.hpp"
#include "asperity/gl/mapped_buffer.hpp"
#include "asperity/gl/names.hpp"
#include "asperity/gl/program.hpp"
#include "tile_layout.hpp"

namespace asperity::gl {

/// A tile of differences as difference_vertex.glsl reads it.
struct difference_record {
  std::array<float, 2> tile, heights_a, heights_b;  ///< first pixels
  float low = 0.0F;                                 ///< difference of the lowest level, half sizes of the window
  float levels_per_unit = 0.0F;
  float cosine = 1.0F, sine = 0.0F;  ///< of the probe's turn about n
  std::array<float, 2> shift{};      ///< of the probe, samples
};

class difference_pass {
 public:
  difference_pass() = default;
  /// @pre the context is current in this thread   @return limit_exceeded | unsupported
  [[nodiscard]] static result<difference_pass> make(const context_ptr& context, const tile_atlas& largest,
                                                    std::uint32_t contacts, std::uint32_t depth_bits,
                                                    const std::string& definitions, std::array<int, 2> tile_samples);

  /// Takes the smallest atlas for as many, until the next call. @rt safe
  void make_room(std::size_t contacts) noexcept { now_ = smallest_of(atlases_, contacts); }
  [[nodiscard]] const tile_atlas& atlas() const noexcept { return atlases_[now_].tiles; }
  [[nodiscard]] GLuint framebuffer() const noexcept { return atlases_[now_].framebuffer.get(); }
  [[nodiscard]] std::span<difference_record> records() noexcept { return records_.as<difference_record>(); }
  /// Writes the tiles of records [first, first + count). @rt safe, apart from what the driver does
  void draw(std::size_t first, std::size_t count, GLuint heights) noexcept;

  [[nodiscard]] std::size_t device_bytes() const noexcept { return bytes_of(atlases_) + records_.size(); }
  [[nodiscard]] std::size_t heap_bytes() const noexcept { return atlases_.capacity() * sizeof(drawn_atlas); }

 private:
  std::vector<drawn_atlas> atlases_;
  std::size_t now_ = 0;
  std::array<int, 2> tile_samples_{};
  owned_name vertices_;
  program_ptr program_;
  mapped_buffer records_;
  GLint atlas_size_ = 0, tile_pixels_ = 0, samples_ = 0;
};

}  // namespace asperity::gl
