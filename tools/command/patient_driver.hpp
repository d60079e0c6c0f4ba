// A driver of this build that is given a stated time to look.
#pragma once

#include <chrono>
#include <future>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "asperity/device/driver.hpp"

namespace asperity::command {

/// Lists in a thread of its own, because a bus can keep whoever asks it for as long as it likes. What does not come
/// back is left behind with everything that it uses, is not asked again, and ends with the program. What this cannot
/// help: a call that the kernel does not let go keeps the program from ending, too.
class patient_driver final : public device_driver {
 public:
  /// @param uses what the driver refers to, kept as long as anybody is in it
  patient_driver(std::shared_ptr<device_driver> driver, std::shared_ptr<const void> uses,
                 std::chrono::milliseconds patience = std::chrono::milliseconds(1900))
      : driver_(std::move(driver)), uses_(std::move(uses)), patience_(patience), name_(driver_->name()) {}

  [[nodiscard]] std::string_view name() const noexcept override { return name_; }
  [[nodiscard]] driver_maturity maturity() const noexcept override { return driver_->maturity(); }

  [[nodiscard]] result<std::vector<device_listing>> list() override {
    if (hangs_) return silent();
    using listed = result<std::vector<device_listing>>;
    auto promise = std::make_shared<std::promise<listed>>();
    std::future<listed> answer = promise->get_future();
    std::thread([promise, driver = driver_, uses = uses_] { promise->set_value(driver->list()); }).detach();
    if (answer.wait_for(patience_) == std::future_status::ready) return answer.get();
    hangs_ = true;
    return silent();
  }

  [[nodiscard]] result<any_device> make(const device_listing& which) override {
    if (hangs_) return silent();
    return driver_->make(which);
  }

 private:
  [[nodiscard]] error silent() const {
    return {error_code::io_failed, "looking for devices took longer than " + std::to_string(patience_.count()) +
                                       " ms and was given up: unplug what was plugged in last, and look again"};
  }

  std::shared_ptr<device_driver> driver_;
  std::shared_ptr<const void> uses_;
  std::chrono::milliseconds patience_;
  std::string name_;
  bool hangs_ = false;
};

}  // namespace asperity::command
