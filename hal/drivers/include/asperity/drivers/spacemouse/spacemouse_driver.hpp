// Finds SpaceMice.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asperity/core/export.hpp"
#include "asperity/device/driver.hpp"
#include "asperity/drivers/spacemouse/spacemouse_device.hpp"
#include "asperity/transport/hid_finder.hpp"

namespace asperity {

/// The driver of the SpaceMouse family (products.hpp) over any HID: the system's (asperity::hid) or a virtual one.
///
/// A device is the multi-axis controller of a product in the table; its other interfaces are ignored. make() gives a
/// device that remembers its identity and not its path: its open() finds it wherever it is plugged in by then, at the
/// listed path where it is still there. Two of one kind have no serial numbers to tell them apart, so when both have
/// moved, open() says so and takes neither.
class ASPERITY_API spacemouse_driver final : public device_driver {
 public:
  /// @param finder outlives the driver and its devices
  explicit spacemouse_driver(hid_finder& finder, const spacemouse_settings& settings = {})
      : finder_(&finder), settings_(settings) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "spacemouse"; }
  [[nodiscard]] driver_maturity maturity() const noexcept override { return driver_maturity::protocol_tested; }
  [[nodiscard]] result<std::vector<device_listing>> list() override;
  /// @return invalid_argument where the listing is another driver's
  [[nodiscard]] result<any_device> make(const device_listing& which) override;

  /// As make(), with what only a SpaceMouse has: light, battery, the wrench to show.
  [[nodiscard]] result<spacemouse_device> make_spacemouse(const device_listing& which);

 private:
  hid_finder* finder_;
  spacemouse_settings settings_;
};

/// The listed interface as the driver shows it; nothing where it is no SpaceMouse.
[[nodiscard]] ASPERITY_API std::optional<device_listing> as_spacemouse(const hid_listing& which,
                                                                       const spacemouse_settings& settings = {});

/// Which of several interfaces a SpaceMouse remembered by identity and last path is now.
/// @return io_failed where it is not there, or where two could be it
[[nodiscard]] ASPERITY_API result<hid_listing> find_spacemouse_again(const std::vector<hid_listing>& now,
                                                                     const std::string& identity,
                                                                     const std::string& last_path);

}  // namespace asperity
