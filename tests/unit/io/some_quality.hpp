// A bake's quality with a different number in every field.
#pragma once

#include "asperity/model/bake_report.hpp"

namespace asperity::test_support {

inline bake_quality some_quality() {
  bake_quality q;
  q.to_original = {1.1e-6, 1.2e-5, 1.3e-4};
  q.to_textured = {2.1e-6, 2.2e-5, 2.3e-4};
  q.to_original_rms_m = 1.4e-6;
  q.to_textured_rms_m = 2.4e-6;
  q.crack_max_m = 3.1e-5;
  q.texel_m = 1.9e-4;
  q.atlas_utilisation = 0.53;
  q.texel_spacing = {2.0e-4, 0.1 + 0.2, 5.0e-4};
  q.lost_share = 0.021;
  q.lost_part_share = 0.017;
  q.lost_part_centre = {0.001, -0.002, 1.0 / 3.0};
  q.lost_part_low = {-0.004, -0.005, 0.006};
  q.lost_part_high = {0.007, 0.008, 0.009};
  q.surface_to_hull_max_m = 4.1e-5;
  q.bridged_air_max_m = 5.1e-4;
  return q;
}

}  // namespace asperity::test_support
