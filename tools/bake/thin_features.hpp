// Parts of a solid that are thinner than its texture can show.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "asperity/core/math.hpp"
#include "asperity/model/triangle_mesh.hpp"
#include "bake/stage_monitor.hpp"
#include "bake/triangle_bvh.hpp"

namespace asperity::bake {

struct thin_features {
  double share = 0.0;       ///< of the surface whose opposite wall is that near, 0 to 1
  double thinnest_m = 0.0;  ///< the least thickness that was found, m
  vec3 at{0.0};             ///< where, on the surface
  std::size_t points = 0;   ///< of the points looked at, how many lie on such parts
};

/// Where a line from the surface straight inwards leaves the solid again within `thinner_than_m`, through a wall that lies
/// about parallel (by less than 37 degrees). Looks at 20,000 points spread evenly, always the same ones: a part of a
/// twenty-thousandth of the surface may slip through. A sharp edge of a thick solid is no thin part, a blade is one.
/// The result does not depend on the number of threads.
/// @pre the mesh has area and is closed; thinner_than_m > 0 @return nothing where the bake was cancelled
[[nodiscard]] std::optional<thin_features> find_thin_features(const triangle_mesh& mesh, const triangle_bvh& tree,
                                                              double thinner_than_m, unsigned threads,
                                                              stage_monitor& monitor);

/// The sentence with which a report tells of them; empty where there are none.
[[nodiscard]] std::string thin_remark(const thin_features& found, double thinner_than_m);

}  // namespace asperity::bake
