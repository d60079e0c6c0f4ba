// Bodies and geoms of a MuJoCo model by their names, and where a textured model is on its body.
#pragma once

#include <mujoco/mujoco.h>
#include <string>
#include <vector>

#include "asperity/core/pose.hpp"
#include "asperity/core/status.hpp"
#include "asperity/mujoco/textured_contacts.hpp"

namespace asperity::mujoco {

struct found_object {
  int body = 0;
  int geom = -1;  ///< -1: all geoms of the body
  pose T_bm{};    ///< the textured model's frame in the body's
};

/// @param where "pair 2, probe", for messages
[[nodiscard]] result<found_object> find_object(const mjModel& m, const textured_object& object,
                                               const std::string& where);

/// The geoms that an object stands for.
[[nodiscard]] std::vector<int> geoms_of(const mjModel& m, const found_object& object);

/// "geom 'plate'", or its number where it has no name.
[[nodiscard]] std::string name_of(const mjModel& m, mjtObj kind, int id);

/// No others than those that collide are named: the first two.
struct colliding_geoms {
  int of_probe = -1, of_fixed = -1;
  bool by_pair_element = false;  ///< a <pair> of the MJCF, whatever the masks
};
/// Empty (of_probe < 0) where MuJoCo makes no contacts between the two objects.
[[nodiscard]] colliding_geoms find_own_contacts(const mjModel& m, const found_object& probe, const found_object& fixed);

}  // namespace asperity::mujoco
