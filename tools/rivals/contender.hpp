// What every contender of `asperity bench --rivals` is given and reports: asperity's renderers, and other libraries.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "asperity/core/pose.hpp"
#include "asperity/core/status.hpp"
#include "asperity/model/scene.hpp"
#include "asperity/model/triangle_mesh.hpp"

namespace asperity::rivals {

/// Two bodies at full resolution and as they were baked. The fixed body's frame is the world.
struct body_pair {
  std::string name;
  triangle_mesh probe, fixed;  ///< closed, outward oriented, metres
  scene baked;                 ///< of one probe and one fixed body; only asperity's own contenders read it
};

/// What a contender reports of one pose.
struct felt {
  bool touches = false;      ///< it found an overlap
  double depth_m = 0.0;      ///< the largest that it reports
  vec3 force_w{0.0};         ///< on the probe, of any scale: directions are compared, stiffnesses are not
  std::size_t contacts = 0;  ///< as it counts them
};

/// One way to feel a pair of bodies. Not for two threads.
class contender {
 public:
  contender() = default;
  contender(const contender&) = delete;
  contender& operator=(const contender&) = delete;
  virtual ~contender() = default;

  /// Everything that a pose costs happens in here.
  [[nodiscard]] virtual felt feel(const pose& T_wa) = 0;
};

using contender_ptr = std::unique_ptr<contender>;

/// A contender by name, and how it is made of a pair. The pair outlives what is made of it.
struct entry {
  std::string name;  ///< for tables
  bool ours = false;
  std::function<result<contender_ptr>(const body_pair&)> make;
};

/// asperity's three: support planes as for a loop of 1 kHz, the least motion, the paper's contacts.
[[nodiscard]] std::vector<entry> our_entries();

/// FCL, triangles against triangles, every contact asked for: two trees of OBBRSS.
/// depth_m is the largest penetration of two triangles; the force sums depth times normal over all contacts.
[[nodiscard]] result<contender_ptr> make_fcl(const body_pair& bodies);

/// Bullet's GImpact in double precision, triangles against triangles, every contact asked for and none merged.
/// depth_m is the largest of two triangles; the force sums depth times normal over all contacts.
[[nodiscard]] result<contender_ptr> make_gimpact(const body_pair& bodies);

/// A point shell in a dense signed distance field, after McNeely and others and Barbic and James: the probe's vertices
/// in a tree of spheres, the fixed body's distance on a grid from OpenVDB, a spring for each vertex that is inside.
/// depth_m is that of the deepest vertex.
/// @param voxel  edge of a voxel as a share of the fixed body's diagonal
[[nodiscard]] result<contender_ptr> make_point_shell(const body_pair& bodies, double voxel);

/// MuJoCo's own contacts of two mesh geoms: of their convex hulls, for MuJoCo 2.2.2 knows no other meshes.
/// depth_m is the deepest contact's; the force sums depth times normal over all contacts.
[[nodiscard]] result<contender_ptr> make_mujoco(const body_pair& bodies);

/// The libraries above, each as it is raced.
[[nodiscard]] std::vector<entry> rival_entries();

}  // namespace asperity::rivals
