// A six-joint arm over real CAN interfaces: fake drives and mechanics in a thread of their own, each on its bus through
// the kernel, and the device felt against a wall through joint torques. Times are long, because an emulated machine is
// slow; how late anything is is printed and not judged.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <gtest/gtest.h>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include "asperity/can/socketcan.hpp"
#include "asperity/control/virtual_session.hpp"
#include "asperity/drivers/articulated/articulated_device.hpp"
#include "asperity/drivers/canopen/canopen_master.hpp"
#include "hardware/arm/arm_parts.hpp"
#include "hardware/kernel/can_support.hpp"
#include "hardware/kernel/network.hpp"
#include "session/passivity/energy_bound.hpp"
#include "unit/control/analytic_wall.hpp"

namespace asperity::arm_kernel_test {
namespace {

using namespace asperity::test_support;
using can_kernel_test::now_ns;

constexpr std::array<const char*, arm_buses> names{"vcanarm0", "vcanarm1", "vcanarm2"};
constexpr std::int64_t period_ns = 5'000'000;
constexpr double surface_m = -0.006;  // under the handle's first height

class monotonic_clock final : public io_clock {
 public:
  [[nodiscard]] std::int64_t now_ns() noexcept override { return can_kernel_test::now_ns(); }
  void wait_until_ns(std::int64_t due_ns) noexcept override {
    const timespec due{static_cast<std::time_t>(due_ns / 1'000'000'000), static_cast<long>(due_ns % 1'000'000'000)};
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, nullptr) != 0) {
    }
  }
};

/// What lies behind the buses: six drives, the arm's mechanics, a hand that goes down onto the wall.
class world {
 public:
  explicit world(std::array<std::unique_ptr<can_bus>, arm_buses> ends) : ends_(std::move(ends)) {
    fake_arm_settings c = arm_mechanics();
    c.motion = {.T_dh = forward(c.chain, arm_start_rad).T_dh, .depth_m = 0.016, .approach_s = 1.2};
    c.step_ns = 2'000'000;
    for (std::size_t b = 0; b < arm_buses; ++b) split_[b] = std::make_unique<shared_end>(*ends_[b]);
    for (std::size_t i = 0; i < arm_joints; ++i) {
      fakes_[i] = std::make_unique<fake_cia402>(
          fake_cia402_settings{.node = arm_node(i), .rated_torque_m_n_m = arm_rated_m_n_m(i)},
          split_[i / 2]->ends[i % 2]);
    }
    plant_ = std::make_unique<fake_arm>(c);
    thread_ = std::thread([this] { run(); });
  }
  ~world() {
    stop_ = true;
    thread_.join();
  }
  world(const world&) = delete;
  world& operator=(const world&) = delete;

  /// The mechanics begin to move; until then the joints stand still.
  void begin() { moving_ = true; }

  /// Runs something while the world stands still.
  template <class F>
  auto look(F&& f) {
    const std::lock_guard<std::mutex> hold(standing_);
    return f(*plant_, fakes_);
  }

 private:
  // Two drives on one end of a bus: what comes is handed to both. A kernel would give each a socket; this saves three.
  struct shared_end {
    explicit shared_end(can_bus& b) : ends{end(b), end(b)} {
      ends[0].other = &ends[1];
      ends[1].other = &ends[0];
    }
    struct end final : can_bus {
      explicit end(can_bus& b) : bus(&b) {}
      end(const end& e) : bus(e.bus) {}
      io_status send(std::int64_t now, const can_frame& f) noexcept override { return bus->send(now, f); }
      io_status receive(std::int64_t now, can_frame& f) noexcept override {
        if (waiting.empty()) {
          const io_status s = bus->receive(now, f);
          if (s != io_status::ok) return s;
          static_cast<void>(other->waiting.push_back(f));
          return s;
        }
        f = waiting[0];
        for (std::size_t i = 1; i < waiting.size(); ++i) waiting[i - 1] = waiting[i];
        waiting.truncate(waiting.size() - 1);
        return io_status::ok;
      }
      can_health health() const noexcept override { return bus->health(); }
      bool takes_fd() const noexcept override { return false; }
      can_bus* bus;
      end* other = nullptr;
      fixed_vector<can_frame, 64> waiting{};
    };
    std::array<end, 2> ends;
  };

  void run() {
    while (!stop_) {
      {
        const std::lock_guard<std::mutex> hold(standing_);
        const std::int64_t now = can_kernel_test::now_ns();
        joint_vector torques{};
        for (std::size_t i = 0; i < arm_joints; ++i) {
          fakes_[i]->step(now);
          torques[i] = joint_torque(*fakes_[i], i);
        }
        plant_->set_torques(torques);
        // Where the whole machine stood still, the mechanics did as well.
        if (moving_) plant_->advance(plant_ns_ += std::min<std::int64_t>(now - last_ns_, 4'000'000));
        last_ns_ = now;
        for (std::size_t i = 0; i < arm_joints; ++i) move_encoder(*fakes_[i], i, plant_->q()[i], plant_->qd()[i]);
      }
      can_kernel_test::sleep_ms(2);
    }
  }

  std::array<std::unique_ptr<can_bus>, arm_buses> ends_;
  std::array<std::unique_ptr<shared_end>, arm_buses> split_;
  std::array<std::unique_ptr<fake_cia402>, arm_joints> fakes_;
  std::unique_ptr<fake_arm> plant_;
  std::int64_t plant_ns_ = 0;
  std::int64_t last_ns_ = 0;
  std::mutex standing_;
  std::atomic<bool> stop_{false};
  std::atomic<bool> moving_{false};
  std::thread thread_;
};

using motors = std::array<std::unique_ptr<fake_cia402>, arm_joints>;

class arm : public testing::Test {
 protected:
  void SetUp() override {
    if (const std::string reason = can_kernel_test::why_not(); !reason.empty()) GTEST_SKIP() << reason;
    for (const char* name : names) {
      network::remove(name);
      if (network::add_vcan(name) != 0 || network::set_up(name, true) != 0) {
        GTEST_SKIP() << "this kernel has no virtual CAN interface (modprobe vcan)";
      }
    }
    std::array<std::unique_ptr<can_bus>, arm_buses> far;
    articulated_settings c;
    for (std::size_t b = 0; b < arm_buses; ++b) {
      far[b] = open(b);
      hosts_[b] = open(b);
      ASSERT_TRUE(far[b] && hosts_[b]);
      c.buses.push_back({hosts_[b].get(), &masters_[b]});
    }
    cia402_settings slow;
    slow.host_silence_ms = 1000;
    slow.drive_silence_ns = 3'000'000'000;
    slow.boot_limit_ns = 20'000'000'000;
    slow.answer_limit_ns = 500'000'000;
    slow.state_limit_ns = 10'000'000'000;
    c.chain = desk_arm();
    c.clock = &clock_;
    c.period_ns = period_ns;
    c.reading_limit_ns = 2'000'000'000;
    c.open_limit_ns = 40'000'000'000;
    c.arm_limit_ns = 20'000'000'000;
    c.gravity_ramp_ns = 100'000'000;
    c.rest_rad = arm_start_rad;
    for (std::size_t i = 0; i < arm_joints; ++i) {
      drives_[i] = std::make_unique<cia402_drive>(arm_motor(i, slow));
      c.joints.push_back(arm_joint_of(i, *drives_[i]));
    }
    auto made = articulated_device::make(std::move(c));
    ASSERT_TRUE(made) << made.error().message;
    world_ = std::make_unique<world>(std::move(far));
    dev_ = std::make_unique<articulated_device>(std::move(*made));
    const result<void> opened = dev_->open();
    ASSERT_TRUE(opened) << opened.error().message;
    const result<void> armed = dev_->arm();
    ASSERT_TRUE(armed) << armed.error().message;
  }
  void TearDown() override {
    dev_.reset();
    world_.reset();
    for (const char* name : names) network::remove(name);
  }

  static std::unique_ptr<can_bus> open(std::size_t b) {
    auto bus = can::open_socketcan(names[b]);
    EXPECT_TRUE(bus) << (bus ? "" : bus.error().message);
    return bus ? std::move(bus).value() : nullptr;
  }
  [[nodiscard]] bool all_at_zero() {
    return world_->look([](fake_arm&, motors& m) {
      for (const auto& f : m) {
        if (f->torque_permille() != 0) return false;
      }
      return true;
    });
  }

  monotonic_clock clock_{};
  std::array<std::unique_ptr<can_bus>, arm_buses> hosts_;
  std::array<canopen_master, arm_buses> masters_;
  std::array<std::unique_ptr<cia402_drive>, arm_joints> drives_;
  std::unique_ptr<world> world_;
  std::unique_ptr<articulated_device> dev_;
};

struct watch {
  session_record last{};
  std::uint64_t touching = 0;
  double largest_force_n = 0.0;
  void operator()(const session_record& r) noexcept {
    last = r;
    if (r.contacts > 0) ++touching;
    largest_force_n = std::max(largest_force_n, glm::length(r.on_hand_d.force));
  }
};

TEST_F(arm, feels_a_wall_through_joint_torques_and_stays_passive) {
  device_sample in;
  for (int i = 0; i < 30; ++i) {  // until gravity is compensated
    clock_.wait_until_ns(now_ns() + period_ns);
    ASSERT_EQ(dev_->read(now_ns(), in), status::ok) << dev_->fault_words();
    ASSERT_EQ(dev_->write(now_ns(), {{}, wrench_frame::device_base, now_ns() + period_ns, 0}), status::ok);
  }
  world_->begin();
  const pose start = forward(desk_arm(), arm_start_rad).T_dh;
  control_settings control;
  control.map.T_wd.position = -(start.position + vec3(0.0, 0.0, surface_m));
  control.map.T_ha.rotation = glm::conjugate(start.rotation) * exp_rotation({0.08, 0.0, 0.0});
  control.samples.stale_after_ns = 5'000'000'000;  // the session's time lags behind where the machine stalls
  control.samples.reject_limit = 1000;
  virtual_schedule schedule;
  schedule.start_ns = now_ns() + period_ns;
  schedule.device_period_ns = schedule.contact_period_ns = period_ns;
  virtual_session<analytic_wall, articulated_device, watch> session({.stiffness_n_per_m = 600.0, .arm_m = 0.02},
                                                                    {{pose{}}, vec3(0.0)}, *dev_, control, schedule);
  constexpr double longest_s = 0.25;  // the bound is stated for ticks no farther apart; the machine may stall
  energy_bound book(control.guard, session.device().gate().limits(), longest_s);
  const double before_j = world_->look([](fake_arm& p, motors&) { return p.delivered_j(); });
  std::int64_t last_ns = now_ns();
  std::int64_t gap_ns = 0;
  double torque_n_m = 0.0;
  int ticks = 0;
  // How far the hand has come after so many ticks, the machine decides.
  const auto has_felt_enough = [&] {
    const watch& seen = session.device().observer();
    return seen.touching >= 80 && seen.largest_force_n > 0.6 && torque_n_m > 0.6;
  };
  for (; ticks < 4000 && !has_felt_enough(); ++ticks) {
    clock_.wait_until_ns(session.now_ns());
    gap_ns = std::max(gap_ns, now_ns() - last_ns);
    last_ns = now_ns();
    ASSERT_NE(session.step(), status::backend_failed)
        << "tick " << ticks << ": gate: " << to_string(session.device().gate().fault())
        << ", arm: " << dev_->fault_words();
    const session_record& r = session.device().observer().last;
    world_->look([&](fake_arm& p, motors& m) {
      book.observe(p.delivered_j() - before_j, p.T_dh(), p.velocity_d(), r);
      p.set_intended(r.on_hand_d);
      if (r.contacts > 0) torque_n_m = std::max(torque_n_m, std::fabs(joint_torque(*m[1], 1)));
    });
  }
  const watch& w = session.device().observer();
  const double astray_j = world_->look([](fake_arm& p, motors&) { return p.astray_j(); });
  std::printf(
      "%d ticks, longest %.1f ms apart; %.2f N; surplus %.3f mJ of a bound of %.1f mJ, by rounding and lag %.2f mJ "
      "at most\n",
      ticks, 1e-6 * static_cast<double>(gap_ns), w.largest_force_n, 1e3 * book.largest_surplus_j(),
      1e3 * book.surplus_bound_j(), 1e3 * astray_j);
  EXPECT_GE(w.touching, 80U);
  EXPECT_GT(w.largest_force_n, 0.5);
  EXPECT_GT(torque_n_m, 0.5);
  if (1e-9 * static_cast<double>(gap_ns) < longest_s) {
    EXPECT_LE(book.largest_surplus_j(), book.surplus_bound_j() + astray_j);
  } else {
    std::printf("this machine stalled for longer than the bound is stated for: the energy is not judged\n");
  }
  dev_->close();
  EXPECT_EQ(dev_->state(), device_state::closed);
  EXPECT_TRUE(can_kernel_test::soon([this] { return all_at_zero(); }));
}

TEST_F(arm, stops_when_a_drive_faults_and_when_a_bus_goes) {
  device_sample in;
  std::uint64_t n = 0;
  const auto tick = [&] {
    clock_.wait_until_ns(now_ns() + period_ns);
    static_cast<void>(dev_->read(now_ns(), in));
    return dev_->write(now_ns(), {{{2.0, 0.0, 3.0}, {}}, wrench_frame::device_base, now_ns() + 500'000'000, ++n});
  };
  for (int i = 0; i < 40; ++i) ASSERT_EQ(tick(), status::ok) << dev_->fault_words();
  EXPECT_FALSE(all_at_zero());
  world_->look([](fake_arm&, motors& m) { m[3]->trip(0x2310); });
  EXPECT_TRUE(can_kernel_test::soon([&] { return tick() != status::ok; }));
  EXPECT_EQ(dev_->fault().joint, 3) << dev_->fault_words();
  EXPECT_EQ(dev_->fault().code, 0x2310U);
  EXPECT_TRUE(can_kernel_test::soon([&] {
    static_cast<void>(tick());
    return all_at_zero();
  }));
  EXPECT_FALSE(dev_->arm());

  ASSERT_TRUE(dev_->clear_fault());
  const result<void> again = dev_->open();
  ASSERT_TRUE(again) << again.error().message;
  ASSERT_TRUE(dev_->arm()) << dev_->fault_words();
  for (int i = 0; i < 40; ++i) ASSERT_EQ(tick(), status::ok) << dev_->fault_words();
  ASSERT_EQ(network::remove(names[1]), 0);
  EXPECT_TRUE(can_kernel_test::soon([&] { return tick() != status::ok; }));
  EXPECT_EQ(dev_->fault().bus, 1) << dev_->fault_words();
  std::printf("%s\n", dev_->fault_words().c_str());
  // The drives behind the bus that went stop because they hear us no more.
  EXPECT_TRUE(can_kernel_test::soon([&] {
    static_cast<void>(tick());
    return all_at_zero();
  }));
  EXPECT_EQ(dev_->state(), device_state::fault);
}

}  // namespace
}  // namespace asperity::arm_kernel_test
