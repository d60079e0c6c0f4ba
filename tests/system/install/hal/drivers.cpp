// A program of a consumer of asperity::drivers: a USB bus without devices, and a drive on a CAN bus without a motor.
#include <cstdio>

#include <asperity/drivers/falcon/falcon_driver.hpp>
#include <asperity/drivers/mit/mit_drive.hpp>
#include <asperity/drivers/spacemouse/products.hpp>
#include <asperity/transport/virtual/manual_clock.hpp>
#include <asperity/transport/virtual/virtual_can.hpp>
#include <asperity/transport/virtual/virtual_usb.hpp>

// Passed on by pointer, as a host passes drivers on.
static bool finds_nothing(asperity::device_driver& driver) {
  const auto found = driver.list();
  return found && found->empty();
}

int main() {
  asperity::virtual_usb_bus usb;
  asperity::manual_clock clock;
  asperity::falcon_driver falcon(usb, clock);
  if (!finds_nothing(falcon)) return std::puts("a Falcon was found on an empty bus"), 1;

  asperity::virtual_can can;
  asperity::virtual_can_node host(can);
  asperity::mit_drive drive(asperity::mit_settings{});
  drive.start(0);
  bool sent = true;
  for (std::int64_t now_ns = 0; now_ns < 1'000'000'000; now_ns += 1'000'000) {
    sent = drive.step(now_ns, host) == asperity::io_status::ok && sent;
  }
  std::printf("%llu frames, then: %s\n", static_cast<unsigned long long>(can.frames()), drive.fault().what);
  return sent && can.frames() > 0 && drive.state() == asperity::drive_state::fault ? 0 : 1;
}
