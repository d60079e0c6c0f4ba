// Depth fields and what they are compared to: distances and winding numbers of a fine surface by brute force.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "asperity/core/status.hpp"
#include "asperity/field/body_field.hpp"
#include "asperity/model/textured_model.hpp"
#include "field/make_body_field.hpp"

namespace asperity::test_support {

/// make_body_field(), compiled as far optimised as for a user.
[[nodiscard]] result<body_field> built_field(const textured_model& model, const field_settings& settings = {});

/// A textured model's fine surface, cut finely enough to stand for it.
class brute_surface {
 public:
  brute_surface(const textured_model& model, double edge_m);

  /// To the closest of all triangles, m.
  [[nodiscard]] double distance(const vec3& p_b) const;
  /// How often the surface goes around a point: 1 inside, 0 outside. The sum of all triangles' solid angles.
  [[nodiscard]] double winding(const vec3& p_b) const;

 private:
  std::vector<std::array<vec3, 3>> triangles_;
};

/// A point of the fine surface.
struct surface_point {
  vec3 p_b{0.0};
  double to_sharp_edge_m = 0.0;  ///< from its coarse point to the nearest sharp edge of its triangle; 1 where none is
};

/// Points spread evenly over the coarse area, at random; those where the texture has no point are left out.
[[nodiscard]] std::vector<surface_point> random_surface_points(const textured_model& model, std::size_t count,
                                                               std::uint64_t seed);

/// |D| at points of the fine surface, where it should be zero, as shares of the body's diagonal.
struct zero_errors {
  double median = 0.0, p99 = 0.0, p99_off_edges = 0.0, p99_at_edges = 0.0, largest = 0.0;
  std::size_t at_edges = 0;  ///< points within two pitches of a sharp edge
};
[[nodiscard]] zero_errors measure_zero(const body_field& field, const textured_model& model, std::size_t count,
                                       std::uint64_t seed);

/// The errors as a line of text.
[[nodiscard]] std::string to_text(const std::string& name, const body_field& field, const zero_errors& e);

}  // namespace asperity::test_support
