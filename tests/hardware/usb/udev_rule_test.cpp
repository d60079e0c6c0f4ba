// The rule that an error tells people to write is the one that an installation brings.
#include <fstream>
#include <gtest/gtest.h>
#include <string>

#include <asperity/drivers/falcon/falcon_driver.hpp>
#include <asperity/usb/usb.hpp>

namespace {

using namespace asperity;

TEST(udev_rule, is_a_line_of_the_installed_file) {
  std::ifstream file(ASPERITY_UDEV_RULES);
  ASSERT_TRUE(file) << ASPERITY_UDEV_RULES;
  std::string line;
  int found = 0;
  while (std::getline(file, line)) found += line == usb::udev_rule(falcon_vendor, falcon_product) ? 1 : 0;
  EXPECT_EQ(found, 1) << usb::udev_rule(falcon_vendor, falcon_product);
}

}  // namespace
