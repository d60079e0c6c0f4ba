// A session that somebody breaks from outside of its loops: the device is at rest and disarmed all the same.
#include "session.hpp"

#include <algorithm>
#include <functional>
#include <gtest/gtest.h>
#include <memory>
#include <stdexcept>
#include <utility>

#include "asperity/device/simulated/simulated_device.hpp"
#include "unit/control/analytic_wall.hpp"

namespace {

using namespace asperity;
using namespace asperity::command;

struct wall : test_support::analytic_wall {
  [[nodiscard]] const asperity::scene& scene() const noexcept { return nothing; }
  [[nodiscard]] static std::size_t memory_bytes() noexcept { return 0; }
  asperity::scene nothing{};
};

struct seen_by_the_device {
  double largest_n = 0.0, last_n = 0.0;
  double at_first_disarm_n = -1.0;
  device_state at_end = device_state::armed;
};

// The simulated device with a witness that outlives it.
class witnessed {
 public:
  using policy_tag = device_tag;
  explicit witnessed(std::shared_ptr<seen_by_the_device> seen) : seen_(std::move(seen)) {}
  [[nodiscard]] const device_capabilities& capabilities() const noexcept { return device_.capabilities(); }
  [[nodiscard]] device_state state() const noexcept { return device_.state(); }
  [[nodiscard]] result<void> open() { return device_.open(); }
  [[nodiscard]] result<void> arm() { return device_.arm(); }
  [[nodiscard]] result<void> clear_fault() { return device_.clear_fault(); }
  status disarm() noexcept {
    if (seen_->at_first_disarm_n < 0.0) seen_->at_first_disarm_n = seen_->last_n;
    const status s = device_.disarm();
    seen_->at_end = device_.state();
    return s;
  }
  void close() noexcept { device_.close(); }
  [[nodiscard]] status read(std::int64_t now_ns, device_sample& in) noexcept { return device_.read(now_ns, in); }
  [[nodiscard]] status write(std::int64_t now_ns, const device_command& out) noexcept {
    seen_->last_n = glm::length(out.on_hand.force);
    seen_->largest_n = std::max(seen_->largest_n, seen_->last_n);
    return device_.write(now_ns, out);
  }

 private:
  std::shared_ptr<seen_by_the_device> seen_;
  simulated_device device_{{.motion = {.depth_m = 0.01, .approach_s = 0.05}}};
};

class broken_session : public testing::TestWithParam<session_clock> {
 protected:
  // Runs until on_tick has seen a push, which then does what it is told.
  result<session_outcome> run(std::function<result<void>()> at_push) {
    any_device device{witnessed(seen_)};
    EXPECT_TRUE(device.open());
    progress_line quiet(true);
    return run_session({.feel = any_renderer(wall{}),
                        .placement = {{pose{}}, vec3(0.0)},
                        .device = std::move(device),
                        .clock = GetParam(),
                        .seconds = 20.0,
                        .on_tick = [&](const session_record& r) -> result<void> {
                          return glm::length(r.on_hand_d.force) > 0.2 ? at_push() : result<void>();
                        }},
                       quiet);
  }
  std::shared_ptr<seen_by_the_device> seen_ = std::make_shared<seen_by_the_device>();
};

TEST_P(broken_session, by_an_exception_is_disarmed) {
  EXPECT_THROW(static_cast<void>(run([]() -> result<void> { throw std::runtime_error("no memory for a row"); })),
               std::runtime_error);
  EXPECT_GT(seen_->largest_n, 0.2);
  EXPECT_FALSE(may_put_out(seen_->at_end)) << to_string(seen_->at_end);
  EXPECT_EQ(seen_->at_first_disarm_n, 0.0);
}

TEST_P(broken_session, by_an_error_is_disarmed_and_says_so) {
  const result<session_outcome> ended = run([]() -> result<void> {
    return error{error_code::io_failed, "the disk is full"};
  });
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().message,
            "the disk is full (the session was ended: the wrench is zero, the device is disarmed)");
  EXPECT_FALSE(may_put_out(seen_->at_end)) << to_string(seen_->at_end);
  EXPECT_EQ(seen_->at_first_disarm_n, 0.0);
}

INSTANTIATE_TEST_SUITE_P(on_either_clock, broken_session,
                         testing::Values(session_clock::virtual_time, session_clock::real_time),
                         [](const auto& tested) {
                           return tested.param == session_clock::real_time ? "real" : "virtual";
                         });

}  // namespace
