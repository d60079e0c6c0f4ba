// What must hold in a session with stalls, by the device's side alone.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <sstream>
#include <string>
#include <vector>

#include "session/simulation/stall/stall_session.hpp"

namespace asperity::simulation {

/// What came of one scenario.
struct stall_outcome {
  std::string broken;  ///< what does not hold, in words; empty where everything does
  gate_fault fault = gate_fault::none;
  double force_over_share = 0.0;  ///< largest force above the unstalled one, as a share of its bound
  double torque_over_share = 0.0;
  double expired_j = 0.0;  ///< work of commands that expired, which nobody can book: |J|
  std::uint64_t ticks = 0;
};

/// The stated bounds. A session that stalls pushes no harder than the same poses do without stalls, plus what the
/// coupling's springs pull over the way that the hand went in the last 150 ms: for so long a contact is felt (100 ms),
/// a command valid (20 ms), and something is left for the thread to hand over in.
struct stall_bounds {
  static constexpr std::int64_t blind_ns = 150'000'000;
  static constexpr std::int64_t shift_ns =
      20'000'000;  ///< the loops' grids are shifted by a stall: a touch is seen later
  static constexpr double force_n = 0.05;
  static constexpr double torque_n_m = 0.002;
  static constexpr double book_j = 1e-9;
};

class stall_checks {
 public:
  explicit stall_checks(const stall_scenario& s) noexcept : s_(s) {}

  [[nodiscard]] stall_outcome run() {
    stall_session stalled(s_, true);
    stalled.run();
    out_.fault = stalled.loop().gate().fault();
    out_.ticks = stalled.loop().rates().report().ticks;
    out_.expired_j = std::fabs(stalled.device().work().expired_j);
    motors(stalled.device().motors());
    book(stalled);
    if (!s_.control.guard.enabled) against_unstalled(stalled.device().motors());
    expect(!stalled.device().full(), "the notebook of the motors is too short");
    return out_;
  }

 private:
  void expect(bool holds, const char* what, std::int64_t at_ns = 0) {
    if (holds || !out_.broken.empty()) return;
    std::ostringstream text;
    text << "seed " << s_.seed << ", " << 1e-9 * static_cast<double>(at_ns) << " s: " << what;
    out_.broken = text.str();
  }

  [[nodiscard]] static bool is_zero(const wrench& w) { return w.force == vec3(0.0) && w.torque == vec3(0.0); }

  // Limits and slew of what was put out; silence after a command expired; silence after a gap that is too long.
  void motors(const std::vector<motor_entry>& m) {
    const rate_limits& limits = s_.control.rates;
    const device_capabilities& c = s_.capabilities;
    constexpr double room = 1.0 + 1e-8;
    constexpr std::int64_t longest_slew_ns = 4'000'000;
    std::int64_t commanded_ns = 0;
    std::int64_t silent_until_ns = 0;
    bool shut = false;
    for (std::size_t i = 1; i < m.size(); ++i) {
      if (!m[i].commanded) continue;
      const std::int64_t gap_ns = m[i].from_ns - commanded_ns;
      commanded_ns = m[i].from_ns;
      if (!m[i - 1].commanded) silent_until_ns = commanded_ns + limits.settle_ns;
      shut = shut || gap_ns > limits.longest_gap_ns;
      const wrench& now = m[i].out;
      const wrench change = now - m[i - 1].out;
      const double slew_s = 1e-9 * static_cast<double>(std::min(gap_ns, longest_slew_ns));
      expect(glm::length(now.force) <= c.peak_force_n * room, "force past its limit", commanded_ns);
      expect(glm::length(now.torque) <= c.peak_torque_n_m * room, "torque past its limit", commanded_ns);
      expect(glm::length(change.force) <= c.force_slew_n_per_s * slew_s * room + 1e-12, "force steps", commanded_ns);
      expect(glm::length(change.torque) <= c.torque_slew_n_m_per_s * slew_s * room + 1e-12, "torque steps",
             commanded_ns);
      expect(is_zero(now) || commanded_ns >= silent_until_ns, "output too soon after a command expired", commanded_ns);
      expect(is_zero(now) || !shut, "output after a gap that shuts the gate", commanded_ns);
    }
    expect(!shut || out_.fault == gate_fault::stalled, "no fault tells of a gap past its limit");
  }

  // The sum of F . dx and T . dangle that the script knows, against the guard's.
  void book(const stall_session& stalled) {
    const motor_work& w = stalled.device().work();
    expect(std::fabs(stalled.loop().guard().delivered_j() - w.renewed_j) <= stall_bounds::book_j,
           "the book differs from the work that was done");
    expect(std::fabs(w.expired_j) <= w.expired_way + 1e-12, "an expired command gave more than its way");
  }

  void against_unstalled(const std::vector<motor_entry>& m) {
    stall_scenario unstalled = s_;
    const auto last = std::find_if(m.rbegin(), m.rend(), [](const motor_entry& e) { return !is_zero(e.out); });
    if (last == m.rend()) return;
    unstalled.length_ns = std::min(s_.length_ns, last->from_ns + 2 * stall_bounds::shift_ns);
    stall_session reference(unstalled, false);
    reference.run();
    expect(reference.loop().gate().fault() == gate_fault::none, "the session without stalls faults");
    expect(reference.loop().rates().report().lowest_scale == 1.0, "the session without stalls is scaled down");
    const std::vector<motor_entry>& r = reference.device().motors();
    std::size_t from = 0;
    std::size_t to = 0;
    for (const motor_entry& e : m) {
      if (is_zero(e.out)) continue;
      while (from + 1 < r.size() && r[from].from_ns < e.from_ns - stall_bounds::shift_ns) ++from;
      while (to + 1 < r.size() && r[to].from_ns <= e.from_ns + stall_bounds::shift_ns) ++to;
      double force_n = 0.0;
      double torque_n_m = 0.0;
      for (std::size_t i = from; i <= to; ++i) {
        force_n = std::max(force_n, glm::length(r[i].out.force));
        torque_n_m = std::max(torque_n_m, glm::length(r[i].out.torque));
      }
      compare(e, force_n, torque_n_m);
    }
  }

  void compare(const motor_entry& e, double force_n, double torque_n_m) {
    double way_m = 0.0;
    double turn_rad = 0.0;
    for (std::int64_t back = 0; back <= stall_bounds::blind_ns; back += stall_bounds::blind_ns / 15) {
      way_m = std::max(way_m, glm::length(s_.hand.at(e.from_ns).position - s_.hand.at(e.from_ns - back).position));
      turn_rad = std::max(turn_rad, std::fabs(s_.hand.angle_rad(e.from_ns) - s_.hand.angle_rad(e.from_ns - back)));
    }
    const coupling_settings& k = s_.control.coupling;
    const double pull_n = k.stiffness_n_per_m * way_m;
    const double force_bound_n = pull_n + stall_bounds::force_n;
    const double torque_bound_n_m =
        k.stiffness_n_m_per_rad * turn_rad + s_.ground.arm_m * pull_n + stall_bounds::torque_n_m;
    out_.force_over_share = std::max(out_.force_over_share, (glm::length(e.out.force) - force_n) / force_bound_n);
    out_.torque_over_share =
        std::max(out_.torque_over_share, (glm::length(e.out.torque) - torque_n_m) / torque_bound_n_m);
    expect(glm::length(e.out.force) <= force_n + force_bound_n, "pushes harder than without stalls", e.from_ns);
    expect(glm::length(e.out.torque) <= torque_n_m + torque_bound_n_m, "turns harder than without stalls", e.from_ns);
  }

  stall_scenario s_;
  stall_outcome out_{};
};

}  // namespace asperity::simulation
