// What the two renderers tell of a pair of bodies at poses that neither had a part in, beside what the originals say.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/geometric.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "law/oracle/approach.hpp"
#include "law/truth/originals_depth.hpp"
#include "law/truth/reported.hpp"
#include "law/truth/truth_bodies.hpp"

namespace asperity::truth {

/// How far the probe was moved from a first touch: drawn back by up to a millimetre, pressed on by 0.05 to 1 mm, and by
/// 1 to 4 mm.
enum class band : std::uint8_t { gap, light, deep };
inline constexpr std::array band_names{"gap", "light", "deep"};

/// One pose of the planes' truth.
struct plane_case {
  std::uint64_t index = 0;
  band of = band::gap;
  double way_m = 0.0;    ///< from the first touch; negative: drawn back
  bool against = false;  ///< pressed against the features that touch; otherwise along the approach
  pose T_wa;
  std::optional<reported_plane> reported;
  double overlap_m = 0.0;  ///< how deep the originals are in each other, at least; negative: their distance
  bool of_probe = false;   ///< the sample lies on the probe
  place_depth truth;
  /// One wall is all that the sample's depth is about: of the body that it is in, no triangle as near as the depth and
  /// two pitches of the field looks aside by more than 30 degrees.
  bool one_wall = false;

  /// Told less true; only where a plane was told and the originals have a surface there.
  [[nodiscard]] double error_m() const { return reported->depth_m - truth.at_place_m; }
  /// Angle between n_ab and the mean normal of the surface that the sample is in, rad.
  [[nodiscard]] double tilt_rad() const;
};

/// Puts faults between the library and its judge.
using plane_bend = std::function<void(reported_plane&)>;

/// The originals of a pair, as both judges ask them.
class pair_originals {
 public:
  [[nodiscard]] const std::string& name() const noexcept { return name_; }

 protected:
  pair_originals(const truth_body& probe, const truth_body& fixed);

  std::string name_;
  double probe_pitch_m_, fixed_pitch_m_;  // of the fields' smooth parts
  oracle::approach_sampler sampler_;
  std::shared_ptr<const near_triangles> probe_, fixed_;
};

/// A pair, its originals, and the support planes that are told of it.
class plane_truth : public pair_originals {
 public:
  plane_truth(const truth_body& probe, const truth_body& fixed);
  /// The originals of two bodies, and fields that are not theirs: for faults.
  plane_truth(const truth_body& probe, const truth_body& fixed, const truth_pair& felt);

  /// Three poses of one approach, one of each band; none of a band where the bodies are too thin for it.
  [[nodiscard]] std::vector<plane_case> approach(std::uint64_t seed, std::uint64_t index);

  [[nodiscard]] double diagonal_m() const noexcept { return diagonal_m_; }      ///< of the smaller body
  [[nodiscard]] double bake_error_m() const noexcept { return bake_error_m_; }  ///< the largest of both, together

  plane_bend bend;  ///< empty: none

 private:
  [[nodiscard]] plane_case judge(const pose& T_wa);

  double diagonal_m_, window_m_, bake_error_m_;
  plane_law law_;
};

/// One press against the features that touch first.
struct press_case {
  std::uint64_t index = 0;
  double depth_m = 0.0;  ///< of the press: by which the features of the first touch overlap, along their normal
  double least_m = 0.0;  ///< no motion shorter than this parts the originals
  /// Of one of the two bodies, no triangle as near to the touch as the depth and two pitches of its field looks aside
  /// by more than 30 degrees: the other touches a wall.
  bool one_wall = false;
  vec3 n_ab_w{0.0};  ///< the way of the press, unit
  pose T_wa;
  reported_force reported;
  [[nodiscard]] double along_n() const { return -glm::dot(reported.on_probe_w.force, n_ab_w); }
};

/// Puts faults between the library and its judge.
using force_bend = std::function<void(reported_force&)>;

/// A pair, its originals, and the wrench that is told of it.
class force_truth : public pair_originals {
 public:
  force_truth(const truth_body& probe, const truth_body& fixed);
  force_truth(const truth_body& probe, const truth_body& fixed, const truth_pair& felt);

  /// The probe pressed by depth_m against the features that touch first. Nothing where the touch is glancing or the
  /// bodies are too thin, and where the least motion that parts them may be shorter than `alone` times the depth: then
  /// another place or another way out has a part in the force.
  [[nodiscard]] std::optional<press_case> press(std::uint64_t seed, std::uint64_t index, double depth_m, double alone);

  [[nodiscard]] pose_law& law() noexcept { return law_; }

  force_bend bend;  ///< empty: none

 private:
  pose_law law_;
};

/// Half the bodies' thickness through the touch along the press, by the originals.
[[nodiscard]] double half_thickness_m(const oracle::approach_sampler& sampler, const oracle::approach& on);

/// The value below which `share` of the values are.
[[nodiscard]] double quantile(std::vector<double> values, double share);

}  // namespace asperity::truth
