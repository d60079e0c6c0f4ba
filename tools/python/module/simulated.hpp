// The simulated device and its hand as Python describes them.
#pragma once

#include <optional>
#include <string>

#include "asperity/device/simulated/simulated_settings.hpp"

namespace asperity::python {

/// A device that is made anew for each session: the same description gives the same bits.
struct device_wish {
  simulated_settings settings{};      ///< but for the motion, which depends on the bodies
  double press_m = 0.012;             ///< how far the hand goes on after the touch
  std::optional<double> amplitude_m;  ///< of scrub, tap and free; nothing: a tenth of the smaller body
};

}  // namespace asperity::python
