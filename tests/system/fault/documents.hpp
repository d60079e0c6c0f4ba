// What tests of the documents that --json promises (docs/reference/command.md) share.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <set>
#include <string>

#include "command_process.hpp"

namespace fault {

class documents : public command_test {
 protected:
  [[nodiscard]] static std::string block(const char* file = "block.glb") { return (small_models() / file).string(); }
  [[nodiscard]] static std::string pin() { return (small_models() / "pin.glb").string(); }
};

inline void expect_keys(const json& object, std::initializer_list<const char*> keys) {
  ASSERT_TRUE(object.is_object()) << object;
  std::set<std::string> wanted(keys.begin(), keys.end());
  std::set<std::string> found;
  for (const auto& [key, value] : object.items()) found.insert(key);
  EXPECT_EQ(found, wanted);
}

inline void expect_numbers(const json& array, std::size_t count) {
  ASSERT_TRUE(array.is_array()) << array;
  EXPECT_EQ(array.size(), count);
  for (const json& x : array) EXPECT_TRUE(x.is_number()) << array;
}

}  // namespace fault
