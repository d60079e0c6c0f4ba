// Finds Falcons.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "asperity/core/export.hpp"
#include "asperity/device/driver.hpp"
#include "asperity/drivers/falcon/falcon_device.hpp"

namespace asperity {

/// Driver of the Novint Falcon over any USB: the system's (asperity::usb) or a virtual one.
class ASPERITY_API falcon_driver final : public device_driver {
 public:
  /// @param finder,clock outlive the driver and its devices
  falcon_driver(usb_finder& finder, io_clock& clock, falcon_settings settings = {});

  [[nodiscard]] std::string_view name() const noexcept override { return "falcon"; }
  [[nodiscard]] driver_maturity maturity() const noexcept override { return driver_maturity::protocol_tested; }

  [[nodiscard]] result<std::vector<device_listing>> list() override;
  [[nodiscard]] result<any_device> make(const device_listing& which) override;

 private:
  [[nodiscard]] static std::string identity_of(const usb_listing& usb) { return "usb:0403:cb48:" + usb.serial; }

  usb_finder* finder_;
  io_clock* clock_;
  falcon_settings settings_;
};

}  // namespace asperity
