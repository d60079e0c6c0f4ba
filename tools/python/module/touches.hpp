// A tick of a renderer as it can be kept.
#pragma once

#include <optional>
#include <vector>

#include "asperity/render/renderer.hpp"

namespace asperity::python {

struct touch_contact {
  contact where;
  penetration deep;
  std::optional<wrench> on_probe_w;
};

struct touch {
  wrench on_probe_w{};
  mat6 stiffness{};
  vec3 centre_of_mass_w{0.0};
  std::vector<wrench> on_body;
  std::vector<touch_contact> contacts;
  std::vector<support_plane> planes;
  std::size_t dropped_contacts = 0;
  status answered = status::ok;
};

/// A copy of what the tick refers to.
[[nodiscard]] touch touch_of(const tick& found, status answered);

}  // namespace asperity::python
