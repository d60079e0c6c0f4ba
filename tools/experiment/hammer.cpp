// The paper's section 6.4 names a textured hammer that touches a wrinkled torus. Here the hammer's face comes down on
// the top of the ring, is drawn along it, rocked to both sides and lifted.
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "experiment.hpp"
#include "full_surface.hpp"
#include "trial.hpp"

namespace asperity::experiment {
namespace {

using models::benchmark;

// The bodies, as tools/models makes them: the hammer's face is its end at +x, the ring's top a circle.
constexpr double face_x_m = 45e-3, face_half_m = 13.4e-3;
constexpr double ring_m = 45e-3, tube_m = 18e-3;
constexpr double relief_m = 0.4e-3 + 0.25e-3;  // largest height of both textures over mid height, together
constexpr double press_n = 1.0;
constexpr double stiffness_n_per_m = 2000.0;  // of a face that is met squarely, the default of every force model
constexpr double rock_rad = 0.1;

/// When what happens, s.
struct schedule {
  double down, stroke, rock, lift, end;
};
schedule times(bool brief) {
  return brief ? schedule{0.2, 0.25, 0.65, 1.05, 1.3} : schedule{0.3, 0.4, 1.6, 2.6, 3.0};
}

double smooth(double from, double to, double t) {
  const double s = std::clamp((t - from) / (to - from), 0.0, 1.0);
  return s * s * (3.0 - 2.0 * s);
}

/// What the hand does: along the ring by an angle, the face's height over mid height of the ring, how far it leans.
struct wish_on_ring {
  double around_rad, height_m, lean_rad;
};
wish_on_ring wish_at(double t, const schedule& s, double push_m) {
  const double held = smooth(0.0, s.down, t) - smooth(s.lift, s.end - 0.05, t);
  const double above_m = relief_m + 0.5e-3;
  const double turns = t > s.rock && t < s.lift ? std::sin(2.0 * std::numbers::pi * (t - s.rock) / (s.lift - s.rock)) : 0.0;
  return {0.5 * smooth(s.stroke, s.rock - 0.05, t), above_m - held * (above_m + push_m), rock_rad * turns};
}

/// The hammer with the middle of its face there, the handle towards the ring's axis. A lean turns it about the radius.
pose hammer_at(const wish_on_ring& w) {
  const quat around = exp_rotation(vec3(0.0, 0.0, w.around_rad));
  const quat face_down = exp_rotation(vec3(0.0, 0.5 * std::numbers::pi, 0.0));
  const quat r = around * exp_rotation(vec3(w.lean_rad, 0.0, 0.0)) * face_down;
  return {r, around * vec3(ring_m, 0.0, tube_m + w.height_m) - r * vec3(face_x_m, 0.0, 0.0)};
}

/// The full-resolution meshes, for comparison.
struct originals {
  std::vector<vec3> face_a;  ///< vertices of the hammer's face
  surface_from_above ring;
};

std::unique_ptr<originals> full_resolution() {
  std::vector<vec3> face;
  for (const vec3& p : models::make_full(benchmark::hammer).positions) {
    if (p.x > face_x_m - 2e-3) face.push_back(p);
  }
  const vec3 middle(0.9 * ring_m, 0.25 * ring_m, 0.0);
  return std::make_unique<originals>(
      originals{std::move(face), {models::make_full(benchmark::torus), pose{}, middle, 32e-3, 0.1e-3}});
}

/// One entry per device tick; what is asked of the full-resolution meshes has one per millisecond times `every`.
struct touch {
  std::vector<double> time_s, height_m, normal_n, lean_rad, lean_lever_m, face_lever_m, hand_n;
  std::vector<double> asked_s, asked_height_m, drop_height_m, depth_m, force_depth_m;
  std::vector<bool> contact;
  double largest_torque_n_m = 0.0;
  double delivered_j = 0.0, largest_jump_n = 0.0;
};
constexpr std::size_t every = 5;

result<touch> touch_ring(workbench& bench, const variant& kind, const originals& full) {
  result<model_ptr> hammer = bench.benchmark(benchmark::hammer);
  if (!hammer) return hammer.error();
  result<model_ptr> torus = bench.benchmark(benchmark::torus);
  if (!torus) return torus.error();
  result<command::chosen_renderer> feel = bench.make_renderer({*hammer, {*torus}}, kind);
  if (!feel) return feel.error();

  const schedule s = times(bench.brief());
  const vec3 c_a = (*hammer)->mass.centre_of_mass;
  trial t;
  t.T_wb = {pose{}};
  t.control.probe = solid_probe((*hammer)->mass, 0.05);
  t.control.coupling.max_damping_n_s_per_m = t.control.coupling.max_damping_n_m_s_per_rad = 1e3;
  const double push_m = press_n / t.control.coupling.stiffness_n_per_m;
  t.T_wa_start = hammer_at(wish_at(0.0, s, push_m));
  t.seconds = s.end;
  t.script = [=, from = t.T_wa_start](double t_s) {
    const pose T_wa = hammer_at(wish_at(t_s, s, push_m));
    hand_wish wish;
    wish.T_dh = {T_wa.rotation * glm::conjugate(from.rotation), T_wa * c_a};
    return wish;
  };
  const result<trial_log> log = run_trial(std::move(feel).value(), t);
  if (!log) return log.error();

  touch out;
  vec3 hand_before(0.0);
  for (std::size_t i = 0; i < log->ticks.size(); ++i) {
    const session_record& r = log->ticks[i];
    const double t_s = 1e-9 * static_cast<double>(r.time_ns - log->ticks.front().time_ns);
    const wish_on_ring wish = wish_at(t_s, s, push_m);
    const vec3 radial(std::cos(wish.around_rad), std::sin(wish.around_rad), 0.0);
    const vec3 face_w = r.T_wa * vec3(face_x_m, 0.0, 0.0);
    const wrench about_face = transport(r.on_probe_w, r.T_wa * c_a, face_w);
    const double normal = r.on_probe_w.force.z;
    out.time_s.push_back(t_s);
    out.height_m.push_back(face_w.z - tube_m);
    out.normal_n.push_back(normal);
    out.lean_rad.push_back(glm::dot(log_rotation(r.T_wa.rotation * glm::conjugate(hammer_at({wish.around_rad, 0.0, 0.0}).rotation)), radial));
    out.lean_lever_m.push_back(normal > 0.0 ? glm::dot(about_face.torque, radial) / normal : 0.0);
    out.face_lever_m.push_back(normal > 0.0 ? std::hypot(about_face.torque.x, about_face.torque.y) / normal : 0.0);
    out.hand_n.push_back(glm::length(r.on_hand_d.force));
    out.contact.push_back(r.contacts > 0);
    out.largest_torque_n_m = std::max(out.largest_torque_n_m, glm::length(r.on_probe_w.torque));
    if (i > 0) out.largest_jump_n = std::max(out.largest_jump_n, glm::length(r.on_hand_d.force - hand_before));
    hand_before = r.on_hand_d.force;
    out.delivered_j = r.delivered_j;
    if (i % every != 0) continue;
    const double depth = depth_along_z(full.ring, full.face_a, r.T_wa);
    out.asked_s.push_back(t_s);
    out.asked_height_m.push_back(out.height_m.back());
    out.drop_height_m.push_back(out.height_m.back() + depth);
    out.depth_m.push_back(depth);
    out.force_depth_m.push_back(normal / stiffness_n_per_m);
  }
  return out;
}

}  // namespace

}  // namespace asperity::experiment
