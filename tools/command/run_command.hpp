// What `asperity run` was asked.
#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asperity/control/control_settings.hpp"
#include "known_devices.hpp"
#include "render_options.hpp"

namespace asperity::command {

struct run_command {
  std::string probe;
  std::vector<std::string> fixed;
  std::string probe_pose;
  std::vector<std::string> fixed_poses;
  std::string device = "simulated";
  std::optional<double> seconds;  // a replay lasts as long as its recording
  std::string motion = "scrub";
  std::uint64_t seed = 1;
  double press_m = 0.012;
  double device_rate_hz = 1000.0;
  double contact_rate_hz = 1000.0;
  std::optional<double> coupling_n_per_m, coupling_n_m_per_rad;  // what fits device and contacts
  double scale = 1.0;                                            // metres of the world for a metre of the device
  std::uint32_t clutch_button = 0;                               // 1 to 32; 0: none
  std::string weight;                                            // see weight_of(); empty: none
  std::string transient;                                         // see transient_of(); empty: none
  std::string velocity = "poses";                                // see velocity_source
  std::string friction;                                          // see friction_of(); empty: none
  bool no_local_model = false;                                   // planes stay between two contacts
  std::vector<std::string> moves;                                // see body_script::read()
  std::string clock;                                             // empty: what fits the device
  std::string firmware;
  driver_choice drivers;
  std::string record;
  std::string record_device;
  std::string plot;
  std::optional<std::string> view;  // port of the live page, or no number: the usual one
  std::string view_address = "127.0.0.1";
  render_options render;
};

inline constexpr double usual_seconds = 3.0;
inline constexpr double usual_viewed_seconds = 600.0;  ///< where somebody looks at it
inline constexpr std::string_view replay_prefix = "replay:";

[[nodiscard]] inline bool is_simulated(const run_command& options) { return options.device == "simulated"; }
[[nodiscard]] inline bool is_replay(const run_command& options) {
  return std::string_view(options.device).starts_with(replay_prefix);
}
/// Whether a person leads the simulated hand from the page.
[[nodiscard]] inline bool is_led(const run_command& options) { return options.motion == "mouse"; }
/// Length of a session that is no replay.
[[nodiscard]] inline double seconds_of(const run_command& options) {
  return options.seconds.value_or(options.view ? usual_viewed_seconds : usual_seconds);
}
/// File of a replay. @pre is_replay()
[[nodiscard]] inline std::string replayed_file(const run_command& options) {
  return options.device.substr(replay_prefix.size());
}

/// Periods of the rates that were asked for, whole nanoseconds.
[[nodiscard]] inline loop_periods periods_of(const run_command& options) {
  return {std::llround(1e9 / options.device_rate_hz), std::llround(1e9 / options.contact_rate_hz)};
}

/// The bit of a button that is counted from 1; none of 0.
[[nodiscard]] constexpr std::uint32_t button_bit(std::uint32_t button) noexcept {
  return button == 0 ? 0U : 1U << (button - 1U);
}

/// Where the coupling's damper takes the handle's velocity from.
[[nodiscard]] inline velocity_source velocity_of(const run_command& options) {
  return options.velocity == "device"   ? velocity_source::device
         : options.velocity == "window" ? velocity_source::window
                                        : velocity_source::poses;
}

/// `virtual` or `real`.
[[nodiscard]] inline std::string clock_of(const run_command& options) {
  if (!options.clock.empty()) return options.clock;
  return is_simulated(options) || is_replay(options) ? "virtual" : "real";
}

/// The name of a file without folder and extension.
[[nodiscard]] inline std::string file_stem(const std::string& file) {
  return std::filesystem::path(file).stem().string();
}

}  // namespace asperity::command
