// Threads start, tick, stop and leave nothing behind. How late they are is the machine's affair and is not asserted.
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <gtest/gtest.h>
#include <string>
#include <thread>
#include <utility>

#if defined(__linux__)
#include <sched.h>
#include <sys/resource.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>
#endif

#include <asperity/control/real_session.hpp>
#include <asperity/control/real_time_thread.hpp>
#include <asperity/device/simulated/simulated_device.hpp>

#include "support/sanitizers.hpp"
#include "unit/control/analytic_wall.hpp"
#include "unit/control/plane_bodies.hpp"

namespace {

using namespace asperity;
using test_support::analytic_wall;

simulated_settings touching_hand() {
  simulated_settings c;
  c.motion = {.depth_m = 0.01, .approach_s = 0.05};
  return c;
}

struct counting {
  std::uint64_t* ticks;
  void operator()(const session_record&) noexcept { ++*ticks; }
};

TEST(real_session, runs_both_threads_and_comes_to_rest) {
  simulated_device dev(touching_hand());
  ASSERT_TRUE(dev.open() && dev.arm());
  std::uint64_t watched = 0;
  real_session<analytic_wall, simulated_device, counting> session({}, {{pose{}}, vec3(0.0)}, dev, {}, {},
                                                                  counting{&watched});
  session.start();
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  session.stop();

  const tick_timing& device = session.device_timing();
  EXPECT_GT(device.ticks, 0U);
  EXPECT_GT(session.contact_timing().ticks, 0U);
  EXPECT_GT(session.contact().computed(), 0U);
  EXPECT_EQ(device.durations_ns.size(), device.ticks);
  EXPECT_GE(watched, device.ticks);  // winding down ticks too
  EXPECT_TRUE(session.device().gate().at_rest());
  EXPECT_EQ(session.device().gate().fault(), gate_fault::stopped);
  EXPECT_EQ(dev.state(), device_state::ready);
}

// An application tells where a body is and takes what it feels, while both loops run.
TEST(real_session, takes_moving_bodies_from_another_thread) {
  simulated_settings hand = touching_hand();
  hand.motion.T_dh.position.z = 0.011;  // a millimetre above the touch
  simulated_device dev(hand);
  ASSERT_TRUE(dev.open() && dev.arm());
  real_session<test_support::plane_body, simulated_device> session(test_support::block_on_plane(),
                                                                   {{pose{}}, vec3(0.0)}, dev, control_settings{});
  session.start();
  constexpr double speed_m_per_s = 0.1;
  const std::int64_t begin_ns = decltype(session)::clock_ns();
  bool was_pressed = false;
  double told_m = 0.0;
  // Until it is pressed, and ten seconds at the most: how long a machine takes is its own affair.
  for (int i = 0; i < 5000 && !(was_pressed && i > 200); ++i) {
    moving_bodies told;
    told.time_ns = decltype(session)::clock_ns();
    told_m = speed_m_per_s * 1e-9 * static_cast<double>(told.time_ns - begin_ns);
    static_cast<void>(
        told.list.push_back({0, {quat(1, 0, 0, 0), {told_m, 0.0, 0.0}}, {{speed_m_per_s, 0.0, 0.0}, {}}}));
    session.move_bodies(told);
    was_pressed = was_pressed || session.felt().on(0).force.z < -0.1;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  session.stop();
  EXPECT_TRUE(was_pressed);
  const double seen_m = session.contact().placement().T_wb[0].position.x;
  EXPECT_GT(seen_m, 0.0);
  EXPECT_LE(seen_m, told_m + 0.11 * speed_m_per_s);  // guessed for a tenth of a second at the most, after the last news
}

TEST(real_session, stops_when_it_is_destroyed_and_when_it_never_ran) {
  simulated_device dev(touching_hand());
  ASSERT_TRUE(dev.open() && dev.arm());
  {
    real_session<analytic_wall, simulated_device> idle({}, {{pose{}}, vec3(0.0)}, dev, control_settings{});
    idle.stop();
  }
  {
    real_session<analytic_wall, simulated_device> session({}, {{pose{}}, vec3(0.0)}, dev, control_settings{});
    session.start();
    session.start();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  EXPECT_EQ(dev.state(), device_state::ready);
}

TEST(real_session, reports_to_the_gate_why_it_stops) {
  simulated_device dev(touching_hand());
  ASSERT_TRUE(dev.open() && dev.arm());
  real_session<analytic_wall, simulated_device> session({}, {{pose{}}, vec3(0.0)}, dev, control_settings{});
  for (const gate_fault cause : {gate_fault::interrupted, gate_fault::stopped}) {
    session.start();
    session.stop(cause);
    session.stop(gate_fault::watchdog);  // it does not run any more
    EXPECT_EQ(session.device().gate().fault(), cause);
    ASSERT_TRUE(session.device().clear_fault());
  }
}

std::atomic<int> threads_set_up{0};

TEST(real_session, lets_each_thread_be_set_up_once) {
  simulated_device dev(touching_hand());
  ASSERT_TRUE(dev.open() && dev.arm());
  threads_set_up = 0;
  real_schedule schedule;
  schedule.timed_ticks = 4;
  schedule.set_up_thread = [](session_thread) { ++threads_set_up; };
  real_session<analytic_wall, simulated_device> session({}, {{pose{}}, vec3(0.0)}, dev, control_settings{}, schedule);
  session.start();
  std::this_thread::sleep_for(std::chrono::milliseconds(60));
  session.stop();
  EXPECT_EQ(threads_set_up.load(), 2);
  EXPECT_LE(session.device_timing().durations_ns.size(), 4U);
}

#if defined(__linux__)

// What the kernel says of the calling thread.
struct kernel_view {
  int policy = -1, priority = -1, processors = -1;
};
kernel_view look_at_this_thread() {
  kernel_view v;
  sched_param p{};
  v.policy = sched_getscheduler(0) & ~SCHED_RESET_ON_FORK;
  if (sched_getparam(0, &p) == 0) v.priority = p.sched_priority;
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  if (sched_getaffinity(0, sizeof allowed, &allowed) == 0) v.processors = CPU_COUNT(&allowed);
  return v;
}

kernel_view contact_view, device_view;

void set_up_and_look(session_thread which) {
  set_up_real_time_thread(which);
  (which == session_thread::device ? device_view : contact_view) = look_at_this_thread();
}

// A session with the ready function, and whether what it says agrees with what the kernel says. Its sentence is empty
// where all is well.
std::string real_time_session() {
  const kernel_view before = look_at_this_thread();
  simulated_device dev(touching_hand());
  if (!dev.open() || !dev.arm()) return "the device does not arm";
  const memory_lock locked;
  if ((locked.outcome() == grant::granted) != (locked.refusal() == 0)) return "a memory lock contradicts itself";
  real_session<analytic_wall, simulated_device> session({}, {{pose{}}, vec3(0.0)}, dev, control_settings{},
                                                        {.set_up_thread = set_up_and_look});
  session.start();
  std::this_thread::sleep_for(std::chrono::milliseconds(60));
  session.stop();
  if (session.device_timing().ticks == 0 || session.contact_timing().ticks == 0) return "a thread did not tick";
  for (const auto& [which, view] :
       {std::pair{session_thread::device, device_view}, std::pair{session_thread::contact, contact_view}}) {
    const thread_grants got = latest_grants(which);
    const bool fifo = view.policy == SCHED_FIFO;
    if ((got.scheduling == grant::granted) != fifo) return "the class is not the one that is told";
    if (fifo && got.priority != view.priority) return "the priority is not the one that is told";
    if (got.scheduling == grant::refused && got.scheduling_error == 0) return "a refusal has no reason";
    if ((got.affinity == grant::granted) != (view.processors == 1 && before.processors > 1)) {
      return "the affinity is not the one that is told";
    }
    if (before.processors < 4 && got.affinity != grant::not_asked) return "few processors, and yet an affinity";
  }
  const bool contact_asked = latest_grants(session_thread::contact).scheduling != grant::not_asked;
  if (contact_asked != (before.processors >= 3)) return "the contact thread's class does not fit the processors";
  if (contact_view.policy == SCHED_FIFO && contact_view.priority >= device_view.priority) return "priorities swapped";
  const kernel_view after = look_at_this_thread();
  if (after.policy != before.policy || after.processors != before.processors) return "another thread was changed";
  return {};
}

TEST(real_session, reports_what_the_system_gave) {
  EXPECT_EQ(real_time_session(), "");
  if (device_view.policy != SCHED_FIFO) std::puts("[  NOTE    ] this user may not have a real-time class");
}

// The sanitizers put a lock of memory that does nothing, and succeeds, in the place of the system's.
constexpr bool lock_is_the_sanitizers = ASPERITY_ADDRESS_SANITIZER || ASPERITY_THREAD_SANITIZER;

// As a user without any rights: everything is refused, and the session runs.
TEST(real_session, runs_where_the_system_refuses) {
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const rlimit none{0, 0};
    if (setrlimit(RLIMIT_RTPRIO, &none) != 0 || setrlimit(RLIMIT_MEMLOCK, &none) != 0) _exit(3);
    if (geteuid() == 0 && (setgid(65534) != 0 || setuid(65534) != 0)) _exit(3);
    const std::string wrong = real_time_session();
    if (!wrong.empty()) std::printf("%s\n", wrong.c_str());
    std::fflush(stdout);
    const bool refused = latest_grants(session_thread::device).scheduling == grant::refused &&
                         latest_grants(session_thread::device).scheduling_error == EPERM &&
                         (lock_is_the_sanitizers || memory_lock().outcome() == grant::refused);
    _exit(!wrong.empty() ? 1 : refused ? 0 : 2);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(WIFEXITED(status) ? WEXITSTATUS(status) : -1, 0);
}

// A limit below the wish is used, not given up.
TEST(real_session, takes_the_priority_that_it_may_have) {
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const rlimit some{7, 7};
    if (setrlimit(RLIMIT_RTPRIO, &some) != 0) _exit(77);
    if (geteuid() == 0 && (setgid(65534) != 0 || setuid(65534) != 0)) _exit(3);
    const thread_grants got = ask_for_real_time(session_thread::device);
    const kernel_view view = look_at_this_thread();
    _exit(got.scheduling == grant::granted && got.priority == 7 && view.policy == SCHED_FIFO && view.priority == 7 ? 0
                                                                                                                   : 1);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  const int answer = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  if (answer == 77) GTEST_SKIP() << "this user may not raise its limit of priorities";
  EXPECT_EQ(answer, 0);
}

#endif

}  // namespace
