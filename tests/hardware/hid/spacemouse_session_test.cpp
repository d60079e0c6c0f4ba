// A fake SpaceMouse moves a probe against a wall, in whole sessions on a virtual clock.
#include <algorithm>
#include <gtest/gtest.h>

#include <asperity/control/virtual_session.hpp>
#include <asperity/drivers/spacemouse/spacemouse_device.hpp>
#include <asperity/transport/virtual/virtual_hid.hpp>

#include "hardware/peers/fake_spacemouse.hpp"
#include "unit/control/analytic_wall.hpp"

namespace {

using namespace asperity;
using test_support::analytic_wall;
using test_support::fake_spacemouse;
using test_support::spacemouse_kind;

constexpr std::int64_t ms = 1'000'000;

struct most {
  double on_probe_n = 0.0;
  double on_hand_n = 0.0;
  double lowest_m = 1.0;
  session_record last{};
  void operator()(const session_record& r) noexcept {
    on_probe_n = std::max(on_probe_n, r.on_probe_w.force.z);
    on_hand_n = std::max(on_hand_n, glm::length(r.on_hand_d.force));
    lowest_m = std::min(lowest_m, r.T_wa.position.z);
    last = r;
  }
};

struct desk {
  explicit desk(spacemouse_kind kind, double shown_n = 0.0, link_script script = {})
      : cable(fake_spacemouse::descriptor(kind), std::move(script)),
        mouse(kind, [this](std::int64_t t, std::span<const std::uint8_t> r) { cable.send(t, r); }),
        device(
            [this]() -> result<std::unique_ptr<hid_link>> {
              if (!cable.plugged()) return error{error_code::io_failed, "the SpaceMouse is not plugged in"};
              return cable.host_end();
            },
            config_for(shown_n)) {
    EXPECT_TRUE(device.open() && device.arm());
    session.emplace(analytic_wall{}, scene_placement{{pose{}}, vec3(0.0)}, device, control_settings{});
  }

  static spacemouse_settings config_for(double shown_n) {
    spacemouse_settings c;
    c.motion.T_dh_start.position = {0, 0, 0.01};
    c.shown_force_n = shown_n;
    return c;
  }
  status run_until(std::int64_t until_ns) {
    status s = status::ok;
    while (session->now_ns() < until_ns) {
      mouse.step(session->now_ns());
      s = session->step();
    }
    return s;
  }
  const most& seen() { return session->device().observer(); }

  virtual_hid cable;
  fake_spacemouse mouse;
  spacemouse_device device;
  std::optional<virtual_session<analytic_wall, spacemouse_device, most>> session{};
};

TEST(spacemouse_session, moves_the_probe_against_a_wall_and_reports_the_wrench) {
  for (const spacemouse_kind kind : {spacemouse_kind::classic, spacemouse_kind::combined}) {
    desk d(kind);
    EXPECT_EQ(d.run_until(100 * ms), status::ok);
    EXPECT_EQ(d.seen().on_probe_n, 0.0);
    d.mouse.push({0, 0, 350, 0, 0, 0});  // down at 0.1 m/s, from 10 mm over the wall
    EXPECT_EQ(d.run_until(250 * ms), status::ok);
    d.mouse.release();
    EXPECT_EQ(d.run_until(1500 * ms), status::ok);  // a second and more without a report: not stale
    EXPECT_EQ(d.session->device().gate().fault(), gate_fault::none);
    // The hand rests about 5 mm below the surface. The probe is a spring against the wall's 2000 N/m.
    const double hand_z = d.seen().last.T_dh.position.z;
    EXPECT_NEAR(hand_z, -0.005, 0.0017);
    EXPECT_GT(d.seen().last.on_probe_w.force.z, 0.3);
    EXPECT_GT(d.seen().last.T_wa.position.z, hand_z);
    EXPECT_EQ(d.seen().on_hand_n, 0.0);  // there is no motor: nothing is put out
    d.mouse.push({0, 0, -350, 0, 0, 0});
    EXPECT_EQ(d.run_until(1800 * ms), status::ok);
    EXPECT_EQ(d.seen().last.on_probe_w.force.z, 0.0);
  }
}

TEST(spacemouse_session, shows_the_wrench_that_a_device_with_motors_would_put_out) {
  desk d(spacemouse_kind::classic, 5.0);
  d.mouse.push({0, 0, 350, 0, 0, 0});
  EXPECT_EQ(d.run_until(150 * ms), status::ok);
  d.mouse.release();
  EXPECT_EQ(d.run_until(1000 * ms), status::ok);
  EXPECT_GT(d.device.shown().force.z, 0.3);
  EXPECT_LE(d.seen().on_hand_n, 5.0);
  EXPECT_EQ(d.device.shown().force, d.session->device().gate().last().force);
  EXPECT_NEAR(d.device.shown().force.z, d.seen().last.on_probe_w.force.z, 0.05);
}

TEST(spacemouse_session, ends_with_zero_when_unplugged_and_does_not_rearm) {
  std::mt19937_64 bits(17);
  for (int run = 0; run < 40; ++run) {
    desk d(run % 2 == 0 ? spacemouse_kind::classic : spacemouse_kind::combined, 5.0);
    d.mouse.push({0, 0, 350, 0, 100, 0});
    d.run_until(150 * ms);
    d.mouse.release();
    const std::int64_t at = (200 + static_cast<std::int64_t>(bits() % 300)) * ms;
    d.run_until(at);
    ASSERT_GT(d.device.shown().force.z, 0.0);
    d.cable.unplug();
    d.run_until(at + ms);
    ASSERT_EQ(d.device.shown().force, vec3(0.0));
    ASSERT_EQ(d.device.state(), device_state::fault);
    ASSERT_EQ(d.device.fault(), spacemouse_fault::unplugged);
    ASSERT_EQ(d.session->device().gate().fault(), gate_fault::device_departed);
    ASSERT_EQ(d.seen().last.on_hand_d.force, vec3(0.0));
    d.cable.plug_in();
    d.run_until(at + 100 * ms);
    ASSERT_EQ(d.device.state(), device_state::fault);
    ASSERT_EQ(d.device.shown().force, vec3(0.0));
    // A person: clears both, opens, arms.
    ASSERT_TRUE(d.device.clear_fault() && d.device.open());
    ASSERT_EQ(d.device.state(), device_state::ready);
    ASSERT_TRUE(d.session->device().clear_fault());
    ASSERT_EQ(d.run_until(at + 200 * ms), status::ok);
    ASSERT_EQ(d.device.state(), device_state::ready);
    ASSERT_EQ(d.device.shown().force, vec3(0.0));
    ASSERT_TRUE(d.device.arm());
  }
}

TEST(spacemouse_session, shuts_its_gate_when_a_pushed_cap_falls_silent) {
  link_script silence{.events = {{.kind = link_fault::lose, .from_ns = 200 * ms}}};
  desk d(spacemouse_kind::combined, 5.0, silence);
  d.mouse.push({0, 0, 100, 0, 0, 0});
  EXPECT_EQ(d.run_until(250 * ms), status::ok);
  d.run_until(500 * ms);
  EXPECT_EQ(d.session->device().gate().fault(), gate_fault::bad_samples);
  EXPECT_EQ(d.device.state(), device_state::ready);  // the gate disarmed it
  EXPECT_EQ(d.device.shown().force, vec3(0.0));
}

// Every fault of the link begins at a seeded tick of a session that presses on the wall and shows the wrench.
TEST(spacemouse_session, keeps_its_limits_under_every_fault_of_the_link) {
  struct row {
    link_fault kind;
    const char* name;
    bool ends;  // whether the link itself says that something is wrong
  };
  const std::array rows{row{link_fault::lose, "lose", false},       row{link_fault::delay, "delay", false},
                        row{link_fault::reorder, "reorder", false}, row{link_fault::duplicate, "duplicate", false},
                        row{link_fault::shorten, "shorten", false}, row{link_fault::flip_bit, "flip bit", false},
                        row{link_fault::bus_off, "bus off", false}, row{link_fault::answer, "answer failed", true},
                        row{link_fault::unplug, "unplug", true}};
  std::mt19937_64 bits(23);
  for (const row& kind : rows) {
    int shut = 0;
    double largest_n = 0.0;
    std::int64_t longest_ns = 0;
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      const std::int64_t at = (150 + static_cast<std::int64_t>(bits() % 200)) * ms;
      const link_event e{.kind = kind.kind, .from_ns = at, .amount_ns = 40 * ms, .with = io_status::failed};
      desk d(seed % 2 == 0 ? spacemouse_kind::classic : spacemouse_kind::combined, 5.0, {.events = {e}, .seed = seed});
      d.mouse.push({0, 0, 350, 50, -50, 0});
      std::int64_t shut_ns = -1;
      for (std::int64_t t = ms; t <= 700 * ms; t += ms) {
        if (t == 160 * ms) d.mouse.push({0, 0, 30, 0, 0, 0});  // held
        d.run_until(t);
        const double shown_n = glm::length(d.device.shown().force);
        ASSERT_LE(shown_n, 5.0 * (1 + 1e-9)) << kind.name;
        largest_n = std::max(largest_n, shown_n);
        const gate_fault fault = d.session->device().gate().fault();
        if (fault == gate_fault::none) continue;
        if (shut_ns < 0) {
          shut_ns = t;
          ++shut;
          const gate_fault causes[]{gate_fault::device_failed, gate_fault::device_departed, gate_fault::bad_samples};
          ASSERT_NE(std::find(std::begin(causes), std::end(causes), fault), std::end(causes)) << to_string(fault);
        }
        if (shown_n > 0.0) longest_ns = std::max(longest_ns, t - shut_ns);
        ASSERT_FALSE(d.device.state() == device_state::active && t > shut_ns + 5 * ms) << kind.name;
      }
      if (kind.ends) {
        ASSERT_EQ(d.device.state(), device_state::fault);
        ASSERT_EQ(d.device.fault(),
                  kind.kind == link_fault::unplug ? spacemouse_fault::unplugged : spacemouse_fault::read_failed);
        ASSERT_EQ(d.session->device().gate().fault(), gate_fault::device_departed);
      } else {
        ASSERT_NE(d.device.state(), device_state::fault) << kind.name;
      }
    }
    // Lost or useless reports of a pushed cap are a silence, and end it; what still comes through does not.
    const bool silent = kind.kind == link_fault::lose || kind.kind == link_fault::shorten;
    EXPECT_EQ(shut > 0, silent || kind.ends) << kind.name;
    EXPECT_GT(largest_n, 0.3) << kind.name;
    EXPECT_LE(longest_ns, 2 * ms) << kind.name;
    std::printf("%-14s 8 sessions, largest %.2f N, ", kind.name, largest_n);
    if (shut == 0) {
      std::printf("none shut\n");
    } else {
      std::printf("%d shut, at zero within %lld ms\n", shut, static_cast<long long>(longest_ns / ms + 1));
    }
  }
}

TEST(spacemouse_session, two_at_once_do_not_touch_each_other) {
  desk a(spacemouse_kind::classic);
  desk b(spacemouse_kind::combined);
  a.mouse.push({0, 0, 350, 0, 0, 0});
  for (std::int64_t t = 0; t <= 400 * ms; t += ms) {
    if (t == 150 * ms) a.mouse.release();
    if (t == 200 * ms) b.cable.unplug();
    a.run_until(t);
    b.run_until(t);
  }
  EXPECT_EQ(b.device.state(), device_state::fault);
  EXPECT_EQ(a.device.state(), device_state::armed);
  EXPECT_EQ(a.session->device().gate().fault(), gate_fault::none);
  EXPECT_GT(a.seen().last.on_probe_w.force.z, 0.0);
  EXPECT_EQ(b.seen().on_probe_n, 0.0);
}

}  // namespace
