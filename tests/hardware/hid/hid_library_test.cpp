// asperity::hid where there is no HID device: made-up folders of the system, sockets in place of nodes.
#include <csignal>
#include <fcntl.h>
#include <fstream>
#include <gtest/gtest.h>
#include <set>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <asperity/drivers/spacemouse/products.hpp>
#include <asperity/hid/hid.hpp>

#include "asperity/hid/enumerate.hpp"
#include "asperity/hid/hidraw_link.hpp"
#include "hardware/peers/hid_items.hpp"

namespace {

using namespace asperity;
using namespace asperity::hid;
namespace fs = std::filesystem;
using bytes = std::vector<std::uint8_t>;

// A folder that goes away with the test.
struct scratch {
  scratch() {
    std::string name = (fs::temp_directory_path() / "asperity-hid-XXXXXX").string();
    path = ::mkdtemp(name.data());
  }
  ~scratch() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
  void write(const fs::path& file, std::string_view text) const {
    fs::create_directories((path / file).parent_path());
    std::ofstream(path / file, std::ios::binary) << text;
  }
  fs::path path;
};

std::string text_of(const bytes& b) { return {b.begin(), b.end()}; }

TEST(hid_listing, is_read_from_the_files_of_the_system) {
  const scratch s;
  // A SpaceNavigator on USB, as the kernel shows it, and a keyboard over Bluetooth.
  const fs::path usb = "devices/usb1/1-4/1-4:1.0/0003:046D:C626.0001";
  s.write(usb / "uevent",
          "DRIVER=hid-generic\nHID_ID=0003:0000046D:0000C626\nHID_NAME=3Dconnexion "
          "SpaceNavigator\nHID_PHYS=x\nHID_UNIQ=\n");
  s.write(usb / "report_descriptor", text_of(test_support::space_navigator_descriptor()));
  s.write("devices/usb1/1-4/1-4:1.0/bInterfaceNumber", "00\n");
  s.write("devices/usb1/1-4/manufacturer", "3Dconnexion\n");
  s.write("devices/usb1/1-4/product", "SpaceNavigator\n");
  fs::create_directories(s.path / "class/hidraw/hidraw9");
  fs::create_symlink(s.path / usb, s.path / "class/hidraw/hidraw9/device");
  s.write("class/hidraw/hidraw10/device/uevent", "HID_ID=0005:0000256F:0000C63A\nHID_NAME=Mouse\nHID_UNIQ=aa:bb:cc\n");
  // Nodes on their way out, and nonsense.
  fs::create_directories(s.path / "class/hidraw/hidraw2");
  s.write("class/hidraw/hidraw3/device/uevent", "");
  s.write("class/hidraw/hidraw4/device/uevent", "HID_ID=0003:00046D");
  s.write("class/hidraw/hidraw5/device/uevent", "HID_ID=0003:0001046D:0000C626\n");
  s.write("class/hidraw/hidraw6/device/uevent", std::string(100'000, 'x'));
  s.write("class/hidraw/hidraw7/device/uevent", std::string("HID_ID\0\n=", 9));

  std::vector<hid_listing> found = list_from_sysfs(s.path, "/dev");
  ASSERT_EQ(found.size(), 2U);
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.path < b.path; });
  EXPECT_EQ(found[0].path, "/dev/hidraw10");
  EXPECT_EQ(identity_of(found[0]), "256f:c63a:aa:bb:cc");
  EXPECT_EQ(found[0].interface_number, -1);
  EXPECT_TRUE(found[0].report_descriptor.empty());
  EXPECT_EQ(found[1].path, "/dev/hidraw9");
  EXPECT_EQ(identity_of(found[1]), "046d:c626");
  EXPECT_EQ(found[1].product, "SpaceNavigator");
  EXPECT_EQ(found[1].manufacturer, "3Dconnexion");
  EXPECT_EQ(found[1].interface_number, 0);
  EXPECT_EQ(found[1].report_descriptor, test_support::space_navigator_descriptor());
  EXPECT_TRUE(list_from_sysfs(s.path / "nowhere", "/dev").empty());
}

TEST(hid_listing, is_asked_of_hidapi_only_where_that_survives_a_departure) {
  EXPECT_FALSE(may_list(0, 13));
  EXPECT_FALSE(may_list(0, 14));
  EXPECT_TRUE(may_list(0, 15));
  EXPECT_TRUE(may_list(1, 0));
  EXPECT_TRUE(list_hid());  // whatever there is here
}

// hidapi before 0.14 frees its device and then writes to it where a path opens and does not answer as hidraw: a node
// that vanishes between the two, or simply something else. Every one of these is that.
TEST(hid_open, answers_with_an_error_where_hidapi_would_use_what_it_freed) {
  const scratch s;
  s.write("file", "no device");
  ASSERT_EQ(::mkfifo((s.path / "fifo").c_str(), 0600), 0);
  const std::set<std::string> there{"/dev/null", "/dev/zero", (s.path / "file").string(), (s.path / "fifo").string()};
  for (const std::string& path : there) {
    const auto link = open_hid(path);
    ASSERT_FALSE(link) << path;
    EXPECT_EQ(link.error().code, error_code::unsupported) << link.error().message;
    EXPECT_NE(link.error().message.find(path), std::string::npos);
  }
  for (const std::string path : {"/dev/hidraw4711", "", "/", "/dev/null/x"}) {
    const auto link = open_hid(path);
    ASSERT_FALSE(link) << path;
    EXPECT_EQ(link.error().code, error_code::io_failed) << link.error().message;
  }
}

TEST(hid_open, leaves_no_file_open_behind_an_error) {
  const auto lowest = [] {
    const int fd = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
    ::close(fd);
    return fd;
  };
  const int before = lowest();
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(open_hid("/dev/null"));
  EXPECT_EQ(lowest(), before);
}

TEST(hid_open, explains_how_to_get_permission) {
  const std::string rule = udev_rule(0x046d, 0xc626);
  EXPECT_EQ(rule, "SUBSYSTEM==\"hidraw\", KERNELS==\"*:046D:C626.*\", TAG+=\"uaccess\"");
  const std::string why = explain_open_error("/dev/hidraw3", EACCES, rule);
  EXPECT_NE(why.find("/dev/hidraw3"), std::string::npos);
  EXPECT_NE(why.find(rule), std::string::npos);
  EXPECT_EQ(explain_open_error("/dev/hidraw3", ENODEV, rule).find(rule), std::string::npos);
  hid_listing nowhere;
  nowhere.path = "/dev/hidraw4711";
  EXPECT_TRUE(why_not_openable(nowhere));
  nowhere.path = "/dev/null";
  EXPECT_FALSE(why_not_openable(nowhere));
}

TEST(hid_rules, are_the_ones_that_errors_print) {
  std::ifstream file(ASPERITY_UDEV_RULES);
  ASSERT_TRUE(file.is_open());
  std::set<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.insert(line);
  for (const spacemouse_product& p : spacemouse_products) {
    EXPECT_EQ(lines.count(udev_rule(p.vendor_id, p.product_id)), 1U) << p.name;
  }
}

// A pair of sockets keeps one message one message, as hidraw does.
struct node {
  node() {
    int fds[2];
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, fds), 0);
    device = fds[1];
    link = std::make_unique<hidraw_link>(fds[0], bytes{1, 2});
  }
  ~node() {
    if (device >= 0) ::close(device);
  }
  void leave() {
    ::close(device);
    device = -1;
  }
  int device = -1;
  std::unique_ptr<hidraw_link> link;
};

TEST(hidraw_link, reads_one_report_at_a_time_and_never_waits) {
  node n;
  EXPECT_EQ(n.link->report_descriptor().size(), 2U);
  std::array<std::uint8_t, 64> room{};
  hid_report r{99, 99};
  EXPECT_EQ(n.link->read(5, room, r), io_status::nothing);
  EXPECT_EQ(r.size, 99U);
  EXPECT_EQ(n.link->read(5, {}, r), io_status::failed);
  const bytes first{1, 2, 3};
  const bytes second{9};
  ASSERT_EQ(::send(n.device, first.data(), first.size(), 0), 3);
  ASSERT_EQ(::send(n.device, second.data(), second.size(), 0), 1);
  ASSERT_EQ(n.link->read(7, room, r), io_status::ok);
  EXPECT_EQ(r.size, 3U);
  EXPECT_EQ(r.host_time_ns, 7);
  ASSERT_EQ(n.link->read(8, room, r), io_status::ok);
  EXPECT_EQ(r.size, 1U);
  EXPECT_EQ(room[0], 9);
  n.leave();
  EXPECT_EQ(n.link->read(9, room, r), io_status::gone);
}

TEST(hidraw_link, writes_a_report_or_says_why_not) {
  node n;
  EXPECT_EQ(n.link->write(0, {}), io_status::refused);
  const bytes light{4, 1};
  ASSERT_EQ(n.link->write(0, light), io_status::ok);
  bytes got(8);
  ASSERT_EQ(::recv(n.device, got.data(), got.size(), 0), 2);
  int sent = 0;
  io_status s = io_status::ok;
  while ((s = n.link->write(0, light)) == io_status::ok && sent < 100'000) ++sent;
  EXPECT_EQ(s, io_status::busy);
  n.leave();
  std::signal(SIGPIPE, SIG_IGN);  // a socket's way; hidraw has no signal
  EXPECT_EQ(n.link->write(0, light), io_status::gone);
  EXPECT_NE(n.link->errno_value(), 0);
}

TEST(hidraw_link, closes_its_node) {
  node n;
  n.link.reset();
  std::uint8_t b = 0;
  EXPECT_EQ(::recv(n.device, &b, 1, 0), 0);  // the other end sees it
}

}  // namespace
