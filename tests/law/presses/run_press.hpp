// A press along a touch's direction, step by step, and what a wall must not do in it: be weak, give way, pull.
#pragma once

#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "asperity/core/spatial.hpp"
#include "law/presses/press_touch.hpp"
#include "law/presses/true_exit.hpp"

namespace asperity::presses {

/// The wrench on the probe at a pose, world axes; the fixed body's frame is the world. Not finite where the law could
/// not answer.
using step_function = std::function<wrench(const pose& T_wa)>;

/// What a press is held to.
struct press_rules {
  double stiffness_n_per_m = 2000.0;
  double step_m = 1e-4;
  double from_m = 3e-4;      ///< where the rules begin: what is shallower shows softness and texture
  double allowance_m = 0.0;  ///< how far the models lie from the originals together; a press may begin that much late
  double weak_share = 0.5;   ///< the force is at least this share of k d
  double fall_share = 0.95;  ///< and of the largest force so far
  double pull_n = 0.1;       ///< the force against the press is never less than minus this
  /// Where the shortest way out is less than this share of d, or leads another way than the cosine below, another part
  /// of the surface holds the probe, and the force follows that way. A law may change over so far ahead of the tie.
  double held_elsewhere = 0.95, same_way = 0.9, ahead = 1.1;
};

/// One breach of a rule.
struct breach {
  bool found = false;
  double at_m = 0.0;        ///< way into the press where it began
  double force_n = 0.0;     ///< against the press there
  double expected_n = 0.0;  ///< at least
};

struct press_step {
  double way_m = 0.0;
  double along_n = 0.0;  ///< force along out_w: against the press
  double force_n = 0.0;  ///< its length
};

/// One press. A rule that a step breaks is asked again of the true depth: where the originals can be parted by less
/// than the way pressed, past an edge or on a slope, the length of the force has to follow that depth instead.
struct press_result {
  std::vector<press_step> steps;
  breach weak, falls, pulls;
  int unanswered = 0;        ///< steps whose wrench was not finite
  int elsewhere = 0;         ///< steps that broke a rule and were held by another part of the surface
  double peak_n = 0.0;       ///< largest force along out_w
  double least_n = 0.0;      ///< smallest force along out_w from press_rules::from_m on
  double last_n = 0.0;       ///< at the end
  double worst_share = 0.0;  ///< smallest along_n / (k d), from press_rules::from_m on, of steps not held elsewhere
  double worst_fall = 0.0;   ///< smallest share of the largest force so far, likewise

  [[nodiscard]] bool good() const noexcept { return !weak.found && !falls.found && !pulls.found && unanswered == 0; }
};

[[nodiscard]] press_result run_press(const step_function& step, const press_touch& touch, const press_rules& rules,
                                     exit_search& originals);

/// All presses of one pair under one law.
struct press_row {
  std::string probe, fixed;
  std::vector<press_result> presses;
  double longest_m = 0.0;
  double touch_s = 0.0;  ///< time that finding the touches took
  double step_s = 0.0;   ///< time of the law's steps
  std::size_t step_count = 0;

  [[nodiscard]] int weak() const;
  [[nodiscard]] int falls() const;
  [[nodiscard]] int pulls() const;
  [[nodiscard]] int unanswered() const;
  [[nodiscard]] int good() const;
};

/// Names the columns of print_row().
void print_heading(std::FILE* to);
/// One line: how many presses broke each rule, where the first and the median of them did, and the forces at the end.
void print_row(std::FILE* to, const press_row& row);
/// In words, for a failed test: the pair, the touch's index and each breach.
[[nodiscard]] std::string in_words(const press_row& row, std::size_t press);

}  // namespace asperity::presses
