// A driver behind the C interface as a device_driver of this library.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "asperity/device/driver.hpp"
#include "asperity/plugin/driver_module.hpp"
#include "asperity/plugin/plugin_device.hpp"

namespace asperity::plugin {

class plugin_driver final : public device_driver {
 public:
  explicit plugin_driver(std::shared_ptr<const driver_module> module) : module_(std::move(module)) {}

  /// Loads a driver from a file into this process; see driver_module::load().
  [[nodiscard]] static result<std::unique_ptr<plugin_driver>> load(const std::filesystem::path& file, log_sink log = {},
                                                                   file_trust trust = file_trust::owner_only);

  [[nodiscard]] std::string_view name() const noexcept override { return module_->table().name; }
  [[nodiscard]] driver_maturity maturity() const noexcept override {
    return static_cast<driver_maturity>(module_->table().maturity);
  }
  /// Fails where the driver does, and where its list is impossible: a text without an end, limits that are no numbers,
  /// or more than 64 devices. The names in the listed capabilities belong to this driver until it lists again.
  [[nodiscard]] result<std::vector<device_listing>> list() override;
  [[nodiscard]] result<any_device> make(const device_listing& which) override;
  /// As make(), with the type kept.
  [[nodiscard]] result<plugin_device> make_plugin(const device_listing& which);

  [[nodiscard]] const driver_module& module() const noexcept { return *module_; }

 private:
  std::shared_ptr<const driver_module> module_;
  std::vector<std::unique_ptr<asperity_capabilities>> listed_;
};

}  // namespace asperity::plugin
