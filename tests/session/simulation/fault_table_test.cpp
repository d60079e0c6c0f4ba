// Every fault, at a random tick of a running session, a thousand times and more: the wrench at the device stays within
// its limits in every tick, reaches zero in the stated time, the fault names its cause, and nothing arms again.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <vector>

#include "asperity/control/virtual_session.hpp"
#include "asperity/device/simulated/simulated_device.hpp"
#include "session/simulation/dice.hpp"
#include "unit/control/analytic_wall.hpp"

namespace {

using namespace asperity;
using simulation::dice;
using test_support::analytic_wall;

constexpr std::int64_t ms = 1'000'000;
constexpr int sessions_per_fault = 50;
constexpr std::int64_t watchdog_ns = 40 * ms;

struct setting {
  simulated_settings device{};
  control_settings control{};
  std::int64_t fault_ns = 0;
};

// A hand that presses onto the wall with a force that is felt long before the fault.
setting draw(std::uint64_t seed) {
  dice d(seed);
  setting s;
  s.device.seed = seed;
  s.device.motion = {.kind = d.chance(0.5) ? motion_kind::scrub : motion_kind::press,
                     .T_dh = {quat(1, 0, 0, 0), {d.between(-0.01, 0.01), 0.0, 0.001}},
                     .depth_m = d.between(0.008, 0.02),
                     .approach_s = d.between(0.05, 0.15),
                     .frequency_hz = d.between(0.5, 4.0)};
  s.device.hand = d.chance(0.5) ? firm_hand() : soft_hand();
  device_capabilities& c = s.device.capabilities;
  c.peak_force_n = d.log_between(2.0, 40.0);
  c.continuous_force_n = c.peak_force_n * d.between(0.3, 1.0);
  c.force_slew_n_per_s = d.log_between(500.0, 20000.0);
  c.peak_torque_n_m = d.log_between(0.05, 2.0);
  c.continuous_torque_n_m = c.peak_torque_n_m * d.between(0.3, 1.0);
  c.torque_slew_n_m_per_s = d.log_between(30.0, 1000.0);
  s.control.low_pass_hz = d.chance(0.3) ? d.log_between(20.0, 500.0) : output_gate::no_low_pass;
  s.control.watchdog_ns = watchdog_ns;
  s.fault_ns = static_cast<std::int64_t>(d.between(200.0, 350.0)) * ms;
  return s;
}

// What the motors did in one tick, against the limits; what fell to zero at once was silenced, which is allowed.
class output_watch {
 public:
  explicit output_watch(const device_capabilities& c) : c_(&c) {}

  void look(std::int64_t now_ns, const wrench& out, std::uint64_t seed) {
    constexpr double room = 1.0 + 1e-7;
    ASSERT_TRUE(is_finite(out)) << "seed " << seed;
    ASSERT_LE(glm::length(out.force), c_->peak_force_n * room) << "seed " << seed;
    ASSERT_LE(glm::length(out.torque), c_->peak_torque_n_m * room) << "seed " << seed;
    const bool zero = out.force == vec3(0.0) && out.torque == vec3(0.0);
    if (!zero) {
      ASSERT_LE(glm::length(out.force - last_.force), 1e-3 * c_->force_slew_n_per_s * room) << "seed " << seed;
      ASSERT_LE(glm::length(out.torque - last_.torque), 1e-3 * c_->torque_slew_n_m_per_s * room) << "seed " << seed;
      pushed_ns_ = now_ns;
    }
    last_ = out;
  }

  /// When the motors were last seen to push.
  [[nodiscard]] std::int64_t pushed_ns() const { return pushed_ns_; }
  [[nodiscard]] bool pushes() const { return last_.force != vec3(0.0) || last_.torque != vec3(0.0); }

 private:
  const device_capabilities* c_;
  wrench last_{};
  std::int64_t pushed_ns_ = std::numeric_limits<std::int64_t>::min();
};

struct row {
  std::string fault;
  int sessions = 0;
  int felt = 0;               // sessions in which the motors pushed when the fault came
  std::int64_t worst_ns = 0;  // from the injection to zero at the device
  double worst_share = 0.0;   // of the stated time
  std::string causes;

  void add(std::int64_t taken_ns, std::int64_t stated_ns, gate_fault cause) {
    ++sessions;
    worst_ns = std::max(worst_ns, taken_ns);
    worst_share = std::max(worst_share, static_cast<double>(taken_ns) / static_cast<double>(stated_ns));
    const std::string name = to_string(cause);
    if (causes.find(name) == std::string::npos) causes += (causes.empty() ? "" : ", ") + name;
  }
};

// Stated: `detect` until nothing is wanted, peak / slew until nothing is sent, a tick until the motors were seen.
std::int64_t stated_time_ns(const gate_limits& l, std::int64_t detect_ns) {
  return detect_ns + time_to_zero_ns(l, ms) + ms;
}

enum class by_hand { nothing, silence, stop, interrupt, replug, stop_later };

// One fault in a whole session: the device, the probe, the guard, the gate.
struct session_fault {
  const char* name;
  device_fault kind;
  bool scripted;
  by_hand also;
  std::int64_t detect_ns;
  std::vector<gate_fault> causes;
};

void run_one(const session_fault& f, std::uint64_t seed, row& out) {
  setting s = draw(seed);
  const std::int64_t forever = std::numeric_limits<std::int64_t>::max();
  if (f.scripted) s.device.faults = {{f.kind, s.fault_ns, forever}};
  if (f.also == by_hand::replug) s.device.faults = {{f.kind, s.fault_ns, s.fault_ns + ms}};
  simulated_device dev(s.device);
  ASSERT_TRUE(dev.open() && dev.arm());
  virtual_session<analytic_wall, simulated_device> session({}, {{pose{}}, vec3(0.0)}, dev, s.control);
  const output_gate& gate = session.device().gate();
  output_watch watch(dev.capabilities());
  const std::int64_t stated = stated_time_ns(gate.limits(), f.detect_ns);
  std::int64_t from_ns = s.fault_ns + (f.also == by_hand::stop_later ? 100 * ms : 0);
  bool pushed = false;
  while (session.now_ns() < from_ns + stated + 60 * ms) {
    const std::int64_t now = session.now_ns();
    if (f.also != by_hand::silence || now < s.fault_ns) session.beat();
    if (now == s.fault_ns) pushed = watch.pushes();
    if (now == from_ns) {
      if (f.also == by_hand::stop || f.also == by_hand::stop_later) session.device().stop();
      if (f.also == by_hand::interrupt) session.device().stop(gate_fault::interrupted);
    }
    if (f.also == by_hand::replug && now == s.fault_ns + 30 * ms) dev.plug_in();
    static_cast<void>(session.step());
    watch.look(now, dev.put_out(), seed);
    if (testing::Test::HasFatalFailure()) return;
  }
  const std::int64_t taken = std::max<std::int64_t>(0, watch.pushed_ns() - from_ns);
  EXPECT_LE(taken, stated) << f.name << ", seed " << seed;
  EXPECT_TRUE(std::find(f.causes.begin(), f.causes.end(), gate.fault()) != f.causes.end())
      << f.name << ", seed " << seed << ": " << to_string(gate.fault());
  EXPECT_FALSE(may_put_out(dev.state())) << f.name << ": armed after its fault, seed " << seed;
  EXPECT_TRUE(gate.flight().frozen());
  EXPECT_GT(gate.flight().size(), 0U);

  // A person clears, opens, and is ready: armed only by arming.
  if (f.also == by_hand::replug) {
    EXPECT_EQ(dev.path(), "simulated:1");
    EXPECT_FALSE(dev.arm());
    EXPECT_TRUE(dev.clear_fault() && dev.open());
    EXPECT_EQ(dev.state(), device_state::ready);
    EXPECT_TRUE(session.device().clear_fault());
    for (int i = 0; i < 20; ++i) {
      session.beat();
      static_cast<void>(session.step());
      EXPECT_EQ(dev.put_out().force, vec3(0.0));
    }
    EXPECT_EQ(dev.state(), device_state::ready);
  }
  out.felt += pushed ? 1 : 0;
  out.add(taken, stated, f.also == by_hand::replug ? gate_fault::device_departed : gate.fault());
}

// One fault in what an application hands to the gate, in a loop of its own around a spring.
struct command_fault {
  const char* name;
  double bad;
  std::int64_t late_ns;
  wrench_frame frame;
  gate_fault cause;
};

void run_one(const command_fault& f, std::uint64_t seed, row& out) {
  const setting s = draw(seed);
  dice d(seed ^ 0x62616e67);
  simulated_device dev(s.device);
  ASSERT_TRUE(dev.open() && dev.arm());
  output_gate gate(limits_of(dev.capabilities()), 20 * ms, s.control.low_pass_hz);
  output_watch watch(dev.capabilities());
  const std::int64_t stated = stated_time_ns(gate.limits(), 0);
  const std::size_t where = d.below(6);
  const bool lasts = d.chance(0.5);
  for (std::int64_t now = 0; now < s.fault_ns + stated + 60 * ms; now += ms) {
    device_sample seen;
    ASSERT_EQ(dev.read(now, seen), status::ok);
    device_command c{{-500.0 * seen.T_dh.position, {0.01, 0.0, 0.0}}, wrench_frame::device_base, now, 1};
    if (now == s.fault_ns || (lasts && now > s.fault_ns)) {
      if (f.bad != 0.0) (where < 3 ? c.on_hand.force : c.on_hand.torque)[static_cast<int>(where % 3)] = f.bad;
      c.valid_until_ns -= f.late_ns;
      c.frame = f.frame;
    }
    ASSERT_EQ(dev.write(now, gate.pass(now, seen, c)), status::ok);
    if (gate.fault() != gate_fault::none && gate.at_rest()) static_cast<void>(dev.disarm());
    watch.look(now, dev.put_out(), seed);
    if (now == s.fault_ns && watch.pushes()) ++out.felt;
    if (testing::Test::HasFatalFailure()) return;
  }
  const std::int64_t taken = std::max<std::int64_t>(0, watch.pushed_ns() - s.fault_ns);
  EXPECT_LE(taken, stated) << f.name << ", seed " << seed;
  EXPECT_EQ(gate.fault(), f.cause) << f.name << ", seed " << seed;
  EXPECT_EQ(gate.fault_time_ns(), s.fault_ns) << f.name << ", seed " << seed;
  EXPECT_EQ(dev.state(), device_state::ready);
  out.add(taken, stated, gate.fault());
}

template <class Fault>
void run_all(const Fault& f, std::uint64_t& seed, int& sessions) {
  row r;
  r.fault = f.name;
  for (int i = 0; i < sessions_per_fault; ++i) {
    run_one(f, ++seed, r);
    if (testing::Test::HasFatalFailure()) return;
  }
  std::printf("%-26s %8d %14.0f %17.0f %%  %s\n", r.fault.c_str(), r.sessions, 1e-6 * static_cast<double>(r.worst_ns),
              100.0 * r.worst_share, r.causes.c_str());
  EXPECT_GE(r.felt, r.sessions * 9 / 10) << f.name << ": most sessions push when the fault comes";
  sessions += r.sessions;
}

TEST(fault_table, every_fault_at_a_random_tick_ends_in_zero_with_its_cause) {
  using G = gate_fault;
  using D = device_fault;
  const std::vector<G> samples{G::bad_samples};
  // Where a low-pass is set, it takes its time over the zero that is wanted until the rejections make a fault.
  const std::int64_t rejects = sample_check_settings{}.reject_limit * ms;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const auto base = wrench_frame::device_base;
  const std::vector<command_fault> commands{
      {"NaN in the command", nan, 0, base, G::not_finite},
      {"infinity in the command", infinity, 0, base, G::not_finite},
      {"1e300 in the command", 1e300, 0, base, G::not_finite},
      {"command out of date", 0.0, 1, base, G::stale_command},
      {"command in a wrong frame", 0.0, 0, wrench_frame::world, G::wrong_frame},
  };
  const std::vector<session_fault> sessions_faults{
      {"NaN in the pose", D::nan_pose, true, by_hand::nothing, rejects, samples},
      {"infinity in the pose", D::infinite_pose, true, by_hand::nothing, rejects, samples},
      {"rotation not of length 1", D::bad_rotation, true, by_hand::nothing, rejects, samples},
      {"jump of the pose", D::jump, true, by_hand::nothing, rejects, samples},
      {"no answer to a read", D::drop, true, by_hand::nothing, rejects, samples},
      {"samples that stand still", D::stale, true, by_hand::nothing, 20 * ms + rejects, samples},
      {"write refused", D::refuse_write, true, by_hand::nothing, ms, {G::device_failed}},
      {"device's own fault", D::overheat, true, by_hand::nothing, 0, {G::device_failed}},
      {"unplugged", D::depart, true, by_hand::nothing, 0, {G::device_departed}},
      {"unplugged and returned", D::depart, true, by_hand::replug, 0, {G::device_departed}},
      {"application stalled", D::drop, false, by_hand::silence, watchdog_ns + 2 * ms, {G::watchdog}},
      {"stop", D::drop, false, by_hand::stop, 0, {G::stopped}},
      {"SIGINT", D::drop, false, by_hand::interrupt, 0, {G::interrupted}},
      {"encoder stuck, then stop", D::stuck_encoder, true, by_hand::stop_later, 0, {G::stopped}},
      {"slow replies, then stop", D::slow_reply, true, by_hand::stop_later, 0, {G::stopped}},
      {"90 % loss, then stop", D::loss, true, by_hand::stop_later, 0, {G::stopped, G::bad_samples}},
  };
  std::printf("%-26s %8s %14s %19s  %s\n", "fault", "sessions", "worst ms to 0", "of the stated time", "cause");
  std::uint64_t seed = 0;
  int sessions = 0;
  for (const session_fault& f : sessions_faults) run_all(f, seed, sessions);
  for (const command_fault& f : commands) run_all(f, seed, sessions);
  std::printf("%d sessions\n", sessions);
  EXPECT_GE(sessions, 1000);
}

}  // namespace
