// How a fixed body moves in a session of `run`: a conveyor, a pendulum, a turntable, or poses of a file.
#pragma once

#include <cstddef>
#include <string>
#include <variant>
#include <vector>

#include "asperity/control/moving_bodies.hpp"
#include "asperity/core/pose.hpp"
#include "asperity/core/status.hpp"

namespace asperity::command {

/// Goes to and fro along the world's x axis, at one speed but where it turns.
struct conveyor {
  double speed_m_per_s = 0.0;  ///< negative: begins the other way
  double way_m = 0.1;          ///< from one end to the other at that speed
};
/// Swings about the world's y axis, through the origin of the body's frame.
struct pendulum {
  double amplitude_rad = 0.0;
  double period_s = 1.0;
};
/// Turns about the world's z axis, through the origin of the body's frame.
struct turntable {
  double rate_rad_per_s = 0.0;
};
/// Poses in the world at increasing times; between them the body goes evenly, before and after them it stands still.
struct pose_table {
  std::vector<double> time_s;
  std::vector<pose> T_wb;
};

/// One body's motion.
class body_script {
 public:
  /// What `--move` was given: `[N:]conveyor=SPEED[,WAY]`, `[N:]pendulum=DEGREES,SECONDS`, `[N:]turntable=RPM`, or
  /// `[N:]FILE.csv`. N is the body's place among --fixed, from 1; without it the first.
  /// @param bodies number of fixed bodies
  /// @return invalid_argument, io_failed or bad_format, with what is wrong and where
  [[nodiscard]] static result<body_script> read(const std::string& text, std::size_t bodies);

  /// Index of the body in scene::fixed.
  [[nodiscard]] std::uint32_t body() const noexcept { return body_; }
  /// Where the body is at the beginning, where it would stand at T_wb_still.
  [[nodiscard]] pose begins_at(const pose& T_wb_still) const { return at(0.0, T_wb_still).T_wb; }
  /// Pose and velocity at a time of the session. A motion begins gently.
  [[nodiscard]] body_motion at(double t_s, const pose& T_wb_still) const;

 private:
  [[nodiscard]] pose pose_at(double t_s, const pose& T_wb_still) const;

  std::uint32_t body_ = 0;
  std::variant<conveyor, pendulum, turntable, pose_table> motion_;
};

/// For CLI11: empty where the text has the form of a motion, else what is wrong with it.
[[nodiscard]] std::string body_script_error(const std::string& text);

}  // namespace asperity::command
