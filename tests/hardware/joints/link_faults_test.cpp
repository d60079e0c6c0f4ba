// Joint drives over a link that fails: every fault of a link script, and the n-th call for every n.
#include <cstdint>
#include <set>
#include <string>

#include "hardware/joints/rig.hpp"

namespace asperity::test_support {
namespace {

template <class Kind>
class LinkFaults : public ::testing::Test {};
TYPED_TEST_SUITE(LinkFaults, every_kind);

// A session that was enabled at that time with 10 N m; the faults of the script begin a second after the start.
constexpr std::int64_t fault_from_ns = 2'000 * ms;
constexpr std::int64_t fault_until_ns = 2'100 * ms;

link_event in_window(link_fault kind, link_direction way, double share = 1.0) {
  return {.kind = kind, .direction = way, .from_ns = fault_from_ns, .until_ns = fault_until_ns, .share = share};
}

template <class Kind>
void run_into_window(rig<Kind>& r) {
  ASSERT_TRUE(r.go(10.0)) << Kind::name << ": " << r.drive.fault().what;
  r.run(fault_from_ns - r.clock.now_ns() - ms);
  ASSERT_EQ(r.drive.state(), drive_state::enabled) << Kind::name << ": " << r.drive.fault().what;
  ASSERT_FALSE(r.is_limp());
}

// What cuts the link: the joint is limp while it lasts and after it, the driver says why, and nothing comes back.
TYPED_TEST(LinkFaults, a_cut_link_leaves_no_torque) {
  link_event answers = in_window(link_fault::answer, link_direction::to_device);
  answers.with = io_status::down;
  const link_event cuts[] = {
      in_window(link_fault::lose, link_direction::to_device), in_window(link_fault::lose, link_direction::from_device),
      in_window(link_fault::lose, link_direction::both),      in_window(link_fault::bus_off, link_direction::both),
      in_window(link_fault::unplug, link_direction::both),    answers};
  for (const link_event& cut : cuts) {
    SCOPED_TRACE(static_cast<int>(cut.kind) * 10 + static_cast<int>(cut.direction));
    rig<TypeParam> r({.events = {cut}, .latency_ns = 100'000});
    run_into_window(r);
    r.run(60 * ms);
    EXPECT_TRUE(r.is_limp()) << "within 60 ms, the drive's own watchdog included";
    r.run(400 * ms);
    EXPECT_TRUE(r.is_limp());
    EXPECT_NE(r.drive.state(), drive_state::enabled);
    EXPECT_EQ(r.peer.enables(), 1);
    if (r.receive_failed == io_status::ok) {
      EXPECT_EQ(r.drive.state(), drive_state::fault);
    }
    if (r.drive.state() == drive_state::fault) {
      EXPECT_STRNE(r.drive.fault().what, "none");
    }
  }
}

// A bus that takes no frame is a fault in the same period, and the fault says what the bus said.
TYPED_TEST(LinkFaults, a_bus_that_takes_nothing_is_a_fault_at_once) {
  const std::pair<io_status, const char*> answers[] = {{io_status::down, "down"},
                                                       {io_status::gone, "gone"},
                                                       {io_status::too_short, "a part of a frame"},
                                                       {io_status::refused, "cannot carry"},
                                                       {io_status::failed, "sending failed"}};
  for (const auto& [with, word] : answers) {
    link_event cut = in_window(link_fault::answer, link_direction::to_device);
    cut.with = with;
    rig<TypeParam> r({.events = {cut}, .latency_ns = 100'000});
    run_into_window(r);
    r.run(2 * ms);
    EXPECT_EQ(r.drive.state(), drive_state::fault) << word;
    EXPECT_TRUE(r.why_contains(word)) << r.drive.fault().what;
  }
}

// What spoils a part: torque within limits all the time, and either the session goes on or it ends as above.
TYPED_TEST(LinkFaults, a_bad_link_never_brings_more_torque_than_asked_for) {
  for (const link_fault kind : {link_fault::lose, link_fault::delay, link_fault::reorder, link_fault::duplicate,
                                link_fault::shorten, link_fault::flip_bit}) {
    for (const link_direction way : {link_direction::to_device, link_direction::from_device, link_direction::both}) {
      for (const double share : {0.05, 0.5, 1.0}) {
        link_event e = in_window(kind, way, share);
        e.amount_ns = 4 * ms;
        rig<TypeParam> r({.events = {e}, .latency_ns = 100'000, .seed = 3});
        run_into_window(r);
        // A bus that lets wrong bits through has no limits; a CAN controller throws such frames away.
        if (kind == link_fault::flip_bit && way != link_direction::from_device) r.trusted_link = false;
        r.run(250 * ms);
        SCOPED_TRACE(std::string(TypeParam::name) + " fault " + std::to_string(static_cast<int>(kind)) + " way " +
                     std::to_string(static_cast<int>(way)) + " share " + std::to_string(share));
        if (r.drive.state() == drive_state::enabled) {
          EXPECT_NEAR(r.joint_torque(), 10.0, r.drive.facts().torque_resolution_n_m * 1.01);
        } else {
          EXPECT_EQ(r.drive.state(), drive_state::fault);
          EXPECT_STRNE(r.drive.fault().what, "none");
          EXPECT_TRUE(r.is_limp());
        }
        EXPECT_EQ(r.peer.enables(), 1);
      }
    }
  }
}

// The n-th call on the bus fails, for every n of a whole session.
TYPED_TEST(LinkFaults, the_nth_call_that_fails_leaves_no_torque_and_a_cause) {
  joint_drive_settings joint = geared();
  const auto session = [](rig<TypeParam>& r) {
    r.drive.start(r.clock.now_ns());
    if (!r.run_until(drive_state::idle, 300 * ms) || !r.drive.enable(r.clock.now_ns())) return;
    r.wanted_n_m = 10.0;
    if (!r.run_until(drive_state::enabled, 200 * ms)) return;
    r.run(20 * ms);
    r.drive.disable(r.clock.now_ns());
    r.run(50 * ms);
  };
  std::uint64_t calls = 0;
  {
    rig<TypeParam> whole({}, TypeParam::options(joint));
    session(whole);
    ASSERT_TRUE(whole.was_enabled);
    ASSERT_EQ(whole.drive.state(), drive_state::idle);
    calls = whole.host.player().calls();
  }
  ASSERT_GT(calls, 150U);
  std::set<std::string> causes;
  std::uint64_t faults = 0;
  std::uint64_t disabled = 0;
  for (const io_status with : {io_status::failed, io_status::gone, io_status::too_short, io_status::busy}) {
    for (std::uint64_t n = 0; n < calls; n += with == io_status::failed ? 1 : 7) {
      rig<TypeParam> r({.events = {fail_call(n, with)}}, TypeParam::options(joint));
      session(r);
      ASSERT_TRUE(r.is_limp()) << TypeParam::name << " call " << n;
      ASSERT_NE(r.drive.state(), drive_state::enabled) << n;
      ASSERT_LE(r.peer.enables(), 1) << n;
      const bool in_fault = r.drive.state() == drive_state::fault;
      // A call that failed shows: as a fault of the drive, or to its owner, who disables it. A full queue is waited
      // for.
      ASSERT_TRUE(in_fault || r.receive_failed != io_status::ok || with == io_status::busy) << n;
      faults += in_fault ? 1U : 0U;
      disabled += r.receive_failed != io_status::ok ? 1U : 0U;
      if (in_fault) {
        ASSERT_STRNE(r.drive.fault().what, "none") << n;
        causes.insert(r.drive.fault().what);
      }
    }
  }
  EXPECT_GT(faults, 50U) << "calls that send";
  EXPECT_GT(disabled, 50U) << "calls that receive";
  for (const std::string& c : causes) EXPECT_NE(c.find("bus"), std::string::npos) << c;
}

// A queue that stays full.
TYPED_TEST(LinkFaults, a_queue_that_stays_full_is_a_fault_after_a_while) {
  link_event e = in_window(link_fault::answer, link_direction::to_device);
  e.with = io_status::busy;
  rig<TypeParam> r({.events = {e}});
  run_into_window(r);
  r.run(4 * ms);
  EXPECT_EQ(r.drive.state(), drive_state::enabled) << "a few full queues are no fault";
  r.run(6 * ms);
  EXPECT_EQ(r.drive.state(), drive_state::fault);
  EXPECT_TRUE(r.why_contains("full")) << r.drive.fault().what;
  r.run(200 * ms);
  EXPECT_TRUE(r.is_limp());
  EXPECT_FALSE(r.peer.enabled());
}

}  // namespace
}  // namespace asperity::test_support
