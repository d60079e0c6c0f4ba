#include "can_devices.hpp"

#include <string>

#include "asperity/can/socketcan.hpp"
#include "text.hpp"

namespace asperity::command {

void add_can_interfaces(answer& devices) {
  devices.document["can_interfaces"] = json::array();
  for (can::interface_state i : can::list_interfaces()) {
    if (i.problem.empty()) {
      if (const result<void> support = can::check_support(); !support) i.problem = printable(support.error().message);
    }
    devices.document["can_interfaces"].push_back({{"name", i.name},
                                                  {"driver", i.driver.empty() ? json() : json(i.driver)},
                                                  {"fd", i.fd},
                                                  {"up", i.up},
                                                  {"running", i.running},
                                                  {"problem", i.problem.empty() ? json() : json(i.problem)}});
    const std::string kind = std::string(i.fd ? "CAN FD" : "classic CAN") +
                             (i.driver.empty() ? ", no device behind it" : ", driver " + i.driver);
    devices.text += row(i.name, kind + (i.problem.empty() ? "; up" : ": " + i.problem));
  }
}

}  // namespace asperity::command
