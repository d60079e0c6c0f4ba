// What an occlusion_depth is made of.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "asperity/gl/occlusion_depth.hpp"
#include "asperity/gl/uploaded_model.hpp"
#include "contact_slot.hpp"
#include "difference_pass.hpp"
#include "height_pass.hpp"
#include "query_pass.hpp"
#include "tile_writer.hpp"
#include "window/central_difference.hpp"

namespace asperity::gl {

struct occlusion_depth::parts {
  context_ptr context;
  tile_writer writer;
  occlusion_settings gpu_settings;
  depth_levels levels;
  uploaded_scene models;
  height_pass heights;
  difference_pass differences;
  query_pass queries;
  std::vector<contact_slot> slots;     ///< of the last call, by fixed body
  std::vector<std::uint32_t> slot_of;  ///< of each contact of the last call; no_slot where it was not drawn
  std::vector<char> look_for_bad;      ///< per slot
  std::vector<record_run> runs;
  occlusion_counters counters;

  static constexpr std::uint32_t no_slot = 0xffffffffU;
  /// Motions of the probe whose heights are rendered; the others are read out of those at rest.
  static constexpr std::size_t first_turn = 4, end_turns = 8;

  parts(context_ptr c, const scene& s, const window_depth_settings& settings, const occlusion_settings& o);
  [[nodiscard]] bool reuses() const noexcept { return gpu_settings.moved == moved_heights::reused; }
  [[nodiscard]] std::size_t first_drawn() const noexcept { return reuses() ? first_turn : 0; }
  [[nodiscard]] std::size_t end_drawn() const noexcept { return reuses() ? end_turns : detail::probe_motions; }
  /// Tiles of heights per contact: B, A at rest, A after the motions that are rendered.
  [[nodiscard]] std::size_t height_tiles() const noexcept { return 2 + end_drawn() - first_drawn(); }
  [[nodiscard]] std::array<int, 2> tile_samples() const noexcept {
    return {static_cast<int>(writer.tile_samples()), static_cast<int>(writer.margin())};
  }

  [[nodiscard]] result<void> set_up();
  [[nodiscard]] status measure(const scene_pose& at, const contact_set& contacts, std::span<penetration> out) noexcept;

 private:
  [[nodiscard]] query_view view() const noexcept;
  void write_at_rest(const scene_pose& at, const contact_set& contacts) noexcept;
  void write_moved(const scene_pose& at, const contact_set& contacts) noexcept;
  [[nodiscard]] bool records_fit() noexcept;
  [[nodiscard]] status draw(const scene_pose& at, const contact_set& contacts) noexcept;
  template <class Add>
  void write_runs(Add add) noexcept;
  [[nodiscard]] difference_record at_rest(std::size_t slot, double half_m) const noexcept;
  void draw_at_rest(const contact_set& contacts) noexcept;
  void draw_all(const contact_set& contacts) noexcept;
  void choose_range(contact_slot& slot, double half_m) const noexcept;
  [[nodiscard]] std::optional<double> depth_of(const contact_slot& slot, std::size_t search) const noexcept;
  [[nodiscard]] penetration answer(const scene_pose& at, const contact& c, const contact_slot& slot) const noexcept;
  [[nodiscard]] vec3 rotation_origin_w(const contact& c, const pose& T_wa) const noexcept {
    return writer.settings().origin == rotation_origin::contact ? c.window.centre_w
                                                                : centre_of_mass_w(writer.bodies(), T_wa);
  }
};

}  // namespace asperity::gl
