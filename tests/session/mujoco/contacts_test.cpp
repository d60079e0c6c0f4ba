// Wrenches of textured contacts inside MuJoCo: the renderer's own, at the right places, and nothing else disturbed.
#include <cmath>
#include <cstring>

#include "asperity/least_motion/least_motion_renderer.hpp"
#include "asperity/mujoco/conversions.hpp"
#include "asperity/mujoco/textured_contacts.hpp"
#include "session/mujoco/simulation.hpp"
#include "session/rt/tick_trap.hpp"
#include "support/extent.hpp"
#include "support/fresh_seed.hpp"

namespace {

using namespace asperity;
using namespace asperity::test_support;
using mujoco::object_kind;
using mujoco::textured_contacts;
using mujoco::textured_pair;

// A plate and a block, free both, their centres of mass anywhere, their textured models anywhere in their bodies.
struct two_free_bodies {
  vec3 block_half{0.011, 0.009, 0.008}, plate_half{0.02, 0.02, 0.01};
  pose T_block{}, T_plate{};  // of the textured models in their bodies
  simulation s;

  explicit two_free_bodies(drawn& draw)
      : T_block{drawn_rotation(draw), draw.inside(0.03)},
        T_plate{drawn_rotation(draw), draw.inside(0.03)},
        s("<option timestep='.0005' gravity='0 0 0'/><worldbody>" + body("block", draw) + body("plate", draw) +
          "<body name='third'><freejoint/><geom size='.01'/></body></worldbody>") {}

  static std::string body(const char* name, drawn& draw) {
    return std::string("<body name='") + name + "'><freejoint/><inertial pos='" + text(draw.inside(0.05)) + "' mass='" +
           text({draw.log_between(0.02, 2.0)}) + "' diaginertia='1e-4 1.2e-4 .9e-4'/></body>";
  }
  [[nodiscard]] textured_pair pair() const {
    static const model_ptr block = ridged_box(block_half), plate = ridged_box(plate_half);
    return {.probe = {block, "block", object_kind::body, T_block},
            .fixed = {plate, "plate", object_kind::body, T_plate},
            .damping_s = 0.0,
            .make_renderer = least_motion_of()};
  }
  // Puts the plate anywhere and the block on one of its sides, so deep.
  void place(drawn& draw, double depth_m) {
    std::fill_n(s.d().qvel, s.m().nv, 0.0);
    const pose T_w_plate{drawn_rotation(draw), draw.inside(0.5)};
    const pose T_plate_block{
        exp_rotation(draw.inside(0.02)),
        {draw.between(-0.01, 0.01), draw.between(-0.01, 0.01), plate_half.z + block_half.z - depth_m}};
    put("plate", T_w_plate * inverse(T_plate));
    put("block", T_w_plate * T_plate_block * inverse(T_block));
  }
  void put(const char* name, const pose& T_wb) {
    const int joint = s.m().body_jntadr[s.body(name)];
    mujoco::pose_to_qpos(T_wb, std::span<double, 7>(s.d().qpos + s.m().jnt_qposadr[joint], 7));
  }
};

wrench in_xfrc(const simulation& s, const char* body) {
  return mujoco::wrench_from_xfrc(std::span<const double, 6>(s.d().xfrc_applied + 6 * s.body(body), 6));
}
vec3 xipos(const simulation& s, const char* body) {
  return mujoco::vector_from_mujoco(std::span<const double, 3>(s.d().xipos + 3 * s.body(body), 3));
}
// By MuJoCo's order, and without the adapter's own reading.
pose frame(const simulation& s, const char* body) {
  const double* const p = s.d().xpos + 3 * s.body(body);
  const double* const q = s.d().xquat + 4 * s.body(body);
  return {quat(q[0], q[1], q[2], q[3]), {p[0], p[1], p[2]}};
}
double largest_difference(const wrench& a, const wrench& b) {
  const wrench d = a - b;
  return std::max(glm::length(d.force), glm::length(d.torque));
}

TEST(mujoco_contacts, act_at_both_centres_of_mass_as_the_renderer_says) {
  drawn draw(
      seed_of(fresh_seed("mujoco_contacts.wrench", "40 poses of 2 pairs, 200 of 10 at length"), "mujoco_wrench"));
  double worst = 0.0, worst_at_frames = 0.0, most_n = 0.0;
  for (int round = 0; round < extent(2, 10); ++round) {
    two_free_bodies w(draw);
    const textured_pair pair = w.pair();
    textured_contacts contacts = made(w.s, {pair});
    any_renderer direct = least_motion_of()({pair.probe.model, {pair.fixed.model}}).value();
    for (int i = 0; i < 20; ++i) {
      w.place(draw, draw.log_between(2e-5, 2e-3));
      mj_step1(&w.s.m(), &w.s.d());
      ASSERT_EQ(contacts.apply(w.s.m(), w.s.d()), status::ok);
      const std::vector<pose> T_wb{frame(w.s, "plate") * w.T_plate};
      tick found;
      ASSERT_EQ(direct.step({frame(w.s, "block") * w.T_block, T_wb}, found), status::ok);
      const wrench about_block = transport(found.force.on_probe_w, found.centre_of_mass_w, xipos(w.s, "block"));
      const wrench about_plate = -1.0 * transport(found.force.on_probe_w, found.centre_of_mass_w, xipos(w.s, "plate"));
      const double size = std::max(1.0, glm::length(about_block.force));
      worst = std::max({worst, largest_difference(about_block, in_xfrc(w.s, "block")) / size,
                        largest_difference(about_plate, in_xfrc(w.s, "plate")) / size});
      most_n = std::max(most_n, glm::length(about_block.force));
      EXPECT_TRUE(is_zero(in_xfrc(w.s, "third")));
      EXPECT_EQ(contacts.report(0).force_share, 1.0);
      // The control: about the bodies' frames the torque is another one.
      worst_at_frames = std::max(
          worst_at_frames,
          largest_difference(transport(found.force.on_probe_w, found.centre_of_mass_w, frame(w.s, "block").position),
                             in_xfrc(w.s, "block")));
      contacts.take_back(w.s.d());
    }
  }
  EXPECT_GT(most_n, 1.0);  // something was felt
  EXPECT_LT(worst, 1e-12);
  EXPECT_GT(worst_at_frames, 1e-3);
}

TEST(mujoco_contacts, give_what_they_take) {
  drawn draw(seed_of(fresh_seed("mujoco_contacts.momentum", "a collision of two free bodies"), "mujoco_momentum"));
  two_free_bodies w(draw);
  w.place(draw, -1e-4);
  mj_forward(&w.s.m(), &w.s.d());
  textured_pair pair = w.pair();
  pair.damping_s = 2e-3;
  textured_contacts contacts = made(w.s, {pair});
  // The block comes along the plate's normal.
  const vec3 down = -((frame(w.s, "plate") * w.T_plate).rotation * vec3(0.0, 0.0, 1.0));
  const int dof = w.s.m().body_dofadr[w.s.body("block")];
  for (int i = 0; i < 3; ++i) w.s.d().qvel[dof + i] = 0.05 * down[i];
  const auto momentum = [&] {
    mj_subtreeVel(&w.s.m(), &w.s.d());
    const double* const v = w.s.d().subtree_linvel;
    const double* const turn = w.s.d().subtree_angmom;
    return std::pair(w.s.m().body_subtreemass[0] * vec3(v[0], v[1], v[2]), vec3(turn[0], turn[1], turn[2]));
  };
  mj_forward(&w.s.m(), &w.s.d());
  const auto [linear, angular] = momentum();
  double exchanged_n_s = 0.0;
  for (int i = 0; i < 500; ++i) {
    ASSERT_EQ(contacts.step(w.s.m(), w.s.d()), status::ok);
    const mujoco::pair_report& r = contacts.report(0);
    exchanged_n_s += w.s.m().opt.timestep * glm::length(r.on_probe_w.force);
    EXPECT_EQ(r.on_probe_w.force, -r.on_fixed_w.force);
  }
  mj_forward(&w.s.m(), &w.s.d());
  const auto [linear_after, angular_after] = momentum();
  EXPECT_GT(exchanged_n_s, 1e-4);
  // To the first order of MuJoCo's own step: bodies that tumble about a point beside their frames.
  EXPECT_LT(glm::length(linear_after - linear), 0.03 * exchanged_n_s);
  EXPECT_LT(glm::length(angular_after - angular), 0.03 * exchanged_n_s);
}

// A block on a vertical slide above a plate that stands.
std::string slide_scene(double mass_kg, double timestep_s, const std::string& more_joints = "") {
  return "<option timestep='" + text({timestep_s}) +
         "'><flag energy='enable'/></option><worldbody>"
         "<body name='plate'><geom name='plate' type='box' size='.05 .03 .03' contype='0' conaffinity='0'/></body>"
         "<body name='block' pos='0 0 .0601'>" +
         more_joints + "<joint type='slide' axis='0 0 1'/><geom name='block' type='box' size='.03 .02 .03' mass='" +
         text({mass_kg}) + "' contype='0' conaffinity='0'/></body></worldbody>";
}

// Where a weight comes to rest on a wall, by the depth that its weight takes there.
double rest_by(const textured_pair& pair, double mass_kg, double stiffness_n_per_m, double period_s) {
  const simulation s(slide_scene(mass_kg, period_s));
  textured_contacts contacts = made(s, {pair});
  const double w_per_s = std::sqrt(stiffness_n_per_m / mass_kg);
  const double until_s = 24.0 / (0.5 * pair.damping_s * w_per_s * w_per_s);
  while (s.d().time < until_s) EXPECT_EQ(contacts.step(s.m(), s.d()), status::ok);
  const mujoco::pair_report& r = contacts.report(0);
  EXPECT_EQ(r.force_share, 1.0);
  EXPECT_NEAR(r.mass_kg, mass_kg, 1e-6 * mass_kg);
  EXPECT_NEAR(r.stiffness_n_per_m, stiffness_n_per_m, 0.02 * stiffness_n_per_m);
  EXPECT_NEAR(r.on_probe_w.force.z, 9.81 * mass_kg, 1e-3 * 9.81 * mass_kg);
  const double depth_m = -1e-4 - s.d().qpos[0];
  if (r.contacts > 0) {
    EXPECT_NEAR(r.deepest_m, depth_m, 0.02 * depth_m);
  }
  return depth_m * stiffness_n_per_m / (9.81 * mass_kg);
}

TEST(mujoco_contacts, a_weight_comes_to_rest_at_its_weight_over_the_stiffness) {
  drawn draw(seed_of(fresh_seed("mujoco_contacts.press", "3 presses, 12 at length"), "mujoco_press"));
  static const model_ptr block = flat_box({0.02, 0.02, 0.03}), plate = flat_box({0.05, 0.03, 0.03});
  for (int i = 0; i < extent(3, 12); ++i) {
    const double stiffness = draw.log_between(500.0, 50e3), depth = draw.log_between(2e-4, 0.012);
    const double mass_kg = stiffness * depth / 9.81, period_s = draw.log_between(2e-4, 2e-3);
    const double w_per_s = std::sqrt(stiffness / mass_kg);
    textured_pair pair{.probe = {block, "block"},
                       .fixed = {plate, "plate"},
                       .damping_s = std::min(1.0 / w_per_s, 0.4 / (period_s * w_per_s * w_per_s)),
                       .make_renderer = walls_of(stiffness)};
    EXPECT_NEAR(rest_by(pair, mass_kg, stiffness, period_s), 1.0, 1e-3) << mass_kg << " kg, " << stiffness << " N/m";
    if (i > 0 || depth < 1e-3) continue;
    // The default's contacts have their stiffness within a hundredth, from half of their softness on.
    pair.make_renderer = least_motion_of(stiffness, period_s);
    EXPECT_NEAR(rest_by(pair, mass_kg, stiffness, period_s), 1.0, 0.02) << mass_kg << " kg, " << stiffness << " N/m";
  }
}

// A renderer that answers one tick late, which is not a function of the pose any more.
struct late_renderer {
  any_renderer inside;
  wrench before{};
  mat6 stiffness_before{};

  status step(const scene_pose& at, tick& out) noexcept {
    const status answer = inside.step(at, out);
    std::swap(before, out.force.on_probe_w);
    std::swap(stiffness_before, out.force.stiffness);
    return answer;
  }
  [[nodiscard]] const asperity::scene& scene() const noexcept { return inside.scene(); }
  [[nodiscard]] std::size_t memory_bytes() const noexcept { return inside.memory_bytes(); }
};

// The most that a slide of ten seconds had above the energy that it began with, J: a spring pulls the block to and fro over
// the plate's ridges.
double energy_gained(double damping_s, bool late, double seconds) {
  const simulation s(slide_scene(0.3, 1e-3, "<joint type='slide' axis='1 0 0' stiffness='40'/>"));
  static const model_ptr block = flat_box({0.005, 0.004, 0.03}), plate = ridged_box({0.05, 0.012, 0.03});
  textured_pair pair{
      .probe = {block, "block"}, .fixed = {plate, "plate"}, .damping_s = damping_s, .make_renderer = least_motion_of()};
  if (late) {
    pair.make_renderer = [](scene bodies) -> result<any_renderer> {
      return any_renderer(late_renderer{least_motion_of()(std::move(bodies)).value()});
    };
  }
  textured_contacts contacts = made(s, {pair});
  s.d().qpos[0] = 0.012;
  mj_forward(&s.m(), &s.d());
  // Kinetic, height and the joint's spring; what the contact stores makes it less.
  const double began_with = s.d().energy[0] + s.d().energy[1];
  double gained = -1e9;
  int touched = 0;
  while (s.d().time < seconds) {
    const status answer = contacts.step(s.m(), s.d());
    EXPECT_TRUE(answer == status::ok || answer == status::capacity_reached) << to_string(answer);
    touched += contacts.report(0).contacts > 0 ? 1 : 0;
    gained = std::max(gained, s.d().energy[0] + s.d().energy[1] - began_with);
  }
  EXPECT_GT(touched, 300);
  return gained;
}

TEST(mujoco_contacts, a_textured_slide_gains_no_energy) {
  // What the block swings with: 40 N/m over 12 mm.
  constexpr double swing_j = 0.5 * 40.0 * 0.012 * 0.012;
  EXPECT_LT(energy_gained(2e-3, false, extent(1.5, 10.0)), 1e-3 * swing_j);
  EXPECT_GT(energy_gained(0.0, true, extent(1.5, 3.0)), 0.1 * swing_j);  // the control
}

TEST(mujoco_contacts, leave_what_others_apply_as_it_was) {
  drawn draw(seed_of(fresh_seed("mujoco_contacts.others", "300 steps, 3000 at length"), "mujoco_others"));
  two_free_bodies w(draw);
  const textured_pair pair = w.pair();
  textured_contacts contacts = made(w.s, {pair});
  const auto write_all = [&] {
    for (int i = 0; i < 6 * w.s.m().nbody; ++i) w.s.d().xfrc_applied[i] = draw.between(-3.0, 3.0);
  };
  const auto expect_bits = [&](const std::vector<double>& theirs) {
    EXPECT_EQ(std::memcmp(theirs.data(), w.s.d().xfrc_applied, theirs.size() * sizeof(double)), 0);
  };
  int naive_differs = 0;
  for (int i = 0; i < extent(100, 1000); ++i) {
    // Written anew in each step.
    w.place(draw, 5e-4);
    write_all();
    std::vector<double> theirs = w.s.xfrc();
    ASSERT_EQ(contacts.step(w.s.m(), w.s.d()), status::ok);
    expect_bits(theirs);
    // The same without take_back(): theirs and ours are in the array, and the next step takes ours out again.
    w.place(draw, 5e-4);
    write_all();
    theirs = w.s.xfrc();
    mj_step1(&w.s.m(), &w.s.d());
    ASSERT_EQ(contacts.apply(w.s.m(), w.s.d()), status::ok);
    const vec6 ours = to_vec6(contacts.report(0).on_probe_w);
    for (std::size_t k = 0; k < 6; ++k) {
      const auto at = static_cast<std::size_t>(6 * w.s.body("block")) + k;
      EXPECT_EQ(w.s.d().xfrc_applied[at], theirs[at] + ours[k]);
      naive_differs += (theirs[at] + ours[k]) - ours[k] != theirs[at] ? 1 : 0;
    }
    mj_step2(&w.s.m(), &w.s.d());
    w.place(draw, 5e-4);
    mj_step1(&w.s.m(), &w.s.d());
    ASSERT_EQ(contacts.apply(w.s.m(), w.s.d()), status::ok);  // nobody wrote
    contacts.take_back(w.s.d());
    expect_bits(theirs);
    // Somebody assigns while ours is in the array: theirs, whole.
    ASSERT_EQ(contacts.apply(w.s.m(), w.s.d()), status::ok);
    write_all();
    theirs = w.s.xfrc();
    contacts.take_back(w.s.d());
    expect_bits(theirs);
    contacts.take_back(w.s.d());  // a second time takes nothing
    expect_bits(theirs);
  }
  EXPECT_GT(naive_differs, 10);  // the control: adding and subtracting does not come back to the bits
}

TEST(mujoco_contacts, change_nothing_where_nothing_touches) {
  drawn draw(seed_of(fresh_seed("mujoco_contacts.apart", "200 steps"), "mujoco_apart"));
  two_free_bodies w(draw);
  w.place(draw, -0.01);
  textured_contacts contacts = made(w.s, {w.pair()});
  const std::unique_ptr<mjData, mujoco_model_end> alone(mj_copyData(nullptr, &w.s.m(), &w.s.d()));
  for (int i = 0; i < 200; ++i) {
    ASSERT_EQ(contacts.step(w.s.m(), w.s.d()), status::ok);
    mj_step(&w.s.m(), alone.get());
  }
  const auto bytes = static_cast<std::size_t>(w.s.m().nq) * sizeof(double);
  EXPECT_EQ(std::memcmp(alone->qpos, w.s.d().qpos, bytes), 0);
  // The control: in touch the ways part.
  w.place(draw, 1e-3);
  std::memcpy(alone->qpos, w.s.d().qpos, bytes);
  ASSERT_EQ(contacts.step(w.s.m(), w.s.d()), status::ok);
  mj_step(&w.s.m(), alone.get());
  EXPECT_NE(std::memcmp(alone->qpos, w.s.d().qpos, bytes), 0);
}

TEST(mujoco_contacts, scale_down_what_the_time_step_does_not_bear) {
  drawn draw(
      seed_of(fresh_seed("mujoco_contacts.bound", "2 presses that are too stiff, 12 at length"), "mujoco_bound"));
  static const model_ptr block = flat_box({0.02, 0.02, 0.03}), plate = flat_box({0.05, 0.03, 0.03});
  for (int i = 0; i < extent(2, 12); ++i) {
    const double mass_kg = draw.log_between(0.02, 1.0), period_s = draw.log_between(5e-4, 5e-3);
    const double load = draw.log_between(6.0, 100.0), stiffness = load * mass_kg / (period_s * period_s);
    const auto pressed = [&](const simulation& s) {
      textured_pair pair{.probe = {block, "block"},
                         .fixed = {plate, "plate"},
                         .damping_s = 0.1 * period_s,
                         .make_renderer = walls_of(stiffness)};
      return made(s, {pair});
    };
    const simulation s(slide_scene(mass_kg, period_s));
    textured_contacts contacts = pressed(s);
    double highest_m = -1.0;
    for (int k = 0; k < 1500; ++k) {
      ASSERT_EQ(contacts.step(s.m(), s.d()), status::ok);
      highest_m = std::max(highest_m, s.d().qpos[0]);
    }
    EXPECT_LE(highest_m, 1e-6);  // it never comes back above where it fell from
    const mujoco::pair_report& r = contacts.report(0);
    if (r.stiffness_n_per_m > 0.9 * stiffness) {
      EXPECT_LT(r.force_share, 1.0);
      EXPECT_NEAR(r.step_load * r.force_share, 1.0, 1e-9);
      EXPECT_GE(r.step_load, 0.9 * load);
      EXPECT_LE(r.step_load, 1.3 * load);
    }
    EXPECT_GT(contacts.scaled(), 0U);
    // The control: the same force unscaled throws the block away.
    const simulation t(slide_scene(mass_kg, period_s));
    textured_contacts raw = pressed(t);
    double thrown_m = -1.0;
    for (int k = 0; k < 1500 && thrown_m < 0.01; ++k) {
      mj_step1(&t.m(), &t.d());
      ASSERT_EQ(raw.apply(t.m(), t.d()), status::ok);
      const double up_n = raw.report(0).on_probe_w.force.z / raw.report(0).force_share;
      raw.take_back(t.d());
      t.d().xfrc_applied[6 * t.body("block") + 2] = up_n;
      mj_step2(&t.m(), &t.d());
      thrown_m = std::max(thrown_m, t.d().qpos[0]);
    }
    EXPECT_GT(thrown_m, 1e-4) << load;
  }
}

TEST(mujoco_contacts, know_the_mass_that_is_against_them) {
  drawn draw(seed_of(fresh_seed("mujoco_contacts.mass", "two balls and a lever"), "mujoco_mass"));
  const double a_kg = draw.log_between(0.01, 1.0), b_kg = draw.log_between(0.01, 1.0), arm_m = draw.between(0.1, 0.5);
  // Boxes above each other, free, their centres of mass in one line; and a box on a hinge.
  const simulation s(
      "<option gravity='0 0 0'/><worldbody><body name='low'><freejoint/><geom type='box' size='.01 .01 .01' mass='" +
      text({a_kg}) +
      "' contype='0' conaffinity='0'/></body><body name='high' pos='0 0 .0195'><freejoint/><geom "
      "type='box' size='.01 .01 .01' mass='" +
      text({b_kg}) + "' contype='0' conaffinity='0'/></body><body name='post' pos='" + text({-arm_m, 0.0, 0.0}) +
      "'><joint type='hinge' axis='0 1 0'/><inertial pos='0 0 0' mass='1' diaginertia='.01 .01 .01'/>"
      "</body></worldbody>");
  const model_ptr box = flat_box(vec3(0.01));
  textured_contacts contacts =
      made(s, {{.probe = {box, "high"}, .fixed = {box, "low"}, .make_renderer = least_motion_of()},
               {.probe = {box, "post", object_kind::body, {quat(1, 0, 0, 0), {arm_m, 0.0, 0.0195}}},
                .fixed = {box, "low"},
                .make_renderer = least_motion_of()}});
  mj_step1(&s.m(), &s.d());
  ASSERT_EQ(contacts.apply(s.m(), s.d()), status::ok);
  EXPECT_NEAR(contacts.report(0).mass_kg, a_kg * b_kg / (a_kg + b_kg), 1e-9);
  EXPECT_NEAR(1.0 / contacts.report(1).mass_kg, 1.0 / a_kg + arm_m * arm_m / 0.01, 1e-4 / contacts.report(1).mass_kg);
  // Both pairs push the same body: what the step bears is asked of both together.
  EXPECT_EQ(contacts.report(0).step_load, contacts.report(1).step_load);
}

TEST(mujoco_contacts, damp_and_never_pull) {
  drawn draw(
      seed_of(fresh_seed("mujoco_contacts.damping", "60 poses and velocities, 1000 at length"), "mujoco_damping"));
  two_free_bodies w(draw);
  textured_pair pair = w.pair();
  textured_contacts plain = made(w.s, {pair});
  pair.damping_s = 0.05;
  textured_contacts damped = made(w.s, {pair});
  double most_taken_w = 0.0;
  for (int i = 0; i < extent(60, 1000); ++i) {
    w.place(draw, draw.log_between(1e-5, 1e-3));
    for (int k = 0; k < w.s.m().nv; ++k) w.s.d().qvel[k] = draw.between(-0.3, 0.3);
    mj_step1(&w.s.m(), &w.s.d());
    std::array<wrench, 2> force{};
    std::array<double, 2> power_w{};
    int of = 0;
    for (textured_contacts* c : {&plain, &damped}) {
      ASSERT_EQ(c->apply(w.s.m(), w.s.d()), status::ok);
      force[static_cast<std::size_t>(of)] = c->report(0).on_probe_w;
      for (const char* body : {"block", "plate"}) {
        std::array<double, 6> v{};
        mj_objectVelocity(&w.s.m(), &w.s.d(), mjOBJ_BODY, w.s.body(body), v.data(), 0);
        power_w[static_cast<std::size_t>(of)] +=
            dot(to_vec6(in_xfrc(w.s, body)), {{v[3], v[4], v[5]}, {v[0], v[1], v[2]}});
      }
      c->take_back(w.s.d());
      ++of;
    }
    EXPECT_LE(power_w[1], power_w[0] + 1e-12);
    most_taken_w = std::max(most_taken_w, power_w[0] - power_w[1]);
    EXPECT_GE(glm::dot(force[0].force, force[1].force), -1e-9);
  }
  EXPECT_GT(most_taken_w, 1e-3);
}

TEST(mujoco_contacts, go_through_the_tick_trap) {
  if (!tick_trap::missing().empty()) GTEST_SKIP() << tick_trap::missing();
  drawn draw(seed_of(fresh_seed("mujoco_contacts.trap", "200 steps"), "mujoco_trap"));
  two_free_bodies w(draw);
  textured_pair pair = w.pair();
  pair.damping_s = 2e-3;
  textured_contacts contacts = made(w.s, {pair});
  tick_trap trap;
  status answer = status::ok;
  std::uint32_t touched = 0;
  for (int i = 0; i < 200; ++i) {
    w.place(draw, draw.log_between(1e-5, 2e-3));
    mj_step1(&w.s.m(), &w.s.d());
    trap([&] { answer = contacts.apply(w.s.m(), w.s.d()); });
    touched += contacts.report(0).contacts;
    mj_step2(&w.s.m(), &w.s.d());
    trap([&] { contacts.take_back(w.s.d()); });
    ASSERT_EQ(answer, status::ok);
  }
  EXPECT_GT(touched, 100U);
  EXPECT_EQ(trap.ticks(), 400U);
}

TEST(mujoco_contacts, answer_bad_numbers_and_other_models_without_a_force) {
  drawn draw(seed_of(fresh_seed("mujoco_contacts.bad", "3 poses"), "mujoco_bad"));
  two_free_bodies w(draw);
  textured_contacts contacts = made(w.s, {w.pair()});
  w.place(draw, 1e-3);
  mj_step1(&w.s.m(), &w.s.d());
  const std::vector<double> before = w.s.xfrc();
  w.s.d().xpos[3 * w.s.body("block")] = std::nan("");
  EXPECT_EQ(contacts.apply(w.s.m(), w.s.d()), status::invalid_pose);
  EXPECT_EQ(w.s.xfrc(), before);
  EXPECT_EQ(contacts.report(0).answer, status::invalid_pose);
  mj_step1(&w.s.m(), &w.s.d());
  w.s.d().qvel[0] = INFINITY;
  EXPECT_EQ(contacts.apply(w.s.m(), w.s.d()), status::not_finite);
  EXPECT_EQ(w.s.xfrc(), before);
  const simulation other("<worldbody><body><freejoint/><geom size='.1'/></body></worldbody>");
  EXPECT_EQ(contacts.apply(other.m(), other.d()), status::not_ready);
}

}  // namespace
