// What `run --move` is given, and where a body is by it.
#include "body_script.hpp"

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <string>

#include "support/fresh_seed.hpp"
#include "unit/control/drawn.hpp"

namespace {

using namespace asperity;
using namespace asperity::command;
using asperity::test_support::drawn;
using asperity::test_support::fresh_seed;
using asperity::test_support::seed_of;

const pose still{glm::normalize(quat(0.9, 0.1, -0.3, 0.2)), {0.1, -0.2, 0.3}};

body_script script(const std::string& text) {
  result<body_script> read = body_script::read(text, 3);
  EXPECT_TRUE(read) << text << ": " << read.error().message;
  return std::move(read).value();
}

// A file of the test's own that is gone at its end.
class table_file {
 public:
  explicit table_file(const std::string& text)
      : path_(std::filesystem::temp_directory_path() /
              ("asperity-moves-" + std::to_string(reinterpret_cast<std::uintptr_t>(this)) + ".csv")) {
    std::ofstream(path_) << text;
  }
  table_file(const table_file&) = delete;
  table_file& operator=(const table_file&) = delete;
  ~table_file() { std::filesystem::remove(path_); }
  [[nodiscard]] std::string name() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

/// No step in pose or velocity, and the velocity is that of the pose.
void expect_smooth(const body_script& s, double seconds, double most_m_per_s2, double most_rad_per_s2) {
  constexpr double h = 1e-4;
  body_motion last = s.at(0.0, still);
  EXPECT_LE(glm::length(last.velocity_w.linear), 1e-4);
  EXPECT_LE(glm::length(last.velocity_w.angular), 1e-4);
  for (double t = h; t < seconds; t += h) {
    const body_motion m = s.at(t, still);
    ASSERT_TRUE(is_valid(m.T_wb)) << t;
    EXPECT_LE(glm::length(m.velocity_w.linear - last.velocity_w.linear), 1.01 * most_m_per_s2 * h + 1e-7) << t;
    EXPECT_LE(glm::length(m.velocity_w.angular - last.velocity_w.angular), 1.01 * most_rad_per_s2 * h + 1e-7) << t;
    const vec3 mean = 0.5 * (m.velocity_w.linear + last.velocity_w.linear);
    EXPECT_LE(glm::length(m.T_wb.position - last.T_wb.position - h * mean), most_m_per_s2 * h * h + 1e-9) << t;
    last = m;
  }
}

TEST(BodyScript, AConveyorGoesToAndFroAtItsSpeed) {
  const body_script s = script("conveyor=0.05,0.02");
  EXPECT_EQ(s.body(), 0U);
  expect_smooth(s, 2.0, 0.5, 0.0);
  double low = 0.0, high = 0.0, even_s = 0.0;
  for (double t = 0.0; t < 2.4; t += 1e-3) {
    const body_motion m = s.at(t, still);
    const double x = m.T_wb.position.x - still.position.x;
    low = std::min(low, x);
    high = std::max(high, x);
    EXPECT_EQ(m.T_wb.position.y, still.position.y);
    EXPECT_LE(std::fabs(m.velocity_w.linear.x), 0.05 + 1e-9);
    if (std::fabs(std::fabs(m.velocity_w.linear.x) - 0.05) < 1e-6) even_s += 1e-3;
  }
  EXPECT_NEAR(low, 0.0, 1e-9);
  EXPECT_NEAR(high, 0.02 + 0.05 * 0.1, 1e-4);  // half of a turn at each end
  EXPECT_NEAR(even_s, 4 * 0.4, 0.01);          // 0.4 s each way, two laps of 1.2 s
  EXPECT_NEAR(script("conveyor=-0.05,0.02").at(0.3, still).velocity_w.linear.x, -0.05, 1e-6);
}

TEST(BodyScript, APendulumAndATurntableTurnAboutTheBodysOrigin) {
  const body_script swings = script("2:pendulum=5,0.8");
  EXPECT_EQ(swings.body(), 1U);
  const double fastest = glm::radians(5.0) * 6.2832 / 0.8;
  expect_smooth(swings, 2.0, 0.0, 30.0 * fastest);
  double most = 0.0;
  for (double t = 0.2; t < 2.0; t += 1e-3) {
    const vec3 turned = log_rotation(swings.at(t, still).T_wb.rotation * glm::conjugate(still.rotation));
    most = std::max(most, std::fabs(turned.y));
    EXPECT_NEAR(turned.x, 0.0, 1e-9);
    EXPECT_EQ(swings.at(t, still).T_wb.position, still.position);
  }
  EXPECT_NEAR(most, glm::radians(5.0), 1e-4);

  const body_script turns = script("3:turntable=-30");
  EXPECT_EQ(turns.body(), 2U);
  expect_smooth(turns, 3.0, 0.0, 3.1416 / 0.2);
  EXPECT_NEAR(turns.at(5.0, still).velocity_w.angular.z, -3.14159265, 1e-6);
}

TEST(BodyScript, ATableIsFollowedEvenly) {
  const table_file file(
      "time,x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,0,1\n1,0.1,0,0,0,0,0.7071067811865476,0.7071067811865476\n\n"
      "1.5,0.1,0,0.2,0,0,0.7071067811865476,0.7071067811865476\r\n");
  const body_script s = script("2:" + file.name());
  EXPECT_EQ(s.body(), 1U);
  EXPECT_EQ(s.begins_at(still).position, vec3(0.0));
  const body_motion m = s.at(0.5, still);
  EXPECT_NEAR(m.T_wb.position.x, 0.05, 1e-12);
  EXPECT_NEAR(m.velocity_w.linear.x, 0.1, 1e-9);
  EXPECT_NEAR(m.velocity_w.angular.z, 1.5707963, 1e-6);
  EXPECT_NEAR(s.at(1.25, still).T_wb.position.z, 0.1, 1e-12);
  EXPECT_EQ(s.at(9.0, still).T_wb.position.z, 0.2);
  EXPECT_EQ(s.at(9.0, still).velocity_w.linear, vec3(0.0));
}

TEST(BodyScript, SaysWhatIsWrongAndWhere) {
  for (const std::string text : {"conveyor=0.1", "2:pendulum=5,1", "turntable=-33.3", "motion.csv", "1:a b.csv"}) {
    EXPECT_EQ(body_script_error(text), "") << text;
  }
  for (const std::string text : {"", "conveyor", "conveyor=", "conveyor=nan", "conveyor=1,2,3", "conveyor=0.1,0",
                                 "conveyor=99", "pendulum=5", "pendulum=120,1", "pendulum=5,0", "turntable=1e9",
                                 "0:turntable=1", "wobble=3", "99999999999999999999:turntable=1"}) {
    EXPECT_NE(body_script_error(text), "") << text;
  }
  const auto failure = [](const std::string& text) {
    const result<body_script> read = body_script::read(text, 3);
    return read ? std::string() : read.error().message;
  };
  EXPECT_NE(failure("4:turntable=1").find("3 fixed bodies"), std::string::npos);
  EXPECT_NE(failure("/nowhere/moves.csv").find("no such file"), std::string::npos);
  const auto of_rows = [&](const std::string& rows) {
    const table_file file(rows);
    return failure(file.name());
  };
  EXPECT_NE(of_rows("").find("two rows"), std::string::npos);
  EXPECT_NE(of_rows("0,0,0,0,0,0,0,1\n").find("two rows"), std::string::npos);
  EXPECT_NE(of_rows("0,0,0,0,0,0,0,1\n0,0,0,0,0,0,0,1\n").find("line 2: its time"), std::string::npos);
  EXPECT_NE(of_rows("0,0,0,0,0,0,0,1\n1,0,0,0,0,0,1\n").find("line 2: a row must hold eight numbers"),
            std::string::npos);
  EXPECT_NE(of_rows("0,0,0,0,0,0,0,1\n1,0,0,nan,0,0,0,1\n").find("line 2: a row must hold"), std::string::npos);
  EXPECT_NE(of_rows("t,x\n0,0,0,0,0,0,0,2\n").find("line 2: its quaternion"), std::string::npos);
  EXPECT_NE(of_rows("0,0,0,0,0,0,0,1\n" + std::string(2000, '1') + "\n").find("line 2: a row is longer"),
            std::string::npos);
}

// Any bytes end in a motion or in a sentence.
TEST(BodyScript, TakesAnyBytes) {
  drawn d(seed_of(fresh_seed("BodyScript.TakesAnyBytes", "2000 texts, 500 files"), "bytes"));
  const std::string likely = "0123456789.,:-+e=\n\r conveyorpendulumturntable";
  const auto draw = [&](std::size_t most) {
    std::string out;
    for (std::size_t i = d.bits() % most; i > 0; --i) {
      out += d.bits() % 8 == 0 ? static_cast<char>(d.bits() % 256) : likely[d.bits() % likely.size()];
    }
    return out;
  };
  for (int i = 0; i < 2000; ++i) {
    const std::string text = draw(40);
    const result<body_script> read = body_script::read(text, 3);
    if (read) {
      EXPECT_TRUE(is_valid(read->at(d.between(0.0, 1e6), still).T_wb)) << text;
    } else {
      EXPECT_FALSE(read.error().message.empty());
    }
  }
  for (int i = 0; i < 500; ++i) {
    const table_file file(draw(400));
    const result<body_script> read = body_script::read(file.name(), 1);
    EXPECT_TRUE(read || !read.error().message.empty());
  }
}

}  // namespace
