// The paper's section 6.4 names a textured hammer that touches a wrinkled torus. Here the hammer's face comes down on
// the top of the ring, is drawn along it, rocked to both sides and lifted.
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "experiment.hpp"
#include "full_surface.hpp"
#include "series.hpp"
#include "trial.hpp"

namespace asperity::experiment {
namespace {

using models::benchmark;

// The bodies, as tools/models makes them: the hammer's face is its end at +x, the ring's top a circle.
constexpr double face_x_m = 45e-3, face_half_m = 13.4e-3, face_corner_m = 14.8e-3;
constexpr double ring_m = 45e-3, tube_m = 18e-3;
constexpr double highest_relief_m = 0.4e-3 + 0.25e-3;  // largest height of both textures over mid height, together
constexpr double press_n = 1.0;
constexpr double rock_rad = 0.1;

/// When what happens, s.
struct schedule {
  double down, stroke, rock, lift, end;
};
schedule times(bool brief) { return brief ? schedule{0.2, 0.25, 0.65, 1.05, 1.3} : schedule{0.3, 0.4, 1.6, 2.6, 3.0}; }

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
  const double above_m = highest_relief_m + 0.5e-3;
  // To one side and to the other, starting and ending at rest.
  const double u = std::numbers::pi * std::clamp((t - s.rock) / (s.lift - s.rock), 0.0, 1.0);
  const double rocks = std::sin(2.0 * u) * std::sin(u) * std::sin(u) / 0.65;
  return {0.5 * smooth(s.stroke, s.rock - 0.05, t), above_m - held * (above_m + push_m), rock_rad * rocks};
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

/// One entry per device tick; what the full-resolution meshes are asked for, in every fifth.
struct touch {
  std::vector<double> time_s, height_m, normal_n, contacts;
  std::vector<double> lean_rad;      ///< about the ring's radius
  std::vector<double> lean_lever_m;  ///< torque about the face's middle and the radius, over the normal force
  std::vector<double> off_middle_m;  ///< distance of the centre of pressure from the face's middle
  std::vector<double> asked_s, asked_height_m, asked_n;
  std::vector<double> drop_height_m;  ///< where the hammer would touch the ring, both at full resolution
  double delivered_j = 0.0, largest_jump_n = 0.0;
};
constexpr std::size_t every = 5;

result<touch> touch_ring(workbench& bench, const variant& kind, const originals& full) {
  result<model_ptr> hammer = bench.models().benchmark(benchmark::hammer);
  if (!hammer) return hammer.error();
  result<model_ptr> torus = bench.models().benchmark(benchmark::torus);
  if (!torus) return torus.error();
  result<any_renderer> feel = bench.make_renderer({*hammer, {*torus}}, kind);
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
    out.contacts.push_back(r.contacts);
    const pose upright = hammer_at({wish.around_rad, 0.0, 0.0});
    out.lean_rad.push_back(glm::dot(log_rotation(r.T_wa.rotation * glm::conjugate(upright.rotation)), radial));
    out.lean_lever_m.push_back(normal > 0.0 ? glm::dot(about_face.torque, radial) / normal : 0.0);
    out.off_middle_m.push_back(normal > 0.0 ? std::hypot(about_face.torque.x, about_face.torque.y) / normal : 0.0);
    if (i > 0) out.largest_jump_n = std::max(out.largest_jump_n, glm::length(r.on_hand_d.force - hand_before));
    hand_before = r.on_hand_d.force;
    out.delivered_j = r.delivered_j;
    if (i % every != 0) continue;
    out.asked_s.push_back(t_s);
    out.asked_height_m.push_back(out.height_m.back());
    out.asked_n.push_back(normal);
    out.drop_height_m.push_back(out.height_m.back() + depth_along_z(full.ring, full.face_a, r.T_wa));
  }
  return out;
}

// How much of the variance of one the other explains, over the entries between two times.
double explained(const touch& t, double from_s, double to_s) {
  double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, yy = 0.0, xy = 0.0;
  for (std::size_t i = 0; i < t.asked_s.size(); ++i) {
    if (t.asked_s[i] < from_s || t.asked_s[i] > to_s) continue;
    const double a = 1e3 * t.asked_height_m[i], b = 1e3 * t.drop_height_m[i];
    n += 1.0;
    x += a;
    y += b;
    xx += a * a;
    yy += b * b;
    xy += a * b;
  }
  const double both = n * xy - x * y;
  return both * std::fabs(both) /
         ((n * xx - x * x) * (n * yy - y * y));  // a height that goes the other way: below zero
}

void state(const std::string& name, const touch& t, const schedule& s, findings& out) {
  double kept = 0.0, held = 0.0, from_nothing_n = 0.0, rocks = 0.0, on_face = 0.0;
  double opposes = 0.0, leans = 0.0, low_m = 0.0, high_m = 0.0;
  // The furthest point is a corner. While the hammer leans it hangs lower than the middle, by the relief more, and a
  // force that slants by 45 degrees there passes the middle's height that much further out.
  constexpr double furthest_m = face_corner_m * (1.0 + rock_rad) + highest_relief_m;
  for (std::size_t i = 0; i < t.time_s.size(); ++i) {
    if (t.time_s[i] < s.down || t.time_s[i] > s.lift) continue;
    held += 1.0;
    kept += t.contacts[i] > 0.0 && t.normal_n[i] > 0.0 ? 1.0 : 0.0;
    if (t.time_s[i] > s.rock) {
      rocks += 1.0;
      on_face += t.off_middle_m[i] <= furthest_m ? 1.0 : 0.0;
    }
    low_m = std::min(low_m, t.lean_lever_m[i]);
    high_m = std::max(high_m, t.lean_lever_m[i]);
    if (std::fabs(t.lean_rad[i]) < 0.5 * rock_rad) continue;
    leans += 1.0;
    opposes += t.lean_rad[i] * t.lean_lever_m[i] < 0.0 ? 1.0 : 0.0;
  }
  for (std::size_t i = 0; i < t.asked_s.size(); ++i) {
    constexpr double clear_m = 0.05e-3;  // more than baking and interpolation can be wrong
    if (t.drop_height_m[i] < t.asked_height_m[i] - clear_m) from_nothing_n = std::max(from_nothing_n, t.asked_n[i]);
  }
  std::vector<statement>& to = out.statements;
  to.push_back(at_least("kept_" + name, "share of the ticks between touch and lift that have a contact that pushes",
                        kept / held, 1.0));
  to.push_back(
      at_most("free_" + name, "largest force while the full-resolution meshes are apart, N", from_nothing_n, 0.0));
  to.push_back(at_least("follows_" + name,
                        "share of the variance of the height along the ring that the full-resolution surfaces explain",
                        explained(t, s.stroke, s.rock), 0.5));
  to.push_back(at_least("opposes_" + name,
                        "share of the ticks that lean by 0.05 rad or more whose torque rights the face",
                        leans > 0.0 ? opposes / leans : std::nan(""), 1.0));
  // A renderer with one point on the tool has its force there always: 0. Rocked from rim to rim it is the whole face.
  to.push_back(at_least("travel_" + name, "way of the centre of pressure while the hammer rocks, mm",
                        1e3 * (high_m - low_m), 1e3 * face_half_m));
  // Where the force is light a small torque puts its centre far away: one tick in two hundred may be so.
  to.push_back(at_least("on_face_" + name, "share of the ticks of rocking whose centre of pressure is on the face",
                        on_face / rocks, 0.995));
  // People tell two forces apart from about 7 % on.
  to.push_back(at_most("jump_" + name, "largest change of the force on the hand from one millisecond to the next, N",
                       t.largest_jump_n, 0.07 * press_n));
  to.push_back(
      at_most("energy_" + name, "energy that the hand has got back after the lift, mJ", 1e3 * t.delivered_j, 0.0));
}

table numbers_of(const std::string& name, const touch& t) {
  table out{name, {"time_s", "height_m", "normal_force_n", "contacts", "lean_rad", "lean_lever_m", "off_middle_m"}, {}};
  for (std::size_t i = 0; i < t.time_s.size(); ++i) {
    out.rows.push_back({t.time_s[i], t.height_m[i], t.normal_n[i], t.contacts[i], t.lean_rad[i], t.lean_lever_m[i],
                        t.off_middle_m[i]});
  }
  return out;
}

}  // namespace

result<findings> run_hammer(workbench& bench) {
  findings out;
  figure f{
      "hammer",
      "The hammer's height follows the wrinkles of the full-resolution meshes below it; when it rocks, the centre of "
      "pressure goes from rim to rim and rights it.",
      {}};
  f.page.title = "A textured hammer on a wrinkled torus: touched, drawn along, rocked, lifted";
  f.page.caption = "Virtual clock. Dashed: where the full-resolution meshes would touch, at the hammer's own pose.";
  f.page.x_label = "time (s)";
  f.page.panels = {{"height (mm)", {}}, {"normal force (N)", {}}, {"centre of pressure (mm)", {}}};
  const std::unique_ptr<originals> full = full_resolution();
  const schedule s = times(bench.brief());
  command::plot_line full_height;  // drawn last, so that each renderer has one colour in all panels
  const auto touch_with = [&](const variant& kind) -> result<void> {
    const result<touch> touched = touch_ring(bench, kind, *full);
    if (!touched) return touched.error();
    state(kind.name, *touched, s, out);
    out.tables.push_back(numbers_of(kind.name, *touched));
    if (f.page.x.empty()) {
      f.page.x = touched->time_s;
      full_height = {"full resolution", in_milli(touched->drop_height_m), touched->asked_s,
                     command::plot_style::dashed};
    }
    f.page.panels[0].lines.push_back({kind.says, in_milli(touched->height_m)});
    f.page.panels[1].lines.push_back({kind.says, touched->normal_n});
    f.page.panels[2].lines.push_back({kind.says, in_milli(touched->lean_lever_m)});
    return {};
  };
  if (const result<void> ran = bench.with_each("hammer", bench.variants(), out, touch_with); !ran) return ran.error();
  f.page.panels[0].lines.push_back(std::move(full_height));
  out.figures.push_back(std::move(f));
  return out;
}

}  // namespace asperity::experiment
