// The six models of the paper's benchmark (section 6.2, Fig. 6, Table 1), made from formulas.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "asperity/model/triangle_mesh.hpp"

namespace asperity::models {

/// A model of the paper's Table 1.
enum class benchmark : std::uint8_t {
  block,     ///< box with straight ridges on its top and bottom; its ridges interlock with the gear and with a second
             ///< block
  gear,      ///< cylinder about x with straight ridges around it
  hammer,    ///< cross-peen hammer, rough as forged, grain along its handle
  cad_part,  ///< stepped plate with three round holes and a slot, rough as cast
  file,      ///< hand file with a tang; two families of grooves cross on its faces
  torus,     ///< wrinkled torus about z
};

/// All models in the order of Table 1.
inline constexpr std::array<benchmark, 6> all_benchmarks = {benchmark::block,    benchmark::gear, benchmark::hammer,
                                                            benchmark::cad_part, benchmark::file, benchmark::torus};

/// Pitch of the ridges on block and gear, along the block's y and around the gear, metres.
inline constexpr double ridge_wavelength_m = 4e-3;
/// Half of the height between valley and crest of those ridges, metres. The coarse meshes lie at mid height.
inline constexpr double ridge_amplitude_m = 0.5e-3;
/// Length along x over which the ridges rise from nothing at the ends of block and gear, metres. They end level with
/// the coarse mesh so that its sharp edges are the full mesh's edges too.
inline constexpr double ridge_fade_m = 1e-3;

/// Extents of the block at mid height, metres. Centred at the origin. Across y it is nine and a half ridges wide, so
/// that the cosine ends at mid height by itself.
inline constexpr std::array<double, 3> block_size_m = {40e-3, 38e-3, 20e-3};

/// Number of ridges around the gear.
inline constexpr std::uint32_t gear_ridges = 96;
/// Radius of the gear at mid height, metres: gear_ridges whole wavelengths around.
inline constexpr double gear_radius_m = gear_ridges * ridge_wavelength_m / 6.283185307179586;
/// Extent of the gear along x, metres. Centred at the origin; a crest points along +z.
inline constexpr double gear_length_m = 48e-3;

/// Positions of the full-resolution models are whole multiples of this, metres: 2^-26 m, 15 nm. Up to 0.25 m from the
/// origin single precision holds them exactly, so that a file holds the very same mesh; and the last bit of a sine,
/// which mathematical libraries do not agree on, does not show.
inline constexpr double position_step_m = 0x1p-26;

/// Name of the model as the command and its files use it.
[[nodiscard]] std::string_view to_string(benchmark b) noexcept;

/// The model of that name; nothing where no model has it.
[[nodiscard]] std::optional<benchmark> parse_benchmark(std::string_view name) noexcept;

/// Triangles at full resolution. @source paper Table 1
[[nodiscard]] std::size_t full_triangle_count(benchmark b) noexcept;

/// Triangles at coarse resolution. @source paper Table 1
[[nodiscard]] std::size_t coarse_triangle_count(benchmark b) noexcept;

/// Convex pieces that the paper's decomposition of its own coarse mesh has. @source paper Table 1
[[nodiscard]] std::size_t paper_piece_count(benchmark b) noexcept;

/// The full-resolution model in its body frame, metres: full_triangle_count(b) triangles, closed, 2-manifold, one
/// component, outward oriented. The same bits on every call and in every build type.
[[nodiscard]] triangle_mesh make_full(benchmark b);

/// The coarse partner of a full-resolution model, for block and gear: coarse_triangle_count(b) triangles, convex, no
/// ridge left in it. Nothing for the others: their coarse meshes come from simplifying.
[[nodiscard]] std::optional<triangle_mesh> make_coarse(benchmark b);

}  // namespace asperity::models
