// Drivers in modules: good ones work, others are refused or put into their fault, with the cause.
#include <cmath>
#include <cstring>
#include <dlfcn.h>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <memory>
#include <string>
#include <unistd.h>
#include <vector>

#include "asperity/device/driver_conversion.hpp"
#include "asperity/device/simulated/simulated_device.hpp"
#include "asperity/plugin/plugin_driver.hpp"
#include "module_files.hpp"

namespace asperity::plugin {
namespace {

using test_support::broken_way;

constexpr std::int64_t ms = 1'000'000;

std::unique_ptr<plugin_driver> load(const std::filesystem::path& file, log_sink log = {}) {
  result<std::unique_ptr<plugin_driver>> driver = plugin_driver::load(file, std::move(log), file_trust::as_named);
  EXPECT_TRUE(driver) << driver.error().message;
  return driver ? std::move(driver).value() : nullptr;
}

plugin_device make_first(plugin_driver& driver) {
  const result<std::vector<device_listing>> listed = driver.list();
  EXPECT_TRUE(listed) << listed.error().message;
  result<plugin_device> device = driver.make_plugin(listed->at(0));
  EXPECT_TRUE(device) << device.error().message;
  return std::move(device).value();
}

// The broken driver's device, broken in a way that still lets it be made.
plugin_device make_broken(const std::string& way) {
  const broken_way chosen(way);
  const std::unique_ptr<plugin_driver> driver = load(test_support::broken_driver);
  return make_first(*driver);
}

device_command push(std::int64_t now_ns, const vec3& force) {
  return {.on_hand = {force, vec3(0.0)},
          .frame = wrench_frame::device_base,
          .valid_until_ns = now_ns + 20 * ms,
          .sequence = 1};
}

// So many ticks with one command. @return the last answer of write()
status run(plugin_device& device, std::int64_t& now_ns, int ticks, const vec3& force, device_sample* last = nullptr) {
  device_sample in;
  status written = status::ok;
  for (int i = 0; i < ticks; ++i) {
    now_ns += ms;
    static_cast<void>(device.read(now_ns, in));
    written = device.write(now_ns, push(now_ns, force));
  }
  if (last != nullptr) *last = in;
  return written;
}

TEST(plugin, the_sample_driver_from_listing_to_closing) {
  const std::unique_ptr<plugin_driver> driver = load(test_support::sample_driver);
  EXPECT_EQ(driver->name(), "spring_handle");
  EXPECT_EQ(driver->maturity(), driver_maturity::simulated);
  const result<std::vector<device_listing>> listed = driver->list();
  ASSERT_TRUE(listed);
  ASSERT_EQ(listed->size(), 1U);
  EXPECT_EQ(listed->at(0).identity, "sample:spring-handle:0001");
  EXPECT_EQ(listed->at(0).capabilities.peak_force_n, 4.0);
  EXPECT_EQ(listed->at(0).capabilities.name, "spring handle");
  EXPECT_FALSE(listed->at(0).not_openable);

  result<any_device> device = driver->make(listed->at(0));
  ASSERT_TRUE(device) << device.error().message;
  EXPECT_EQ(device->state(), device_state::present);
  EXPECT_FALSE(device->arm());
  ASSERT_TRUE(device->open());
  EXPECT_EQ(device->state(), device_state::ready);
  ASSERT_TRUE(device->arm());
  EXPECT_EQ(device->state(), device_state::armed);

  // Half a newton along +y against 80 N/m: units, signs and axes come through.
  std::int64_t now_ns = 0;
  device_sample in;
  for (int i = 0; i < 1000; ++i) {
    now_ns += ms;
    ASSERT_EQ(device->read(now_ns, in), status::ok);
    ASSERT_EQ(device->write(now_ns, push(now_ns, {0.0, 0.5, 0.0})), status::ok);
  }
  EXPECT_EQ(device->state(), device_state::active);
  EXPECT_NEAR(in.T_dh.position.y, 0.5 / 80.0, 1e-5);
  EXPECT_EQ(in.T_dh.position.x, 0.0);
  EXPECT_EQ(in.valid, sample_field::position);
  EXPECT_EQ(device->disarm(), status::ok);
  EXPECT_EQ(device->state(), device_state::ready);
  device->close();
  EXPECT_EQ(device->state(), device_state::closed);
  EXPECT_EQ(device->read(now_ns, in), status::not_ready);
}

TEST(plugin, the_simulated_device_is_the_same_behind_the_interface_to_the_bit) {
  const std::unique_ptr<plugin_driver> driver = load(test_support::simulated_driver);
  plugin_device behind = make_first(*driver);
  simulated_device direct;
  ASSERT_TRUE(behind.open() && behind.arm() && direct.open() && direct.arm());
  for (std::int64_t now_ns = ms; now_ns < 500 * ms; now_ns += ms) {
    device_sample a;
    device_sample b;
    ASSERT_EQ(behind.read(now_ns, a), direct.read(now_ns, b));
    const asperity_sample bits_a = abi::to_abi(a);
    const asperity_sample bits_b = abi::to_abi(b);
    ASSERT_EQ(std::memcmp(&bits_a, &bits_b, sizeof bits_a), 0) << now_ns;
    const device_command c = push(now_ns, {1.5 * std::sin(1e-8 * static_cast<double>(now_ns)), 0.25, -1.0});
    ASSERT_EQ(behind.write(now_ns, c), direct.write(now_ns, c));
  }
}

TEST(plugin, a_table_that_cannot_be_used_is_refused_with_its_fault) {
  const std::pair<const char*, table_fault> ways[] = {{"no_table", table_fault::refused},
                                                      {"wrong_struct_size", table_fault::struct_size},
                                                      {"wrong_abi_major", table_fault::abi_major},
                                                      {"no_disarm", table_fault::mandatory},
                                                      {"no_name", table_fault::text}};
  for (const auto& [way, fault] : ways) {
    SCOPED_TRACE(way);
    const broken_way chosen(way);
    load_failure failure{};
    EXPECT_EQ(driver_module::load(test_support::broken_driver, {}, failure, file_trust::as_named), nullptr);
    EXPECT_EQ(failure.fault, fault) << failure.why.message;
    EXPECT_NE(failure.why.message.find(test_support::broken_driver.string()), std::string::npos);
  }
}

TEST(plugin, a_file_that_is_no_driver_is_refused) {
  load_failure failure{};
  EXPECT_EQ(driver_module::load("/nowhere/driver.so", {}, failure, file_trust::as_named), nullptr);
  EXPECT_EQ(failure.fault, table_fault::not_loadable);

  const std::filesystem::path text = std::filesystem::path(testing::TempDir()) / "text.so";
  std::ofstream(text) << "not a shared object";
  EXPECT_EQ(driver_module::load(text, {}, failure, file_trust::as_named), nullptr);
  EXPECT_EQ(failure.fault, table_fault::not_loadable);
  std::filesystem::remove(text);

  Dl_info c_library{};
  ASSERT_NE(::dladdr(reinterpret_cast<void*>(&::getpid), &c_library), 0);
  EXPECT_EQ(driver_module::load(c_library.dli_fname, {}, failure, file_trust::as_named), nullptr);
  EXPECT_EQ(failure.fault, table_fault::no_entry) << failure.why.message;
}

TEST(plugin, a_driver_that_is_part_of_the_program) {
  const result<std::shared_ptr<const driver_module>> loaded =
      driver_module::load(test_support::sample_driver, {}, file_trust::as_named);
  ASSERT_TRUE(loaded);
  const result<std::shared_ptr<const driver_module>> built_in =
      driver_module::from_table(&(*loaded)->table(), "in this program");
  ASSERT_TRUE(built_in);
  plugin_driver driver(*built_in);
  plugin_device device = make_first(driver);
  EXPECT_TRUE(device.open());
  EXPECT_EQ((*built_in)->where(), "in this program");
  EXPECT_FALSE(driver_module::from_table(nullptr, "nowhere"));
}

TEST(plugin, older_and_newer_tables_work_with_what_both_sides_know) {
  for (const char* way : {"older", "newer", "nothing_optional"}) {
    SCOPED_TRACE(way);
    plugin_device device = make_broken(way);
    ASSERT_TRUE(device.open() && device.arm());
    std::int64_t now_ns = 0;
    device_sample last;
    EXPECT_EQ(run(device, now_ns, 1000, {0.5, 0.0, 0.0}, &last), status::ok);
    EXPECT_NEAR(last.T_dh.position.x, 0.5 / 80.0, 1e-5);
  }
}

TEST(plugin, structs_of_another_size_keep_their_end) {
  // A caller that is older: it has room for less.
  struct {
    asperity_applied it;
    std::uint64_t behind;
  } small{};
  std::memset(static_cast<void*>(&small), 0x11, sizeof small);
  small.it.struct_size = offsetof(asperity_applied, torque_d_n_m);
  abi::copy_out(abi::to_abi(wrench{{1, 2, 3}, {4, 5, 6}}), small.it);
  EXPECT_EQ(small.it.struct_size, offsetof(asperity_applied, torque_d_n_m));
  EXPECT_EQ(small.it.force_d_n[2], 3.0);
  double untouched = 0.0;
  std::memset(&untouched, 0x11, sizeof untouched);
  EXPECT_EQ(std::memcmp(&small.it.torque_d_n_m[0], &untouched, sizeof untouched), 0);

  // A writer that is older: what it does not know is zero, whatever lies there.
  small.it.force_d_n[0] = 7.0;
  const asperity_applied in = abi::copy_in(small.it);
  EXPECT_EQ(in.force_d_n[0], 7.0);
  EXPECT_EQ(in.torque_d_n_m[0], 0.0);

  // Sizes that are none.
  small.it.struct_size = 0;
  abi::copy_out(abi::to_abi(wrench{}), small.it);
  EXPECT_EQ(small.it.force_d_n[0], 7.0);
  EXPECT_EQ(abi::copy_in(small.it).force_d_n[0], 0.0);
  small.it.struct_size = 0xffffffffU;
  EXPECT_EQ(abi::copy_in(small.it).struct_size, sizeof(asperity_applied));
}

TEST(plugin, texts_are_cut_between_characters) {
  char field[4];
  abi::put_text(field, "a\xc3\xa4\xc3\xa4");
  EXPECT_STREQ(field, "a\xc3\xa4");
  abi::put_text(field, "aa\xc3\xa4");
  EXPECT_STREQ(field, "aa");
  EXPECT_FALSE(abi::get_text(std::span<const char>("abcd", 4)));
}

TEST(plugin, nothing_but_arm_arms_whatever_the_driver_says) {
  {
    plugin_device device = make_broken("open_arms");
    const result<void> opened = device.open();
    ASSERT_FALSE(opened);
    EXPECT_NE(opened.error().message.find("armed after open()"), std::string::npos) << opened.error().message;
    EXPECT_FALSE(may_put_out(device.state()));
  }
  {
    plugin_device device = make_broken("unknown_state");
    EXPECT_FALSE(device.open());
  }
  {
    plugin_device device = make_broken("rearms_after_clear_fault");
    ASSERT_TRUE(device.open() && device.arm());
    std::int64_t now_ns = 0;
    run(device, now_ns, 5, {0.5, 0.0, 0.0});
    EXPECT_EQ(run(device, now_ns, 1, {std::nan(""), 0.0, 0.0}), status::not_finite);
    EXPECT_EQ(device.state(), device_state::fault);
    EXPECT_EQ(device.fault(), plugin_fault::bad_command);
    static_cast<void>(device.clear_fault());
    EXPECT_FALSE(may_put_out(device.state()));
    if (device.state() == device_state::fault) {
      EXPECT_TRUE(device.clear_fault());
    }
    EXPECT_EQ(device.state(), device_state::closed);
    EXPECT_FALSE(device.arm());
    device_sample in;
    EXPECT_EQ(device.read(now_ns, in), status::not_ready);
  }
}

TEST(plugin, a_driver_that_arms_itself_in_a_tick_is_in_fault) {
  plugin_device device = make_broken("arms_in_read");
  ASSERT_TRUE(device.open());
  std::int64_t now_ns = 0;
  run(device, now_ns, 18, {0.5, 0.0, 0.0});
  ASSERT_EQ(device.state(), device_state::ready);
  run(device, now_ns, 10, {0.5, 0.0, 0.0});
  EXPECT_EQ(device.state(), device_state::fault);
  EXPECT_EQ(device.fault(), plugin_fault::armed_itself);
}

TEST(plugin, a_device_that_leaves_is_absent_or_in_fault) {
  std::int64_t now_ns = 0;
  {
    plugin_device device = make_broken("vanishes");
    ASSERT_TRUE(device.open());
    run(device, now_ns, 30, vec3(0.0));
    EXPECT_EQ(device.state(), device_state::absent);
    EXPECT_EQ(device.fault(), plugin_fault::none);
  }
  plugin_device device = make_broken("vanishes");
  ASSERT_TRUE(device.open() && device.arm());
  EXPECT_EQ(run(device, now_ns, 15, {0.5, 0.0, 0.0}), status::ok);
  EXPECT_EQ(run(device, now_ns, 15, {0.5, 0.0, 0.0}), status::not_ready);
  EXPECT_EQ(device.state(), device_state::fault);
  EXPECT_EQ(device.fault(), plugin_fault::device_fault);
  EXPECT_NE(device.fault_text().find("its cable is out"), std::string::npos) << device.fault_text();
  EXPECT_TRUE(device.clear_fault());
  const result<void> opened = device.open();
  ASSERT_FALSE(opened);
  EXPECT_NE(opened.error().message.find("not plugged in"), std::string::npos) << opened.error().message;
  EXPECT_FALSE(may_put_out(device.state()));
}

TEST(plugin, exceptions_become_errors_and_faults) {
  {
    plugin_device device = make_broken("throws_in_open");
    const result<void> opened = device.open();
    ASSERT_FALSE(opened);
    EXPECT_NE(opened.error().message.find("thrown in open()"), std::string::npos) << opened.error().message;
  }
  {
    plugin_device device = make_broken("throws_in_read");
    ASSERT_TRUE(device.open() && device.arm());
    device_sample in;
    EXPECT_EQ(device.read(ms, in), status::backend_failed);
    EXPECT_EQ(device.state(), device_state::fault);
    EXPECT_EQ(device.fault(), plugin_fault::threw);
    EXPECT_NE(device.fault_text().find("exception"), std::string::npos);
  }
}

TEST(plugin, samples_that_cannot_be_are_refused) {
  const std::pair<const char*, status> ways[] = {{"nan", status::not_finite},
                                                 {"long_quaternion", status::invalid_pose}};
  for (const auto& [way, answer] : ways) {
    plugin_device device = make_broken(way);
    ASSERT_TRUE(device.open());
    device_sample in;
    in.sequence = 4711;
    EXPECT_EQ(device.read(ms, in), answer) << way;
    EXPECT_EQ(in.sequence, 4711U);
    EXPECT_EQ(device.state(), device_state::ready);
  }
}

TEST(plugin, commands_are_bounded_before_the_driver_sees_them) {
  plugin_device device = make_broken("nothing");
  ASSERT_TRUE(device.open() && device.arm());
  std::int64_t now_ns = 0;
  device_sample last;
  for (const double force : {1e6, 1e149}) {
    EXPECT_EQ(run(device, now_ns, 1000, {-force, 0.0, 0.0}, &last), status::ok);
    EXPECT_NEAR(last.T_dh.position.x, -4.0 / 80.0, 1e-4) << force;
  }
  // Past its time: zero, and the handle goes back to its middle.
  for (int i = 0; i < 1000; ++i) {
    now_ns += ms;
    device_command old = push(now_ns, {4.0, 0.0, 0.0});
    old.valid_until_ns = now_ns - 1;
    ASSERT_EQ(device.read(now_ns, last), status::ok);
    ASSERT_EQ(device.write(now_ns, old), status::stale_input);
  }
  EXPECT_NEAR(last.T_dh.position.x, 0.0, 1e-5);
  // Not armed: nothing is put out.
  EXPECT_EQ(device.disarm(), status::ok);
  EXPECT_EQ(run(device, now_ns, 200, {4.0, 0.0, 0.0}, &last), status::ok);
  EXPECT_NEAR(last.T_dh.position.x, 0.0, 1e-5);
  EXPECT_EQ(device.state(), device_state::ready);
  // Another frame.
  ASSERT_TRUE(device.arm());
  device_command world = push(now_ns, {1.0, 0.0, 0.0});
  world.frame = wrench_frame::world;
  EXPECT_EQ(device.write(now_ns, world), status::not_finite);
  EXPECT_EQ(device.state(), device_state::fault);
}

TEST(plugin, what_reaches_a_driver_is_bounded_whatever_it_would_do_with_it) {
  plugin_device device = make_broken("echoes");
  ASSERT_TRUE(device.open());
  std::int64_t now_ns = ms;
  const auto applied = [&](const device_command& c) {
    now_ns += ms;
    device_sample in;
    static_cast<void>(device.write(now_ns, c));
    static_cast<void>(device.read(now_ns, in));
    return in.T_dh.position;
  };
  EXPECT_EQ(applied(push(now_ns, {1.0, 0.0, 0.0})), vec3(0.0)) << "ready";
  ASSERT_TRUE(device.arm());
  EXPECT_EQ(applied(push(now_ns, {1.0, 0.0, 0.0})), vec3(0.001, 0.0, 0.0));
  const vec3 bounded = applied(push(now_ns, {0.0, -3e5, 4e5}));
  EXPECT_NEAR(glm::length(bounded), 0.004, 1e-12);
  EXPECT_NEAR(bounded.y / bounded.z, -0.75, 1e-12);
  device_command old = push(now_ns, {1.0, 0.0, 0.0});
  old.valid_until_ns = now_ns;  // the clock has gone on when it arrives
  EXPECT_EQ(applied(old), vec3(0.0)) << "expired";
  EXPECT_EQ(device.disarm(), status::ok);
  EXPECT_EQ(applied(push(now_ns, {1.0, 0.0, 0.0})), vec3(0.0)) << "disarmed";
}

TEST(plugin, limits_do_not_move) {
  plugin_device device = make_broken("moves_limits");
  ASSERT_TRUE(device.open() && device.arm());
  EXPECT_EQ(device.capabilities().peak_force_n, 4.0);
}

TEST(plugin, capabilities_that_cannot_be_are_refused) {
  const broken_way chosen("negative_limit");
  const std::unique_ptr<plugin_driver> driver = load(test_support::broken_driver);
  const result<std::vector<device_listing>> listed = driver->list();
  ASSERT_TRUE(listed);
  const result<plugin_device> device = driver->make_plugin(listed->at(0));
  ASSERT_FALSE(device);
  EXPECT_NE(device.error().message.find("moving_mass_kg"), std::string::npos) << device.error().message;

  const asperity_capabilities good = abi::to_abi(simulated_capabilities());
  EXPECT_FALSE(find_problem(good));
  for (double asperity_capabilities::*field :
       {&asperity_capabilities::continuous_force_n, &asperity_capabilities::peak_torque_n_m,
        &asperity_capabilities::force_slew_n_per_s, &asperity_capabilities::nominal_rate_hz}) {
    for (const double bad : {-1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
      asperity_capabilities c = good;
      c.*field = bad;
      EXPECT_TRUE(find_problem(c));
    }
  }
  asperity_capabilities c = good;
  std::memset(c.name, 'x', sizeof c.name);
  EXPECT_TRUE(find_problem(c));
  c = good;
  c.actuated = 0x40;
  EXPECT_TRUE(find_problem(c));
  c = good;
  std::swap(c.workspace_low_d_m, c.workspace_high_d_m);
  EXPECT_TRUE(find_problem(c));
}

TEST(plugin, what_a_driver_lists_is_looked_at) {
  {
    const broken_way chosen("list_without_end");
    const result<std::vector<device_listing>> listed = load(test_support::broken_driver)->list();
    ASSERT_FALSE(listed);
    EXPECT_NE(listed.error().message.find("identity has no zero byte"), std::string::npos) << listed.error().message;
  }
  const broken_way chosen("fails_to_list");
  const result<std::vector<device_listing>> listed = load(test_support::broken_driver)->list();
  ASSERT_FALSE(listed);
  EXPECT_NE(listed.error().message.find("the bus is on fire"), std::string::npos) << listed.error().message;
}

TEST(plugin, a_module_stays_until_its_last_device_is_gone) {
  const auto is_loaded = [] {
    void* handle = ::dlopen(test_support::simulated_driver.c_str(), RTLD_NOW | RTLD_NOLOAD);
    if (handle != nullptr) ::dlclose(handle);
    return handle != nullptr;
  };
  ASSERT_FALSE(is_loaded());
  {
    std::vector<std::string> lines;
    std::unique_ptr<plugin_driver> driver =
        load(test_support::simulated_driver, [&](std::uint32_t level, std::string_view from, std::string_view line) {
          lines.push_back(std::to_string(level) + " " + std::string(from) + ": " + std::string(line));
        });
    plugin_device device = make_first(*driver);
    EXPECT_EQ(lines, std::vector<std::string>{"1 simulated: a simulated device is made"});
    driver.reset();
    EXPECT_TRUE(is_loaded());
    EXPECT_TRUE(device.open());
    device_sample in;
    EXPECT_EQ(device.read(ms, in), status::ok);
  }
  EXPECT_FALSE(is_loaded());
}

}  // namespace
}  // namespace asperity::plugin
