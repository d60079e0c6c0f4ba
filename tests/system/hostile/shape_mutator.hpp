// Shapes that a bake has to refuse or to repair aloud: planted by name, and at random.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "asperity/model/triangle_mesh.hpp"
#include "random_source.hpp"

namespace asperity::hostile {

/// A closed bumpy ball of some two hundred triangles, 5 cm in radius.
[[nodiscard]] triangle_mesh good_ball();

/// A fault of a shape.
struct planted_fault {
  const char* name;
  std::function<void(triangle_mesh&, random_source&)> plant;
  /// Parts of messages, one of which has to come: of a refusal, or of a remark where `baked` is set. Empty with
  /// `baked`: nothing need be said.
  std::vector<std::string> says;
  bool baked = false;
  bool needs_indices = false;  ///< a format without shared vertices cannot express it
};

[[nodiscard]] const std::vector<planted_fault>& planted_faults();

/// One to three faults of the list, small random damage to indices and positions among them.
[[nodiscard]] triangle_mesh mutated_shape(const triangle_mesh& good, random_source& random);

}  // namespace asperity::hostile
