// The whole examination of one driver.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "ledger.hpp"
#include "progress.hpp"

namespace asperity::conformance {

struct kit_options {
  std::filesystem::path driver;
  std::optional<std::string> device{};  ///< identity; the first listed where not given
  bool hand_held = false;               ///< a person holds the device: wrenches may be put out
  std::string date{};                   ///< as the report shall show it
  int ticks = 2000;                     ///< of the session
};

/// What a vendor publishes.
struct report {
  std::string file{};
  std::string date{};
  std::string driver{}, version{}, licence{}, vendor{}, driver_maturity{}, abi{};
  std::string device{}, path{}, device_name{}, device_maturity{};
  bool hand_held = false;
  bool virtual_clock = false;
  ledger found{};
};

[[nodiscard]] report examine(const kit_options& options, progress& shared);

}  // namespace asperity::conformance
