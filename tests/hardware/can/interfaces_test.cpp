// The list of CAN interfaces, read from folders like the kernel's.
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <string>
#include <unistd.h>

#include "asperity/can/socketcan.hpp"

namespace asperity::can_interfaces_test {
namespace {

namespace fs = std::filesystem;

class can_interfaces : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(root); }
  void TearDown() override { fs::remove_all(root); }

  void add(const std::string& name, int type, int mtu, const std::string& flags, const std::string& carrier,
           const std::string& driver = {}) const {
    fs::create_directories(root / name);
    write(name, "type", std::to_string(type));
    write(name, "mtu", std::to_string(mtu));
    write(name, "flags", flags);
    write(name, "carrier", carrier);
    if (driver.empty()) return;
    fs::create_directories(root / name / "device");
    fs::create_symlink("../../../bus/pci/drivers/" + driver, root / name / "device/driver");
  }
  void write(const std::string& name, const char* file, const std::string& text) const {
    std::ofstream(root / name / file) << text << '\n';
  }

  fs::path root = fs::temp_directory_path() / ("asperity-can-interfaces-" + std::to_string(::getpid()));
};

TEST_F(can_interfaces, are_reported_with_their_driver_and_what_is_wrong) {
  add("vcan0", 280, 72, "0xc1", "1");
  add("can1", 280, 16, "0x80", "", "kvaser_pci");
  add("can0", 280, 72, "0x400c1", "0", "mcp251xfd");
  add("eth0", 1, 1500, "0x1003", "1", "virtio_net");
  fs::create_directories(root / "vanishing");
  add("odd", 280, 72, "0xzz", "1");
  const auto all = can::list_interfaces(root);
  ASSERT_EQ(all.size(), 4U);
  EXPECT_EQ(all[0].name, "can0");
  EXPECT_EQ(all[0].driver, "mcp251xfd");
  EXPECT_TRUE(all[0].up && all[0].fd);
  EXPECT_FALSE(all[0].running);
  EXPECT_NE(all[0].problem.find("ip link set can0 down && ip link set can0 up"), std::string::npos) << all[0].problem;
  EXPECT_EQ(all[1].name, "can1");
  EXPECT_EQ(all[1].driver, "kvaser_pci");
  EXPECT_FALSE(all[1].up || all[1].running || all[1].fd);
  EXPECT_NE(all[1].problem.find("ip link set can1 up type can bitrate"), std::string::npos) << all[1].problem;
  EXPECT_FALSE(all[2].up) << "flags that cannot be read are no flags";
  EXPECT_EQ(all[3].name, "vcan0");
  EXPECT_EQ(all[3].driver, "");
  EXPECT_TRUE(all[3].up && all[3].running && all[3].fd);
  EXPECT_EQ(all[3].problem, "");
}

TEST_F(can_interfaces, are_none_where_the_kernel_shows_none) {
  EXPECT_TRUE(can::list_interfaces(root).empty());
  EXPECT_TRUE(can::list_interfaces(root / "absent").empty());
}

}  // namespace
}  // namespace asperity::can_interfaces_test
