// The Falcon's driver over a real kernel's USB. Needs the module vhci-hcd and root; skips without.
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "asperity/drivers/falcon/falcon_driver.hpp"
#include "hardware/kernel/usb_fixture.hpp"
#include "hardware/peers/fake_falcon.hpp"
#include "hardware/usb/falcon_rig.hpp"

namespace {

using namespace asperity;
using namespace asperity::test_support;

// The fake Falcon at the kernel's end of the cable, with the FTDI chip's packet in every millisecond.
class falcon_function final : public usb_function {
 public:
  explicit falcon_function(fake_falcon_settings settings) : peer(std::move(settings)) {}
  io_status control(const usb_setup& setup, std::span<std::uint8_t> data, std::size_t& done) override {
    return peer.control(setup, data, done);
  }
  bool take(std::span<const std::uint8_t> bytes) override {
    peer.receive(bytes);
    return true;
  }
  answer give(std::span<std::uint8_t> room, std::size_t& size) override {
    if (!peer.has_payload() && !status_due_) return answer::nothing;
    status_due_ = false;
    size = peer.transmit(room);
    return answer::data;
  }
  void tick() override { status_due_ = true; }

  fake_falcon peer;

 private:
  bool status_due_ = false;
};

TEST_F(kernel_usb, a_falcon_from_power_on_to_an_unplugged_cable_and_back) {
  const fake_image image(200);
  falcon_function falcon({.image = image.bytes(), .split = true});
  const usb_identity id{
      .vendor = falcon_vendor, .product = falcon_product, .maker = "Novint", .name = "Falcon", .serial = "F7"};
  usbip_device cable(falcon, id);
  plugged(cable, 0, id);

  // An emulated machine may stand still for a while; what a standstill does is tested on a clock that is a number.
  falcon_settings settings;
  settings.firmware_path = image.path();
  settings.silent_after_ns = 5'000 * ms;
  settings.wake_ns = 2'000 * ms;
  settings.settle_reports = 10;
  settings.busy_limit = 5'000;
  usb::system_finder finder;
  falcon_driver driver(finder, clock, settings);
  const auto listed = driver.list();
  ASSERT_TRUE(listed);
  ASSERT_EQ(listed->size(), 1U);
  EXPECT_EQ((*listed)[0].name, "Novint Falcon");
  EXPECT_EQ((*listed)[0].identity, "usb:0403:cb48:F7");
  auto device = driver.make((*listed)[0]);
  ASSERT_TRUE(device);
  const auto opened = device->open();
  ASSERT_TRUE(opened) << opened.error().message;
  cable.with_lock([&] { EXPECT_TRUE(falcon.peer.running()); });
  ASSERT_TRUE(device->arm());

  const vec3 push{0.5, -0.5, 1.5};
  device_sample seen;
  const auto tick = [&] {
    const std::int64_t now_ns = clock.now_ns();
    const status got = device->read(now_ns, seen);
    const status put = device->write(
        now_ns,
        {.on_hand = {push, vec3(0.0)}, .frame = wrench_frame::device_base, .valid_until_ns = now_ns + 5'000 * ms});
    clock.wait_until_ns(now_ns + ms);
    return got != status::ok ? got : put;
  };
  for (int i = 0; i < 200; ++i) ASSERT_EQ(tick(), status::ok) << i;
  EXPECT_EQ(device->state(), device_state::active);
  EXPECT_GT(seen.sequence, 30U);
  EXPECT_EQ(seen.lost, 0U);
  EXPECT_LT(glm::length(seen.T_dh.position - vec3(0.0, 0.0, 0.11)), 1e-4);
  cable.with_lock([&] { EXPECT_LT(glm::length(falcon.peer.force_d() - push), 0.02); });

  cable.unplug();
  EXPECT_TRUE(eventually([&] { return tick() != status::ok; }));
  EXPECT_EQ(device->state(), device_state::fault);
  EXPECT_NE(device->open().error().message.find("it was unplugged"), std::string::npos);
  falcon.peer.power_on();
  plugged(cable, 2, id);
  EXPECT_EQ(tick(), status::not_ready);
  ASSERT_TRUE(device->clear_fault());
  const auto again = device->open();
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(device->state(), device_state::ready);
  for (int i = 0; i < 30; ++i) ASSERT_EQ(tick(), status::ok);
  cable.with_lock([&] { EXPECT_TRUE(falcon.peer.at_rest()); });

  ASSERT_TRUE(device->arm());
  for (int i = 0; i < 20; ++i) ASSERT_EQ(tick(), status::ok);
  cable.with_lock([&] { EXPECT_FALSE(falcon.peer.at_rest()); });
  device->close();
  cable.with_lock([&] { EXPECT_TRUE(falcon.peer.at_rest()); });
}

}  // namespace
