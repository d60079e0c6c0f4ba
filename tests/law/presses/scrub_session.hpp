// A hand that scrubs over a body at some rates, beside the same hand where both loops run at 10 kHz.
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <string>

#include "asperity/core/status.hpp"
#include "law/presses/press_law.hpp"
#include "law/presses/press_touch.hpp"

namespace asperity::presses {

/// How a hand scrubs: pressed in beyond the touch, to and fro across the press. It does not tremble, since a tremor is
/// drawn anew at every rate.
struct scrub_rules {
  double way_m = 5e-3;  ///< of the hand beyond the touch
  double amplitude_m = 4e-3, frequency_hz = 1.0;
  double across_rad = 0.0;  ///< of the scrubbing's direction, about the press
  double begins_s = 0.5, seconds = 1.0;
};

/// Draws a scrub: presses of 3 to 10 mm, 2 to 6 mm to and fro at 0.5 to 3 Hz, in any direction across.
[[nodiscard]] scrub_rules drawn_scrub(std::uint64_t seed, const std::string& pair, std::uint64_t touch);

/// The rates of contacts that are compared, Hz, with a device loop of 1 kHz and contacts one period late.
inline constexpr std::array<double, 3> scrub_rates_hz{1000.0, 400.0, 200.0};

/// What the hand feels beside the loops at 10 kHz, rms, N: the force, and how far it is off with planes that stay as
/// the contact had them, and with planes that are read again in each device tick.
struct scrub_result {
  double force_n = 0.0;
  std::array<double, scrub_rates_hz.size()> off_n{}, read_again_off_n{};
};

/// One hand's scrubs at a touch of the seed.
[[nodiscard]] result<scrub_result> scrub_sessions(const press_pair& pair, const press_body& probe,
                                                  const press_body& fixed, const press_choice& which);

void print_scrub_heading(std::FILE* to);
/// One line.
void print_row(std::FILE* to, const press_pair& pair, const scrub_result& row);

}  // namespace asperity::presses
