// How deep two originals are in each other, by trial: the shortest translation that was found to part them.
#pragma once

#include <cstddef>
#include <limits>

#include "asperity/core/pose.hpp"
#include "asperity/model/triangle_mesh.hpp"
#include "law/oracle/placed_mesh.hpp"

namespace asperity::presses {

inline constexpr double infinity = std::numeric_limits<double>::infinity();

/// A translation of the probe that parts the two bodies.
struct way_out {
  double way_m = 0.0;     ///< 0 where they are apart; infinite where none was found
  vec3 direction_w{0.0};  ///< unit
};

/// Asks full-resolution meshes which translations of the probe part them. The fixed body's frame is the world. Either
/// surface is one connected piece, or the parts of it that lie wholly within the other body go unseen.
class exit_search {
 public:
  exit_search(const triangle_mesh& probe, const triangle_mesh& fixed);

  /// Whether the bodies share no point.
  [[nodiscard]] bool apart(const pose& T_wa);

  /// The shortest way out that was found: never shorter than the true one, so that a law that is held to less is not
  /// held to too much. Directions over the whole sphere are tried at the best length so far, then ever closer ones
  /// round the best. Along one direction the search halves, so that a gap that lies nearer may be missed.
  /// @param guess_w a direction to begin with
  [[nodiscard]] way_out true_exit(const pose& T_wa, const vec3& guess_w);

  [[nodiscard]] const oracle::placed_mesh& probe() const noexcept { return probe_; }  ///< turned, not moved
  [[nodiscard]] const oracle::placed_mesh& fixed() const noexcept { return fixed_; }
  /// How often apart() was asked.
  [[nodiscard]] std::size_t trials() const noexcept { return trials_; }

 private:
  void turn(const quat& rotation);
  [[nodiscard]] bool apart_at(const vec3& position);

  oracle::placed_mesh probe_, fixed_;
  quat rotation_{1.0, 0.0, 0.0, 0.0};
  double farthest_m_;
  std::size_t trials_ = 0;
};

}  // namespace asperity::presses
