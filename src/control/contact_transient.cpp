#include <cmath>
#include <string>

#include "asperity/control/virtual_coupling.hpp"

namespace asperity {
namespace {

bool is_from(double x, double low, double high) noexcept { return x >= low && x <= high; }

}  // namespace

result<void> check(const transient_settings& t) {
  const auto bad = [](std::string what) { return error{error_code::invalid_argument, "contact transient: " + what}; };
  if (!is_from(t.amplitude_n_s_per_m, 0.0, 100.0)) return bad("amplitude_n_s_per_m must be from 0 to 100");
  if (!is_from(t.frequency_hz, 20.0, 1000.0)) return bad("frequency_hz must be from 20 to 1000");
  if (!is_from(t.decay_s, 0.001, 0.2)) return bad("decay_s must be from 0.001 to 0.2");
  if (!is_from(t.most_force_n, 0.0, 10.0)) return bad("most_force_n must be from 0 to 10");
  if (!is_from(t.quiet_s, 0.01, 10.0)) return bad("quiet_s must be from 0.01 to 10");
  return {};
}

bool contact_transient::is_within(const transient_settings& t) noexcept {
  return is_from(t.amplitude_n_s_per_m, 0.0, 100.0) && is_from(t.frequency_hz, 20.0, 1000.0) &&
         is_from(t.decay_s, 0.001, 0.2) && is_from(t.most_force_n, 0.0, 10.0) && is_from(t.quiet_s, 0.01, 10.0);
}

}  // namespace asperity
