// A driver of the build that does not come back keeps no list waiting.
#include "command/patient_driver.hpp"

#include <chrono>
#include <future>
#include <gtest/gtest.h>
#include <memory>
#include <string>
#include <vector>

#include "asperity/device/device_directory.hpp"
#include "child_rig.hpp"

namespace asperity::plugin {
namespace {

using namespace child_tests;
using namespace std::chrono_literals;

// A driver of the build whose bus does not answer until it is told to.
class waiting_driver final : public device_driver {
 public:
  explicit waiting_driver(std::shared_future<void> answer) : answer_(std::move(answer)) {}
  [[nodiscard]] std::string_view name() const noexcept override { return "waiting"; }
  [[nodiscard]] driver_maturity maturity() const noexcept override { return driver_maturity::simulated; }
  [[nodiscard]] result<std::vector<device_listing>> list() override {
    answer_.wait();
    return std::vector<device_listing>(1);
  }
  [[nodiscard]] result<any_device> make(const device_listing&) override {
    return error{error_code::unsupported, "it makes none"};
  }

 private:
  std::shared_future<void> answer_;
};

TEST(drivers_of_the_build, one_that_hangs_is_left_behind_and_the_others_are_listed) {
  std::promise<void> answers;
  auto uses = std::make_shared<int>(1);
  const std::weak_ptr<int> used = uses;
  const auto waiting = std::make_shared<waiting_driver>(answers.get_future().share());
  std::vector<std::unique_ptr<device_driver>> all;
  all.push_back(std::make_unique<command::patient_driver>(waiting, std::move(uses), 50ms));
  std::promise<void> at_once;
  at_once.set_value();
  all.push_back(std::make_unique<command::patient_driver>(
      std::make_shared<waiting_driver>(at_once.get_future().share()), nullptr, 10s));
  {
    device_directory directory(std::move(all));
    const std::int64_t begin_ns = clock_ns();
    static_cast<void>(directory.refresh());
    static_cast<void>(directory.refresh());
    EXPECT_LT(seconds_since(begin_ns), 5.0);
    EXPECT_EQ(directory.devices().size(), 1U);
    ASSERT_EQ(directory.problems().size(), 1U);
    EXPECT_NE(directory.problems()[0].why.message.find("50 ms"), std::string::npos)
        << directory.problems()[0].why.message;
  }
  EXPECT_FALSE(used.expired()) << "what it uses stays until it is out of there";
  answers.set_value();
  EXPECT_TRUE(wait_until(10s, [&] { return used.expired(); }));
}

}  // namespace
}  // namespace asperity::plugin
