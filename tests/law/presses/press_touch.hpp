// Where a press begins: random first touches of two originals, which nothing but the originals decides.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "asperity/core/pose.hpp"
#include "asperity/model/triangle_mesh.hpp"
#include "law/oracle/approach.hpp"

namespace asperity::presses {

/// A first touch and the press that begins there. The fixed body's frame is the world.
struct press_touch {
  std::uint64_t index = 0;  ///< of the approach among its pair's of the day
  pose touching_T_wa;       ///< of the probe
  vec3 point_w{0.0};        ///< where they touch
  vec3 way_w{0.0};          ///< of the approach, unit
  vec3 out_w{0.0};          ///< against the press, unit, out of the fixed body; by the features that touch
  double probe_thickness_m = 0.0, fixed_thickness_m = 0.0;  ///< through the point along out_w; infinite where out_w
                                                            ///< leaves a sharp edge at once
  double press_m = 0.0;                                     ///< how far the press goes

  /// The probe `way_m` into the press.
  [[nodiscard]] pose pressed(double way_m) const {
    return {touching_T_wa.rotation, touching_T_wa.position - way_m * out_w};
  }
};

/// Whether a touch at these points, each in its body's frame, is one that a pair asks for.
using touch_region = std::function<bool(const vec3& point_a, const vec3& point_b)>;

/// How far a press goes at most: beyond half way through a body the other side is the nearer one, and a law that
/// remembers nothing must push out there.
inline constexpr double longest_press_m = 8e-3;
inline constexpr double share_of_half_thickness = 0.9;
inline constexpr double shortest_press_m = 0.5e-3;

/// Finds touches of one pair.
class touch_finder {
 public:
  /// @param name of the pair: another one draws other touches from the same seed
  touch_finder(std::string name, const triangle_mesh& probe, const triangle_mesh& fixed, touch_region region = {});

  /// The next touch of the seed: approaches are drawn (approach_sampler::draw) until one touches in the region, on
  /// features that face the approach by 0.2 at least, where the bodies are thick enough for shortest_press_m.
  /// @return nothing where `attempts` approaches had none
  [[nodiscard]] std::optional<press_touch> next(std::uint64_t seed, int attempts = 4000);

  /// The touch of one approach; nothing where it is not wanted.
  [[nodiscard]] std::optional<press_touch> at(std::uint64_t seed, std::uint64_t index);

 private:
  oracle::approach_sampler sampler_;
  touch_region region_;
  std::uint64_t next_ = 0;
};

}  // namespace asperity::presses
