// The SpaceMouse driver over HID devices that a test lists.
#include <gtest/gtest.h>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <asperity/drivers/spacemouse/spacemouse_driver.hpp>
#include <asperity/transport/virtual/virtual_hid.hpp>

#include "hardware/peers/hid_items.hpp"

namespace {

using namespace asperity;

// Devices by their listing; a virtual one answers at a path that has one.
struct listed_hid final : hid_finder {
  std::vector<hid_listing> listings{};
  std::map<std::string, virtual_hid*> devices{};

  result<std::vector<hid_listing>> list() override { return listings; }
  result<std::unique_ptr<hid_link>> open(const hid_listing& which) override {
    const auto device = devices.find(which.path);
    if (device == devices.end()) return error{error_code::io_failed, "nothing answers at " + which.path};
    return device->second->host_end();
  }
};

hid_listing navigator(const std::string& path, const std::string& serial = "") {
  hid_listing l;
  l.path = path;
  l.vendor_id = 0x046d;
  l.product_id = 0xc626;
  l.serial = serial;
  l.report_descriptor = test_support::space_navigator_descriptor();
  return l;
}

TEST(spacemouse_driver, knows_its_own_among_other_devices) {
  const auto mine = as_spacemouse(navigator("/dev/hidraw1"));
  ASSERT_TRUE(mine);
  EXPECT_EQ(mine->driver, "spacemouse");
  EXPECT_EQ(mine->name, "SpaceNavigator");
  EXPECT_EQ(mine->identity, "046d:c626");
  EXPECT_EQ(mine->capabilities.actuated, no_axes);
  EXPECT_EQ(mine->capabilities.sensed, all_axes);
  hid_listing other = navigator("/dev/hidraw1");
  other.product_id = 0xc52b;
  EXPECT_FALSE(as_spacemouse(other));
  // Another interface of a receiver: a keyboard.
  hid_listing keys = navigator("/dev/hidraw2");
  test_support::hid_items d;
  d.page(1).usage(6).collection(1).page(7).usages(0xe0, 0xe7).logical(0, 1).bits(1).count(8).input(2).end();
  keys.report_descriptor = d.bytes;
  EXPECT_FALSE(as_spacemouse(keys));
  keys.report_descriptor.clear();
  EXPECT_TRUE(as_spacemouse(keys));
}

TEST(spacemouse_driver, finds_a_device_again_wherever_it_is) {
  const std::vector<hid_listing> one{navigator("/dev/hidraw4")};
  EXPECT_EQ(find_spacemouse_again(one, "046d:c626", "/dev/hidraw1")->path, "/dev/hidraw4");
  const std::vector<hid_listing> two{navigator("/dev/hidraw4"), navigator("/dev/hidraw5")};
  EXPECT_EQ(find_spacemouse_again(two, "046d:c626", "/dev/hidraw5")->path, "/dev/hidraw5");
  const auto which = find_spacemouse_again(two, "046d:c626", "/dev/hidraw1");
  ASSERT_FALSE(which);
  EXPECT_NE(which.error().message.find("2 SpaceMice"), std::string::npos);
  const std::vector<hid_listing> named{navigator("/dev/hidraw4", "A"), navigator("/dev/hidraw5", "B")};
  EXPECT_EQ(find_spacemouse_again(named, "046d:c626:B", "/dev/hidraw1")->path, "/dev/hidraw5");
  // Its old path belongs to another one now.
  EXPECT_EQ(find_spacemouse_again(named, "046d:c626:B", "/dev/hidraw4")->path, "/dev/hidraw5");
  EXPECT_FALSE(find_spacemouse_again({}, "046d:c626", "/dev/hidraw1"));
}

TEST(spacemouse_driver, makes_devices_that_say_what_is_wrong) {
  listed_hid nothing;
  spacemouse_driver driver(nothing);
  const auto all = driver.list();
  ASSERT_TRUE(all);
  device_listing gone = *as_spacemouse(navigator("/dev/hidraw4711", "not here"));
  auto device = driver.make(gone);
  ASSERT_TRUE(device);
  EXPECT_EQ(device->state(), device_state::present);
  EXPECT_EQ(device->capabilities().name, "SpaceNavigator");
  const result<void> opened = device->open();
  ASSERT_FALSE(opened);
  EXPECT_NE(opened.error().message.find("046d:c626:not here is not plugged in"), std::string::npos)
      << opened.error().message;
  gone.driver = "falcon";
  EXPECT_FALSE(driver.make(gone));
}

TEST(spacemouse_driver, opens_a_device_where_it_is_by_then) {
  virtual_hid mouse(test_support::space_navigator_descriptor());
  listed_hid bus;
  bus.listings = {navigator("/dev/hidraw1", "A")};
  spacemouse_driver driver(bus);
  const auto found = driver.list();
  ASSERT_TRUE(found);
  ASSERT_EQ(found->size(), 1U);
  auto device = driver.make_spacemouse(found->front());
  ASSERT_TRUE(device);
  EXPECT_FALSE(device->open());  // listed, and nothing answers
  bus.listings = {navigator("/dev/hidraw1", "B"), navigator("/dev/hidraw7", "A")};
  bus.devices = {{"/dev/hidraw7", &mouse}};
  ASSERT_TRUE(device->open());
  EXPECT_EQ(device->state(), device_state::ready);
  EXPECT_TRUE(device->format().described());
}

}  // namespace
