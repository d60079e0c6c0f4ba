// The tiles of heights, and the pass that renders into them.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "asperity/gl/functions.hpp"
#include "asperity/gl/mapped_buffer.hpp"
#include "asperity/gl/names.hpp"
#include "asperity/gl/program.hpp"
#include "asperity/gl/uploaded_model.hpp"
#include "tile_layout.hpp"
#include "tile_writer.hpp"

namespace asperity::gl {

/// Records of one fixed body and one quarter that follow each other.
struct record_run {
  std::size_t quarter = 0, body = 0, first = 0, count = 0;
};

/// Definitions that the stages share.
[[nodiscard]] std::string tile_definitions(std::uint32_t depth_bits, bool packed);

class height_pass {
 public:
  height_pass() = default;
  /// @pre the context is current in this thread   @return limit_exceeded | unsupported
  [[nodiscard]] static result<height_pass> make(const context_ptr& context, const tile_atlas& largest,
                                                std::uint32_t contacts, bool packed, const std::string& definitions,
                                                std::array<int, 2> tile_samples, std::size_t records);

  /// Takes the smallest atlas for as many, until the next call. @rt safe
  void make_room(std::size_t contacts) noexcept { now_ = smallest_of(atlases_, contacts); }
  [[nodiscard]] const tile_atlas& atlas() const noexcept { return atlases_[now_].tiles; }
  [[nodiscard]] GLuint texture() const noexcept { return atlases_[now_].colour.get(); }
  [[nodiscard]] GLuint framebuffer() const noexcept { return atlases_[now_].framebuffer.get(); }
  /// Where the records of each quarter go.
  [[nodiscard]] std::span<record_list> lists() noexcept { return std::span(lists_).first(packed_ ? 4 : 1); }

  /// Empties the tiles of the first `contacts`. @rt safe, apart from what the driver does
  void clear(std::size_t contacts) noexcept;
  /// Renders runs of records, of which each quarter's follow each other. @rt safe, apart from what the driver does
  void draw(std::span<const record_run> runs, std::size_t contacts, const uploaded_scene& models) noexcept;

  [[nodiscard]] std::size_t device_bytes() const noexcept { return bytes_of(atlases_) + records_.size(); }
  [[nodiscard]] std::size_t heap_bytes() const noexcept { return atlases_.capacity() * sizeof(drawn_atlas); }

 private:
  std::vector<drawn_atlas> atlases_;
  std::size_t now_ = 0;
  bool packed_ = false;
  std::array<int, 2> tile_samples_{};
  owned_name vertices_;
  program_ptr program_;
  mapped_buffer records_;
  std::array<record_list, 4> lists_;
  GLint atlas_size_ = 0, samples_ = 0, mirrored_ = 0;
};

}  // namespace asperity::gl
