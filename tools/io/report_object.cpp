#include "report_object.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace asperity::io {
namespace {

using value = tinygltf::Value;
using object = tinygltf::Value::Object;

object spread_object(const length_spread& s) {
  return {{"median_m", value(s.median_m)}, {"p99_m", value(s.p99_m)}, {"max_m", value(s.max_m)}};
}

tinygltf::Value vector_value(const vec3& v) {
  return value(tinygltf::Value::Array{value(v.x), value(v.y), value(v.z)});
}

object quality_object(const bake_quality& q) {
  return {{"to_original", value(spread_object(q.to_original))},
          {"to_textured", value(spread_object(q.to_textured))},
          {"to_original_rms_m", value(q.to_original_rms_m)},
          {"to_textured_rms_m", value(q.to_textured_rms_m)},
          {"crack_max_m", value(q.crack_max_m)},
          {"texel_m", value(q.texel_m)},
          {"atlas_utilisation", value(q.atlas_utilisation)},
          {"texel_spacing", value(spread_object(q.texel_spacing))},
          {"lost_share", value(q.lost_share)},
          {"lost_part_share", value(q.lost_part_share)},
          {"lost_part_centre", vector_value(q.lost_part_centre)},
          {"lost_part_low", vector_value(q.lost_part_low)},
          {"lost_part_high", vector_value(q.lost_part_high)},
          {"surface_to_hull_max_m", value(q.surface_to_hull_max_m)},
          {"bridged_air_max_m", value(q.bridged_air_max_m)}};
}

bool all_finite(const length_spread& s) {
  return std::isfinite(s.median_m) && std::isfinite(s.p99_m) && std::isfinite(s.max_m);
}

bool all_finite(const bake_quality& q) {
  for (const double x : {q.to_original_rms_m, q.to_textured_rms_m, q.crack_max_m, q.texel_m, q.atlas_utilisation,
                         q.lost_share, q.lost_part_share, q.surface_to_hull_max_m, q.bridged_air_max_m}) {
    if (!std::isfinite(x)) return false;
  }
  return all_finite(q.to_original) && all_finite(q.to_textured) && all_finite(q.texel_spacing) &&
         is_finite(q.lost_part_centre) && is_finite(q.lost_part_low) && is_finite(q.lost_part_high);
}

}  // namespace

tinygltf::Value::Object report_object(const bake_report& report) {
  const auto count = [](std::size_t n) {
    return value(static_cast<int>(std::min<std::size_t>(n, std::numeric_limits<int>::max())));
  };
  object out{{"rms_error_m", value(report.rms_error_m)},
             {"max_error_m", value(report.max_error_m)},
             {"relief_m", value(report.peak_to_valley_m)},
             {"max_displacement_m", value(report.max_displacement_m)},
             {"full_triangles", count(report.full_triangles)},
             {"fallback_texels", count(report.fallback_texels)},
             {"texels", count(report.texels)}};
  if (report.quality) out["quality"] = value(quality_object(*report.quality));
  return out;
}

bool has_finite_figures(const bake_report& r) {
  return std::isfinite(r.rms_error_m) && std::isfinite(r.max_error_m) && std::isfinite(r.peak_to_valley_m) &&
         std::isfinite(r.max_displacement_m) && (!r.quality || all_finite(*r.quality));
}

}  // namespace asperity::io
