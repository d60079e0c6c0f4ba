// Whether this machine keeps the rate of a contact loop: a short look before a session.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "asperity/control/contact_loop.hpp"
#include "asperity/control/control_settings.hpp"
#include "asperity/render/any_renderer.hpp"
#include "render_choice.hpp"
#include "statistics.hpp"

namespace asperity::command {

/// A rate is kept where no more ticks than this share take longer than their period.
inline constexpr double allowed_over_period = 0.01;

/// What contact ticks take here, time on the wall.
struct rate_check {
  double period_s = 0.0;  ///< of the contact loop that was asked for
  time_summary tick{};
  double processor_p99_s = 0.0;          ///< the same percentile of the processor's time alone
  bool kept = false;                     ///< the 99th percentile of a tick is within the period
  std::optional<double> kept_rate_hz{};  ///< where it is not: a lower rate that a processor of its own would keep
  std::optional<unsigned> threads{};     ///< see more_threads()
};

/// The largest of the usual rates whose period is a quarter longer than this. @return nothing below 100 Hz
[[nodiscard]] std::optional<double> rate_within(double tick_s);

/// Times up to 200 contact ticks of a probe that the coupling presses on the bodies at their first touch and moves to
/// and fro there; fewer where they take longer than a third of a second together. Before a session, not in it.
/// @param feel        keeps what it knows of these poses, so one whose answers depend on earlier ticks should not go
///                    into the session afterwards
/// @param touch_T_wa  the probe's pose at the touch
[[nodiscard]] rate_check check_rate(any_renderer& feel, const scene_placement& placement, const pose& touch_T_wa,
                                    const control_settings& control, const loop_periods& periods);

[[nodiscard]] nlohmann::ordered_json to_json(const rate_check& checked);
/// One line: what a tick takes, whether the rate is kept, and where it is not, what to do.
[[nodiscard]] std::string to_text(const rate_check& checked);
/// How many threads could share a tick on a machine of so many processors, beside the device thread and the
/// application; nothing where that is no more than there are, or the contacts are not support planes.
[[nodiscard]] std::optional<unsigned> more_threads(const render_options& chosen, unsigned processors);
/// What to do where a rate is not kept: "use --threads 2, --contact-rate 400, or coarser models".
[[nodiscard]] std::string advice_for(std::optional<double> kept_rate_hz, std::optional<unsigned> threads = {});

}  // namespace asperity::command
