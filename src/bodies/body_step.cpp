#include "bodies/body_step.hpp"

#include <algorithm>
#include <cmath>

#include "asperity/core/memory.hpp"
#include "bodies/free_turn.hpp"
#include "control/bristle.hpp"

namespace asperity::detail {

namespace {

mat3 inertia_w(const mover& m) noexcept {
  const mat3 r = glm::mat3_cast(m.T_wc.rotation);
  return r * m.inertia_kg_m2 * glm::transpose(r);
}

pose moved(const pose& T_wc, const vec6& by) noexcept {
  return {glm::normalize(exp_rotation(by.angular) * T_wc.rotation), T_wc.position + by.linear};
}

// In the spring of a plane, which has come by way_m since the step began.
double stored_j(const joint_plane& p, double way_m) noexcept {
  const double depth_m = std::max(0.0, p.depth_m + way_m);
  return 0.5 * p.stiffness_n_per_m * depth_m * depth_m;
}

// A finite load can give a velocity that no body has. NaN fails too.
bool plausible(const vec6& v) noexcept {
  constexpr double fastest_m_per_s = 1e3, fastest_rad_per_s = 1e5;
  return glm::dot(v.linear, v.linear) <= fastest_m_per_s * fastest_m_per_s &&
         glm::dot(v.angular, v.angular) <= fastest_rad_per_s * fastest_rad_per_s;
}

}  // namespace

body_step::body_step(const free_bodies_settings& settings, const virtual_coupling& coupling, std::size_t movers,
                     std::size_t standing, bool has_probe)
    : settings_(settings),
      coupling_(coupling),
      movers_(movers),
      has_probe_(has_probe),
      solver_(movers, settings.most_planes),
      place_(movers),
      touches_(movers),
      impulses_(movers + standing) {
  const std::size_t most_pairs = 8 * movers + 8;
  reserve_resident(planes_, settings.most_planes);
  reserve_resident(bodies_, settings.most_planes);
  reserve_resident(turned_, settings.most_planes);
  reserve_resident(told_, settings.most_planes);
  reserve_resident(calming_s_, settings.most_planes);
  reserve_resident(bristles_, most_pairs);
  reserve_resident(springs_, most_pairs);
  reserve_resident(at_place_, movers);
  reserve_resident(inertia_, movers);
  reserve_resident(a_, movers);
  reserve_resident(load_, movers);
  reserve_resident(v0_, movers);
  reserve_resident(v_, movers);
  reserve_resident(brake_, movers);
}

std::size_t body_step::heap_bytes() const noexcept {
  return solver_.heap_bytes() + asperity::heap_bytes(planes_, bodies_, turned_, told_, calming_s_, bristles_, springs_,
                                                     place_, at_place_, inertia_, a_, load_, v0_, v_, brake_,
                                                     impulses_);
}

void body_step::begin() noexcept {
  std::fill(impulses_.begin(), impulses_.end(), wrench{});
  braked_ = false;
}

void body_step::forget(std::uint32_t mover) noexcept {
  std::size_t kept = 0;
  for (const bristle& b : bristles_) {
    if (b.of.a == mover || b.of.b == mover) {
      energy_.lost_j += b.stored_j;
      energy_.bristles_j -= b.stored_j;
    } else {
      bristles_[kept++] = b;
    }
  }
  bristles_.resize(kept);
}

void body_step::feel(const pair_of& of, const wrench& impulse_on_a, std::span<const mover> movers,
                     std::span<const vec3> standing_centres_w) noexcept {
  const vec3 other_w = is_mover(of.b) ? movers[of.b].T_wc.position : standing_centres_w[of.b - movers_];
  impulses_[of.a] += impulse_on_a;
  impulses_[of.b] += -1.0 * transport(impulse_on_a, movers[of.a].T_wc.position, other_w);
}

void body_step::add_sleepers(double dt_s, std::span<const mover> movers, std::span<const mover_contacts> contacts,
                             std::span<const vec3> standing_centres_w) noexcept {
  for (std::uint32_t a = 0; a < movers_; ++a) {
    if (!movers[a].sleeps) continue;
    const mover_contacts& of = contacts[a];
    for (std::size_t i = 0; i < of.contact.planes.size(); ++i) {
      const support_plane& p = of.contact.planes[i];
      const std::uint32_t b = of.others[p.body].number;
      if (moves(movers, b)) continue;
      feel({a, b}, to_wrench(-dt_s * of.lambda_n[i] * p.gradient), movers, standing_centres_w);
    }
  }
  for (const bristle& b : bristles_) {
    if (!moves(movers, b.of.a) && !moves(movers, b.of.b)) feel(b.of, dt_s * b.on_a_w, movers, standing_centres_w);
  }
}

bool body_step::gather(double h_s, std::span<const mover> movers, std::span<const mover_contacts> contacts) noexcept {
  planes_.clear();
  bodies_.clear();
  turned_.clear();
  told_.clear();
  // A plane that is further away than two bodies can go in a step cannot be met in it.
  const double far_m = -2.0 * h_s * settings_.fastest_m_per_s;
  bool all = true;
  for (std::uint32_t a = 0; a < movers_; ++a) {
    const mover_contacts& of = contacts[a];
    const vec6 gone = pose_difference(movers[a].T_wc, of.contact.T_wc);
    for (const support_plane& told : of.contact.planes) {
      const std::uint32_t b = of.others[told.body].number;
      if (!moves(movers, a) && !moves(movers, b)) continue;
      support_plane p = told;
      vec6 gradient_b;
      if (is_mover(b)) {
        p = carried(told, movers[a].T_wc, of.contact.T_wc, movers[b].T_wb(), of.T_wb[told.body]);
        const vec3 arm_w = movers[a].T_wc.position - movers[b].T_wc.position;
        gradient_b = {-p.gradient.linear, -p.gradient.angular - glm::cross(arm_w, p.gradient.linear)};
      } else {
        p.depth_m += dot(p.gradient, gone);
      }
      if (p.depth_m < far_m) continue;
      if (planes_.size() == planes_.capacity()) {
        all = false;
        continue;
      }
      const double alpha = of.laws.dissipation_s_per_m(told);
      planes_.push_back({.a = a,
                         .b = b,
                         .gradient_a = p.gradient,
                         .gradient_b = gradient_b,
                         .depth_m = p.depth_m,
                         .stiffness_n_per_m = of.laws.stiffness_n_per_m(told),
                         .horizon_s = h_s + 1.5 * alpha * std::max(0.0, p.depth_m)});
      bodies_.push_back({a, b});
      turned_.push_back(p);
      told_.push_back(static_cast<std::uint32_t>(&told - of.contact.planes.begin()));
    }
  }
  return all;
}

// The planes of a pair damp its motion while its springs hold energy that no motion gave them, the more the larger a part
// of what they hold it is. What the damping takes is taken from what was made.
void body_step::calm(double h_s, std::span<const mover> movers, std::span<mover_contacts> contacts) noexcept {
  constexpr double longest_s = 0.02;  // so long it takes a plane that came with a depth to press the bodies apart
  constexpr double forget_s = 0.3;    // blocks on each other rock once in some 50 ms
  const auto for_each_pair = [&](auto&& visit) noexcept {
    for (std::uint32_t a = 0; a < movers_; ++a) {
      for (std::size_t i = 0; i < contacts[a].others.size(); ++i) {
        if (moves(movers, a) || moves(movers, contacts[a].others[i].number)) visit(contacts[a].springs[i]);
      }
    }
  };
  for_each_pair([](pair_springs& s) noexcept { s.now_j = 0.0; });
  for (std::size_t i = 0; i < planes_.size(); ++i) springs_of(i, contacts).now_j += stored_j(planes_[i], 0.0);
  double springs_j = 0.0;
  for_each_pair([&](pair_springs& s) noexcept {
    springs_j += s.now_j;
    s.made_j = std::max(0.0, (1.0 - h_s / forget_s) * s.made_j + s.now_j - s.held_j);
    s.held_j = 0.0;
  });
  energy_.by_rendering_j += springs_j - energy_.springs_j;
  energy_.springs_j = springs_j;
  calming_s_.clear();
  for (std::size_t i = 0; i < planes_.size(); ++i) {
    const pair_springs& s = springs_of(i, contacts);
    const bool is_felt = has_probe_ && bodies_[i].a == 0;  // a hand would feel the damping on each slope of the texture
    calming_s_.push_back(!is_felt && s.made_j > 0.0 ? longest_s * std::min(1.0, s.made_j / s.now_j) : 0.0);
    planes_[i].horizon_s += calming_s_.back();
  }
}

// Bodies that touch get places next to each other: from each body that has none, its neighbours, theirs, and so on.
void body_step::order(std::span<const mover> movers) noexcept {
  touches_.clear();
  const auto meet = [&](const pair_of& p) noexcept {
    if (moves(movers, p.a) && moves(movers, p.b)) touches_.meet(p.a, p.b);
  };
  for (const pair_of& p : bodies_) meet(p);
  for (const bristle& b : bristles_) meet(b.of);
  std::fill(place_.begin(), place_.end(), unmoved);
  at_place_.clear();
  const auto put = [&](std::uint32_t m) noexcept {
    if (place_[m] != unmoved) return;
    place_[m] = static_cast<std::uint32_t>(at_place_.size());
    at_place_.push_back(m);
  };
  for (std::uint32_t from = 0; from < movers_; ++from) {
    if (!moves(movers, from)) continue;
    std::size_t next = at_place_.size();
    put(from);
    for (; next < at_place_.size(); ++next) {
      for (std::uint32_t m = 0; m < movers_; ++m) {
        if (touches_.touch(at_place_[next], m)) put(m);
      }
    }
  }
  for (std::size_t i = 0; i < planes_.size(); ++i) {
    joint_plane& p = planes_[i];
    p.a = place_[bodies_[i].a];
    p.b = is_mover(bodies_[i].b) ? place_[bodies_[i].b] : unmoved;
    if (p.a != unmoved) continue;
    // The first body sleeps: the plane is one of the second and what stands.
    std::swap(p.a, p.b);
    std::swap(p.gradient_a, p.gradient_b);
  }
}

void body_step::turn_freely(double h_s, std::span<mover> movers) noexcept {
  for (std::uint32_t m = has_probe_ ? 1 : 0; m < movers_; ++m) {
    mover& body = movers[m];
    if (body.sleeps || body.velocity.angular == vec3(0.0)) continue;
    const quat to_b = glm::conjugate(body.T_wc.rotation);
    const vec3 w0 = to_b * body.velocity.angular;
    const vec3 w = after_free_turn(body.inertia_kg_m2, w0, h_s);
    const double lost_j = -0.5 * glm::dot(w - w0, body.inertia_kg_m2 * (w + w0));
    // A body that turns by more than a radian in a step has no solution that three passes find; it keeps its velocity.
    if (!(lost_j >= 0.0)) continue;
    body.velocity.angular = body.T_wc.rotation * w;
    energy_.lost_j += lost_j;
  }
}

void body_step::load(double h_s, std::span<const mover> movers, const hand_pull& hand) noexcept {
  inertia_.clear();
  a_.clear();
  load_.clear();
  v0_.clear();
  for (const std::uint32_t m : at_place_) {
    const mover& body = movers[m];
    mat6 inertia;
    set_block(inertia, 0, 0, mat3(body.mass_kg));
    const mat3 turned_inertia = inertia_w(body);
    set_block(inertia, 3, 3, turned_inertia);
    mat6 a = (1.0 / h_s) * inertia;
    vec6 load;
    const vec6& v = body.velocity;
    if (has_probe_ && m == 0) {
      coupled_ = coupling_.on_probe(hand.target_T_wc, hand.target_velocity_w, body.T_wc, to_twist(v));
      load = to_vec6(coupled_);
      for (std::size_t i = 0; i < 6; ++i) {
        const double k = i < 3 ? coupling_.stiffness_n_per_m() : coupling_.stiffness_n_m_per_rad();
        const double b = i < 3 ? coupling_.damping_n_s_per_m() : coupling_.damping_n_m_s_per_rad();
        a(i, i) += b + h_s * k;
        load[i] -= h_s * k * v[i];
      }
    } else {
      load = {body.mass_kg * settings_.gravity_m_per_s2 + body.push_w.force, body.push_w.torque};
      mat6 damping;
      set_block(damping, 0, 0, mat3(settings_.linear_damping_per_s * body.mass_kg));
      set_block(damping, 3, 3, settings_.angular_damping_per_s * turned_inertia);
      a += damping;
      load = load - damping * v;
    }
    inertia_.push_back(inertia);
    a_.push_back(a);
    load_.push_back(load);
    v0_.push_back(v);
  }
  v_.assign(v0_.begin(), v0_.end());
  brake_.assign(v0_.size(), 0.0);
}

body_step::of_friction body_step::coefficients(std::size_t plane,
                                               std::span<const mover_contacts> contacts) const noexcept {
  const surface_pair* const pair = contacts[bodies_[plane].a].laws.pair(turned_[plane]);
  if (pair == nullptr) return {settings_.friction.static_coefficient, settings_.friction.dynamic_coefficient};
  return {pair->static_friction, pair->dynamic_friction};
}

bool body_step::find_bristles(std::span<const mover> movers, std::span<const mover_contacts> contacts) noexcept {
  bool all = true;
  for (std::size_t i = 0; i < planes_.size(); ++i) {
    if (!(planes_[i].lambda_n > 0.0)) continue;
    const pair_of of = bodies_[i];
    const double at_rest = coefficients(i, contacts).at_rest;
    const bool known = std::any_of(bristles_.begin(), bristles_.end(),
                                   [&](const bristle& b) { return b.of.a == of.a && b.of.b == of.b; });
    if (!(at_rest > 0.0) || known) continue;
    if (bristles_.size() == bristles_.capacity()) {
      all = false;
      continue;
    }
    bristles_.push_back({.of = of});
  }
  for (bristle& b : bristles_) {
    b.solved_for = moves(movers, b.of.a) || moves(movers, b.of.b);
    b.arm_w = is_mover(b.of.b) ? movers[b.of.a].T_wc.position - movers[b.of.b].T_wc.position : vec3(0.0);
  }
  return all;
}

vec6 body_step::slide_of(const bristle& b, std::span<const vec6> v) const noexcept {
  const std::uint32_t a = place_[b.of.a], other = is_mover(b.of.b) ? place_[b.of.b] : unmoved;
  vec6 out = a != unmoved ? v[a] : vec6{};
  if (other != unmoved) out = out - seen_from(v[other], b.arm_w);
  return out;
}

void body_step::measure(double h_s, std::span<const vec6> v, std::span<const mover_contacts> contacts) noexcept {
  for (bristle& b : bristles_) {
    if (!b.solved_for) continue;
    b.normal_n = 0.0;
    b.metric = {};
    const auto force_n = [&](std::size_t i) noexcept {
      const bool is_its = bodies_[i].a == b.of.a && bodies_[i].b == b.of.b && planes_[i].lambda_n > 0.0;
      return is_its ? planes_[i].lambda_n * glm::length(turned_[i].gradient.linear) : 0.0;
    };
    for (std::size_t i = 0; i < planes_.size(); ++i) b.normal_n += force_n(i);
    if (!(b.normal_n > 0.0)) continue;
    b.static_coefficient = b.dynamic_coefficient = 0.0;
    for (std::size_t i = 0; i < planes_.size(); ++i) {
      const double n = force_n(i);
      if (!(n > 0.0)) continue;
      add_point(b.metric, n / b.normal_n, turned_[i]);
      const auto [at_rest, slipping] = coefficients(i, contacts);
      b.static_coefficient += n / b.normal_n * at_rest;
      b.dynamic_coefficient += n / b.normal_n * slipping;
    }
    b.held = held_in(b.metric, b.stretch, b.stored_j, settings_.friction.stiffness_n_per_m);
    b.theta = share_held(settings_.friction, b.metric, b.held, slide_of(b, v), h_s, b.theta, b.normal_n,
                         b.static_coefficient, b.dynamic_coefficient);
  }
}

bool body_step::solve(double h_s, std::span<const mover> movers, std::span<const mover_contacts> contacts) noexcept {
  constexpr int most_passes = 4;
  const double k = settings_.friction.stiffness_n_per_m, horizon_s = h_s + settings_.friction.damping_s;
  springs_.clear();
  for (bristle& b : bristles_) b.normal_n = 0.0;
  if (!solver_.solve(a_, load_, v0_, planes_, springs_, v_).solved) return false;
  for (int pass = 0; pass < most_passes; ++pass) {
    if (!find_bristles(movers, contacts)) left_out_ = true;
    measure(h_s, pass == 0 ? v0_ : v_, contacts);
    springs_.clear();
    for (const bristle& b : bristles_) {
      if (!b.solved_for || !(b.normal_n > 0.0)) continue;
      springs_.push_back({.a = place_[b.of.a],
                          .b = is_mover(b.of.b) ? place_[b.of.b] : unmoved,
                          .matrix = (b.theta * k) * b.metric,
                          .stretch = b.held,
                          .horizon_s = horizon_s,
                          .arm_w = b.arm_w});
    }
    if (springs_.empty()) return true;
    if (!solver_.solve(a_, load_, v0_, planes_, springs_, v_).solved) return false;
  }
  return true;
}

bool body_step::brake(double h_s, std::span<const mover> movers) noexcept {
  bool any = false;
  for (std::size_t i = 0; i < at_place_.size(); ++i) {
    const mover& body = movers[at_place_[i]];
    const double before_m = body.way_m(body.T_wc), after_m = body.way_m(moved(body.T_wc, h_s * v_[i]));
    const double left_m = std::max(0.0, body.known_m - before_m);
    const double by =
        std::max(after_m > body.known_m && after_m > before_m ? (after_m - before_m) / (left_m + 1e-6) : 0.0,
                 glm::length(v_[i].linear) / settings_.fastest_m_per_s);
    if (!(by > 1.0)) continue;
    // A body that nothing drives comes to v / (1 + c h) by a brake c.
    const double more = (by * 1.01 - 1.0) * (1.0 / h_s + brake_[i]);
    brake_[i] += more;
    a_[i] += more * inertia_[i];
    load_[i] = load_[i] - more * (inertia_[i] * v0_[i]);
    any = true;
  }
  return any;
}

void body_step::settle(double h_s, std::span<mover> movers, std::span<mover_contacts> contacts,
                       std::span<const vec3> standing_centres_w) noexcept {
  const double k = settings_.friction.stiffness_n_per_m;
  double given_j = 0.0, kept_j = 0.0, springs_j = 0.0;
  for (std::size_t i = 0; i < planes_.size(); ++i) {
    const joint_plane& p = planes_[i];
    pair_springs& of_pair = springs_of(i, contacts);
    double way_m = h_s * dot(p.gradient_a, v_[p.a]);
    if (p.b != unmoved) way_m += h_s * dot(p.gradient_b, v_[p.b]);
    const double held_j = stored_j(p, way_m);
    kept_j += held_j - stored_j(p, 0.0);
    springs_j += held_j;
    of_pair.held_j += held_j;
    if (!(p.lambda_n > 0.0)) continue;
    of_pair.made_j = std::max(0.0, of_pair.made_j - p.stiffness_n_per_m * calming_s_[i] * way_m * way_m / h_s);
    feel(bodies_[i], to_wrench(-h_s * p.lambda_n * turned_[i].gradient), movers, standing_centres_w);
  }
  double bristles_j = 0.0;
  std::size_t kept = 0;
  for (bristle& b : bristles_) {
    if (!b.solved_for) {
      bristles_j += b.stored_j;
      bristles_[kept++] = b;
      continue;
    }
    if (!(b.normal_n > 0.0)) {
      kept_j -= b.stored_j;
      continue;
    }
    const vec6 slide = slide_of(b, v_);
    b.stretch = b.theta * (b.held + h_s * slide);
    b.on_a_w = to_wrench(-k * (b.metric * (b.stretch + (b.theta * settings_.friction.damping_s) * slide)));
    feel(b.of, h_s * b.on_a_w, movers, standing_centres_w);
    b.stretch = without_rest(b.metric, b.stretch);
    const double now_j = 0.5 * k * squared(b.metric, b.stretch);
    kept_j += now_j - b.stored_j;
    b.stored_j = now_j;
    bristles_j += now_j;
    if (const std::uint32_t at = is_mover(b.of.b) ? place_[b.of.b] : unmoved; at != unmoved) {
      const quat turned = exp_rotation(h_s * v_[at].angular);  // the stretch is the other body's, and turns with it
      b.stretch = {turned * b.stretch.linear, turned * b.stretch.angular};
    }
    bristles_[kept++] = b;
  }
  bristles_.resize(kept);
  double kinetic_j = 0.0;
  for (std::size_t i = 0; i < at_place_.size(); ++i) {
    mover& body = movers[at_place_[i]];
    const vec6 dv = v_[i] - v0_[i];
    kept_j += 0.5 * dot(dv, inertia_[i] * (v_[i] + v0_[i]));
    kinetic_j += 0.5 * dot(v_[i], inertia_[i] * v_[i]);
    if (has_probe_ && at_place_[i] == 0) {
      vec6 end = to_vec6(coupled_);
      for (std::size_t n = 0; n < 6; ++n) {
        const double spring = n < 3 ? coupling_.stiffness_n_per_m() : coupling_.stiffness_n_m_per_rad();
        const double damper = n < 3 ? coupling_.damping_n_s_per_m() : coupling_.damping_n_m_s_per_rad();
        end[n] -= damper * dv[n] + h_s * spring * v_[i][n];
      }
      const double work_j = h_s * dot(end, v_[i]);
      energy_.by_hand_j += work_j;
      given_j += work_j;
    } else {
      const double fall_j = h_s * body.mass_kg * glm::dot(settings_.gravity_m_per_s2, v_[i].linear);
      const double push_j = h_s * dot(to_vec6(body.push_w), v_[i]);
      energy_.by_gravity_j += fall_j;
      energy_.by_pushes_j += push_j;
      given_j += fall_j + push_j;
    }
    body.velocity = v_[i];
    body.T_wc = moved(body.T_wc, h_s * v_[i]);
  }
  const double lost_j = given_j - kept_j;
  energy_.lost_j += lost_j;
  energy_.most_made_j = std::max(energy_.most_made_j, -lost_j);
  energy_.kinetic_j = kinetic_j;
  energy_.springs_j = springs_j;
  energy_.bristles_j = bristles_j;
}

status body_step::step(double h_s, std::span<mover> movers, std::span<mover_contacts> contacts,
                       std::span<const vec3> standing_centres_w, const hand_pull& hand) noexcept {
  constexpr int most_brakes = 4;
  left_out_ = !gather(h_s, movers, contacts);
  calm(h_s, movers, contacts);
  order(movers);
  if (at_place_.empty()) {
    energy_.kinetic_j = 0.0;
    return status::ok;
  }
  turn_freely(h_s, movers);
  load(h_s, movers, hand);
  bool solved = solve(h_s, movers, contacts);
  for (int i = 0; solved && i < most_brakes && brake(h_s, movers); ++i) {
    braked_ = true;
    solved = solve(h_s, movers, contacts);
  }
  if (!solved || !std::all_of(v_.begin(), v_.end(), plausible)) {
    for (mover& m : movers) m.velocity = {};
    for (bristle& b : bristles_) energy_.lost_j += b.stored_j;
    bristles_.clear();
    return status::not_finite;
  }
  for (std::uint32_t a = 0; a < movers_; ++a) {
    mover_contacts& of = contacts[a];
    for (std::size_t i = 0; i < of.contact.planes.size(); ++i) {
      const bool is_solved = moves(movers, a) || moves(movers, of.others[of.contact.planes[i].body].number);
      if (is_solved) of.lambda_n[i] = 0.0;
    }
  }
  for (std::size_t i = 0; i < planes_.size(); ++i) contacts[bodies_[i].a].lambda_n[told_[i]] = planes_[i].lambda_n;
  settle(h_s, movers, contacts, standing_centres_w);
  return left_out_ ? status::capacity_reached : status::ok;
}

}  // namespace asperity::detail
