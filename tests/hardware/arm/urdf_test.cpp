// URDF documents: arms that are known by other means, and documents that are no arms.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <random>
#include <string>
#include <vector>

#include "asperity/urdf/read_urdf.hpp"
#include "hardware/arm/arm_rig.hpp"
#include "hardware/peers/fake_arm.hpp"

namespace {

using namespace asperity;
using namespace asperity::test_support;

// Two links of 0.3 and 0.2 m in the vertical plane, a bracket that is fixed to the first, a pen that is fixed to the
// second, and a camera beside the chain.
std::string two_links(const std::string& more = "") {
  return R"(<?xml version="1.0"?>
<robot name="two">
  <link name="table"><inertial><mass value="50"/><inertia ixx="1" iyy="1" izz="1"/></inertial></link>
  <joint name="mount" type="fixed"><origin xyz="0 0 0.5"/><parent link="table"/><child link="base"/></joint>
  <link name="base"/>
  <joint name="shoulder" type="revolute">
    <origin xyz="0 0 0.1"/><parent link="base"/><child link="upper"/><axis xyz="0 -2 0"/>
    <limit lower="-1.5" upper="2.5" effort="12" velocity="6.5"/>
  </joint>
  <link name="upper">
    <inertial><origin xyz="0.15 0 0"/><mass value="0.7"/><inertia ixx="0" iyy="0.001" izz="0.001"/></inertial>
  </link>
  <joint name="bracket" type="fixed"><origin xyz="0.1 0 0"/><parent link="upper"/><child link="camera"/></joint>
  <link name="camera">
    <inertial><mass value="0.1"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial>
  </link>
  <joint name="elbow" type="continuous">
    <origin xyz="0.3 0 0"/><parent link="upper"/><child link="lower"/><axis xyz="0 -1 0"/>
  </joint>
  <link name="lower">
    <inertial><origin xyz="0.1 0 0"/><mass value="0.4"/><inertia ixx="0" iyy="0" izz="0"/></inertial>
  </link>
  <joint name="tip" type="fixed">
    <origin xyz="0.2 0 0" rpy="0.1 0.2 0.3"/><parent link="lower"/><child link="pen"/>
  </joint>
  <link name="pen">
    <inertial><origin xyz="0 0 0"/><mass value="0.05"/><inertia ixx="0" iyy="0" izz="0"/></inertial>
  </link>)" +
         more + "</robot>";
}

const urdf_chain table_to_pen{"table", "pen"};

std::string why(const std::string& text, const urdf_chain& which = table_to_pen) {
  const auto arm = parse_urdf(text, which);
  return arm ? std::string() : arm.error().message;
}

TEST(urdf, two_links_are_their_closed_form) {
  const auto arm = parse_urdf(two_links(), table_to_pen);
  ASSERT_TRUE(arm) << arm.error().message;
  ASSERT_EQ(arm->chain.joints.size(), 2U);
  EXPECT_EQ(arm->joint_names, (std::vector<std::string>{"shoulder", "elbow"}));
  EXPECT_EQ(arm->chain.joints[0].lower_rad, -1.5);
  EXPECT_EQ(arm->chain.joints[0].upper_rad, 2.5);
  EXPECT_EQ(arm->chain.joints[0].max_torque_n_m, 12.0);
  EXPECT_EQ(arm->max_speed_rad_per_s[0], 6.5);
  EXPECT_EQ(arm->chain.joints[1].upper_rad, table_to_pen.continuous_range_rad);
  EXPECT_NEAR(arm->chain.joints[0].link.mass_kg, 0.8, 1e-15);   // with the camera
  EXPECT_NEAR(arm->chain.joints[1].link.mass_kg, 0.45, 1e-15);  // with the pen

  const double g = 9.80665;
  for (const double a : {-1.0, 0.0, 0.4, 2.0}) {
    for (const double b : {-2.0, 0.0, 1.1}) {
      const chain_pose at = forward(arm->chain, {a, b});
      EXPECT_NEAR(at.T_dh.position.x, 0.3 * std::cos(a) + 0.2 * std::cos(a + b), 1e-12);
      EXPECT_NEAR(at.T_dh.position.z, 0.6 + 0.3 * std::sin(a) + 0.2 * std::sin(a + b), 1e-12);
      const joint_vector weight = torques_against_gravity(arm->chain, at);
      const double lower = g * (0.4 * 0.1 + 0.05 * 0.2) * std::cos(a + b);
      EXPECT_NEAR(weight[1], lower, 1e-12);
      EXPECT_NEAR(weight[0], lower + g * (0.7 * 0.15 + 0.1 * 0.1 + 0.45 * 0.3) * std::cos(a), 1e-12);
    }
  }
  // Roll, pitch and yaw about fixed axes: what the matrix of the URDF's definition does to the axes.
  const quat r = forward(arm->chain, {}).T_dh.rotation;
  const double cr = std::cos(0.1);
  const double sr = std::sin(0.1);
  const double cp = std::cos(0.2);
  const double sp = std::sin(0.2);
  const double cy = std::cos(0.3);
  const double sy = std::sin(0.3);
  EXPECT_LT(glm::length(r * vec3(1, 0, 0) - vec3(cy * cp, sy * cp, -sp)), 1e-12);
  EXPECT_LT(glm::length(r * vec3(0, 0, 1) - vec3(cy * sp * cr + sy * sr, sy * sp * cr - cy * sr, cp * cr)), 1e-12);
}

TEST(urdf, a_written_arm_is_read_as_it_was) {
  // The desk arm of the other tests, as a document.
  const serial_chain c = desk_arm();
  std::string text = "<robot name='desk'><link name='l0'/>";
  char line[600];
  for (std::size_t i = 0; i < c.joints.size(); ++i) {
    const chain_joint& j = c.joints[i];
    const vec3 p = j.T_parent.position;
    const double inertia = j.link.inertia_kg_m2[0][0];
    std::snprintf(line, sizeof line,
                  "<joint name='j%zu' type='revolute'><origin xyz='%.17g %.17g %.17g'/><parent link='l%zu'/>"
                  "<child link='l%zu'/><axis xyz='%g %g %g'/><limit lower='%.17g' upper='%.17g' effort='%.17g' "
                  "velocity='3'/></joint>",
                  i + 1, p.x, p.y, p.z, i, i + 1, j.axis.x, j.axis.y, j.axis.z, j.lower_rad, j.upper_rad,
                  j.max_torque_n_m);
    text += line;
    std::snprintf(line, sizeof line,
                  "<link name='l%zu'><inertial><origin xyz='%.17g %.17g %.17g'/><mass value='%.17g'/><inertia "
                  "ixx='%.17g' iyy='%.17g' izz='%.17g'/></inertial></link>",
                  i + 1, j.link.centre.x, j.link.centre.y, j.link.centre.z, j.link.mass_kg, inertia, inertia, inertia);
    text += line;
  }
  text +=
      "<joint name='tip' type='fixed'><origin xyz='0.08 0 0'/><parent link='l6'/><child link='h'/></joint>"
      "<link name='h'/></robot>";
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "asperity_desk_arm.urdf";
  std::ofstream(file) << text;
  const auto arm = read_urdf(file, {"l0", "h"});
  std::filesystem::remove(file);
  ASSERT_TRUE(arm) << arm.error().message;
  ASSERT_EQ(arm->chain.joints.size(), 6U);
  const joint_vector q{0.3, -0.5, 1.0, 0.7, -0.4, 0.2};
  const joint_vector one = newton_euler(c, q, q, q);
  const joint_vector two = newton_euler(arm->chain, q, q, q);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(one[i], two[i], 1e-12);
  EXPECT_LT(glm::length(forward(c, q).T_dh.position - forward(arm->chain, q).T_dh.position), 1e-12);
}

TEST(urdf, what_is_no_arm_is_refused_with_its_line) {
  const std::string good = two_links();
  const auto changed = [&good](const std::string& what, const std::string& by) {
    std::string s = good;
    const std::size_t at = s.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    return s.replace(at, what.size(), by);
  };
  const auto has = [](const std::string& text, const std::string& words) {
    EXPECT_NE(text.find(words), std::string::npos) << text;
  };
  EXPECT_EQ(why(good), "");
  has(why("<robot"), "no XML");
  has(why("<sdf/>"), "no <robot>");
  has(why(good, {"table", "nowhere"}), "no link \"nowhere\"");
  has(why(good, {"pen", "table"}), "does not hang on");
  has(why(changed("type=\"revolute\"", "type=\"prismatic\"")), "line 6: joint shoulder is of type prismatic");
  has(why(changed("xyz=\"0 -2 0\"", "xyz=\"0 0 0\"")), "no direction");
  has(why(changed("xyz=\"0 -2 0\"", "xyz=\"0 -2\"")), "not 3 finite numbers");
  has(why(changed("xyz=\"0 -2 0\"", "xyz=\"0 nan 0\"")), "not 3 finite numbers");
  has(why(changed("xyz=\"0 -2 0\"", "xyz=\"0 1e999 0\"")), "not 3 finite numbers");
  has(why(changed("lower=\"-1.5\"", "lower=\"9\"")), "rising order");
  has(why(changed("<limit lower=\"-1.5\" upper=\"2.5\" effort=\"12\" velocity=\"6.5\"/>", "")), "has no <limit>");
  has(why(changed("mass value=\"0.7\"", "mass value=\"-0.7\"")), "negative");
  has(why(changed("<mass value=\"0.7\"/>", "")), "<inertial> needs");
  has(why(changed("<child link=\"camera\"/>", "<child link=\"lower\"/>")), "two parents");
  has(why(changed("<child link=\"camera\"/>", "<child link=\"ghost\"/>")), "not there");
  has(why(changed("<link name=\"camera\">", "<link name=\"pen\">")), "two links of the name");
  has(why(changed("<axis xyz=\"0 -1 0\"/>", "<mimic joint=\"shoulder\"/>")), "mimics another");
  has(why(changed("name=\"bracket\" type=\"fixed\"", "name=\"bracket\" type=\"revolute\"")), "bracket moves a mass");
  std::string knot =
      two_links("<joint name=\"knot\" type=\"fixed\"><parent link=\"camera\"/><child link=\"table\"/></joint>");
  has(why(knot), "shoulder moves a mass beside the chain");
  for (std::size_t at = 0; (at = knot.find("mass value=\"", at)) != std::string::npos;) {
    at += 12;
    knot.replace(at, knot.find('"', at) - at, "0");
  }
  has(why(knot), "hangs on itself");
  std::string many = "<robot>";
  for (int i = 0; i < 1100; ++i) many += "<link name=\"l" + std::to_string(i) + "\"/>";
  has(why(many + "</robot>", {"l0", "l1"}), "1000 links");
  std::string nine = "<robot><link name=\"l0\"/>";
  for (int i = 0; i < 9; ++i) {
    const std::string a = std::to_string(i);
    const std::string b = std::to_string(i + 1);
    nine += "<link name=\"l" + b + "\"/><joint name=\"j" + b + "\" type=\"continuous\"><parent link=\"l" + a +
            "\"/><child link=\"l" + b + "\"/></joint>";
  }
  has(why(nine + "</robot>", {"l0", "l9"}), "more than 8 joints");
  EXPECT_EQ(why(nine + "</robot>", {"l0", "l8"}), "");
  const auto missing = read_urdf("/nowhere/arm.urdf", table_to_pen);
  ASSERT_FALSE(missing);
  has(missing.error().message, "/nowhere/arm.urdf");
}

// What no body has, and numbers that are slips of a unit or an exponent: refused with the element, its name and line.
TEST(urdf, masses_and_limits_that_no_arm_has_are_refused) {
  const std::string good = two_links();
  const std::string inertia = "<inertia ixx=\"0\" iyy=\"0.001\" izz=\"0.001\"/>";
  const std::string limit = "<limit lower=\"-1.5\" upper=\"2.5\" effort=\"12\" velocity=\"6.5\"/>";
  const auto with = [&good](const std::string& what, const std::string& by) {
    std::string s = good;
    const std::size_t at = s.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    return why(s.replace(at, what.size(), by));
  };
  const auto tensor = [](const char* text) { return "<inertia " + std::string(text) + "/>"; };
  struct wrong {
    std::string what, by, says;
  };
  const std::vector<wrong> all{
      {inertia, tensor("ixx='-0.001' iyy='0.001' izz='0.001'"), "line 11: the inertia of link upper is not positive"},
      {inertia, tensor("ixx='0.001' iyy='0.001' izz='0.001' ixy='0.002'"), "upper is not positive definite"},
      {inertia, tensor("ixx='0.001' iyy='0.001' izz='0.001' ixy='0.0009' ixz='0.0009' iyz='-0.0009'"), "not positive"},
      {inertia, tensor("ixx='0' iyy='0' izz='0' ixz='0.001'"), "upper is not positive definite"},
      {inertia, tensor("ixx='0.001' iyy='0.001' izz='0.0021'"),
       "line 11: the inertia of link upper breaks the triangle"},
      {inertia, tensor("ixx='0.0021' iyy='0.001' izz='0.001'"), "upper breaks the triangle inequality"},
      // Principal moments 1, 1 and 2.2 about axes that are turned by 45 degrees.
      {inertia, tensor("ixx='1.6' iyy='1.6' izz='1' ixy='0.6'"), "upper breaks the triangle inequality"},
      {inertia, tensor("ixx='1e300' iyy='1e300' izz='1e300'"), "ixx=\"1e300\" of the <inertial> of link upper"},
      {"mass value=\"0.7\"", "mass value=\"7e5\"", "outside 0 to 1000 kg"},
      {limit, "<limit lower='-1' upper='1' effort='1e308'/>",
       "line 8: effort=\"1e308\" of joint shoulder holds 1e+308"},
      {limit, "<limit lower='-1' upper='1' effort='-1'/>", "effort=\"-1\" of joint shoulder"},
      {limit, "<limit lower='-1' upper='1' velocity='1e9'/>", "velocity=\"1e9\" of joint shoulder"},
      {limit, "<limit lower='-1' upper='1e9' effort='1'/>", "upper=\"1e9\" of joint shoulder"},
      {limit, "<limit lower='-inf' upper='1' effort='1'/>", "lower=\"-inf\" is not 1 finite number"},
      {"xyz=\"0.3 0 0\"", "xyz=\"0.3 0 1e300\"", "line 18: xyz=\"0.3 0 1e300\" of joint elbow holds 1e+300"},
      {"rpy=\"0.1 0.2 0.3\"", "rpy=\"0.1 1e300 0.3\"", "of joint tip"},
      {"xyz=\"0 -1 0\"", "xyz=\"0 -1e200 0\"", "of joint elbow"},
  };
  for (const wrong& w : all) {
    const std::string said = with(w.what, w.by);
    EXPECT_NE(said.find(w.says), std::string::npos) << w.by << " said: " << said;
    EXPECT_NE(said.find("URDF, line "), std::string::npos) << said;
  }
  for (const char* sound :
       {"ixx='0.001' iyy='0.001' izz='0.002'", "ixx='0.002' iyy='0.002' izz='0.001' ixy='0.0004'"}) {
    EXPECT_EQ(with(inertia, tensor(sound)), "") << sound;
  }
}

// A name cannot steer the terminal that a message reaches, nor fill it.
TEST(urdf, messages_show_names_and_never_obey_them) {
  const std::string odd = "\x1b[2J&#10;\xe2\x80\xae";
  std::string s = two_links();
  s.replace(s.find("name=\"shoulder\""), 15, "name=\"" + odd + std::string(5000, 'n') + "\"");
  s.replace(s.find("effort=\"12\""), 11, "effort=\"-12\"");
  const std::string said = why(s);
  EXPECT_NE(said.find("joint \\x1b[2J\\n\\u{202e}nnn"), std::string::npos) << said;
  EXPECT_LT(said.size(), 400U);
}

double seconds_of(const std::string& text) {
  const auto start = std::chrono::steady_clock::now();
  EXPECT_NE(why(text), "");
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// tinyxml2 takes quadratic time for the attributes of one element, 44 s for 80,000, and memory by the element.
TEST(urdf, documents_of_another_size_than_an_arms_are_refused_before_they_are_parsed) {
  const auto attributes = [](int n) {
    std::string s = "<robot>\n<link";
    for (int i = 0; i < n; ++i) s += " a" + std::to_string(i) + "=''";
    return s + "/></robot>";
  };
  EXPECT_NE(why(attributes(80'000)).find("line 2: an element has more than 64 attributes"), std::string::npos);
  EXPECT_LT(seconds_of(attributes(200'000)), 2.0);
  // What only looks like the end of an element, and what only looks like attributes.
  EXPECT_NE(why("<robot a='>' b='" + std::string("/>' ") + attributes(80).substr(13)).find("64 attributes"),
            std::string::npos);
  // Comments and CDATA hold no elements, whatever they look like.
  std::string commented = two_links();
  commented.insert(commented.find("<link"), "<!-- " + attributes(80) + " --><![CDATA[" + attributes(80) + "]]>");
  EXPECT_EQ(why(commented), "");
  const auto repeated = [](const char* what, int n) {
    std::string s = "<robot>";
    for (int i = 0; i < n; ++i) s += what;
    return s;
  };
  EXPECT_NE(why(repeated("<a/>", 100'001) + "</robot>").find("more than 100000 elements"), std::string::npos);
  EXPECT_NE(why(repeated("<a>", 70)).find("more than 64 levels"), std::string::npos);
  EXPECT_NE(why(repeated("<a b='' c='' d='' e='' f=''/>", 90'000)).find("400000 attributes"), std::string::npos);
  EXPECT_EQ(why(repeated("<a></a>", 50'000) + two_links().substr(two_links().find("<link"))), "");
}

TEST(urdf, spoiled_documents_are_read_or_refused_and_never_more) {
  const std::string good = two_links();
  std::mt19937_64 bits(11);
  int read = 0;
  for (int k = 0; k < 3000; ++k) {
    std::string s = good;
    for (std::uint64_t n = 1 + bits() % 4; n > 0; --n) {
      const std::size_t at = bits() % s.size();
      switch (bits() % 3) {
        case 0:
          s[at] = static_cast<char>(bits());
          break;
        case 1:
          s.erase(at, 1 + bits() % 40);
          break;
        default:
          s.insert(at, s.substr(bits() % s.size(), bits() % 60));
      }
    }
    const auto arm = parse_urdf(s, table_to_pen);
    if (!arm) {
      EXPECT_FALSE(arm.error().message.empty());
      continue;
    }
    ++read;
    ASSERT_TRUE(check(arm->chain));
  }
  EXPECT_GT(read, 50);
  EXPECT_LT(read, 2900);
  std::string deep = "<robot>";
  for (int i = 0; i < 100'000; ++i) deep += "<a>";
  EXPECT_NE(why(deep), "");
}

}  // namespace
