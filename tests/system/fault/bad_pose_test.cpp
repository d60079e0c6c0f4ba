// Poses and sizes that no tick may see: exit status 1 and a sentence that says what to do.
#include "command_process.hpp"

namespace fault {
namespace {

class bad_pose : public command_test {
 protected:
  [[nodiscard]] static arguments query(const std::string& probe_pose, const std::string& fixed_pose) {
    const std::string pin = (small_models() / "pin.glb").string();
    return {"query", "--probe", pin, "--fixed", pin, "--probe-pose", probe_pose, "--fixed-pose", fixed_pose};
  }
};

const char* const identity = "0 0 0 0 0 0 1";

TEST_F(bad_pose, not_a_number) {
  const std::string message = expect_failure(query("0 nan 0 0 0 0 1", identity), 1, "invalid_argument");
  EXPECT_NE(message.find("--probe-pose"), std::string::npos);
  expect_failure(query("0 0 0 0 0 0 nan", identity), 1, "invalid_argument");
  EXPECT_NE(expect_failure(query(identity, "0 0 nan 0 0 0 1"), 1, "invalid_argument").find("--fixed-pose"),
            std::string::npos);
}

TEST_F(bad_pose, infinite) {
  expect_failure(query("inf 0 0 0 0 0 1", identity), 1, "invalid_argument");
  expect_failure(query("0 0 0 0 -inf 0 1", identity), 1, "invalid_argument");
}

TEST_F(bad_pose, quaternion_that_is_not_of_unit_length) {
  for (const char* pose : {"0 0 0 0 0 0 0", "0 0 0 0 0 0 2", "0 0 0 1 1 0 0", "0 0 0 0 0 0 0.999"}) {
    const std::string message = expect_failure(query(pose, identity), 1, "invalid_argument");
    EXPECT_NE(message.find("length"), std::string::npos) << message;
  }
}

TEST_F(bad_pose, quaternion_of_unit_length_within_the_digits_that_people_type) {
  static_cast<void>(expect_document(query("0 0 0.2 0 0 0.7071068 0.7071068", identity), "asperity.query/1"));
}

}  // namespace
}  // namespace fault
