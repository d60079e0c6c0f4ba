// What the library says at poses that it did not choose, beside what the two original meshes say.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "law/oracle/against_originals.hpp"
#include "law/oracle/approach.hpp"

namespace asperity::oracle {

/// Whose force is judged.
enum class formulation : std::uint8_t { least_motion, window };
inline constexpr std::array formulation_names{"least motion", "window"};

/// What was wrong at a pose.
enum class verdict : std::uint8_t {
  agrees,
  missed,       ///< the originals overlap by more than the bound, and there is no force
  shallow,      ///< what is felt is less than the overlap, by more than the bound
  deep,         ///< what is felt is more than the way back out, by more than the bound
  false_touch,  ///< there is force to be felt where the originals are further apart than the bound
  pulls,        ///< pressed on by less than four millimetres, the probe is drawn further in
  doubtful,     ///< within the bound, but beyond what the bakes' mean errors let expect
};
inline constexpr std::array verdict_names{"agrees", "missed", "shallow", "deep", "false touch", "pulls", "doubtful"};
inline constexpr std::size_t verdicts = verdict_names.size();

/// How far the probe was pressed on from the first touch: less than a tenth of a millimetre, less than one, less than
/// four, and from there to a tenth of the smaller diagonal, which can be through the middle of a body.
enum class press : std::uint8_t { drawn_back, graze, light, firm, deep };
inline constexpr std::array press_names{"drawn back", "graze", "light", "firm", "deep"};
inline constexpr std::size_t presses = press_names.size();

/// Less than this is not felt: 0.02 N at 2 N/mm. A soft maximum does not end at the surface, it fades.
inline constexpr double whisper_m = 1e-5;

/// What is felt at a pose, as one spring would have it: sqrt(2 U / k), or the deepest contact of the paper's renderer.
struct felt_depth {
  double depth_m = 0.0;  ///< 0: no force
  std::size_t contacts = 0;
  vec3 towards_w{0.0};  ///< of the force on the probe; unit, or zero
};

/// One pose and its judgement.
struct judged {
  double way_m = 0.0;      ///< from the first touch; negative: drawn back
  double overlap_m = 0.0;  ///< of the originals, at least, where it matters; negative: minus their distance
  double bound_m = 0.0;
  felt_depth felt;
  verdict is = verdict::agrees;
  double excess_m = 0.0;  ///< by how much the bound was passed
};

/// The depth backend alone, in a window of the sampler's own, which may lie up to half its size aside.
struct window_depth {
  double way_m = 0.0;      ///< the originals' depth along n: exact
  double on_grid_m = 0.0;  ///< the same on the samples of the window alone
  double depth_m = 0.0;    ///< what the backend says
  bool nothing = false;    ///< the backend saw no overlap of the patches
  touch_bracket bracket;   ///< wider than the errors of the bakes only where these do not explain the difference

  /// Zero where what the bakes promise and the samples miss explains the difference; otherwise by how much not.
  [[nodiscard]] double excess_m() const noexcept;
};

/// Everything about one approach.
struct judged_approach {
  std::uint64_t index = 0;
  std::array<std::array<judged, presses>, 2> poses;  ///< by formulation and press
  window_depth window;
};

/// What is felt of a pair of bodies by one formulation. Tests put faults in its place.
using feel_function = std::function<felt_depth(formulation, const pose& T_wa)>;
/// The depth in a window; nothing where the patches do not overlap.
using depth_function = std::function<std::optional<double>(const contact_window&, const pose& T_wa)>;

/// A pair of bodies, its originals, and both renderers.
class judged_pair {
 public:
  judged_pair(original_and_bake probe, original_and_bake fixed);
  ~judged_pair();

  /// Poses drawn back and pressed on within each band, by each formulation, and a window.
  [[nodiscard]] judged_approach judge_approach(std::uint64_t seed, std::uint64_t index);
  /// One of its poses alone.
  [[nodiscard]] judged judge_pose(std::uint64_t seed, std::uint64_t index, formulation f, press by);
  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] double bake_error_m() const noexcept { return error_m_; }
  [[nodiscard]] double rms_error_m() const noexcept;
  [[nodiscard]] approach_sampler& sampler() noexcept { return sampler_; }

  feel_function feel;                   ///< the library's, until a test puts something else here
  depth_function depth;                 ///< likewise
  std::function<void(approach&)> bend;  ///< empty; for faults of the sampler

 private:
  struct renderers;
  [[nodiscard]] double missing_m(formulation f) const noexcept;
  [[nodiscard]] double overlap_m(double way_m);
  [[nodiscard]] double way_m(press by);
  [[nodiscard]] window_depth judge_window(const approach& on);
  /// Leaves the originals where they touch first.
  [[nodiscard]] approach draw(std::uint64_t seed, std::uint64_t index);
  [[nodiscard]] judged judge(formulation f, const approach& on, press by, double way_m);

  original_and_bake probe_, fixed_;
  std::string name_;
  double error_m_ = 0.0, smaller_m_ = 0.0;       ///< largest error of both bakes; smaller diagonal
  double overlap_m_ = 0.0, overlap_of_m_ = 0.0;  ///< the last one, and the way that it is of
  approach_sampler sampler_;
  std::unique_ptr<renderers> made_;
};

}  // namespace asperity::oracle
