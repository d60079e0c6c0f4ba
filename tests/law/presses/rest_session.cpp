#include "law/presses/rest_session.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "asperity/control/virtual_session.hpp"
#include "asperity/device/simulated/simulated_device.hpp"
#include "law/oracle/against_originals.hpp"
#include "support/fresh_seed.hpp"

namespace asperity::presses {
namespace {

hand_settings hand_of(std::size_t grip) {
  switch (grip) {
    case 0:
      return soft_hand();
    case 1:
      return {};
    default:
      return firm_hand();
  }
}

struct listen {
  std::int64_t from_ns;
  vibration_monitor monitor;
  double largest_n = 0.0, deepest_m = 0.0, step_n_per_ms = 0.0, rest_m = 0.0, slides_m = 0.0;
  bool shut = false, rests = false;
  vec3 rests_at_w{0.0};
  vec3 before_n{0.0};
  std::int64_t before_ns = 0;
  void operator()(const session_record& r) noexcept {
    deepest_m = std::max(deepest_m, r.max_depth_m);
    const double way_ms = 1e-6 * static_cast<double>(r.time_ns - before_ns);
    if (before_ns >= from_ns && way_ms > 0.0) {
      step_n_per_ms = std::max(step_n_per_ms, glm::length(r.on_hand_d.force - before_n) / way_ms);
    }
    before_n = r.on_hand_d.force;
    before_ns = r.time_ns;
    shut = shut || r.fault != gate_fault::none;
    largest_n = std::max(largest_n, glm::length(r.on_hand_d.force));
    if (r.time_ns < from_ns) return;
    if (!std::exchange(rests, true)) rests_at_w = r.T_wa.position;
    slides_m = std::max(slides_m, glm::distance(r.T_wa.position, rests_at_w));
    rest_m = std::max(rest_m, r.max_depth_m);
    monitor.observe(r.time_ns, r.T_dh, r.on_hand_d);
  }
};

}  // namespace

rest_result rest_session(render_function render, const press_touch& touch, const vec3& centre_of_mass_a,
                         const rest_rules& rules, std::uint64_t seed) {
  constexpr double before_m = 2e-4, strong_n = 40.0;
  simulated_settings made = hand_at(touch, centre_of_mass_a, before_m, rules.way_m, rules.ramp_s, strong_n);
  made.seed = seed;
  made.hand = hand_of(rules.grip);
  control_settings control;
  control.map.T_ha = {quat(1.0, 0.0, 0.0, 0.0), -centre_of_mass_a};
  control.guard.enabled = rules.guard;
  control.contact.stiffness_n_per_m = rules.plane_stiffness_n_per_m;

  rest_result out;
  out.rules = rules;
  out.touch = touch.index;
  simulated_device dev(made);
  if (!dev.open() || !dev.arm()) {
    out.ended_early = true;
    return out;
  }
  virtual_schedule when;
  when.device_period_ns = rules.device_period_ns;
  when.contact_period_ns = rules.contact_period_ns;
  when.contact_one_period_late = rules.one_period_late;
  const auto from_ns = static_cast<std::int64_t>(1e9 * (rules.ramp_s + rules.settle_s));
  virtual_session<rendered, simulated_device, listen> session({&render}, {{pose{}}, centre_of_mass_a}, dev, control,
                                                              when,
                                                              {from_ns, vibration_monitor(rules.device_period_ns)});
  const auto until_ns = from_ns + static_cast<std::int64_t>(1e9 * rules.rest_s);
  constexpr double least_credit_j = 0.1;
  double surplus_j = 0.0, before_j = 0.0;
  const listen& heard = session.device().observer();
  while (session.now_ns() < until_ns && !out.ended_early) {
    out.ended_early = session.step() == status::backend_failed || heard.shut;
    const double delivered_j = dev.delivered_j();
    surplus_j = std::max(-least_credit_j, surplus_j + delivered_j - before_j);
    before_j = delivered_j;
    out.surplus_j = std::max(out.surplus_j, surplus_j);
  }
  out.deepest_m = heard.deepest_m;
  out.step_n_per_ms = heard.step_n_per_ms;
  out.rest_m = heard.rest_m;
  out.slides_m = heard.slides_m;
  out.heard = heard.monitor.report();
  out.largest_n = heard.largest_n;
  return out;
}

rest_rules drawn_rest(std::uint64_t seed, const std::string& pair, std::uint64_t touch) {
  std::mt19937_64 dice(test_support::seed_of(seed, pair + " at rest", touch));
  const auto below = [&](double most) { return std::uniform_real_distribution<double>(0.0, most)(dice); };
  rest_rules out;
  out.grip = static_cast<std::size_t>(below(3.0));
  out.way_m = 2e-3 * std::pow(15.0, below(1.0));
  constexpr std::array<std::int64_t, 5> periods_ns{5'000'000, 2'000'000, 1'000'000, 500'000, 250'000};
  out.contact_period_ns = periods_ns[static_cast<std::size_t>(below(5.0))];
  out.device_period_ns = std::min<std::int64_t>(1'000'000, out.contact_period_ns);
  return out;
}

void print_rest_heading(std::FILE* to) {
  std::fprintf(to, "%-13s %-14s %3s | %-8s %-8s %-5s | %-22s | %-22s | %s\n", "probe", "fixed", "n", "trembles",
               "restless", "early", "force rms N p50 p100", "torque rms N m p50 p100", "s a session");
}

void print_row(std::FILE* to, const rest_row& row) {
  std::vector<double> force, torque;
  int trembles = 0, restless = 0, early = 0;
  for (const rest_result& r : row.rests) {
    early += r.ended_early ? 1 : 0;
    restless += r.restless() ? 1 : 0;
    if (r.restless()) continue;
    trembles += r.trembles() ? 1 : 0;
    force.push_back(r.heard.force.worst_rms);
    torque.push_back(r.heard.torque.worst_rms);
  }
  const auto of = [](const std::vector<double>& v, double p) { return v.empty() ? 0.0 : oracle::percentile(v, p); };
  std::fprintf(to, "%-13s %-14s %3zu | %8d %8d %5d | %10.4f %11.4f | %10.5f %11.5f | %.1f\n", row.probe.c_str(),
               row.fixed.c_str(), row.rests.size(), trembles, restless, early, of(force, 0.5), of(force, 1.0),
               of(torque, 0.5), of(torque, 1.0),
               row.seconds / std::max<double>(1.0, static_cast<double>(row.rests.size())));
  for (const rest_result& r : row.rests) {
    if (r.restless() || !r.trembles()) continue;
    std::fprintf(
        to, "    touch %llu: %s hand, %.1f mm, contacts at %.0f Hz: force %.4f of %.3f N, torque %.5f of %.4f N m\n",
        static_cast<unsigned long long>(r.touch), std::string(grips[r.rules.grip]).c_str(), 1e3 * r.rules.way_m,
        1e9 / static_cast<double>(r.rules.contact_period_ns), r.heard.force.worst_rms, r.heard.force.worst_mean,
        r.heard.torque.worst_rms, r.heard.torque.worst_mean);
  }
  std::fflush(to);
}

}  // namespace asperity::presses
