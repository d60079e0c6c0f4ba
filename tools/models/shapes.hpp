// The makers behind make_full and make_coarse, one source file each.
#pragma once

#include "asperity/model/triangle_mesh.hpp"

namespace asperity::models {

[[nodiscard]] triangle_mesh make_block();
[[nodiscard]] triangle_mesh make_coarse_block();
[[nodiscard]] triangle_mesh make_gear();
[[nodiscard]] triangle_mesh make_coarse_gear();
[[nodiscard]] triangle_mesh make_hammer();
[[nodiscard]] triangle_mesh make_cad_part();
[[nodiscard]] triangle_mesh make_file();
[[nodiscard]] triangle_mesh make_torus();

}  // namespace asperity::models
