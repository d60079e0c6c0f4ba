// The few support planes that the contact thread hands to the device thread.
#pragma once

#include <cstddef>

#include "asperity/core/fixed_vector.hpp"
#include "asperity/render/support_plane.hpp"

namespace asperity {

/// Most support planes that a contact carries: those that press where the probe will rest, one for each sample, and
/// those that it meets next when it tilts or slides.
inline constexpr std::size_t most_support_planes = 64;
/// Of these, how many are chosen for test motions; the rest is for where the probe will come to rest.
inline constexpr std::size_t most_selected_planes = 20;

/// Support planes of one contact; dropped() tells how many more were wanted than it could keep.
using support_planes = fixed_vector<support_plane, most_support_planes>;

}  // namespace asperity
