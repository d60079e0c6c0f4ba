#include "law/presses/scrub_session.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <random>
#include <vector>

#include "asperity/control/virtual_session.hpp"
#include "asperity/device/simulated/simulated_device.hpp"
#include "law/oracle/against_originals.hpp"
#include "law/presses/press_session.hpp"
#include "support/fresh_seed.hpp"

namespace asperity::presses {
namespace {

// Where the probe was, and how deep by the planes in use.
struct held_at {
  pose T_wa{};
  double overlap_m = 0.0;
};
struct keeps_ticks {
  std::vector<held_at>* out;
  std::int64_t from_ns;
  void operator()(const session_record& r) noexcept {
    if (r.time_ns >= from_ns && r.overlap_m > 0.0) out->push_back({r.T_wa, r.overlap_m});
  }
};

simulated_settings hand_for(const press_touch& touch, const vec3& centre_of_mass_a, const scrub_rules& rules,
                            std::uint64_t seed) {
  constexpr double before_m = 2e-4, strong_n = 40.0;
  simulated_settings made = hand_at(touch, centre_of_mass_a, before_m, rules.way_m, rules.begins_s, strong_n);
  made.seed = seed;
  motion_settings& m = made.motion;
  m.kind = motion_kind::scrub;
  const vec3 u = any_orthogonal(touch.out_w);
  m.sideways_d = std::cos(rules.across_rad) * u + std::sin(rules.across_rad) * glm::cross(touch.out_w, u);
  m.amplitude_m = rules.amplitude_m;
  m.frequency_hz = rules.frequency_hz;
  return made;
}

result<plane_error> scrub(const press_body& probe, const press_body& fixed, const press_touch& touch,
                          const scrub_rules& rules, double contact_hz, bool reads_again) {
  const auto render = plane_renderer_law(1.0 / contact_hz).render(probe, fixed, session_rules{}.stiffness_n_per_m);
  if (!render) return render.error();
  const vec3 c_a = probe.model->mass.centre_of_mass;
  simulated_device dev(hand_for(touch, c_a, rules, touch.index));
  if (!dev.open() || !dev.arm()) return error{error_code::invalid_argument, "the simulated device does not start"};
  control_settings control;
  control.map.T_ha = {quat(1.0, 0.0, 0.0, 0.0), -c_a};
  control.local_model = reads_again;
  virtual_schedule when;
  when.contact_period_ns = static_cast<std::int64_t>(1e9 / contact_hz);
  when.contact_one_period_late = true;
  std::vector<held_at> ticks;
  const auto from_ns = static_cast<std::int64_t>(1e9 * rules.begins_s);
  virtual_session<rendered, simulated_device, keeps_ticks> session({&*render}, {{pose{}}, c_a}, dev, control, when,
                                                                   {&ticks, from_ns});
  session.run_until(from_ns + static_cast<std::int64_t>(1e9 * rules.seconds));
  std::vector<double> off_m;
  double squares = 0.0;
  tick there;
  const std::array<pose, 1> T_wb{};
  for (const held_at& h : ticks) {
    if ((*render)({h.T_wa, T_wb}, there) != status::ok) continue;
    double deepest_m = -std::numeric_limits<double>::infinity();
    for (const support_plane& p : there.planes) deepest_m = std::max(deepest_m, p.depth_m);
    if (there.planes.empty()) continue;
    off_m.push_back(std::fabs(deepest_m - h.overlap_m));
    squares += off_m.back() * off_m.back();
  }
  if (off_m.empty()) return plane_error{};
  const auto count = static_cast<double>(off_m.size());
  return plane_error{std::sqrt(squares / count), oracle::percentile(off_m, 0.99), static_cast<int>(off_m.size())};
}

}  // namespace

scrub_rules drawn_scrub(std::uint64_t seed, const std::string& pair, std::uint64_t touch) {
  std::mt19937_64 dice(test_support::seed_of(seed, pair + " scrubbed", touch));
  const auto between = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(dice); };
  scrub_rules out;
  out.way_m = between(3e-3, 1e-2);
  out.amplitude_m = between(2e-3, 6e-3);
  out.frequency_hz = between(0.5, 3.0);
  out.across_rad = between(0.0, 6.283185307179586);
  return out;
}

result<scrub_result> scrub_sessions(const press_pair& pair, const press_body& probe, const press_body& fixed,
                                    const press_choice& which) {
  touch_finder finder(pair.name(), probe.full, fixed.full, pair.region);
  std::optional<press_touch> touch;
  for (int i = 0; i <= which.first; ++i) touch = finder.next(which.seed);
  if (!touch) return error{error_code::invalid_argument, pair.name() + ": no approach touches"};
  const scrub_rules rules = drawn_scrub(which.seed, pair.name(), touch->index);
  scrub_result out;
  for (std::size_t i = 0; i < scrub_rates_hz.size(); ++i) {
    for (const bool again : {false, true}) {
      const auto measured = scrub(probe, fixed, *touch, rules, scrub_rates_hz[i], again);
      if (!measured) return measured.error();
      (again ? out.read_again : out.stay)[i] = *measured;
    }
  }
  return out;
}

void print_scrub_heading(std::FILE* to) {
  std::fprintf(to, "off the surface, um: rms and p99 of planes that stay, and that are read again\n%-26s", "pair");
  for (const double hz : scrub_rates_hz) std::fprintf(to, " | %14.0f Hz        ", hz);
  std::fputc('\n', to);
}

void print_row(std::FILE* to, const press_pair& pair, const scrub_result& row) {
  std::fprintf(to, "%-26s", pair.name().c_str());
  for (std::size_t i = 0; i < scrub_rates_hz.size(); ++i) {
    const plane_error &a = row.stay[i], &b = row.read_again[i];
    std::fprintf(to, " | %5.1f %6.1f %5.1f %6.1f", 1e6 * a.rms_m, 1e6 * a.p99_m, 1e6 * b.rms_m, 1e6 * b.p99_m);
  }
  std::fputc('\n', to);
  std::fflush(to);
}

}  // namespace asperity::presses
