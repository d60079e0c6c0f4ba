// The driver: which devices are there, and how one is made. The last line makes the C interface of it.
#include <memory>
#include <vector>

#include <asperity/device/driver_export.hpp>

#include "spring_handle.hpp"

namespace sample {

struct spring_handle_driver {
  static constexpr asperity::driver_description description{.name = "spring_handle",
                                                            .version = "1.0",
                                                            .licence = "Apache-2.0",
                                                            .vendor = "the asperity authors",
                                                            .maturity = asperity::driver_maturity::simulated};

  static asperity::result<std::vector<asperity::device_listing>> list() {
    // Here: look for your vendor and product number on the bus. A device that is there and cannot be opened is listed
    // as well, with `not_openable` saying why and how to mend it.
    asperity::device_listing one{.driver = description.name,
                                 .identity = "sample:spring-handle:0001",
                                 .path = "nowhere",
                                 .name = "spring handle (pretended)",
                                 .maturity = description.maturity,
                                 .capabilities = spring_handle_capabilities()};
    return std::vector<asperity::device_listing>{one};
  }

  static asperity::result<std::unique_ptr<spring_handle>> make(const asperity::device_listing& which) {
    if (which.identity != "sample:spring-handle:0001") {
      return asperity::error{asperity::error_code::invalid_argument,
                             "there is no spring handle " + which.identity + "; list the devices again"};
    }
    return std::make_unique<spring_handle>();
  }
};

}  // namespace sample

ASPERITY_EXPORT_DRIVER(sample::spring_handle_driver);
