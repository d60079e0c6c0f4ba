#include "striped_block.hpp"

#include <utility>

#include "lattice_solid.hpp"

namespace asperity::experiment {
namespace {

// The box, cut along x where ridges begin to run out.
models::lattice_solid cut_box(std::uint32_t run_out, std::uint32_t along, std::uint32_t across, std::uint32_t high) {
  models::lattice_solid solid;
  solid.axes[0] = {{-block_half_m[0], -ridge_half_length_m, ridge_half_length_m, block_half_m[0]},
                   {run_out, along, run_out}};
  solid.axes[1] = {{-block_half_m[1], block_half_m[1]}, {across}};
  solid.axes[2] = {{-block_half_m[2], block_half_m[2]}, {high}};
  solid.filled = [](const vec3&) { return true; };
  return solid;
}

// 64 cells to a ridge across, many where it runs out, few along it.
triangle_mesh full_resolution() {
  return models::surface_of(cut_box(16, 24, 608, 16), [](const vec3& p) {
    if (std::abs(p.z) < block_half_m[2]) return p;
    const ridge_heights h = ridges_at(p.x, p.y);
    return p + vec3(0.0, 0.0, p.z > 0.0 ? h.top_m : h.bottom_m);
  });
}

// Its edges are those of the full mesh, so that texels look straight at the ridges up to there: the ends are as low as
// the valleys.
triangle_mesh coarse() {
  return models::surface_of(cut_box(1, 1, 1, 1), [](const vec3& p) {
    const double sunk_m = std::abs(p.x) < block_half_m[0] ? 0.0 : models::ridge_amplitude_m;
    return vec3(p.x, p.y, p.z - std::copysign(sunk_m, p.z));
  });
}

}  // namespace

result<model_ptr> striped_block(workbench& bench) {
  bake::bake_settings options;
  options.coarse = coarse();
  options.texture_size = 1536;
  return bench.models().baked("striped_block", full_resolution, std::move(options));
}

}  // namespace asperity::experiment
