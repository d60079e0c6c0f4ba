// asperity::hid and the SpaceMouse driver over the kernel's own hidraw; the devices are made with /dev/uhid, in this
// process. hidapi reads beside us, as an oracle.
#include <atomic>
#include <gtest/gtest.h>
#include <hidapi.h>
#include <sys/wait.h>
#include <thread>

#include <asperity/control/virtual_session.hpp>
#include <asperity/drivers/spacemouse/spacemouse_driver.hpp>
#include <asperity/hid/hid.hpp>
#include <asperity/transport/virtual/virtual_hid.hpp>

#include "asperity/hid/enumerate.hpp"
#include "asperity/hid/hidraw_link.hpp"
#include "hardware/kernel/uhid_device.hpp"
#include "hardware/peers/fake_spacemouse.hpp"
#include "unit/control/analytic_wall.hpp"

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && !defined(__clang__)
#define ASPERITY_COUNTS_ALLOCATIONS 1
static std::atomic<std::uint64_t> allocations{0};
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* malloc(std::size_t n) {
  allocations.fetch_add(1, std::memory_order_relaxed);
  return __libc_malloc(n);
}
void* calloc(std::size_t n, std::size_t size) {
  allocations.fetch_add(1, std::memory_order_relaxed);
  return __libc_calloc(n, size);
}
}
#endif

namespace {

using namespace asperity;
using namespace asperity::hid;
using test_support::fake_spacemouse;
using test_support::spacemouse_kind;
using test_support::uhid_device;
using bytes = std::vector<std::uint8_t>;

constexpr std::int64_t ms = 1'000'000;

void nap(int n = 5) { std::this_thread::sleep_for(std::chrono::milliseconds(n)); }

// Waits for a device to come, or to go. The kernel does both in a thread of its own.
std::optional<hid_listing> wait_for(const std::string& identity, bool there = true) {
  for (int i = 0; i < 1000; ++i) {
    const auto all = list_hid();
    const auto it = std::find_if(all->begin(), all->end(), [&](const auto& l) { return identity_of(l) == identity; });
    if ((it != all->end()) == there) return there ? std::optional(*it) : std::nullopt;
    nap();
  }
  ADD_FAILURE() << identity << (there ? " did not come" : " did not go");
  return std::nullopt;
}

struct kernel_hid : ::testing::Test {
  void SetUp() override {
    if (const std::string why = uhid_device::missing(); !why.empty()) GTEST_SKIP() << why;
  }
};

// A fake SpaceMouse as the firmware of a device of the kernel's. The classic one has the numbers of a Compact:
// hid-generic leaves those of a SpaceNavigator to a driver of the kernel's that takes real USB devices only.
struct plugged {
  explicit plugged(spacemouse_kind k, std::string serial_number = "S1")
      : kind(k),
        serial(std::move(serial_number)),
        mouse(k, [this](std::int64_t, std::span<const std::uint8_t> r) { uhid.send(r); }) {
    plug_in();
  }
  void plug_in() {
    const bool classic = kind == spacemouse_kind::classic;
    EXPECT_TRUE(uhid.plug_in(0x256f, classic ? 0xc635 : 0xc62e, "3Dconnexion SpaceMouse", serial,
                             fake_spacemouse::descriptor(kind)));
    listing = wait_for(identity());
  }
  void unplug() {
    EXPECT_TRUE(uhid.unplug());
    wait_for(identity(), false);
  }
  [[nodiscard]] std::string identity() const {
    return (kind == spacemouse_kind::classic ? "256f:c635:" : "256f:c62e:") + serial;
  }
  void step(std::int64_t now_ns) {
    mouse.step(now_ns);
    for (const bytes& r : uhid.take_outputs()) mouse.take(r);
  }

  spacemouse_kind kind;
  std::string serial;
  uhid_device uhid{};
  fake_spacemouse mouse;
  std::optional<hid_listing> listing{};
};

TEST_F(kernel_hid, both_ways_to_list_find_the_same) {
  const plugged a(spacemouse_kind::classic, "A");
  const plugged b(spacemouse_kind::combined, "B");
  ASSERT_TRUE(a.listing && b.listing);
  const auto by_path = [](const hid_listing& x, const hid_listing& y) { return x.path < y.path; };
  std::vector<hid_listing> ours = list_from_sysfs();
  std::vector<hid_listing> theirs = list_from_hidapi();
  std::sort(ours.begin(), ours.end(), by_path);
  std::sort(theirs.begin(), theirs.end(), by_path);
  ASSERT_EQ(ours.size(), theirs.size());
  ASSERT_GE(ours.size(), 2U);
  for (std::size_t i = 0; i < ours.size(); ++i) {
    EXPECT_EQ(ours[i].path, theirs[i].path);
    EXPECT_EQ(identity_of(ours[i]), identity_of(theirs[i]));
    EXPECT_EQ(ours[i].product, theirs[i].product);
    EXPECT_EQ(ours[i].manufacturer, theirs[i].manufacturer);
    EXPECT_EQ(ours[i].interface_number, theirs[i].interface_number);
    EXPECT_EQ(ours[i].report_descriptor, theirs[i].report_descriptor);
  }
  EXPECT_EQ(a.listing->report_descriptor, fake_spacemouse::descriptor(spacemouse_kind::classic));
  EXPECT_FALSE(a.listing->not_openable);
  std::printf("hidapi %s; it is %s to list\n", hid_version_str(),
              may_list(hid_version()->major, hid_version()->minor) ? "asked" : "not asked");
}

TEST_F(kernel_hid, reads_what_was_sent_as_hidapi_does) {
  plugged p(spacemouse_kind::combined);
  ASSERT_TRUE(p.listing);
  const auto link = open_hid(*p.listing);
  ASSERT_TRUE(link) << link.error().message;
  const std::span<const std::uint8_t> d = (*link)->report_descriptor();
  EXPECT_EQ(bytes(d.begin(), d.end()), fake_spacemouse::descriptor(p.kind));
  hid_device* const other = hid_open_path(p.listing->path.c_str());
  ASSERT_NE(other, nullptr);

  std::array<std::uint8_t, 64> room{};
  std::array<std::uint8_t, 64> theirs{};
  hid_report r;
  EXPECT_EQ((*link)->read(0, room, r), io_status::nothing);
  std::mt19937_64 bits(1);
  for (int n = 0; n < 300; ++n) {
    bytes report(13);
    for (std::uint8_t& b : report) b = static_cast<std::uint8_t>(bits());
    report[0] = 1;
    ASSERT_TRUE(p.uhid.send(report));
    io_status s = io_status::nothing;
    for (int i = 0; i < 1000 && s == io_status::nothing; ++i) s = (*link)->read(n, room, r);
    ASSERT_EQ(s, io_status::ok);
    ASSERT_EQ(r.size, report.size());
    ASSERT_EQ(r.host_time_ns, n);
    ASSERT_TRUE(std::equal(report.begin(), report.end(), room.begin()));
    ASSERT_EQ(hid_read_timeout(other, theirs.data(), theirs.size(), 1000), 13);
    ASSERT_TRUE(std::equal(report.begin(), report.end(), theirs.begin()));
  }
  hid_close(other);

  ASSERT_EQ((*link)->write(0, bytes{4, 1}), io_status::ok);
  p.step(0);
  EXPECT_TRUE(p.mouse.light());
  EXPECT_EQ((*link)->write(0, bytes{4}), io_status::refused);
  EXPECT_EQ((*link)->write(0, bytes(20'000, 4)), io_status::refused);
}

TEST_F(kernel_hid, loses_the_newest_of_too_many_as_the_twin_does) {
  plugged p(spacemouse_kind::classic);
  ASSERT_TRUE(p.listing);
  virtual_hid twin({});
  const auto link = open_hid(*p.listing);
  const auto virtual_link = twin.host_end();
  ASSERT_TRUE(link);
  for (std::uint8_t i = 0; i < 100; ++i) {
    const bytes report{1, i, 0, 0, 0, 0, 0};
    p.uhid.send(report);
    twin.send(0, report);
  }
  std::array<std::uint8_t, 64> room{};
  std::array<std::uint8_t, 64> same{};
  hid_report r;
  hid_report s;
  int n = 0;
  while ((*link)->read(0, room, r) == io_status::ok) {
    ASSERT_EQ(virtual_link->read(0, same, s), io_status::ok);
    ASSERT_EQ(room, same);
    ASSERT_EQ(r.size, s.size);
    ++n;
  }
  EXPECT_EQ(virtual_link->read(0, same, s), io_status::nothing);
  EXPECT_EQ(n, 63);
}

TEST_F(kernel_hid, is_gone_from_the_call_after_unplugging) {
  for (const bool by_death : {false, true}) {  // of the device, or of the program that was it
    auto p = std::make_unique<plugged>(spacemouse_kind::classic);
    ASSERT_TRUE(p->listing);
    const hid_listing listing = *p->listing;
    const auto link = open_hid(listing);
    ASSERT_TRUE(link);
    if (by_death) {
      const std::string identity = p->identity();
      p.reset();
      wait_for(identity, false);
    } else {
      p->unplug();
    }
    std::array<std::uint8_t, 64> room{};
    hid_report r;
    EXPECT_EQ((*link)->read(0, room, r), io_status::gone);
    EXPECT_EQ((*link)->read(0, room, r), io_status::gone);
    EXPECT_EQ((*link)->write(0, bytes{4, 1}), io_status::gone);
    EXPECT_NE(dynamic_cast<hidraw_link&>(**link).errno_value(), 0);
    const auto again = open_hid(listing);
    ASSERT_FALSE(again);
    EXPECT_EQ(again.error().code, error_code::io_failed) << again.error().message;
  }
}

TEST_F(kernel_hid, takes_no_other_device_for_the_listed_one) {
  plugged p(spacemouse_kind::classic, "A");
  ASSERT_TRUE(p.listing);
  hid_listing wrong = *p.listing;
  wrong.serial = "B";
  const auto by_serial = open_hid(wrong);
  ASSERT_FALSE(by_serial);
  EXPECT_NE(by_serial.error().message.find("256f:c635:B"), std::string::npos) << by_serial.error().message;
  wrong = *p.listing;
  wrong.product_id = 0xc636;
  EXPECT_FALSE(open_hid(wrong));
  EXPECT_TRUE(open_hid(*p.listing));
}

// The node goes away at every moment of being opened and listed: values come back, and the program lives.
TEST_F(kernel_hid, survives_nodes_that_vanish_while_they_are_opened) {
  int opened = 0;
  int refused = 0;
  for (int n = 0; n < 20; ++n) {
    uhid_device uhid;
    const bytes descriptor = fake_spacemouse::descriptor(spacemouse_kind::classic);
    ASSERT_TRUE(uhid.plug_in(0x256f, 0xc635, "x", "V", descriptor));
    const auto listing = wait_for("256f:c635:V");
    ASSERT_TRUE(listing);
    std::thread leaver([&] {
      std::this_thread::sleep_for(std::chrono::microseconds(197 * n));
      static_cast<void>(uhid.unplug());
    });
    int refused_in_a_row = 0;
    while (refused_in_a_row < 5) {
      const auto link = open_hid(listing->path);
      link ? ++opened : ++refused;
      refused_in_a_row = link ? 0 : refused_in_a_row + 1;
      ASSERT_TRUE(list_hid());
    }
    leaver.join();
  }
  EXPECT_GT(opened, 0);
  std::printf("opened %d times, refused %d times\n", opened, refused);
}

TEST_F(kernel_hid, allocates_nothing_in_a_tick_even_when_it_is_unplugged) {
#ifndef ASPERITY_COUNTS_ALLOCATIONS
  GTEST_SKIP() << "allocations are not counted in this build";
#else
  plugged p(spacemouse_kind::combined);
  ASSERT_TRUE(p.listing);
  const auto link = open_hid(*p.listing);
  ASSERT_TRUE(link);
  hid_device* const other = hid_open_path(p.listing->path.c_str());
  ASSERT_NE(other, nullptr);
  std::array<std::uint8_t, 64> room{};
  const bytes light{4, 1};
  hid_report r;
  std::uint64_t in_reads = 0;
  const auto count = [&](auto&& call) {
    const std::uint64_t before = allocations.load();
    call();
    return allocations.load() - before;
  };
  for (int n = 0; n < 200; ++n) {
    p.uhid.send(bytes(13, 1));
    in_reads += count([&] { static_cast<void>((*link)->read(n, room, r)); });
    in_reads += count([&] { static_cast<void>((*link)->write(n, light)); });
  }
  EXPECT_EQ(in_reads, 0U);
  p.unplug();
  while ((*link)->read(0, room, r) == io_status::ok) {
  }
  EXPECT_EQ(count([&] { static_cast<void>((*link)->read(0, room, r)); }), 0U);
  EXPECT_EQ(count([&] { static_cast<void>((*link)->write(0, light)); }), 0U);
  // Why reports do not go through hidapi: it makes a sentence out of every error.
  EXPECT_GT(count([&] { hid_write(other, light.data(), light.size()); }), 0U);
  hid_close(other);
#endif
}

TEST_F(kernel_hid, says_which_rule_gives_permission) {
  plugged p(spacemouse_kind::classic);
  ASSERT_TRUE(p.listing);
  if (::geteuid() != 0) GTEST_SKIP() << "only root can become somebody without permission";
  const pid_t child = ::fork();
  if (child == 0) {
    if (::setresgid(65534, 65534, 65534) != 0 || ::setresuid(65534, 65534, 65534) != 0) _exit(10);
    const std::string rule = udev_rule(0x256f, 0xc635);
    const auto all = list_hid();
    for (const hid_listing& l : *all) {
      if (identity_of(l) != p.identity()) continue;
      const bool listed = l.not_openable && l.not_openable->find(rule) != std::string::npos;
      const auto link = open_hid(l);
      const bool opened = !link && link.error().message.find(rule) != std::string::npos;
      _exit(listed && opened ? 0 : 11);
    }
    _exit(12);
  }
  int how = 0;
  ASSERT_EQ(::waitpid(child, &how, 0), child);
  EXPECT_TRUE(WIFEXITED(how));
  EXPECT_EQ(WEXITSTATUS(how), 0);
}

TEST_F(kernel_hid, drives_a_spacemouse_from_end_to_end) {
  for (const spacemouse_kind kind : {spacemouse_kind::classic, spacemouse_kind::combined}) {
    plugged p(kind);
    ASSERT_TRUE(p.listing);
    const std::string first_path = p.listing->path;
    system_finder finder;
    spacemouse_driver driver(finder);
    const auto list = driver.list();
    ASSERT_TRUE(list);
    const auto mine =
        std::find_if(list->begin(), list->end(), [&](const auto& l) { return l.identity == p.identity(); });
    ASSERT_NE(mine, list->end());
    EXPECT_EQ(mine->path, first_path);
    EXPECT_EQ(mine->name,
              kind == spacemouse_kind::classic ? "SpaceMouse Compact" : "SpaceMouse Wireless, on its cable");
    auto made = driver.make_spacemouse(*mine);
    ASSERT_TRUE(made);
    spacemouse_device& device = *made;
    const result<void> open = device.open();
    ASSERT_TRUE(open) << open.error().message;
    EXPECT_TRUE(device.format().described());
    ASSERT_TRUE(device.arm());
    ASSERT_TRUE(device.set_light(true));

    device_sample seen;
    std::int64_t now = 0;
    const auto run_to = [&](std::int64_t until_ns) {
      status s = status::ok;
      for (; now < until_ns; now += ms) {
        p.step(now);
        s = device.read(now, seen);
        static_cast<void>(device.write(now, {{{0, 0, 1}, {}}, wrench_frame::device_base, now + ms, 1}));
      }
      return s;
    };
    p.mouse.push({350, 0, 0, 0, 0, -350});
    EXPECT_EQ(run_to(200 * ms), status::ok);
    p.mouse.release();
    p.mouse.press(now, 3);
    EXPECT_EQ(run_to(400 * ms), status::ok);
    EXPECT_NEAR(seen.T_dh.position.x, 0.02, 0.0025);
    EXPECT_NEAR(log_rotation(seen.T_dh.rotation).z, 0.2, 0.025);
    EXPECT_EQ(seen.buttons, 3U);
    EXPECT_EQ(seen.lost, 0U);
    EXPECT_TRUE(p.mouse.light());
    EXPECT_EQ(device.shown().force.z, 1.0);
    EXPECT_EQ(device.counts().silences, 0U);

    // Unplugged while armed; its node is taken by another one before it returns.
    p.unplug();
    EXPECT_EQ(run_to(now + 2 * ms), status::not_ready);
    EXPECT_EQ(device.state(), device_state::fault);
    EXPECT_EQ(device.fault(), spacemouse_fault::unplugged);
    EXPECT_EQ(device.shown().force.z, 0.0);
    const plugged intruder(kind, "other");
    p.plug_in();
    ASSERT_TRUE(p.listing);
    EXPECT_EQ(run_to(now + 20 * ms), status::not_ready);
    EXPECT_EQ(device.state(), device_state::fault);
    ASSERT_TRUE(device.clear_fault());
    EXPECT_NE(p.listing->path, intruder.listing->path);
    ASSERT_TRUE(device.open());
    EXPECT_EQ(device.state(), device_state::ready);  // not armed
    p.mouse.push({0, 100, 0, 0, 0, 0});
    EXPECT_EQ(run_to(now + 50 * ms), status::ok);
    EXPECT_LT(seen.T_dh.position.y, -0.0005);
    std::printf("%s: %s, then %s\n", p.identity().c_str(), first_path.c_str(), p.listing->path.c_str());
    EXPECT_NE(p.listing->path, first_path);
  }
}

struct last_record {
  session_record r{};
  void operator()(const session_record& now) noexcept { r = now; }
};

// A whole session: the firmware's reports go through the kernel, the driver and both loops, and the wrench is shown.
TEST_F(kernel_hid, moves_a_probe_against_a_wall) {
  plugged p(spacemouse_kind::combined);
  ASSERT_TRUE(p.listing);
  spacemouse_settings settings;
  settings.motion.T_dh_start.position = {0, 0, 0.01};
  settings.shown_force_n = 5.0;
  system_finder finder;
  spacemouse_driver driver(finder, settings);
  const auto list = driver.list();
  ASSERT_TRUE(list && !list->empty());
  auto device = driver.make_spacemouse(list->front());
  ASSERT_TRUE(device && device->open() && device->arm());
  virtual_session<test_support::analytic_wall, spacemouse_device, last_record> session({}, {{pose{}}, vec3(0.0)},
                                                                                       *device, control_settings{});
  const auto run_to = [&](std::int64_t until_ns) {
    status s = status::ok;
    while (session.now_ns() < until_ns) {
      p.step(session.now_ns());
      s = session.step();
    }
    return s;
  };
  const session_record& seen = session.device().observer().r;
  p.mouse.push({0, 0, 350, 0, 0, 0});  // down
  EXPECT_EQ(run_to(150 * ms), status::ok);
  p.mouse.release();
  EXPECT_EQ(run_to(1000 * ms), status::ok);
  EXPECT_NEAR(seen.T_dh.position.z, -0.005, 0.0017);
  EXPECT_GT(seen.on_probe_w.force.z, 0.3);
  EXPECT_GT(device->shown().force.z, 0.3);
  p.unplug();
  static_cast<void>(session.step());
  EXPECT_EQ(device->shown().force.z, 0.0);
  EXPECT_EQ(session.device().gate().fault(), gate_fault::device_departed);
  EXPECT_EQ(device->fault(), spacemouse_fault::unplugged);
}

}  // namespace
