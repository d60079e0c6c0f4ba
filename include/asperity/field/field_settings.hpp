// How finely depth fields are made.
#pragma once

#include <cstddef>

namespace asperity {

/// How finely a depth field is made. Lengths in metres, 0 for automatic. A pitch is raised where it would go beyond the
/// limits.
struct field_settings {
  double pitch_m = 0.0;                   ///< of the smooth part; automatic: extent / 96, at most a third of thin parts
  double relief_pitch_m = 0.0;            ///< of the relief; automatic: a texel, at most a third of the pitch above
  double margin_m = 0.0;                  ///< of the grid around the body; automatic: 4 % of its diagonal
  std::size_t most_nodes = 4'000'000;     ///< of the smooth part; 4 bytes each
  std::size_t relief_bytes = 40'000'000;  ///< about what the relief may take

  friend bool operator==(const field_settings&, const field_settings&) = default;
};

/// Settings of make_field_body().
struct field_body_settings {
  field_settings field{};
  double sample_pitch_m = 0.0;  ///< distance between samples; 0: 0.3 % of the body's diagonal

  friend bool operator==(const field_body_settings&, const field_body_settings&) = default;
};

}  // namespace asperity
