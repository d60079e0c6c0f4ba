#include "stroking.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace asperity::experiment {
namespace {

constexpr double shank_half_m = 4e-3;  // across
constexpr double shank_length_m = 21e-3;
constexpr double tip_length_m = 1.15e-3;  // from the shank's end to the lowest point of the ball
constexpr double flank_slope = 2.5;       // of the cone that goes on where the ball gets steeper
constexpr double plate_thickness_m = 4e-3;
constexpr double settle_s = 0.15;  // from the start to the first stroke

triangle_mesh box_between(const vec3& low, const vec3& high) {
  triangle_mesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.positions.emplace_back((i & 1) != 0 ? high.x : low.x, (i & 2) != 0 ? high.y : low.y,
                                (i & 4) != 0 ? high.z : low.z);
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {3, 2, 6}, {3, 6, 7}, {2, 0, 4}, {2, 4, 6}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

// How far the tip stands out of the shank's end at a distance from the axis.
double tip_height(double radius_m, double off_axis_m) {
  const double steepest = flank_slope / std::hypot(1.0, flank_slope);
  const double ball = radius_m * steepest;
  const double on_ball = std::min(off_axis_m, ball);
  const double risen = radius_m - std::sqrt(radius_m * radius_m - on_ball * on_ball);
  return std::max(0.0, tip_length_m - risen - flank_slope * std::max(0.0, off_axis_m - ball));
}

// Where the hand wants to be, and what it pushes with: the legs of its way, one after another.
struct hand_way {
  struct leg {
    double from_s, to_s;
    vec2 from_m, to_m;
    double push_n;
  };
  std::vector<leg> legs;

  explicit hand_way(const stroking& how) {
    double now = settle_s;
    vec2 at = how.from_m;
    legs.push_back({0.0, now, at, at, how.strokes.front().push_n});
    for (const stroke& s : how.strokes) {
      const double took = glm::length(s.to_m - at) / s.speed_m_per_s;
      legs.push_back({now, now + took, at, s.to_m, s.push_n});
      now += took;
      at = s.to_m;
    }
  }

  [[nodiscard]] hand_wish operator()(const pose& start, double t_s) const {
    const auto found = std::find_if(legs.begin(), legs.end(), [&](const leg& l) { return t_s < l.to_s; });
    const leg& l = found == legs.end() ? legs.back() : *found;
    const double length_s = l.to_s - l.from_s;
    const double share = length_s > 0.0 ? std::clamp((t_s - l.from_s) / length_s, 0.0, 1.0) : 1.0;
    const vec2 at = l.from_m + share * (l.to_m - l.from_m);
    hand_wish wish;
    wish.T_dh = {start.rotation, vec3(at, start.position.z)};
    if (share < 1.0 && length_s > 0.0) wish.velocity_d.linear = vec3((l.to_m - l.from_m) / length_s, 0.0);
    wish.push_d.force.z = -l.push_n * std::min(1.0, t_s / 0.05);
    return wish;
  }
};

// A handle of 100 g in the hand. What holds it across and keeps it from turning is stiff: the way is the script's.
hand_grip loose_grip() {
  hand_grip grip;
  grip.rigid = false;
  grip.mass_kg = 0.1;
  grip.stiffness_n_per_m = vec3(350.0, 20e3, 0.0);
  grip.damping_n_s_per_m = vec3(4.0, 60.0, 4.0);
  grip.stiffness_n_m_per_rad = vec3(50.0);
  grip.damping_n_m_s_per_rad = vec3(0.2);
  return grip;
}

felt_stroke cut_stroke(const std::vector<session_record>& ticks, double from_s, double to_s, int felt) {
  constexpr double h = 1e-9 * static_cast<double>(device_period_ns);
  felt_stroke out;
  out.felt = felt;
  out.sample_s = h;
  for (std::size_t i = 1; i + 1 < ticks.size(); ++i) {
    const double t_s = 1e-9 * static_cast<double>(ticks[i].time_ns);
    if (t_s < from_s || t_s >= to_s) continue;
    const vec3 &before = ticks[i - 1].T_dh.position, &at = ticks[i].T_dh.position, &after = ticks[i + 1].T_dh.position;
    const vec3 acceleration = (after - 2.0 * at + before) / (h * h);
    out.x_m.push_back(at.x);
    out.z_m.push_back(at.z);
    out.along_m_per_s2.push_back(acceleration.x);
    out.normal_m_per_s2.push_back(acceleration.z);
    out.along_n.push_back(ticks[i].on_probe_w.force.x);
    out.normal_n.push_back(ticks[i].on_probe_w.force.z);
  }
  return out;
}

}  // namespace

result<model_ptr> bake_stylus(workbench& bench, double radius_m) {
  const vec3 half(shank_half_m, shank_half_m, 0.5 * shank_length_m);
  bake::bake_settings options;
  options.texture_size = 512;
  options.relief.height_m = [radius_m](const bake::relief_point& p) {
    return p.normal.z < -0.5 ? tip_height(radius_m, std::hypot(p.position.x, p.position.y)) : 0.0;
  };
  return bench.models().baked(
      "stylus_" + std::to_string(std::lround(1e6 * radius_m)) + "um", [half] { return box_between(-half, half); },
      std::move(options));
}

result<model_ptr> bake_plate(workbench& bench, const std::string& name, const vec2& size_m, std::uint32_t texture_size,
                             std::function<double(const vec2&)> height_m) {
  bake::bake_settings options;
  options.texture_size = texture_size;
  options.relief.height_m = [height_m = std::move(height_m)](const bake::relief_point& p) {
    return p.normal.z > 0.5 ? height_m(vec2(p.position)) : 0.0;
  };
  return bench.models().baked(
      name, [size_m] { return box_between(vec3(-0.5 * size_m, -plate_thickness_m), vec3(0.5 * size_m, 0.0)); },
      std::move(options));
}

result<std::vector<felt_stroke>> stroke_plate(workbench& bench, const variant& kind, const model_ptr& stylus,
                                              const model_ptr& plate, const stroking& how) {
  result<any_renderer> feel = bench.make_renderer({stylus, {plate}}, kind);
  if (!feel) return feel.error();
  const hand_way planned(how);
  trial t;
  constexpr double above_m = 1e-4;
  t.T_wa_start = {quat(1.0, 0.0, 0.0, 0.0), vec3(how.from_m, 0.5 * shank_length_m + tip_length_m + above_m)};
  t.T_wb = {pose{}};
  t.script = [planned, start = t.T_wa_start](double t_s) { return planned({pose{}.rotation, start.position}, t_s); };
  t.grip = loose_grip();
  t.seconds = planned.legs.back().to_s;
  t.contact_period_ns = how.contact_period_ns;
  t.contact_one_period_late = how.contact_one_period_late;
  t.hold_wrench = how.hold_wrench;
  t.control.coupling.stiffness_n_per_m = 1000.0;
  // What is compared is the contact's rate: a guard that takes out what a bad loop puts in would hide it.
  t.control.guard.enabled = false;
  result<trial_log> log = run_trial(std::move(feel).value(), std::move(t));
  if (!log) return log.error();
  std::vector<felt_stroke> out;
  for (std::size_t i = 0; i < how.strokes.size(); ++i) {
    if (how.strokes[i].felt < 0) continue;
    const hand_way::leg& l = planned.legs[i + 1];
    const double length_s = l.to_s - l.from_s;
    out.push_back(cut_stroke(log->ticks, l.from_s + 0.2 * length_s, l.to_s - 0.02 * length_s, how.strokes[i].felt));
  }
  return out;
}

double rms_about_mean(const std::vector<double>& values) {
  if (values.empty()) return 0.0;
  const double n = static_cast<double>(values.size());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  double sum = 0.0;
  for (const double v : values) sum += (v - mean) * (v - mean);
  return std::sqrt(sum / n);
}

}  // namespace asperity::experiment
