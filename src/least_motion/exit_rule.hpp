// Numbers of the law of least motion, and what a solve had to leave out.
#pragma once

#include <cstddef>

#include "least_motion/bed.hpp"
#include "least_motion/way_out.hpp"

namespace asperity::exits {

/// Numbers of the law.
struct exit_rule {
  double stiffness_n_per_m = 2000.0;  ///< k: of a contact
  double onset_m = 15e-6;             ///< see bed_rule
  double bed = 50.0;                  ///< stiffness of the bed for each sample, in units of k
  double mixed = 4.0;                 ///< bound of the force's slope where ways out are mixed, in units of k
  /// Ways out may turn as well, on a spring of k times the square of this arm and more for a wide contact: a face that
  /// rocks is let out. 0: they are translations. With 25 mm some contacts beside the pivot are softer by 2 to 4 %.
  double turn_arm_m = 0.0;
  std::size_t most_readings = 2'000'000;  ///< of the search; the sum at its end may take a quarter more
  std::size_t most_marks = 32'768;        ///< samples that may touch at one way out

  [[nodiscard]] bed_rule bed_of_samples() const noexcept { return {bed * stiffness_n_per_m, onset_m}; }
  /// The springs in series with the bed make k: exactly for a contact of two samples, within 1 % for one and for many.
  [[nodiscard]] exit_springs springs() const noexcept {
    exit_springs out;
    const double compliance = (1.0 - 0.5 / bed) / stiffness_n_per_m;
    out.mixed = mixed * stiffness_n_per_m;
    out.one = 1.0 / compliance;
    out.each = 1.0 / (compliance + 1.0 / out.mixed);
    return out;
  }
};

}  // namespace asperity::exits
