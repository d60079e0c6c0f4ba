// The second policy: how deep, and which way out.
//
// Contract of every depth backend
// - measure() fills out[i] for the i-th place that was found, for every place, in one call: a GPU pays for its round
//   trip once per tick.
// - Depths are in metres, positive in overlap. Gradients are about c_A, in world axes.
// - Agreement with the double-precision CPU backend is within a bound that the backend states.
// - Nothing in measure() allocates, locks, throws, prints or reads a clock (a GPU backend says what its driver does).
//
// What a formulation promises besides
// - The paper's (reading_type penetration): heights along n are those of the textured surfaces over the coarse
//   patches (paper, Eq. 8), and depth_m is their largest difference h_A - h_B over the window; the gradient's
//   component along n is 1. Where the patches share no sample, no_overlap is set and every number is zero.
// - Fields (reading_type near_plane): the deepest sample of each leaf as a support plane.
#pragma once

#include <concepts>
#include <cstdint>
#include <span>

#include "asperity/core/status.hpp"
#include "asperity/model/scene.hpp"
#include "asperity/render/collision_finder.hpp"
#include "asperity/render/penetration.hpp"

namespace asperity {

/// Base of a backend's `policy_tag`: naming it says "I keep the contract above".
struct depth_tag {};

namespace detail {
template <class P>
struct reading_of {
  using type = penetration;
};
template <class P>
requires requires { typename P::reading_type; }
struct reading_of<P> {
  using type = typename P::reading_type;
};
}  // namespace detail

/// What a policy's depth backend measures of one thing found: a penetration, unless the policy names another
/// reading_type. Depth backend and force model must agree on it.
template <class P>
using reading_of = typename detail::reading_of<P>::type;

template <class P>
concept depth_backend = std::derived_from<typename P::policy_tag, depth_tag> &&
    requires(P& backend, const scene_pose& at, const found_by<P>& found, std::span<reading_of<P>> out) {
  { backend.measure(at, found, out) }
  noexcept->std::same_as<status>;
};

/// How many samples a tick found near, and what it took to tell which of them count. Zero where nobody counts.
struct depth_work {
  std::uint32_t looked_at = 0;  ///< balls of samples, large and small, that a finder could not leave unread
  std::uint32_t listed = 0;     ///< samples that may be within reach
  std::uint32_t bounded = 0;    ///< leaves, a few samples each, that a reading bounded
  std::uint32_t read = 0;       ///< samples that were read, as far as it took to dismiss them or in full
};

/// A stage of a renderer that counts what its last tick took.
template <class P>
concept reports_work = requires(const P& stage) {
  { stage.work() }
  noexcept->std::same_as<const depth_work&>;
};

}  // namespace asperity
