// What comes through the C interface is what the library of C++ answers, bit for bit.
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "asperity/asperity.hpp"
#include "asperity/device/simulated/simulated_device.hpp"
#include "contract/c_interface/saved_models.hpp"
#include "support/fresh_seed.hpp"

namespace {

using namespace asperity;
using namespace asperity::test_support;
using seven = std::array<double, 7>;

seven to_seven(const pose& T) {
  const auto q = to_xyzw(T.rotation);
  return {T.position.x, T.position.y, T.position.z, q[0], q[1], q[2], q[3]};
}
std::array<double, 6> to_six(const wrench& w) {
  return {w.force.x, w.force.y, w.force.z, w.torque.x, w.torque.y, w.torque.z};
}
template <std::size_t n>
bool same_bits(const std::array<double, n>& a, const double* b) {
  return std::memcmp(a.data(), b, sizeof a) == 0;
}

// Poses around the first touch, gaps and deep ones among them.
std::vector<pose> drawn_poses(std::uint64_t seed, int count) {
  std::mt19937_64 bits(seed);
  std::uniform_real_distribution<double> one(-1.0, 1.0);
  std::vector<pose> out;
  for (int i = 0; i < count; ++i) {
    const vec3 turn{0.1 * one(bits), 0.1 * one(bits), one(bits)};
    const double x = 0.03 * one(bits), y = 0.03 * one(bits);
    out.push_back({exp_rotation(turn), {x, y, 0.02 + 0.001 * one(bits)}});
  }
  return out;
}

template <class Renderer>
void expect_same_ticks(const two_models& models, std::uint32_t formulation, Renderer direct,
                       std::uint32_t threads = 0) {
  asperity_renderer_settings settings = sized<asperity_renderer_settings>();
  settings.formulation = formulation;
  settings.threads = threads;
  const owned_renderer c = models.renderer(&settings);
  const pose T_wb{exp_rotation({0.01, 0.0, 0.3}), {0.002, 0.001, -0.0005}};
  ASSERT_EQ(asperity_renderer_place_body(c.get(), 0, to_seven(T_wb).data()), ASPERITY_STATUS_OK);
  const std::vector<pose> at{T_wb};
  int touching = 0;
  const std::uint64_t seed = seed_of(fresh_seed("c_interface.ticks", "100 poses"), "c_interface.ticks", formulation);
  for (const pose& T_wa : drawn_poses(seed, 100)) {
    tick found;
    const status s = direct.step({T_wa, at}, found);
    asperity_touch touch = sized<asperity_touch>();
    ASSERT_EQ(asperity_renderer_step(c.get(), to_seven(T_wa).data(), &touch), static_cast<int>(s));
    EXPECT_TRUE(same_bits(to_six(found.force.on_probe_w), touch.on_probe));
    EXPECT_EQ(touch.flags, static_cast<std::uint32_t>(found.flags));
    EXPECT_EQ(touch.contacts, found.contacts.size());
    EXPECT_EQ(touch.dropped_contacts, found.dropped_contacts);
    double deepest_m = 0.0;
    for (std::size_t i = 0; i < found.depths.size(); ++i) {
      deepest_m = std::max(deepest_m, found.depths[i].depth_m);
      asperity_contact contact = sized<asperity_contact>();
      ASSERT_EQ(asperity_renderer_contact(c.get(), static_cast<std::uint32_t>(i), &contact), ASPERITY_STATUS_OK);
      EXPECT_EQ(contact.depth_m, found.depths[i].depth_m);
      EXPECT_EQ(contact.n_ab[2], found.contacts[i].window.n_ab_w.z);
      EXPECT_EQ(contact.point_m[0], found.depths[i].witness_w.x);
      EXPECT_EQ(contact.body, found.contacts[i].body);
    }
    EXPECT_EQ(touch.deepest_m, deepest_m);
    touching += is_zero(found.force.on_probe_w) ? 0 : 1;
    double on_body[6] = {};
    const std::int32_t told = asperity_renderer_body_wrench(c.get(), 0, on_body);
    ASSERT_EQ(told, found.on_body.empty() ? ASPERITY_STATUS_NOT_READY : ASPERITY_STATUS_OK);
    EXPECT_TRUE(same_bits(to_six(found.on_body.empty() ? wrench{} : found.on_body[0]), on_body));
  }
  EXPECT_GT(touching, 20);
  EXPECT_LT(touching, 100);
}

TEST(c_interface, ticks_of_least_motion_have_the_same_bits) {
  const two_models& m = shared_models();
  expect_same_ticks(m, ASPERITY_FORMULATION_USUAL, make_renderer({m.probe, {m.plate}}).value());
}
TEST(c_interface, ticks_of_planes_have_the_same_bits) {
  const two_models& m = shared_models();
  expect_same_ticks(m, ASPERITY_FORMULATION_PLANES, make_plane_renderer({m.probe, {m.plate}}).value());
}
TEST(c_interface, ticks_that_three_threads_share_have_the_same_bits) {
  const two_models& m = shared_models();
  expect_same_ticks(m, ASPERITY_FORMULATION_PLANES, make_plane_renderer({m.probe, {m.plate}}).value(), 3);
}
TEST(c_interface, ticks_of_windows_have_the_same_bits) {
  const two_models& m = shared_models();
  expect_same_ticks(m, ASPERITY_FORMULATION_WINDOW, make_window_renderer({m.probe, {m.plate}}).value());
}

TEST(c_interface, stiffness_scales_the_force) {
  const two_models& m = shared_models();
  asperity_renderer_settings settings = sized<asperity_renderer_settings>();
  settings.stiffness_n_per_m = 1000.0;
  const owned_renderer soft = m.renderer(&settings), usual = m.renderer();
  asperity_touch a = sized<asperity_touch>(), b = a;
  const double T[7] = {0, 0, 0.0198, 0, 0, 0, 1};
  ASSERT_EQ(asperity_renderer_step(soft.get(), T, &a), 0);
  ASSERT_EQ(asperity_renderer_step(usual.get(), T, &b), 0);
  EXPECT_GT(b.on_probe[2], 0.05);
  EXPECT_NEAR(b.on_probe[2] / a.on_probe[2], 2.0, 1e-6);
}

TEST(c_interface, a_touch_is_found_where_the_probe_comes_down) {
  const two_models& m = shared_models();
  const owned_renderer c = m.renderer();
  const double upright[4] = {0, 0, 0, 1};
  double T[7] = {};
  ASSERT_EQ(asperity_renderer_find_touch(c.get(), upright, T, nullptr), ASPERITY_STATUS_OK);
  asperity_touch touch = sized<asperity_touch>();
  ASSERT_EQ(asperity_renderer_step(c.get(), T, &touch), 0);
  EXPECT_GT(touch.deepest_m, 0.0);
  // A hair higher nothing touches.
  T[2] += 1e-6;
  ASSERT_EQ(asperity_renderer_step(c.get(), T, &touch), 0);
  EXPECT_EQ(touch.on_probe[2], 0.0);
}

// The tool in a loop at 90 Hz, 1 kHz and 5 kHz, pressed and dragged with up to 20 N.
void expect_same_tool(double period_s, std::uint32_t threads = 0) {
  SCOPED_TRACE(period_s);
  const two_models& m = shared_models();
  asperity_tool_settings settings = sized<asperity_tool_settings>();
  settings.period_s = period_s;
  settings.threads = threads;
  settings.static_friction = 0.4;
  settings.dynamic_friction = 0.3;
  const owned_tool c = m.tool(&settings);

  plane_renderer_settings planes;
  planes.reach_m = period_s > 1e-3 ? std::min(0.01, reach_for(period_s)) : period_s < 1e-3 ? 0.0005 : 0.0;
  if (period_s < 1e-3)
    planes.reach_m = std::min(0.1 * std::min(m.probe->box.diagonal(), m.plate->box.diagonal()),
                              std::max(0.0005, reach_for(period_s)));
  plane_renderer direct = make_plane_renderer({m.probe, {m.plate}}, planes).value();
  virtual_tool_settings inside;
  inside.probe = solid_probe(m.probe->mass);
  inside.friction = {.static_coefficient = 0.4, .dynamic_coefficient = 0.3};
  inside.surfaces = surfaces_of(direct.scene());
  inside.selection = selection_for(std::llround(1e9 * period_s));
  inside.centre_of_mass_a = m.probe->mass.centre_of_mass;
  virtual_tool tool(inside);

  const pose start{quat(1, 0, 0, 0), {0.0, 0.0, 0.021}};
  tool.place(start);
  ASSERT_EQ(asperity_tool_place(c.get(), to_seven(start).data()), ASPERITY_STATUS_OK);
  const std::vector<pose> T_wb(1);
  double largest_n = 0.0, sideways_n = 0.0;
  const int steps = static_cast<int>(0.22 / period_s);
  for (int i = 0; i < steps; ++i) {
    const double t = i * period_s;
    const pose hand{exp_rotation({0.0, 0.02 * std::sin(9.0 * t), 0.0}),
                    {0.01 * std::sin(3.0 * t), 0.0, 0.021 - 0.041 * std::min(1.0, t / 0.2)}};
    tick found;
    const status s = direct.step({tool.T_wa(), T_wb}, found);
    const wrench felt = tool.follow(hand, period_s, found, s);
    asperity_felt out = sized<asperity_felt>();
    ASSERT_EQ(asperity_tool_follow(c.get(), to_seven(hand).data(), period_s, &out), static_cast<int>(tool.last()));
    ASSERT_TRUE(same_bits(to_six(felt), out.on_hand)) << i;
    ASSERT_TRUE(same_bits(to_seven(tool.T_wa()), out.probe_pose)) << i;
    EXPECT_TRUE(same_bits(to_six(tool.motion().touched().on_probe_w), out.on_probe));
    EXPECT_EQ(out.contact_answer, static_cast<int>(s));
    largest_n = std::max(largest_n, out.on_hand[2]);
    sideways_n = std::max(sideways_n, std::fabs(out.on_hand[0]));
  }
  EXPECT_GT(largest_n, 15.0);
  EXPECT_LT(largest_n, 25.0);
  EXPECT_GT(sideways_n, 0.3);  // friction
}

TEST(c_interface, a_tool_has_the_same_bits_at_90_hz) { expect_same_tool(1.0 / 90.0); }
TEST(c_interface, a_tool_has_the_same_bits_at_1_khz) { expect_same_tool(1e-3); }
TEST(c_interface, a_tool_has_the_same_bits_at_5_khz) { expect_same_tool(2e-4); }
TEST(c_interface, a_tool_whose_contacts_two_threads_share_has_the_same_bits) { expect_same_tool(1e-3, 2); }

TEST(c_interface, a_tools_wrench_is_shortened_and_keeps_its_direction) {
  const two_models& m = shared_models();
  asperity_tool_settings settings = sized<asperity_tool_settings>();
  const owned_tool free = m.tool(&settings);
  settings.most_force_n = 2.0;
  settings.most_torque_n_m = 0.01;
  const owned_tool limited = m.tool(&settings);
  const double above[7] = {0.008, 0.0, 0.0205, 0, 0, 0, 1};
  ASSERT_EQ(asperity_tool_place(free.get(), above), 0);
  ASSERT_EQ(asperity_tool_place(limited.get(), above), 0);
  const pose hand{exp_rotation({0.0, 0.3, 0.0}), {0.008, 0.0, 0.008}};
  asperity_felt a = sized<asperity_felt>(), b = a;
  for (int i = 0; i < 200; ++i) {
    ASSERT_EQ(asperity_tool_follow(free.get(), to_seven(hand).data(), 1e-3, &a), 0);
    ASSERT_EQ(asperity_tool_follow(limited.get(), to_seven(hand).data(), 1e-3, &b), 0);
  }
  const auto length = [](const double* v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); };
  EXPECT_GT(length(a.on_hand), 4.0);
  EXPECT_NEAR(length(b.on_hand), 2.0, 1e-9);
  EXPECT_NEAR(length(b.on_hand + 3), 0.01, 1e-12);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(b.on_hand[k] / length(b.on_hand), a.on_hand[k] / length(a.on_hand), 1e-9);
}

// A plate that comes up pushes the hand; one that is told to stand still stands.
TEST(c_interface, a_body_that_moves_takes_the_probe_along) {
  const two_models& m = shared_models();
  const owned_tool c = m.tool();
  const double hand[7] = {0, 0, 0.0205, 0, 0, 0, 1}, low[7] = {0, 0, -0.002, 0, 0, 0, 1};
  const double up[6] = {0, 0, 0.02, 0, 0, 0};
  ASSERT_EQ(asperity_tool_place(c.get(), hand), 0);
  ASSERT_EQ(asperity_tool_move_body(c.get(), 0, low, up), 0);
  asperity_felt felt = sized<asperity_felt>();
  for (int i = 0; i < 300; ++i) ASSERT_EQ(asperity_tool_follow(c.get(), hand, 1e-3, &felt), 0);
  // By now the plate is 4 mm higher than where it was, so the probe was lifted by about 3.5 mm.
  EXPECT_NEAR(felt.probe_pose[2], 0.024, 0.0006);
  EXPECT_NEAR(felt.on_hand[2], 500.0 * 0.0035, 0.4);
  const double there[7] = {0, 0, 0.004, 0, 0, 0, 1};
  ASSERT_EQ(asperity_tool_move_body(c.get(), 0, there, nullptr), 0);
  for (int i = 0; i < 300; ++i) ASSERT_EQ(asperity_tool_follow(c.get(), hand, 1e-3, &felt), 0);
  EXPECT_NEAR(felt.probe_pose[2], 0.024, 0.0006);
}

struct keep_rows {
  std::vector<session_record>* rows;
  void operator()(const session_record& r) const noexcept { rows->push_back(r); }
};

void expect_same_session(double device_hz, double contact_hz, std::uint32_t hand, std::uint32_t threads = 0) {
  SCOPED_TRACE(device_hz);
  const two_models& m = shared_models();
  asperity_simulated_settings simulated_wish = sized<asperity_simulated_settings>();
  simulated_wish.hand = hand;
  simulated_wish.approach_s = 0.1;
  simulated_wish.approach_m = 0.015;
  simulated_wish.jitter_ns = 300'000;
  const owned_device device = simulated(&simulated_wish);
  asperity_session_settings settings = sized<asperity_session_settings>();
  settings.device_rate_hz = device_hz;
  settings.contact_rate_hz = contact_hz;
  settings.threads = threads;
  settings.static_friction = settings.dynamic_friction = 0.3;
  const pose start{quat(1, 0, 0, 0), {0.001, 0.0, 0.0235}};
  const seven start_numbers = to_seven(start);
  std::copy(start_numbers.begin(), start_numbers.end(), settings.start_pose);
  const owned_session c = m.session(device.get(), &settings);

  simulated_settings same;
  same.motion.kind = motion_kind::scrub;
  same.motion.approach_s = 0.1;
  same.motion.depth_m = 0.015;
  same.measurement.jitter_ns = 300'000;
  if (hand == ASPERITY_HAND_SOFT) same.hand = soft_hand();
  if (hand == ASPERITY_HAND_FIRM) same.hand = firm_hand();
  simulated_device dev(same);
  ASSERT_TRUE(dev.open() && dev.arm());
  const loop_periods periods{std::llround(1e9 / device_hz), std::llround(1e9 / contact_hz)};
  const double device_s = 1e-9 * static_cast<double>(periods.device_ns);
  const double contact_s = 1e-9 * static_cast<double>(periods.contact_ns);
  plane_renderer_settings planes;
  const double wanted_m = reach_for(contact_s, device_s);
  if (wanted_m > reach_for(1e-3)) planes.reach_m = std::min(0.01, wanted_m);
  if (wanted_m < reach_for(1e-3)) planes.reach_m = std::min(0.1 * m.probe->box.diagonal(), std::max(0.0005, wanted_m));
  plane_renderer feel = make_plane_renderer({m.probe, {m.plate}}, planes).value();
  const vec3 com = m.probe->mass.centre_of_mass;
  control_settings control;
  control.map = {.T_wd = {quat(1, 0, 0, 0), start * com}, .scale = 1.0, .T_ha = {start.rotation, -com}};
  control.probe = solid_probe(m.probe->mass);
  control.coupling = coupling_for(same.capabilities, device_hz);
  control.friction.static_coefficient = control.friction.dynamic_coefficient = 0.3;
  control.surfaces = surfaces_of(feel.scene());
  std::vector<session_record> rows;
  virtual_session session(
      std::move(feel), {{pose{}}, com}, dev, control,
      {.device_period_ns = periods.device_ns, .contact_period_ns = periods.contact_ns, .contact_one_period_late = true},
      keep_rows{&rows});
  asperity_session_tick t = sized<asperity_session_tick>();
  double largest_n = 0.0;
  const int ticks = static_cast<int>(0.4 * device_hz);
  for (int i = 0; i < ticks; ++i) {
    session.beat();
    const status s = session.step();
    ASSERT_EQ(asperity_session_step(c.get(), 1, &t), static_cast<int>(s));
    const session_record& r = rows.back();
    ASSERT_TRUE(same_bits(to_six(r.on_hand_d), t.on_hand)) << i;
    ASSERT_TRUE(same_bits(to_six(r.on_probe_w), t.on_probe)) << i;
    ASSERT_TRUE(same_bits(to_seven(r.T_dh), t.device_pose)) << i;
    ASSERT_TRUE(same_bits(to_seven(r.T_wa), t.probe_pose)) << i;
    EXPECT_EQ(t.time_ns, r.time_ns);
    EXPECT_EQ(t.device, static_cast<std::uint32_t>(r.device));
    EXPECT_EQ(t.planes, r.planes);
    EXPECT_EQ(t.contacts, r.contacts);
    EXPECT_EQ(t.deepest_m, r.max_depth_m);
    EXPECT_EQ(t.delivered_j, r.delivered_j);
    EXPECT_EQ(t.flags, static_cast<std::uint32_t>(r.flags));
    EXPECT_EQ(t.ticks, 1U);
    largest_n = std::max(largest_n, std::fabs(t.on_hand[2]));
  }
  EXPECT_EQ(t.fault, 0U);
  EXPECT_GT(largest_n, 0.5);
}

TEST(c_interface, a_session_has_the_same_bits_at_200_hz) { expect_same_session(200, 200, ASPERITY_HAND_SOFT); }
TEST(c_interface, a_session_has_the_same_bits_at_1_khz) { expect_same_session(1000, 1000, ASPERITY_HAND_USUAL); }
TEST(c_interface, a_session_has_the_same_bits_at_10_khz) { expect_same_session(10000, 2500, ASPERITY_HAND_FIRM); }
TEST(c_interface, a_session_whose_contacts_two_threads_share_has_the_same_bits) {
  expect_same_session(1000, 1000, ASPERITY_HAND_USUAL, 2);
}

TEST(c_interface, many_ticks_at_once_are_as_many_one_by_one) {
  const two_models& m = shared_models();
  const owned_device d1 = simulated(), d2 = simulated();
  const owned_session a = m.session(d1.get()), b = m.session(d2.get());
  asperity_session_tick x = sized<asperity_session_tick>(), y = x;
  ASSERT_EQ(asperity_session_step(a.get(), 700, &x), 0);
  for (int i = 0; i < 700; ++i) ASSERT_EQ(asperity_session_step(b.get(), 1, &y), 0);
  EXPECT_EQ(x.ticks, 700U);
  x.ticks = y.ticks = 0;
  EXPECT_EQ(std::memcmp(&x, &y, sizeof x), 0);
  EXPECT_GT(x.on_hand[2], 0.1);
  EXPECT_EQ(asperity_device_state(d1.get()), ASPERITY_DEVICE_ACTIVE);
}

TEST(c_interface, a_stopped_session_falls_silent) {
  const two_models& m = shared_models();
  const owned_device d = simulated();
  owned_session s = m.session(d.get());
  asperity_session_tick t = sized<asperity_session_tick>();
  ASSERT_EQ(asperity_session_step(s.get(), 600, &t), 0);
  EXPECT_GT(t.on_hand[2], 0.1);
  EXPECT_EQ(asperity_session_stop(s.get()), 0);
  EXPECT_EQ(asperity_session_stop(s.get()), 0);
  EXPECT_EQ(asperity_session_step(s.get(), 10, &t), ASPERITY_STATUS_GATE_SHUT);
  EXPECT_EQ(t.ticks, 0U);
  for (const double x : t.on_hand) EXPECT_EQ(x, 0.0);
  EXPECT_EQ(t.fault, static_cast<std::uint32_t>(gate_fault::stopped));
  EXPECT_EQ(asperity_device_state(d.get()), ASPERITY_DEVICE_READY);
  // Another session takes the same device on from its own time.
  s.reset();
  s = m.session(d.get());
  ASSERT_EQ(asperity_session_step(s.get(), 1, &t), 0);
  const double before_x_m = t.device_pose[0];
  ASSERT_EQ(asperity_session_step(s.get(), 99, &t), 0);
  EXPECT_EQ(t.time_ns, 99'000'000);
  EXPECT_GT(std::fabs(t.device_pose[0] - before_x_m), 1e-4) << "the hand stands still";
}

TEST(c_interface, the_gate_holds_the_sessions_limit) {
  const two_models& m = shared_models();
  const owned_device d = simulated();
  asperity_session_settings settings = sized<asperity_session_settings>();
  settings.most_force_n = 0.3;
  const owned_session s = m.session(d.get(), &settings);
  asperity_session_tick t = sized<asperity_session_tick>();
  for (int i = 0; i < 800; ++i) {
    ASSERT_EQ(asperity_session_step(s.get(), 1, &t), 0);
    EXPECT_LE(std::hypot(std::hypot(t.on_hand[0], t.on_hand[1]), t.on_hand[2]), 0.3000001);
  }
  EXPECT_GT(t.on_hand[2], 0.25);
}

// A device in a loop of one's own: a spring to where the handle was.
TEST(c_interface, a_device_follows_its_own_loop) {
  const owned_device d = simulated();
  asperity_error why = no_error();
  ASSERT_EQ(asperity_device_open(d.get(), &why), 0) << why.message;
  ASSERT_EQ(asperity_device_arm(d.get(), &why), 0) << why.message;
  EXPECT_EQ(asperity_device_state(d.get()), ASPERITY_DEVICE_ARMED);
  asperity_measurement sample = sized<asperity_measurement>();
  std::uint64_t before = 0;
  for (std::int64_t t = 0; t < 800'000'000; t += 1'000'000) {
    ASSERT_EQ(asperity_device_read(d.get(), t, &sample), 0);
    EXPECT_GT(sample.sequence, before);
    before = sample.sequence;
    const double push[6] = {0, 0, std::min(5.0, -2000.0 * sample.pose[2]), 0, 0, 0};
    ASSERT_EQ(asperity_device_write(d.get(), t, push, t + 20'000'000), 0);
  }
  // A hand of 300 N/m that means to go down 10 mm against 2000 N/m.
  EXPECT_NEAR(sample.pose[2], -0.010 * 300.0 / 2300.0, 0.0005);
  EXPECT_EQ(asperity_device_state(d.get()), ASPERITY_DEVICE_ACTIVE);
  EXPECT_EQ(asperity_device_disarm(d.get()), 0);
  EXPECT_EQ(asperity_device_state(d.get()), ASPERITY_DEVICE_READY);
}

TEST(c_interface, materials_and_facts_are_the_models) {
  const two_models& m = shared_models();
  asperity_model_facts facts = sized<asperity_model_facts>();
  ASSERT_EQ(asperity_model_get_facts(m.c_plate.get(), &facts), 0);
  EXPECT_EQ(facts.coarse_triangles, 12U);
  EXPECT_EQ(facts.full_triangles, m.plate->report.full_triangles);
  EXPECT_EQ(facts.texture_width, 64U);
  EXPECT_EQ(facts.volume_m3, m.plate->mass.volume_m3);
  EXPECT_EQ(facts.high_m[0], m.plate->box.high.x);
  EXPECT_EQ(facts.low_m[2], m.plate->box.low.z);
  EXPECT_EQ(facts.inertia_per_mass_m2[4], m.plate->mass.inertia_per_mass[1][1]);
  EXPECT_EQ(facts.materials, 0U);
  EXPECT_STREQ(asperity_model_name(m.c_plate.get()), m.plate->name.c_str());
  for (std::uint32_t i = 0; i < material_presets().size(); ++i) {
    const char* const name = asperity_material_preset_name(i);
    ASSERT_NE(name, nullptr);
    asperity_material preset = sized<asperity_material>();
    ASSERT_EQ(asperity_material_preset(name, &preset, nullptr), 0);
    EXPECT_EQ(preset.stiffness_n_per_m, preset_material(name)->stiffness_n_per_m);
    EXPECT_EQ(preset.dissipation_s_per_m, preset_material(name)->dissipation_s_per_m);
    EXPECT_EQ(preset.static_friction, preset_material(name)->static_friction);
    EXPECT_EQ(preset.dynamic_friction, preset_material(name)->dynamic_friction);
    EXPECT_EQ(preset.combine, static_cast<std::uint32_t>(preset_material(name)->combine));
    asperity_model* with = nullptr;
    ASSERT_EQ(asperity_model_with_material(m.c_plate.get(), &preset, &with, nullptr), 0);
    const owned_model kept(with);
    ASSERT_EQ(asperity_model_get_facts(with, &facts), 0);
    EXPECT_EQ(facts.materials, 1U);
  }
  EXPECT_EQ(asperity_material_preset_name(static_cast<std::uint32_t>(material_presets().size())), nullptr);
}

// Ice slips where rubber drags.
TEST(c_interface, materials_are_felt) {
  const two_models& m = shared_models();
  const auto drag_n = [&](const char* name) {
    asperity_material preset = sized<asperity_material>();
    EXPECT_EQ(asperity_material_preset(name, &preset, nullptr), 0);
    asperity_model *probe = nullptr, *plate = nullptr;
    EXPECT_EQ(asperity_model_with_material(m.c_probe.get(), &preset, &probe, nullptr), 0);
    EXPECT_EQ(asperity_model_with_material(m.c_plate.get(), &preset, &plate, nullptr), 0);
    const owned_model a(probe), b(plate);
    const asperity_model* const fixed = plate;
    asperity_tool* made = nullptr;
    EXPECT_EQ(asperity_tool_make(probe, &fixed, 1, nullptr, &made, nullptr), 0);
    const owned_tool tool(made);
    const double start[7] = {0, 0, 0.0205, 0, 0, 0, 1};
    EXPECT_EQ(asperity_tool_place(made, start), 0);
    asperity_felt felt = sized<asperity_felt>();
    double sum_n = 0.0;
    for (int i = 0; i < 600; ++i) {
      const double hand[7] = {0, 0.00003 * i, 0.017, 0, 0, 0, 1};
      EXPECT_EQ(asperity_tool_follow(made, hand, 1e-3, &felt), 0);
      if (i >= 300) sum_n -= felt.on_hand[1] / 300.0;
    }
    return sum_n;
  };
  const double rubber = drag_n("rubber"), ice = drag_n("ice");
  EXPECT_GT(rubber, 0.3);
  EXPECT_LT(ice, 0.5 * rubber);
}

}  // namespace
