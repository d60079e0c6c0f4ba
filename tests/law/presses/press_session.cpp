#include "law/presses/press_session.hpp"

#include <algorithm>
#include <utility>

#include "asperity/control/virtual_session.hpp"
#include "asperity/device/simulated/simulated_device.hpp"
#include "law/oracle/against_originals.hpp"

namespace asperity::presses {
namespace {

// A probe that slips round a body lies in its far side as well, by what its contact gives there. One that has passed
// lay as deep as half the thickness; a quarter of it is asked for, of thick bodies a millimetre.
double least_passing_m(const press_touch& touch) { return 0.25 * std::min(touch.fixed_thickness_m, 4e-3); }

constexpr double far_side = 0.5;  // cosine between the way of the press and what the nearest surface faces

struct keep_last {
  session_record last;
  void operator()(const session_record& r) noexcept { last = r; }
};

}  // namespace

simulated_settings hand_at(const press_touch& touch, const vec3& centre_of_mass_a, double before_m, double beyond_m,
                           double approach_s, double strongest_n) {
  simulated_settings made;
  made.capabilities.peak_force_n = strongest_n;
  made.capabilities.continuous_force_n = strongest_n;
  made.capabilities.workspace_low_d = vec3(-1.0);
  made.capabilities.workspace_high_d = vec3(1.0);
  motion_settings& m = made.motion;
  m.kind = motion_kind::press;
  m.T_dh = touch.touching_T_wa * pose{quat(1.0, 0.0, 0.0, 0.0), centre_of_mass_a};
  m.T_dh.position -= before_m * touch.way_w;
  m.direction_d = -touch.out_w;
  m.depth_m = before_m + beyond_m;
  m.approach_s = approach_s;
  return made;
}

session_result press_session(render_function render, const press_touch& touch, const vec3& centre_of_mass_a,
                             const session_rules& rules, std::uint64_t seed, exit_search& originals) {
  control_settings control;
  control.map.T_ha = {quat(1.0, 0.0, 0.0, 0.0), -centre_of_mass_a};
  const double beyond_m = rules.hand_n * (1.0 / firm_hand().stiffness_n_per_m +
                                          1.0 / control.coupling.stiffness_n_per_m + 1.0 / rules.stiffness_n_per_m);
  simulated_settings made =
      hand_at(touch, centre_of_mass_a, rules.before_m, beyond_m, rules.ramp_s, 2.0 * rules.hand_n);
  made.seed = seed;
  made.hand = firm_hand();

  session_result out;
  simulated_device dev(made);
  if (!dev.open() || !dev.arm()) {
    out.ended_early = true;
    return out;
  }
  virtual_session<rendered, simulated_device, keep_last> session({&render}, {{pose{}}, centre_of_mass_a}, dev, control,
                                                                 rules.when);
  const vec3 point_a = inverse(touch.touching_T_wa) * touch.point_w;
  const oracle::placed_mesh& fixed = originals.fixed();
  const auto until_ns = static_cast<std::int64_t>(1e9 * (rules.ramp_s + rules.hold_s));
  const session_record& now = session.device().observer().last;
  while (session.now_ns() < until_ns && !out.passed) {
    if (session.step() == status::backend_failed || now.fault != gate_fault::none) {
      out.ended_early = true;
      return out;
    }
    out.reported |= now.flags;
    out.overlap_m = std::max(out.overlap_m, now.max_depth_m);
    out.last_n = glm::length(now.on_hand_d.force);
    out.largest_n = std::max(out.largest_n, out.last_n);
    const vec3 p = now.T_wa * point_a;
    if (!fixed.contains(p)) continue;
    const double depth = fixed.distance_to(p);
    const double least_n = rules.weak_share * rules.stiffness_n_per_m * (depth - rules.allowance_m);
    if (!out.gave_way && glm::length(now.on_probe_w.force) < least_n) {
      out.gave_way = true;
      out.gave_way_at_n = out.largest_n;
    }
    const vec3 back = p + rules.looks_across_m * touch.out_w;
    out.passed = depth > least_passing_m(touch) && fixed.contains(back) &&
                 fixed.distance_to(back) - depth > far_side * rules.looks_across_m;
    if (!out.passed) out.deepest_m = std::max(out.deepest_m, depth);
  }
  // The renderer sees a pose in the tick after it.
  for (int i = 0; out.passed && i < 3 && session.step() != status::backend_failed; ++i) out.reported |= now.flags;
  if (!out.passed && !originals.apart(now.T_wa)) {
    const way_out exit = originals.true_exit(now.T_wa, touch.out_w);
    out.passed = exit.way_m > least_passing_m(touch) && glm::dot(exit.direction_w, touch.out_w) < -far_side;
  }
  out.passed_at_n = out.passed ? out.largest_n : 0.0;
  return out;
}

void print_session_heading(std::FILE* to) {
  std::fprintf(to, "%-13s %-14s %3s | %-26s | %-26s | %-5s | %-18s | %-17s | %s\n", "probe", "fixed", "n",
               "passes    at N p0    p50", "gives way  at N p0    p50", "slips", "largest N p50 p100",
               "at end N p0   p50", "deepest mm; early; s a session");
}

void print_row(std::FILE* to, const session_row& row) {
  std::vector<double> passed_at, gave_way_at, largest, last, deepest;
  int early = 0, slipped = 0;
  for (const session_result& s : row.sessions) {
    slipped += !s.passed && s.last_n < 0.5 * session_rules{}.hand_n ? 1 : 0;
    if (s.passed) passed_at.push_back(s.passed_at_n);
    if (s.gave_way) gave_way_at.push_back(s.gave_way_at_n);
    largest.push_back(s.largest_n);
    last.push_back(s.last_n);
    deepest.push_back(1e3 * s.deepest_m);
    early += s.ended_early ? 1 : 0;
  }
  const auto forces = [&](const std::vector<double>& at) {
    std::fprintf(to, " | %6zu ", at.size());
    if (at.empty()) {
      std::fprintf(to, "%10s %8s", "-", "-");
    } else {
      std::fprintf(to, "%10.2f %8.2f", oracle::percentile(at, 0.0), oracle::percentile(at, 0.5));
    }
  };
  std::fprintf(to, "%-13s %-14s %3zu", row.probe.c_str(), row.fixed.c_str(), row.sessions.size());
  forces(passed_at);
  forces(gave_way_at);
  std::fprintf(to, " | %5d | %8.2f %9.2f | %8.2f %8.2f | %.1f; %d; %.1f\n", slipped, oracle::percentile(largest, 0.5),
               oracle::percentile(largest, 1.0), oracle::percentile(last, 0.0), oracle::percentile(last, 0.5),
               oracle::percentile(deepest, 1.0), early,
               row.seconds / std::max<double>(1.0, static_cast<double>(row.sessions.size())));
  std::fflush(to);
}

}  // namespace asperity::presses
