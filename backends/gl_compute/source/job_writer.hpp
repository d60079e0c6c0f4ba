// The host's share before a submission: contacts become jobs in the buffers that the shader reads. Which coarse
// triangle each sample sees is decided here, by the CPU backend's own code.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "asperity/model/scene.hpp"
#include "asperity/window/window_depth_settings.hpp"
#include "job_buffers.hpp"
#include "window/central_difference.hpp"
#include "window/edge_taper.hpp"
#include "window/height_field.hpp"
#include "window/pair_scale.hpp"

namespace asperity::gl {

/// A contact's place in a submission.
struct contact_jobs {
  std::uint32_t contact = 0;            ///< index in the call
  std::uint32_t first_job = 0;          ///< of job_writer::jobs_per_contact()
  double step_m = 0.0, step_rad = 0.0;  ///< of the central difference
};

/// The ten poses around a contact's own. central_difference() asks for the depth at each; what it asks for is first
/// noted down, and answered in the same order once the device has spoken.
struct asked_poses {
  static constexpr std::size_t count = 10;
  std::array<pose, count>* notes = nullptr;                           ///< where to note down, or
  const std::array<std::optional<double>, count>* answers = nullptr;  ///< what to answer
  std::size_t next = 0;

  std::optional<double> operator()(const pose& T_wa) noexcept {
    const std::size_t i = next++;
    if (notes != nullptr) {
      (*notes)[i] = T_wa;
      return std::nullopt;
    }
    return (*answers)[i];
  }
};

class job_writer {
 public:
  /// Takes all memory that a tick needs. @pre cpu_depth finds nothing wrong with scene and settings
  job_writer(scene s, const window_depth_settings& settings);

  [[nodiscard]] std::uint32_t jobs_per_contact() const noexcept {
    return settings_.gradient == gradient_scheme::central_difference ? 1 + asked_poses::count : 1;
  }
  [[nodiscard]] const scene& bodies() const noexcept { return scene_; }
  [[nodiscard]] const window_depth_settings& settings() const noexcept { return settings_; }
  [[nodiscard]] const detail::pair_scale& pair(std::size_t body) const noexcept { return pairs_[body]; }
  [[nodiscard]] vec3 rotation_origin_w(const contact& c, const pose& T_wa) const noexcept {
    return settings_.origin == rotation_origin::contact ? c.window.centre_w : centre_of_mass_w(scene_, T_wa);
  }

  /// Writes the jobs of a contact from `place.first_job` on.
  /// @return false where there is nothing to measure: no window, or no sample that both patches could have
  /// @pre the lists have room for the jobs' own integers; whether the rest fitted, they say   @rt safe
  [[nodiscard]] bool add(number_list& numbers, integer_list& integers, const contact& c,
                         std::span<const std::uint32_t> patch_a, std::span<const std::uint32_t> patch_b,
                         const pose& T_wa, const pose& T_wb, contact_jobs& place) noexcept;

  [[nodiscard]] std::size_t heap_bytes() const noexcept {
    return asperity::heap_bytes(scene_.fixed, indices_, pairs_, a_.patch, a_.field, a_.taper, b_.patch, b_.field,
                                b_.taper);
  }

 private:
  struct side {
    detail::patch_projection patch;
    detail::height_field field;
    detail::edge_taper taper;
    side(std::size_t samples, std::size_t triangles) : patch(triangles), field(samples), taper(triangles) {}
  };
  /// Where a body's triangles and owners were written.
  struct written {
    std::size_t numbers = 0, integers = 0, owners = 0, edges = 0, edge_count = 0;
  };

  [[nodiscard]] const textured_model& body(std::size_t i) const noexcept {
    return i == 0 ? *scene_.probe : *scene_.fixed[i - 1];
  }
  [[nodiscard]] std::size_t most_triangles(std::size_t first, std::size_t end) const noexcept;
  void project(side& s, std::size_t body_index, std::span<const std::uint32_t> patch, const detail::window_map& map,
               detail::layer which, const detail::sample_grid& grid) noexcept;
  [[nodiscard]] written write(const side& s, std::size_t body_index, const detail::window_map& map, detail::layer which,
                              const detail::sample_grid& grid, number_list& numbers,
                              integer_list& integers) const noexcept;
  void write_triangle(const side& s, const detail::projected_triangle& t, std::size_t body_index,
                      const detail::window_map& map, detail::layer which, double half_m, number_list& numbers,
                      integer_list& integers) const noexcept;
  void write_edges(const side& s, double half_m, number_list& numbers, written& to) const noexcept;
  void write_header(const contact& c, const pose& T_wa, const pose& T_wb, number_list& numbers) const noexcept;
  [[nodiscard]] double taper_width(const detail::sample_grid& grid) const noexcept {
    return settings_.taper_m > 0.0 ? settings_.taper_m : 0.1 * grid.half_m;
  }

  scene scene_;
  window_depth_settings settings_;
  std::vector<detail::surface_index> indices_;  ///< the probe, then the fixed bodies
  std::vector<detail::pair_scale> pairs_;       ///< probe against each fixed body
  side a_, b_;
};

}  // namespace asperity::gl
