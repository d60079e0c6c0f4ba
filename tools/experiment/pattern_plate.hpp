// A plate with nine textures side by side: flat, regular and irregular ones.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "asperity/core/math.hpp"

namespace asperity::experiment {

/// What one band of the plate is. Each kind but the flat one comes twice, the second time a quarter larger: so regular
/// and irregular ones are as far apart.
enum class texture_kind { flat, stripes, dots, scattered_dots, random };

struct texture_class {
  const char* name;
  texture_kind kind;
  double scale_m;  ///< pitch of the stripes and dots, mean distance of scattered ones, shortest wave of the random one
  [[nodiscard]] bool regular() const noexcept {
    return kind == texture_kind::flat || kind == texture_kind::stripes || kind == texture_kind::dots;
  }
};

[[nodiscard]] const std::vector<texture_class>& texture_classes();

/// Bands of lanes along x. Every lane of a band has the same texture, but a place of its own on it: no two lanes of an
/// irregular one are alike, those of a regular one differ in phase.
class pattern_plate {
 public:
  static constexpr std::size_t lanes_per_class = 4;
  static constexpr double lane_width_m = 2.4e-3;
  static constexpr double length_m = 36e-3;

  explicit pattern_plate(std::uint64_t seed);

  [[nodiscard]] double height_m(const vec2& p) const;
  [[nodiscard]] vec2 size_m() const;
  /// Where a lane's middle is.
  [[nodiscard]] double lane_y_m(std::size_t texture, std::size_t lane) const;

 private:
  struct wave {
    vec2 k_rad_per_m;
    double phase_rad, height_m;
  };
  struct lane_texture {
    std::vector<double> stripes_m;  ///< their middles along x
    std::vector<vec2> dots_m;       ///< their middles, y from the lane's middle
    std::vector<wave> waves;
  };

  std::vector<lane_texture> lanes_;
};

}  // namespace asperity::experiment
