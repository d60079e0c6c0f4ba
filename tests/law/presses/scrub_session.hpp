// A hand that scrubs over a body at some rates of contacts: is the probe where the surface has it?
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <string>

#include "asperity/core/status.hpp"
#include "law/presses/press_law.hpp"
#include "law/presses/press_touch.hpp"

namespace asperity::presses {

/// How a hand scrubs: pressed in beyond the touch, to and fro across the press.
struct scrub_rules {
  double way_m = 5e-3;  ///< of the hand beyond the touch
  double amplitude_m = 4e-3, frequency_hz = 1.0;
  double across_rad = 0.0;  ///< of the scrubbing's direction, about the press
  double begins_s = 0.5, seconds = 1.0;
};

/// Draws a scrub: presses of 3 to 10 mm, 2 to 6 mm to and fro at 0.5 to 3 Hz, in any direction across.
[[nodiscard]] scrub_rules drawn_scrub(std::uint64_t seed, const std::string& pair, std::uint64_t touch);

/// The rates of contacts, Hz, with a device loop of 1 kHz and contacts one period late.
inline constexpr std::array<double, 3> scrub_rates_hz{1000.0, 400.0, 200.0};

/// How far the planes that held the probe were from the surface, m: its depth at the end of each device tick, as a tick
/// of the renderer there tells it, less the depth that the planes in use had when its last substep began. Ticks in which
/// something pressed.
struct plane_error {
  double rms_m = 0.0, p99_m = 0.0;
  int ticks = 0;
};
/// By planes that stay as the contact had them, and by planes that are read again in each device tick.
struct scrub_result {
  std::array<plane_error, scrub_rates_hz.size()> stay{}, read_again{};
};

/// One hand's scrubs at a touch of the seed.
[[nodiscard]] result<scrub_result> scrub_sessions(const press_pair& pair, const press_body& probe,
                                                  const press_body& fixed, const press_choice& which);

void print_scrub_heading(std::FILE* to);
/// One line.
void print_row(std::FILE* to, const press_pair& pair, const scrub_result& row);

}  // namespace asperity::presses
