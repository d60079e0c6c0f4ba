// Poses that the library has no part in: two original meshes at random orientations come together along a random
// direction until they touch, and are pressed on or drawn back along it.
#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "asperity/core/pose.hpp"
#include "asperity/render/contact.hpp"
#include "law/oracle/placed_mesh.hpp"

namespace asperity::oracle {

/// One way of one body towards the other. The fixed body's frame is the world.
struct approach {
  contact_window window;  ///< centred where the originals touch first; n_ab_w is the way of the probe; no size
  pose touching;          ///< of the probe at the first touch
  vec3 out_w{0.0};        ///< out of the fixed body by the features that touch: first_touch::normal

  /// The probe pressed on by `way_m` from the first touch; drawn back where negative.
  [[nodiscard]] pose pressed(double way_m) const {
    return {touching.rotation, touching.position + way_m * window.n_ab_w};
  }
};

/// Draws approaches of two original meshes. Along an approach's own direction the originals' depth over the whole
/// overlap is the way pressed, exactly: the first touch from infinity is where the probe's highest and the fixed
/// body's lowest point of some line meet, and the way moves them all alike.
class approach_sampler {
 public:
  /// @param name of the pair: another one draws other poses from the same seed
  approach_sampler(std::string name, const triangle_mesh& probe, const triangle_mesh& fixed);

  /// The approach of this number. Any one can be repeated alone. The two meshes are left where they touch, the way
  /// along +z: see probe() and fixed(). Orientation and direction are uniform; the line of the approach goes through a
  /// point of either surface, uniform in area, so that the bodies always meet.
  [[nodiscard]] approach draw(std::uint64_t seed, std::uint64_t index);
  /// Puts the two meshes as draw() leaves them, for a pose that was found otherwise.
  void put(const pose& T_wa, const vec3& n_ab_w);

  /// A number of the last approach's own, uniform in the logarithm.
  [[nodiscard]] double log_between(double low, double high);
  [[nodiscard]] double between(double low, double high);

  [[nodiscard]] const placed_mesh& probe() const noexcept { return probe_; }
  [[nodiscard]] const placed_mesh& fixed() const noexcept { return fixed_; }

 private:
  [[nodiscard]] vec3 point_of(const triangle_mesh& mesh, const std::vector<double>& areas);
  [[nodiscard]] quat orientation();

  std::string name_;
  const triangle_mesh *probe_mesh_, *fixed_mesh_;
  std::vector<double> probe_areas_, fixed_areas_;  ///< summed up
  placed_mesh probe_, fixed_;
  std::mt19937_64 bits_;
};

/// How far a pair of surfaces that lie up to `error_m` from these two can shift the first touch along z.
struct touch_bracket {
  double earlier_m = 0.0;  ///< with both surfaces swollen
  double later_m = 0.0;    ///< from here on no two such surfaces can be apart
};

/// @pre the two touch: approach_sampler has just drawn an approach
/// @param error_m of both surfaces together
/// @param furthest_m where the search for `later_m` ends
[[nodiscard]] touch_bracket bracket_of(const placed_mesh& probe, const placed_mesh& fixed, double error_m,
                                       double furthest_m);

}  // namespace asperity::oracle
