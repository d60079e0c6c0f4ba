// The models of Minsky, of Ho et al. and of Siira and Pai in the place of the paper's: what each cannot show.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "asperity/collision/finder_settings.hpp"
#include "baselines_renderers.hpp"
#include "experiment.hpp"
#include "turned_block.hpp"

// A namespace of its own: others that are compiled along with it have functions of these names.
namespace asperity::experiment {
namespace rivals {
namespace {

// A place on the block's lower side that is on none of its axes of symmetry.
const vec3 beside_the_axis{11e-3, 5e-3, -0.5 * models::block_size_m[2]};

struct contender {
  std::string name, says;
  point_force force;
  std::optional<vec3> point_a;
  bool turns;  ///< shown in the turn
};

std::vector<contender> contenders() {
  return {{"minsky", "Minsky", point_force::minsky, std::nullopt, true},
          {"ho", "Ho et al.", point_force::ho, std::nullopt, true},
          {"siira_pai", "Siira and Pai", point_force::siira_pai, std::nullopt, true},
          {"minsky_pressure", "Minsky, gain by pressure", point_force::minsky_by_pressure, std::nullopt, false},
          {"minsky_beside", "Minsky, 12 mm off the axis", point_force::minsky, beside_the_axis, true},
          {"ho_beside", "Ho et al., 12 mm off the axis", point_force::ho, beside_the_axis, true},
          {"siira_pai_beside", "Siira and Pai, 12 mm off the axis", point_force::siira_pai, beside_the_axis, true}};
}

// Work of the contact on the probe along a closed path across the ridges, up and down at the same time.
struct loop_work {
  std::vector<double> share, work_j;  // of the way; done so far
  double turnover_j = 0.0;            // sum of |dW|
  [[nodiscard]] double ratio() const { return work_j.back() / turnover_j; }
};

result<loop_work> go_round(command::chosen_renderer feel, int steps) {
  loop_work out;
  const std::vector<pose> T_wb{pose{}};
  vec3 before_m(0.0), before_n(0.0);
  double work = 0.0;
  for (int i = 0; i <= steps; ++i) {
    const double t = 2.0 * std::numbers::pi * i / steps;
    pose T_wa = upper_block();
    T_wa.position +=
        1e-3 * vec3(0.0, 0.4 + 0.9 * std::cos(t) + 0.2 * std::sin(2.0 * t), 0.25 * std::sin(t + 0.3) - 0.8);
    tick found;
    if (const status s = feel.step({T_wa, T_wb}, found); s != status::ok) {
      return error{error_code::invalid_argument, "loop work: the renderer could not answer on the way round"};
    }
    const vec3& force = found.force.on_probe_w.force;
    if (i > 0) {
      const double dw = 0.5 * glm::dot(force + before_n, T_wa.position - before_m);
      work += dw;
      out.turnover_j += std::abs(dw);
    }
    before_m = T_wa.position;
    before_n = force;
    out.share.push_back(static_cast<double>(i) / steps);
    out.work_j.push_back(work);
  }
  return out;
}

// Torque against the turn over the one that geometry asks for, on average where it asks for some.
double resistance(const std::vector<turned_sample>& samples) {
  double sum = 0.0, asked = 0.0;
  for (const turned_sample& s : samples) {
    if (std::abs(s.angle_rad) <= 0.004 || std::abs(s.angle_rad) >= 0.09) continue;
    const double sign = s.angle_rad > 0.0 ? -1.0 : 1.0;
    sum += sign * s.torque_n_m;
    asked += sign * s.force_n * torque_arm_m(s.angle_rad);
  }
  return sum / asked;
}

double largest_rise(const std::vector<turned_sample>& samples) {
  double most = 0.0;
  for (const turned_sample& s : samples) most = std::max(most, std::abs(s.rise_m));
  return most / ridge_height_m;
}

result<findings> run(workbench& bench) {
  result<scene> bodies = block_on_block(bench);
  if (!bodies) return bodies.error();
  const turning how{.reach_rad = bench.brief() ? 0.12 : 0.14,
                    .speed_rad_per_s = bench.brief() ? 0.4 : 0.2,
                    .contact_period_ns = 2'000'000};
  const int steps = 1000;
  findings out;
  for (const contender& c : contenders()) {
    if (const result<void> on = bench.go_on(); !on) return on.error();
    bench.progress("baselines, " + c.says, 0.0);
    if (c.turns) {
      const result<std::vector<turned_sample>> turned =
          turn_block(make_point_renderer(*bodies, c.force, c.point_a), how);
      if (!turned) return turned.error();
      out.statements.push_back(at_most("rise_" + c.name, "largest rise over 2a", largest_rise(*turned), 0.1));
      out.statements.push_back(between("torque_" + c.name, "torque against", resistance(*turned), -0.05, 0.05));
    }
    if (!c.point_a) {
      const result<loop_work> work = go_round(make_point_renderer(*bodies, c.force, c.point_a), steps);
      if (!work) return work.error();
      out.statements.push_back(at_most("loop_" + c.name, "loop work over turnover", std::abs(work->ratio()), 1e-3));
    }
  }
  for (const variant& kind : {shared_contacts(), paper_soft()}) {
    result<command::chosen_renderer> feel = bench.make_renderer(*bodies, kind);
    if (!feel) return feel.error();
    const result<loop_work> work = go_round(std::move(feel).value(), steps);
    if (!work) return work.error();
    out.statements.push_back(at_most("loop_" + kind.name, "loop work over turnover", std::abs(work->ratio()), 1e-3));
  }
  return out;
}

}  // namespace
}  // namespace rivals

result<findings> run_baselines(workbench& bench) { return rivals::run(bench); }

}  // namespace asperity::experiment
