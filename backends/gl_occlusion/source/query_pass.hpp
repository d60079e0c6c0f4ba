// What the paper reads a depth buffer with: occlusion queries. Every query of a round is issued before the first answer
// is waited for, so that a round is one wait, whatever the number of tiles.
#pragma once

#include <array>
#include <span>
#include <utility>
#include <vector>

#include "asperity/gl/functions.hpp"
#include "asperity/gl/names.hpp"
#include "asperity/gl/program.hpp"
#include "contact_slot.hpp"
#include "tile_layout.hpp"

namespace asperity::gl {

/// Query objects. Each keeps the target of its first use: another one would be an error, and no query.
class query_names {
 public:
  query_names() = default;
  /// @pre the context is current in this thread
  query_names(const context_ptr& context, std::size_t count);
  ~query_names();
  query_names(query_names&& other) noexcept { swap(other); }
  query_names& operator=(query_names&& other) noexcept {
    query_names old(std::move(other));
    swap(old);
    return *this;
  }
  [[nodiscard]] GLuint operator[](std::size_t i) const noexcept { return names_[i]; }
  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(names_); }

 private:
  void swap(query_names& other) noexcept {
    std::swap(context_, other.context_);
    std::swap(names_, other.names_);
  }
  context_ptr context_;
  std::vector<GLuint> names_;
};

/// The textures and tiles that queries are about.
struct query_view {
  GLuint heights = 0;
  GLuint framebuffer = 0;  ///< of the differences
  const tile_atlas& height_tiles;
  const tile_atlas& difference_tiles;
  std::array<int, 2> tile_samples;
};

class query_pass {
 public:
  query_pass() = default;
  /// @pre the context is current in this thread   @return unsupported
  [[nodiscard]] static result<query_pass> make(const context_ptr& context, std::size_t contacts, std::uint32_t grid,
                                               std::uint32_t depth_bits, bool packed, const std::string& definitions);

  /// One round: fills samples, outermost and bad_texel of the slots that are visible.
  /// @param look_for_bad  per slot, whether a bad texel can be there
  /// @rt safe, apart from what the driver does
  void coverage(const query_view& view, std::span<contact_slot> slots, std::span<const char> look_for_bad) noexcept;

  /// A round per bit: fills the levels of the slots that have samples. @rt safe, apart from what the driver does
  void search(const query_view& view, std::span<contact_slot> slots) noexcept;

  [[nodiscard]] std::uint64_t rounds() const noexcept { return rounds_; }
  [[nodiscard]] std::uint64_t queries() const noexcept { return queries_; }
  [[nodiscard]] std::size_t heap_bytes() const noexcept { return any_.heap_bytes() + counted_.heap_bytes(); }

 private:
  struct rectangle {
    std::uint32_t x, y, width, height;
  };
  void begin(const query_view& view) noexcept;
  void end() noexcept;
  void draw(const rectangle& r) noexcept;
  void draw_ring(const query_view& view, std::size_t slot, std::uint32_t ring) noexcept;
  void begin_query(GLenum target, GLuint name) noexcept;
  [[nodiscard]] std::uint32_t answer(GLuint name) const noexcept;

  context_ptr context_;
  depth_levels levels_;
  bool packed_ = false, counts_ = false;
  std::uint32_t rings_ = 0;
  std::size_t per_slot_ = 0;
  query_names any_, counted_;
  owned_name vertices_;
  program_ptr threshold_program_, sample_program_;
  GLint threshold_ = 0, tile_a_ = 0, tile_b_ = 0, tile_difference_ = 0, samples_ = 0, quarter_ = 0;
  std::uint64_t rounds_ = 0, queries_ = 0;
};

}  // namespace asperity::gl
