// The simulated device of this library behind the C interface.
#include <memory>
#include <vector>

#include "asperity/device/driver_export.hpp"
#include "asperity/device/simulated/simulated_device.hpp"

namespace {

using namespace asperity;

class simulated_handle : public simulated_device {
 public:
  using simulated_device::simulated_device;
  ~simulated_handle() { close(); }

  [[nodiscard]] bool provoke(provocation what) {
    if (what == provocation::departure) unplug();
    if (what == provocation::comeback) plug_in();
    return what != provocation::write_failure;
  }
};

struct simulated_driver {
  static constexpr driver_description description{.name = "simulated",
                                                  .version = "1",
                                                  .licence = "Apache-2.0",
                                                  .vendor = "the asperity authors",
                                                  .maturity = driver_maturity::simulated};

  static result<std::vector<device_listing>> list() {
    return std::vector<device_listing>{{.driver = description.name,
                                        .identity = "simulated:1",
                                        .path = "nowhere",
                                        .name = "simulated device",
                                        .maturity = description.maturity,
                                        .capabilities = simulated_capabilities()}};
  }
  static result<std::unique_ptr<simulated_handle>> make(const device_listing& /*which*/) {
    driver_log::say(ASPERITY_LOG_INFO, "a simulated device is made");
    return std::make_unique<simulated_handle>();
  }
};

}  // namespace

ASPERITY_EXPORT_DRIVER(simulated_driver);
