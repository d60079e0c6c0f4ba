// Devices come, go and come back elsewhere; two are felt at once.
#include <gtest/gtest.h>

#include <asperity/control/virtual_session.hpp>
#include <asperity/device/device_directory.hpp>
#include <asperity/device/simulated/simulated_device.hpp>

#include "unit/control/analytic_wall.hpp"

namespace {

using namespace asperity;
using test_support::analytic_wall;

// A bus whose sockets the test fills and empties. Every device is a simulated one with a seed.
struct scripted_bus {
  std::vector<device_listing> plugged;
  std::optional<error> fault;
};

class scripted_driver final : public device_driver {
 public:
  scripted_driver(std::string name, std::shared_ptr<scripted_bus> bus) : name_(std::move(name)), bus_(std::move(bus)) {}
  std::string_view name() const noexcept override { return name_; }
  driver_maturity maturity() const noexcept override { return driver_maturity::simulated; }
  result<std::vector<device_listing>> list() override {
    if (bus_->fault) return *bus_->fault;
    return bus_->plugged;
  }
  result<any_device> make(const device_listing& which) override {
    simulated_settings settings;
    settings.seed = static_cast<std::uint64_t>(which.identity.back() - '0');
    settings.motion = {.kind = motion_kind::press, .T_dh = {quat(1, 0, 0, 0), {0, 0, 0.002}}, .depth_m = 0.01};
    if (which.identity == "arm:2") settings.faults = {{device_fault::depart, 400'000'000, 2'000'000'000}};
    return any_device(simulated_device(settings));
  }

 private:
  std::string name_;
  std::shared_ptr<scripted_bus> bus_;
};

device_listing listing(std::string identity, std::string path, std::string name = "Arm") {
  return {.driver = "arm", .identity = std::move(identity), .path = std::move(path), .name = std::move(name)};
}

struct directory_test : ::testing::Test {
  std::shared_ptr<scripted_bus> arms = std::make_shared<scripted_bus>();
  std::shared_ptr<scripted_bus> pucks = std::make_shared<scripted_bus>();
  device_directory all{drivers()};

  std::vector<std::unique_ptr<device_driver>> drivers() const {
    std::vector<std::unique_ptr<device_driver>> out;
    out.push_back(std::make_unique<scripted_driver>("arm", arms));
    out.push_back(std::make_unique<scripted_driver>("puck", pucks));
    return out;
  }
};

TEST_F(directory_test, reports_everything_as_arrived_at_first_and_nothing_when_nothing_changed) {
  arms->plugged = {listing("arm:1", "/1"), listing("arm:2", "/2")};
  const auto first = all.refresh();
  ASSERT_EQ(first.size(), 2u);
  for (const directory_event& e : first) EXPECT_EQ(e.change, directory_change::arrived);
  EXPECT_EQ(first[1].device.identity, "arm:2");
  EXPECT_TRUE(all.refresh().empty());
}

TEST_F(directory_test, tells_a_device_that_returns_elsewhere_from_a_new_one) {
  arms->plugged = {listing("arm:1", "/1")};
  static_cast<void>(all.refresh());
  arms->plugged = {listing("arm:1", "/7"), listing("arm:2", "/1")};
  const auto events = all.refresh();
  ASSERT_EQ(events.size(), 2u);
  EXPECT_EQ(events[0].change, directory_change::moved);
  EXPECT_EQ(events[0].device.identity, "arm:1");
  EXPECT_EQ(events[0].device.path, "/7");
  EXPECT_EQ(events[0].former_path, "/1");
  EXPECT_EQ(events[1].change, directory_change::arrived);

  arms->plugged = {listing("arm:2", "/1")};
  const auto left = all.refresh();
  ASSERT_EQ(left.size(), 1u);
  EXPECT_EQ(left[0].change, directory_change::departed);
  EXPECT_EQ(left[0].device.path, "/7");
}

TEST_F(directory_test, says_which_driver_could_not_look_and_counts_its_devices_as_gone) {
  arms->plugged = {listing("arm:1", "/1")};
  static_cast<void>(all.refresh());
  arms->fault = error{error_code::io_failed, "no bus"};
  const auto events = all.refresh();
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].change, directory_change::departed);
  ASSERT_EQ(all.problems().size(), 1u);
  EXPECT_EQ(all.problems()[0].driver, "arm");
  EXPECT_EQ(all.problems()[0].why.message, "no bus");
}

TEST_F(directory_test, finds_the_device_that_is_meant_or_names_the_choices) {
  arms->plugged = {listing("arm:1", "/1", "Left arm"), listing("arm:2", "/2", "Right arm")};
  static_cast<void>(all.refresh());
  EXPECT_EQ(all.find("arm:2")->path, "/2");
  EXPECT_EQ(all.find("/1")->identity, "arm:1");
  EXPECT_EQ(all.find("Right")->identity, "arm:2");
  const auto several = all.find("arm");
  ASSERT_FALSE(several);
  EXPECT_NE(several.error().message.find("arm:1 (Left arm), arm:2 (Right arm)"), std::string::npos);
  const auto none = all.find("puck");
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, error_code::invalid_argument);
  EXPECT_NE(none.error().message.find("there are: arm:1"), std::string::npos);
  arms->plugged[0].not_openable = "no permission; install the rule";
  static_cast<void>(all.refresh());
  const auto shut = all.make(*all.find("arm:1"));
  ASSERT_FALSE(shut);
  EXPECT_NE(shut.error().message.find("install the rule"), std::string::npos);
}

// What one device's session came to, tick by tick.
struct felt {
  std::vector<session_record>* records;
  void operator()(const session_record& r) noexcept { records->push_back(r); }
};

struct one_hand {
  std::vector<session_record> records;
  any_device device;
  virtual_session<analytic_wall, any_device, felt> session;

  explicit one_hand(any_device d)
      : device(std::move(d)),
        session(analytic_wall{}, {{pose{}}, vec3(0.0)}, device, control_settings{}, {}, felt{&records}) {
    records.reserve(2000);
    EXPECT_TRUE(device.open() && device.arm());
  }
};

bool same_wrench(const session_record& a, const session_record& b) {
  return a.on_hand_d.force == b.on_hand_d.force && a.on_hand_d.torque == b.on_hand_d.torque;
}

TEST_F(directory_test, two_devices_at_once_do_not_feel_each_other_not_even_when_one_is_unplugged) {
  arms->plugged = {listing("arm:1", "/1"), listing("arm:2", "/2")};
  static_cast<void>(all.refresh());
  one_hand alone(*all.make(*all.find("arm:1")));
  one_hand left(*all.make(*all.find("arm:1")));
  one_hand right(*all.make(*all.find("arm:2")));
  for (int tick = 0; tick < 1000; ++tick) {
    static_cast<void>(left.session.step());
    static_cast<void>(right.session.step());
    static_cast<void>(alone.session.step());
  }
  EXPECT_NE(right.session.device().gate().fault(), gate_fault::none);
  EXPECT_EQ(right.device.state(), device_state::fault);
  EXPECT_EQ(left.device.state(), device_state::active);
  ASSERT_EQ(left.records.size(), alone.records.size());
  double strongest = 0.0;
  for (std::size_t i = 0; i < alone.records.size(); ++i) {
    ASSERT_TRUE(same_wrench(left.records[i], alone.records[i])) << "tick " << i;
    strongest = std::max(strongest, glm::length(alone.records[i].on_hand_d.force));
  }
  EXPECT_GT(strongest, 0.5);  // newtons: there was something to feel
}

TEST_F(directory_test, a_device_that_returns_elsewhere_is_opened_anew_and_armed_by_nobody) {
  arms->plugged = {listing("arm:2", "/2")};
  static_cast<void>(all.refresh());
  one_hand hand(*all.make(*all.find("arm:2")));
  for (int tick = 0; tick < 1000; ++tick) static_cast<void>(hand.session.step());
  ASSERT_EQ(hand.device.state(), device_state::fault);

  arms->plugged = {listing("arm:2", "/9")};
  const auto events = all.refresh();
  ASSERT_EQ(events.size(), 1u);
  ASSERT_EQ(events[0].change, directory_change::moved);
  for (int tick = 0; tick < 100; ++tick) static_cast<void>(hand.session.step());
  EXPECT_EQ(hand.device.state(), device_state::fault);

  result<any_device> again = all.make(events[0].device);
  ASSERT_TRUE(again);
  EXPECT_FALSE(may_put_out(again->state()));
  ASSERT_TRUE(again->open());
  EXPECT_EQ(again->state(), device_state::ready);
}

}  // namespace
