#include "law/presses/scrub_session.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <random>
#include <vector>

#include "asperity/control/virtual_session.hpp"
#include "asperity/device/simulated/simulated_device.hpp"
#include "law/presses/press_session.hpp"
#include "support/fresh_seed.hpp"

namespace asperity::presses {
namespace {

struct keeps_force {
  std::vector<vec3>* out;
  void operator()(const session_record& r) noexcept { out->push_back(r.on_hand_d.force); }
};

simulated_settings hand_for(const press_touch& touch, const vec3& centre_of_mass_a, const scrub_rules& rules) {
  constexpr double before_m = 2e-4, strong_n = 40.0;
  simulated_settings made;
  made.hand.tremor_m = 0.0;
  made.capabilities.peak_force_n = made.capabilities.continuous_force_n = strong_n;
  made.capabilities.workspace_low_d = vec3(-1.0);
  made.capabilities.workspace_high_d = vec3(1.0);
  motion_settings& m = made.motion;
  m.kind = motion_kind::scrub;
  m.T_dh = touch.touching_T_wa * pose{quat(1.0, 0.0, 0.0, 0.0), centre_of_mass_a};
  m.T_dh.position -= before_m * touch.way_w;
  m.direction_d = -touch.out_w;
  m.depth_m = before_m + rules.way_m;
  m.approach_s = rules.begins_s;
  const vec3& n = touch.out_w;
  const vec3 u = glm::normalize(glm::cross(n, std::fabs(n.x) < 0.7 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0)));
  m.sideways_d = std::cos(rules.across_rad) * u + std::sin(rules.across_rad) * glm::cross(n, u);
  m.amplitude_m = rules.amplitude_m;
  m.frequency_hz = rules.frequency_hz;
  return made;
}

// What the hand feels at each millisecond from where it scrubs.
result<std::vector<vec3>> felt_at(const press_body& probe, const press_body& fixed, const press_touch& touch,
                                  const scrub_rules& rules, double contact_hz, double device_hz, bool reads_again) {
  const auto render = plane_renderer_law(1.0 / contact_hz).render(probe, fixed, session_rules{}.stiffness_n_per_m);
  if (!render) return render.error();
  const vec3 c_a = probe.model->mass.centre_of_mass;
  simulated_device dev(hand_for(touch, c_a, rules));
  if (!dev.open() || !dev.arm()) return error{error_code::invalid_argument, "the simulated device does not start"};
  control_settings control;
  control.map.T_ha = {quat(1.0, 0.0, 0.0, 0.0), -c_a};
  control.local_model = reads_again;
  virtual_schedule when;
  when.device_period_ns = static_cast<std::int64_t>(1e9 / device_hz);
  when.contact_period_ns = static_cast<std::int64_t>(1e9 / contact_hz);
  when.contact_one_period_late = contact_hz <= device_hz && device_hz < 5e3;
  std::vector<vec3> all, out;
  virtual_session<rendered, simulated_device, keeps_force> session({&*render}, {{pose{}}, c_a}, dev, control, when,
                                                                   {&all});
  session.run_until(static_cast<std::int64_t>(1e9 * (rules.begins_s + rules.seconds)));
  const auto each = static_cast<std::size_t>(std::lround(device_hz / 1000.0));
  for (std::size_t i = 0; i < all.size(); i += each) out.push_back(all[i]);
  out.erase(out.begin(),
            out.begin() + std::lround(std::min<double>(1e3 * rules.begins_s, static_cast<double>(out.size()))));
  return out;
}

double rms(const std::vector<vec3>& a, const std::vector<vec3>* less) {
  double sum = 0.0;
  std::size_t n = 0;
  for (; n < a.size() && (less == nullptr || n < less->size()); ++n) {
    const vec3 d = less == nullptr ? a[n] : a[n] - (*less)[n];
    sum += glm::dot(d, d);
  }
  return n == 0 ? std::numeric_limits<double>::infinity() : std::sqrt(sum / static_cast<double>(n));
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
  constexpr double best_hz = 10'000.0, device_hz = 1000.0;
  touch_finder finder(pair.name(), probe.full, fixed.full, pair.region);
  std::optional<press_touch> touch;
  for (int i = 0; i <= which.first; ++i) touch = finder.next(which.seed);
  if (!touch) return error{error_code::invalid_argument, pair.name() + ": no approach touches"};
  const scrub_rules rules = drawn_scrub(which.seed, pair.name(), touch->index);
  const auto best = felt_at(probe, fixed, *touch, rules, best_hz, best_hz, false);
  if (!best) return best.error();
  scrub_result out;
  out.force_n = rms(*best, nullptr);
  for (std::size_t i = 0; i < scrub_rates_hz.size(); ++i) {
    for (const bool again : {false, true}) {
      const auto felt = felt_at(probe, fixed, *touch, rules, scrub_rates_hz[i], device_hz, again);
      if (!felt) return felt.error();
      (again ? out.read_again_off_n : out.off_n)[i] = rms(*felt, &*best);
    }
  }
  return out;
}

void print_scrub_heading(std::FILE* to) {
  std::fprintf(to, "%-28s %8s", "pair", "force N");
  for (const double hz : scrub_rates_hz) std::fprintf(to, " | %4.0f Hz: off mN, read again", hz);
  std::fputc('\n', to);
}

void print_row(std::FILE* to, const press_pair& pair, const scrub_result& row) {
  std::fprintf(to, "%-28s %8.2f", pair.name().c_str(), row.force_n);
  for (std::size_t i = 0; i < scrub_rates_hz.size(); ++i) {
    std::fprintf(to, " | %16.1f %12.1f", 1e3 * row.off_n[i], 1e3 * row.read_again_off_n[i]);
  }
  std::fputc('\n', to);
  std::fflush(to);
}

}  // namespace asperity::presses
