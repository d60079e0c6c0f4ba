#include <gtest/gtest.h>

#include <asperity/drivers/spacemouse/spacemouse_device.hpp>
#include <asperity/transport/virtual/virtual_hid.hpp>

#include "hardware/peers/fake_spacemouse.hpp"
#include "session/rt/tick_trap.hpp"

namespace {

using namespace asperity;
using test_support::fake_spacemouse;
using test_support::spacemouse_kind;

constexpr std::int64_t ms = 1'000'000;

// A fake on one end of a cable, the driver on the other.
struct bench {
  explicit bench(spacemouse_kind kind = spacemouse_kind::classic, link_script script = {},
                 spacemouse_settings settings = {})
      : cable(fake_spacemouse::descriptor(kind), std::move(script)),
        mouse(kind, [this](std::int64_t t, std::span<const std::uint8_t> r) { cable.send(t, r); }),
        device(
            [this]() -> result<std::unique_ptr<hid_link>> {
              if (!cable.plugged()) return error{error_code::io_failed, "the SpaceMouse is not plugged in"};
              ++opened;
              return cable.host_end();
            },
            settings) {}

  status run_to(std::int64_t until_ns) {
    status s = status::ok;
    for (; now < until_ns; now += ms) {
      mouse.step(now);
      deliver();
      s = device.read(now, seen);
    }
    return s;
  }
  void deliver() {
    std::array<std::uint8_t, 64> room{};
    std::size_t n = 0;
    while (cable.receive(now, room, n)) mouse.take(std::span<const std::uint8_t>(room).first(n));
  }

  virtual_hid cable;
  fake_spacemouse mouse;
  spacemouse_device device;
  device_sample seen{};
  std::int64_t now = 0;
  int opened = 0;
};

device_command newton(double x, wrench_frame frame = wrench_frame::device_base) {
  return {{{x, 0, 0}, {}}, frame, 1'000'000'000'000, 1};
}

TEST(spacemouse_motion, maps_the_cap_to_right_up_and_away) {
  // Full displacement along each device axis, and where the handle goes in d: x right, y away, z up.
  const std::array<vec3, 3> to{vec3(1, 0, 0), vec3(0, -1, 0), vec3(0, 0, -1)};
  for (std::size_t i = 0; i < 6; ++i) {
    for (const spacemouse_control c : {spacemouse_control::rate, spacemouse_control::position}) {
      spacemouse_motion m({.control = c});
      std::array<double, 6> share{};
      share[i] = 1.0;
      m.displace(share);
      for (int t = 0; t < 100; ++t) m.advance(ms);
      const vec3 way = m.T_dh().position;
      const vec3 turn = log_rotation(m.T_dh().rotation);
      const vec3 moved = i < 3 ? way : turn;
      const vec3 still = i < 3 ? turn : way;
      // Rate: 0.1 m/s and 1 rad/s for 0.1 s. Position: no faster than that.
      const double size = i < 3 ? 0.01 : 0.1;
      EXPECT_LT(glm::length(moved - size * to[i % 3]), 1e-12) << i;
      EXPECT_LT(glm::length(still), 1e-12) << i;
    }
  }
}

TEST(spacemouse_motion, has_a_dead_zone_without_a_step_and_stays_in_its_box) {
  spacemouse_motion m({.dead_zone = 0.1});
  m.displace({0.1, -0.1, 0.0999, 0, 0, 0});
  EXPECT_TRUE(m.at_rest());
  m.displace({0.1 + 1e-9, 0, 0, 0, 0, 0});
  m.advance(ms);
  EXPECT_GT(m.velocity_d().linear.x, 0.0);
  EXPECT_LT(m.velocity_d().linear.x, 1e-8);
  m.displace({1, 1, 1, 0, 0, 0});
  for (int t = 0; t < 5000; ++t) {
    m.advance(ms);
    ASSERT_LE(glm::length(m.velocity_d().linear), 0.1 * (1 + 1e-12));
  }
  EXPECT_EQ(m.T_dh().position, vec3(0.1, -0.1, -0.1));
  m.advance(ms);
  EXPECT_EQ(m.velocity_d().linear, vec3(0.0));  // at the wall of the box it stands
}

TEST(spacemouse_motion, returns_with_the_cap_in_position_control) {
  spacemouse_motion m({.control = spacemouse_control::position, .reach_m = 0.02, .reach_rad = 0.3, .dead_zone = 0.0});
  m.displace({0.5, 0, 0, 0, 0, -1});
  for (int t = 0; t < 1000; ++t) m.advance(ms);
  EXPECT_NEAR(m.T_dh().position.x, 0.01, 1e-12);
  EXPECT_NEAR(log_rotation(m.T_dh().rotation).z, 0.3, 1e-9);
  m.displace({});
  for (int t = 0; t < 1000; ++t) m.advance(ms);
  EXPECT_NEAR(glm::length(m.T_dh().position), 0.0, 1e-12);
  EXPECT_NEAR(glm::length(log_rotation(m.T_dh().rotation)), 0.0, 1e-9);
}

TEST(spacemouse_motion, moves_no_faster_than_it_may_whatever_comes_in) {
  const double inf = std::numeric_limits<double>::infinity();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::array<double, 12> values{0.0, 1.0, -1.0, 0.3, nan, inf, -inf, 1e300, -1e300, 93.6, -93.6, 5e-324};
  std::mt19937_64 bits(5);
  for (const bool broken : {false, true}) {
    spacemouse_motion_settings c;
    if (broken) {
      c.max_speed_m_per_s = inf;
      c.max_turn_rad_per_s = nan;
      c.reach_m = -1.0;
      c.dead_zone = nan;
      c.gain = {nan, inf, -5, 0, 1, 1};
      c.R_dn = quat(nan, 0, 0, 0);
      c.T_dh_start.position.x = nan;
      c.workspace_low_d.y = nan;
      c.workspace_high_d.z = -inf;
      c.longest_step_ns = -5;
    }
    for (const spacemouse_control control : {spacemouse_control::rate, spacemouse_control::position}) {
      c.control = control;
      spacemouse_motion m(c);
      for (int n = 0; n < 20'000; ++n) {
        std::array<double, 6> share{};
        for (double& s : share) s = values[bits() % values.size()];
        m.displace(share);
        const pose before = m.T_dh();
        const auto step = static_cast<std::int64_t>(bits() % (40 * ms)) - 5 * ms;
        m.advance(n % 1000 == 0 ? std::numeric_limits<std::int64_t>::max() : step);
        ASSERT_TRUE(is_valid(m.T_dh()));
        for (int i = 0; i < 3; ++i) ASSERT_LE(std::fabs(m.T_dh().position[i]), 0.1);
        if (!broken) {
          ASSERT_LE(glm::length(m.T_dh().position - before.position), 0.1 * 0.02 * (1 + 1e-9));
          ASSERT_LE(glm::length(log_rotation(m.T_dh().rotation * glm::conjugate(before.rotation))), 0.02 * (1 + 1e-6));
        }
      }
    }
  }
}

TEST(spacemouse_device, is_an_input_device_that_puts_out_nothing) {
  bench b;
  EXPECT_EQ(b.device.state(), device_state::present);
  device_sample s;
  EXPECT_EQ(b.device.read(0, s), status::not_ready);
  EXPECT_EQ(b.device.write(0, newton(1)), status::not_ready);
  EXPECT_FALSE(b.device.arm());
  ASSERT_TRUE(b.device.open());
  EXPECT_FALSE(b.device.open());
  const device_capabilities& c = b.device.capabilities();
  EXPECT_EQ(c.sensed, all_axes);
  EXPECT_EQ(c.actuated, no_axes);
  EXPECT_EQ(c.peak_force_n, 0.0);
  EXPECT_EQ(c.maturity, driver_maturity::protocol_tested);
  EXPECT_EQ(b.device.write(0, newton(1)), status::ok);  // ready: zero
  EXPECT_EQ(b.device.shown().force.x, 0.0);
  ASSERT_TRUE(b.device.arm());
  EXPECT_EQ(b.device.write(0, newton(1)), status::ok);
  EXPECT_EQ(b.device.state(), device_state::active);
  EXPECT_EQ(b.device.shown().force.x, 1.0);
  EXPECT_EQ(b.device.write(0, newton(0)), status::ok);
  EXPECT_EQ(b.device.state(), device_state::armed);
  EXPECT_EQ(b.device.disarm(), status::ok);
  EXPECT_EQ(b.device.state(), device_state::ready);
  b.device.close();
  EXPECT_EQ(b.device.state(), device_state::closed);
  EXPECT_TRUE(b.device.open());
}

TEST(spacemouse_device, follows_the_cap_in_both_formats) {
  for (const spacemouse_kind kind : {spacemouse_kind::classic, spacemouse_kind::combined}) {
    bench b(kind);
    ASSERT_TRUE(b.device.open());
    b.run_to(100 * ms);
    EXPECT_EQ(b.seen.T_dh.position, vec3(0.0));
    b.mouse.push({350, 0, 0, 0, 0, -350});
    b.run_to(300 * ms);
    b.mouse.release();
    b.run_to(400 * ms);
    const pose rest = b.seen.T_dh;
    EXPECT_NEAR(rest.position.x, 0.02, 0.002);              // 0.1 m/s for 0.2 s
    EXPECT_NEAR(log_rotation(rest.rotation).z, 0.2, 0.02);  // device z is down
    b.run_to(2000 * ms);
    EXPECT_EQ(b.seen.T_dh.position, rest.position);
    EXPECT_EQ(b.device.counts().silences, 0U);
    EXPECT_EQ(b.seen.lost, 0U);
    EXPECT_EQ(b.device.counts().too_short, 0U);
    EXPECT_EQ(b.device.counts().unknown, 0U);
  }
}

TEST(spacemouse_device, is_fresh_at_rest_and_stale_when_a_pushed_cap_falls_silent) {
  bench b;
  ASSERT_TRUE(b.device.open());
  // At rest: not one report in ten minutes' worth of reads, and every sample is new.
  b.run_to(50 * ms);
  const std::uint64_t first = b.seen.sequence;
  b.run_to(60'000 * ms);
  EXPECT_EQ(b.device.counts().reports, 0U);
  EXPECT_EQ(b.seen.sequence, first + 59'950);
  EXPECT_EQ(b.seen.host_time_ns, b.now - ms);
  // Pushed, and then the air swallows everything.
  b.mouse.push({100, 0, 0, 0, 0, 0});
  b.run_to(b.now + 100 * ms);
  const std::int64_t silent_from = b.now;
  for (; b.now < silent_from + 500 * ms; b.now += ms) ASSERT_EQ(b.device.read(b.now, b.seen), status::ok);
  EXPECT_EQ(b.device.counts().silences, 1U);
  EXPECT_NEAR(static_cast<double>(b.seen.host_time_ns - silent_from), 100e6, 10e6);
  const device_sample old = b.seen;
  static_cast<void>(b.device.read(b.now, b.seen));
  EXPECT_EQ(b.seen.sequence, old.sequence);
  EXPECT_EQ(b.seen.T_dh.position, old.T_dh.position);
  // It comes back, and the pose goes on from where it stood.
  b.run_to(b.now + 20 * ms);
  EXPECT_GT(b.seen.sequence, old.sequence);
  EXPECT_LT(glm::length(b.seen.T_dh.position - old.T_dh.position), 0.0025);
}

TEST(spacemouse_device, reports_buttons_battery_and_light) {
  bench b(spacemouse_kind::combined);
  ASSERT_TRUE(b.device.open());
  b.mouse.press(0, 2);
  b.mouse.report_battery(0, 42, true);
  b.run_to(5 * ms);
  EXPECT_EQ(b.seen.buttons, 2U);
  EXPECT_TRUE(has_all(b.seen.valid, sample_field::buttons));
  EXPECT_EQ(b.device.input().battery_percent, 42);
  EXPECT_TRUE(b.device.input().charging);
  ASSERT_TRUE(b.device.set_light(true));
  b.run_to(6 * ms);
  EXPECT_TRUE(b.mouse.light());
  ASSERT_TRUE(b.device.set_light(false));
  b.run_to(7 * ms);
  EXPECT_FALSE(b.mouse.light());
  EXPECT_EQ(b.mouse.not_understood(), 0);
}

TEST(spacemouse_device, counts_what_was_lost) {
  bench b(spacemouse_kind::classic);
  ASSERT_TRUE(b.device.open());
  const std::array<std::uint8_t, 7> shift{1, 10, 0, 0, 0, 0, 0};
  const std::array<std::uint8_t, 7> turn{2, 0, 0, 0, 0, 0, 0};
  b.cable.send(0, shift);
  b.cable.send(0, turn);
  b.cable.send(0, shift);
  b.cable.send(0, shift);                                         // a turn is missing
  b.cable.send(0, std::span<const std::uint8_t>(turn).first(5));  // and this one is useless
  b.run_to(ms);
  EXPECT_EQ(b.seen.lost, 2U);
  EXPECT_EQ(b.device.counts().too_short, 1U);
}

TEST(spacemouse_device, is_not_held_up_by_a_flood) {
  struct flood final : hid_link {
    std::uint64_t calls = 0;
    [[nodiscard]] std::span<const std::uint8_t> report_descriptor() const noexcept override { return {}; }
    [[nodiscard]] io_status read(std::int64_t, std::span<std::uint8_t> b, hid_report& r) noexcept override {
      ++calls;
      b[0] = 1;
      r.size = 1000;  // more than there is room for
      return io_status::ok;
    }
    [[nodiscard]] io_status write(std::int64_t, std::span<const std::uint8_t>) noexcept override {
      return io_status::ok;
    }
  };
  flood* link = nullptr;
  spacemouse_device d([&]() -> result<std::unique_ptr<hid_link>> {
    auto made = std::make_unique<flood>();
    link = made.get();
    return std::unique_ptr<hid_link>(std::move(made));
  });
  ASSERT_TRUE(d.open());
  device_sample s;
  ASSERT_EQ(d.read(0, s), status::ok);
  EXPECT_EQ(link->calls, 128U);
}

TEST(spacemouse_device, is_absent_when_unplugged_and_opens_again_from_another_path) {
  bench b;
  ASSERT_TRUE(b.device.open());
  b.run_to(10 * ms);
  b.cable.unplug();
  EXPECT_EQ(b.run_to(11 * ms), status::not_ready);
  EXPECT_EQ(b.device.state(), device_state::absent);
  EXPECT_EQ(b.device.fault(), spacemouse_fault::unplugged);
  EXPECT_FALSE(b.device.open());
  b.cable.plug_in();
  EXPECT_EQ(b.run_to(20 * ms), status::not_ready);  // nothing comes back by itself
  ASSERT_TRUE(b.device.open());
  EXPECT_EQ(b.opened, 2);
  EXPECT_EQ(b.device.state(), device_state::ready);
  EXPECT_EQ(b.run_to(30 * ms), status::ok);
}

TEST(spacemouse_device, latches_a_fault_when_unplugged_armed_and_never_arms_itself) {
  bench b;
  ASSERT_TRUE(b.device.open() && b.device.arm());
  ASSERT_EQ(b.device.write(0, newton(1)), status::ok);
  b.cable.unplug();
  EXPECT_EQ(b.run_to(ms), status::not_ready);
  EXPECT_EQ(b.device.state(), device_state::fault);
  EXPECT_EQ(b.device.shown().force.x, 0.0);
  b.cable.plug_in();
  EXPECT_FALSE(b.device.open());
  EXPECT_FALSE(b.device.arm());
  b.run_to(100 * ms);
  EXPECT_EQ(b.device.state(), device_state::fault);
  ASSERT_TRUE(b.device.clear_fault());
  EXPECT_EQ(b.device.state(), device_state::closed);
  ASSERT_TRUE(b.device.open());
  EXPECT_EQ(b.device.state(), device_state::ready);  // not armed
}

TEST(spacemouse_device, refuses_commands_that_make_no_sense) {
  for (const device_command& bad : {newton(std::nan("")), newton(1, wrench_frame::world),
                                    newton(1, wrench_frame::unset), newton(std::numeric_limits<double>::infinity())}) {
    bench b;
    ASSERT_TRUE(b.device.open() && b.device.arm());
    EXPECT_EQ(b.device.write(0, bad), status::not_finite);
    EXPECT_EQ(b.device.state(), device_state::fault);
    EXPECT_EQ(b.device.fault(), spacemouse_fault::bad_command);
  }
}

// A scripted half second: push, buttons, light, release. @return statuses of read that were not ok
int half_second(bench& b) {
  int bad = 0;
  for (int t = 0; t < 500; ++t, b.now += ms) {
    if (t == 50) b.mouse.push({200, -200, 100, 50, 0, -300});
    if (t == 300) b.mouse.release();
    if (t == 100) b.mouse.press(b.now, 1);
    b.mouse.step(b.now);
    b.deliver();
    bad += b.device.read(b.now, b.seen) != status::ok ? 1 : 0;
    static_cast<void>(b.device.write(b.now, newton(0.5)));
    if (t == 200) static_cast<void>(b.device.set_light(true));
    EXPECT_TRUE(is_valid(b.seen.T_dh) && is_finite(b.seen.velocity_d.linear));
  }
  return bad;
}

TEST(spacemouse_device, fails_safely_at_every_call_of_the_link) {
  bench good;
  ASSERT_TRUE(good.device.open() && good.device.arm());
  ASSERT_EQ(half_second(good), 0);
  const std::uint64_t calls = good.cable.calls();
  ASSERT_GT(calls, 500U);
  for (std::uint64_t n = 0; n < calls; ++n) {
    const std::array all{io_status::failed, io_status::gone,    io_status::too_short, io_status::busy,
                         io_status::down,   io_status::refused, io_status::ok,        io_status::nothing};
    const io_status with = all[n % all.size()];
    bench b(spacemouse_kind::classic, {.events = {fail_call(n, with)}});
    ASSERT_TRUE(b.device.open() && b.device.arm());
    const int bad = half_second(b);
    const bool harmless = with == io_status::ok || with == io_status::nothing;
    const bool was_light = b.device.state() != device_state::fault && bad == 0;
    if (harmless || was_light) {
      ASSERT_EQ(bad, 0) << n << " " << to_string(with);
      ASSERT_EQ(b.device.shown().force.x, 0.5);
      ASSERT_TRUE(harmless || !b.mouse.light()) << n;  // only the switching of the light may fail without a fault
      continue;
    }
    ASSERT_EQ(b.device.state(), device_state::fault) << n << " " << to_string(with);
    ASSERT_EQ(b.device.shown().force.x, 0.0);
    ASSERT_EQ(b.device.fault(), with == io_status::gone ? spacemouse_fault::unplugged : spacemouse_fault::read_failed);
  }
  std::printf("%llu calls, each failed once\n", static_cast<unsigned long long>(calls));
}

TEST(spacemouse_device, stays_within_its_box_under_every_fault_of_the_link) {
  const std::array kinds{link_fault::lose,      link_fault::delay,   link_fault::reorder,
                         link_fault::duplicate, link_fault::shorten, link_fault::flip_bit,
                         link_fault::answer,    link_fault::bus_off, link_fault::unplug};
  for (const link_fault kind : kinds) {
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      const link_event e{.kind = kind,
                         .from_ns = static_cast<std::int64_t>(seed) * 40 * ms,
                         .share = kind == link_fault::unplug || kind == link_fault::answer ? 0.01 : 0.3,
                         .amount_ns = 30 * ms,
                         .with = io_status::failed};
      bench b(seed % 2 == 0 ? spacemouse_kind::classic : spacemouse_kind::combined, {.events = {e}, .seed = seed});
      ASSERT_TRUE(b.device.open() && b.device.arm());
      const int bad = half_second(b);
      for (int i = 0; i < 3; ++i) ASSERT_LE(std::fabs(b.seen.T_dh.position[i]), 0.1);
      if (kind == link_fault::unplug || kind == link_fault::answer) {
        ASSERT_EQ(bad > 0, b.device.state() == device_state::fault);
      } else {
        ASSERT_EQ(bad, 0);
      }
    }
  }
}

TEST(spacemouse_device, does_in_a_tick_what_a_tick_may_do) {
  if (const std::string why = test_support::tick_trap::missing(); !why.empty()) GTEST_SKIP() << why;
  bench b;
  ASSERT_TRUE(b.device.open() && b.device.arm());
  test_support::tick_trap trap;
  std::array<std::uint8_t, 7> report{1, 100, 0, 0, 0, 0, 0};
  for (int t = 0; t < 2000; ++t) {
    report[0] = static_cast<std::uint8_t>(1 + t % 2);
    if (t % 8 == 0) b.cable.send(t * ms, report);
    if (t == 1900) b.cable.unplug();
    trap([&]() noexcept {
      static_cast<void>(b.device.read(t * ms, b.seen));
      static_cast<void>(b.device.write(t * ms, newton(0.1)));
      if (t == 1950) static_cast<void>(b.device.disarm());
    });
  }
  EXPECT_EQ(trap.ticks(), 2000U);
  EXPECT_EQ(b.device.state(), device_state::fault);
}

}  // namespace
