#include "asperity/urdf/read_urdf.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>
#include <system_error>
#include <tinyxml2.h>
#include <utility>

#include "asperity/core/printable.hpp"
#include "xml_extent.hpp"

namespace asperity {
namespace {

using tinyxml2::XMLElement;
constexpr std::size_t longest_text = std::size_t{16} << 20;
constexpr std::size_t most_links = 1000;

// Beyond these a number describes no arm that a hand could hold, but a slip of the unit or of the exponent.
constexpr double longest_m = 10.0;
constexpr double heaviest_kg = 1000.0;
constexpr double most_effort_n_m = 1000.0;
constexpr double most_speed_rad_per_s = 100.0;
constexpr double most_turn_rad = 100.0;
constexpr double most_axis = 1e6;  // an axis has a direction; its length says nothing

error wrong(const XMLElement* at, const std::string& what) {
  return {error_code::bad_format, "URDF, line " + std::to_string(at->GetLineNum()) + ": " + what};
}

/// A word of the document as it may stand in a message.
std::string shown(std::string_view word) {
  constexpr std::size_t longest = 60;
  return printable(word.substr(0, longest)) + (word.size() > longest ? "..." : "");
}

std::string name_of(const XMLElement* e) {
  const char* name = e->Attribute("name");
  return name == nullptr ? std::string() : std::string(name);
}

// Numbers with a point whatever the locale says; nothing where the text is anything else, or not finite.
template <std::size_t N>
std::optional<std::array<double, N>> numbers(const char* text) {
  std::array<double, N> out{};
  const char* p = text;
  const char* const end = text + std::strlen(text);
  const auto skip = [&] {
    while (p != end && (*p == ' ' || *p == '\t' || *p == '\n' || *p == '\r')) ++p;
  };
  for (double& x : out) {
    skip();
    if (p != end && *p == '+') ++p;
    const auto [after, failed] = std::from_chars(p, end, x);
    if (failed != std::errc() || !std::isfinite(x)) return std::nullopt;
    p = after;
  }
  skip();
  if (p != end) return std::nullopt;
  return out;
}

template <std::size_t N>
result<std::array<double, N>> attribute(const XMLElement* e, const char* name,
                                        std::optional<std::array<double, N>> otherwise) {
  const char* text = e->Attribute(name);
  if (text == nullptr) {
    if (otherwise) return *otherwise;
    return wrong(e, std::string("<") + e->Name() + "> has no " + name);
  }
  if (const auto n = numbers<N>(text)) return *n;
  return wrong(e, std::string(name) + "=\"" + shown(text) + "\" is not " + std::to_string(N) + " finite number" +
                      (N == 1 ? "" : "s"));
}

std::string brief(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%g", value);
  return text.data();
}

/// The attribute's numbers, each from `least` to `most`. @param whose for the message, as in "joint elbow"
template <std::size_t N>
result<std::array<double, N>> attribute_within(const XMLElement* e, const char* name, const std::string& whose,
                                               double least, double most, const char* unit,
                                               std::optional<std::array<double, N>> otherwise) {
  auto all = attribute<N>(e, name, otherwise);
  if (!all) return all;
  for (const double x : *all) {
    if (x >= least && x <= most) continue;
    return wrong(e, std::string(name) + "=\"" + shown(e->Attribute(name)) + "\" of " + whose + " holds " + brief(x) +
                        ", outside " + brief(least) + " to " + brief(most) + " " + unit + ": correct it");
  }
  return all;
}

/// Whether a symmetric matrix has no negative principal value, but for rounding in the document.
bool is_semidefinite(mat3 a, double tolerance) {
  for (int i = 0; i < 3; ++i) a[i][i] += tolerance;
  return a[0][0] >= 0.0 && a[0][0] * a[1][1] - a[0][1] * a[1][0] >= 0.0 && glm::determinant(a) >= 0.0;
}

/// What no body has as its inertia about its centre of mass, or nothing. Points and rods have moments of zero.
const char* fault_of_inertia(const mat3& inertia) {
  const double trace = inertia[0][0] + inertia[1][1] + inertia[2][2];
  if (inertia == mat3(0.0)) return nullptr;
  const double tolerance = 1e-4 * trace;  // documents are written with few digits
  if (!(trace > 0.0) || !is_semidefinite(inertia, tolerance)) return "is not positive definite";
  // Of the principal moments none is above the sum of the other two: the second moments of mass are not negative.
  if (!is_semidefinite(mat3(0.5 * trace) - inertia, tolerance)) return "breaks the triangle inequality";
  return nullptr;
}

/// @param whose for messages, as in "joint elbow"
result<pose> origin_of(const XMLElement* parent, const std::string& whose) {
  const XMLElement* e = parent->FirstChildElement("origin");
  if (e == nullptr) return pose{};
  const std::array<double, 3> zero{};
  const auto xyz = attribute_within<3>(e, "xyz", whose, -longest_m, longest_m, "m", zero);
  if (!xyz) return xyz.error();
  const auto rpy = attribute_within<3>(e, "rpy", whose, -most_turn_rad, most_turn_rad, "rad", zero);
  if (!rpy) return rpy.error();
  const auto& [roll, pitch, yaw] = *rpy;
  // About the fixed axes x, y, z in this order.
  const quat r = exp_rotation({0.0, 0.0, yaw}) * exp_rotation({0.0, pitch, 0.0}) * exp_rotation({roll, 0.0, 0.0});
  return pose{r, {(*xyz)[0], (*xyz)[1], (*xyz)[2]}};
}

result<link_mass> mass_of(const XMLElement* link) {
  const XMLElement* e = link->FirstChildElement("inertial");
  if (e == nullptr) return link_mass{};
  const std::string whose = "the <inertial> of link " + shown(name_of(link));
  const result<pose> at = origin_of(e, whose);
  if (!at) return at.error();
  const XMLElement* m = e->FirstChildElement("mass");
  const XMLElement* i = e->FirstChildElement("inertia");
  if (m == nullptr || i == nullptr) return wrong(e, "<inertial> needs <mass> and <inertia>");
  if (const auto sign = attribute<1>(m, "value", std::nullopt); sign && (*sign)[0] < 0.0) {
    return wrong(m, "the mass of link " + shown(name_of(link)) + " is negative");
  }
  const auto mass = attribute_within<1>(m, "value", whose, 0.0, heaviest_kg, "kg", std::nullopt);
  if (!mass) return mass.error();
  const double most_inertia = heaviest_kg * longest_m * longest_m;
  std::array<double, 6> t{};
  const char* const names[] = {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"};
  for (std::size_t k = 0; k < 6; ++k) {
    const auto x = attribute_within<1>(i, names[k], whose, -most_inertia, most_inertia, "kg m^2",
                                       k == 1 || k == 2 || k == 4 ? std::optional(std::array{0.0}) : std::nullopt);
    if (!x) return x.error();
    t[k] = (*x)[0];
  }
  const mat3 inertia{t[0], t[1], t[2], t[1], t[3], t[4], t[2], t[4], t[5]};
  if (const char* why = fault_of_inertia(inertia)) {
    return wrong(i, "the inertia of link " + shown(name_of(link)) + " " + why + ", as no body's does: correct it");
  }
  const mat3 r = glm::mat3_cast(at->rotation);
  return link_mass{(*mass)[0], at->position, r * inertia * glm::transpose(r)};
}

struct joint_entry {
  const XMLElement* element = nullptr;
  std::string name;
  std::string type;
  std::string parent;
  std::string child;
  pose T_parent{};
};

struct robot {
  std::map<std::string, const XMLElement*> links;
  std::vector<joint_entry> joints;
  std::map<std::string, std::size_t> joint_to;  ///< of a link: the joint that carries it
};

result<robot> index(const XMLElement* root) {
  robot r;
  for (const XMLElement* e = root->FirstChildElement("link"); e != nullptr; e = e->NextSiblingElement("link")) {
    if (name_of(e).empty()) return wrong(e, "a link has no name");
    if (r.links.size() == most_links) return wrong(e, "the robot has more than 1000 links");
    if (!r.links.emplace(name_of(e), e).second) return wrong(e, "there are two links of the name " + shown(name_of(e)));
  }
  for (const XMLElement* e = root->FirstChildElement("joint"); e != nullptr; e = e->NextSiblingElement("joint")) {
    joint_entry j;
    j.element = e;
    j.name = name_of(e);
    const char* type = e->Attribute("type");
    const XMLElement* parent = e->FirstChildElement("parent");
    const XMLElement* child = e->FirstChildElement("child");
    const char* parent_link = parent == nullptr ? nullptr : parent->Attribute("link");
    const char* child_link = child == nullptr ? nullptr : child->Attribute("link");
    if (j.name.empty() || type == nullptr || parent_link == nullptr || child_link == nullptr) {
      return wrong(e, "a joint needs a name, a type, a parent and a child");
    }
    j.type = type;
    j.parent = parent_link;
    j.child = child_link;
    if (!r.links.contains(j.parent) || !r.links.contains(j.child)) {
      return wrong(e, "joint " + shown(j.name) + " joins a link that is not there");
    }
    const result<pose> at = origin_of(e, "joint " + shown(j.name));
    if (!at) return at.error();
    j.T_parent = *at;
    if (!r.joint_to.emplace(j.child, r.joints.size()).second) {
      return wrong(e, "link " + shown(j.child) + " has two parents: an arm is a tree");
    }
    r.joints.push_back(std::move(j));
  }
  return r;
}

// Adds to `sum` the mass of a link and of all that is fixed to it, but for the chain's own next link.
result<void> add_fixed(const robot& r, const std::string& link, const pose& T, const std::string& next_in_chain,
                       link_mass& sum) {
  struct hung_link {
    std::string name;
    pose T{};
    const joint_entry* moved_by = nullptr;  // beside the chain
  };
  std::vector<hung_link> open{{link, T, nullptr}};
  std::size_t seen = 0;
  while (!open.empty()) {
    const hung_link at = open.back();
    open.pop_back();
    const result<link_mass> own = mass_of(r.links.at(at.name));
    if (!own) return own.error();
    if (at.moved_by == nullptr) {
      sum.add(*own, at.T);
    } else if (own->mass_kg > 0.0) {
      return wrong(at.moved_by->element, "joint " + shown(at.moved_by->name) +
                                             " moves a mass beside the chain, which the arm could not hold: fix it, or "
                                             "take another handle_link");
    }
    // A link has one parent: only the first can be met twice.
    if (seen++ > 0 && at.name == link) return wrong(r.links.at(link), "link " + shown(link) + " hangs on itself");
    for (const joint_entry& j : r.joints) {
      if (j.parent != at.name || j.child == next_in_chain) continue;
      const joint_entry* moved_by = at.moved_by != nullptr || j.type == "fixed" ? at.moved_by : &j;
      open.push_back({j.child, at.T * j.T_parent, moved_by});
    }
  }
  return {};
}

result<chain_joint> joint_of(const joint_entry& j, const pose& before, const urdf_chain& which, double& speed) {
  if (j.element->FirstChildElement("mimic") != nullptr) {
    return wrong(j.element,
                 "joint " + shown(j.name) + " mimics another; each joint of the chain needs a motor of its own");
  }
  if (j.type != "revolute" && j.type != "continuous") {
    return wrong(j.element, "joint " + shown(j.name) + " is of type " + shown(j.type) +
                                "; a chain has revolute, continuous and fixed "
                                "joints only");
  }
  const std::string whose = "joint " + shown(j.name);
  chain_joint out;
  out.T_parent = before * j.T_parent;
  out.axis = {1.0, 0.0, 0.0};
  if (const XMLElement* e = j.element->FirstChildElement("axis")) {
    const auto axis = attribute_within<3>(e, "xyz", whose, -most_axis, most_axis, "of any unit", std::nullopt);
    if (!axis) return axis.error();
    const vec3 a{(*axis)[0], (*axis)[1], (*axis)[2]};
    if (!(glm::length(a) > 1e-9)) return wrong(e, "the axis of " + whose + " has no direction");
    out.axis = glm::normalize(a);
  }
  out.lower_rad = -which.continuous_range_rad;
  out.upper_rad = which.continuous_range_rad;
  const XMLElement* e = j.element->FirstChildElement("limit");
  if (e == nullptr) {
    if (j.type == "revolute") return wrong(j.element, "revolute joint " + shown(j.name) + " has no <limit>");
    return out;
  }
  const std::array<double, 1> zero{};
  const auto effort = attribute_within<1>(e, "effort", whose, 0.0, most_effort_n_m, "N m", zero);
  if (!effort) return effort.error();
  const auto velocity = attribute_within<1>(e, "velocity", whose, 0.0, most_speed_rad_per_s, "rad/s", zero);
  if (!velocity) return velocity.error();
  out.max_torque_n_m = (*effort)[0];
  speed = (*velocity)[0];
  if (j.type == "revolute") {
    const auto lower = attribute_within<1>(e, "lower", whose, -most_turn_rad, most_turn_rad, "rad", zero);
    if (!lower) return lower.error();
    const auto upper = attribute_within<1>(e, "upper", whose, -most_turn_rad, most_turn_rad, "rad", zero);
    if (!upper) return upper.error();
    out.lower_rad = (*lower)[0];
    out.upper_rad = (*upper)[0];
    if (!(out.lower_rad < out.upper_rad)) return wrong(e, "the limits of " + whose + " are not in rising order");
  }
  return out;
}

}  // namespace

result<urdf_arm> parse_urdf(std::string_view text, const urdf_chain& which) {
  if (text.size() > longest_text) {
    return error{error_code::limit_exceeded, "the URDF is longer than 16 MiB, which no arm's is"};
  }
  // Before anybody parses: tinyxml2 takes quadratic time for the attributes of one element, and its memory follows
  // the number of elements and not the bytes.
  if (const result<void> sane = check_xml_extent(text); !sane) return sane.error();
  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
    return error{error_code::bad_format, "the URDF is no XML document, line " +
                                             std::to_string(document.ErrorLineNum()) + ": " +
                                             tinyxml2::XMLDocument::ErrorIDToName(document.ErrorID())};
  }
  const XMLElement* root = document.RootElement();
  if (root == nullptr || std::strcmp(root->Name(), "robot") != 0) {
    return error{error_code::bad_format, "the document has no <robot>: a xacro file has to be expanded first"};
  }
  const result<robot> robot_or = index(root);
  if (!robot_or) return robot_or.error();
  const robot& r = *robot_or;
  for (const std::string* link : {&which.base_link, &which.handle_link}) {
    if (!r.links.contains(*link)) return wrong(root, "the robot has no link \"" + shown(*link) + "\"");
  }

  std::vector<std::size_t> way;  // joints from the handle back to the base
  std::string link = which.handle_link;
  while (link != which.base_link) {
    const auto up = r.joint_to.find(link);
    if (up == r.joint_to.end() || way.size() > r.joints.size()) {
      return wrong(
          root, "link \"" + shown(which.handle_link) + "\" does not hang on link \"" + shown(which.base_link) + "\"");
    }
    way.push_back(up->second);
    link = r.joints[up->second].parent;
  }

  urdf_arm arm;
  pose before{};  // from the last moving link's frame to the present link's
  for (auto k = way.rbegin(); k != way.rend(); ++k) {
    const joint_entry& j = r.joints[*k];
    const std::string next = k + 1 == way.rend() ? std::string() : r.joints[*(k + 1)].child;
    if (j.type == "fixed") {
      before = before * j.T_parent;
    } else {
      double speed = 0.0;
      result<chain_joint> joint = joint_of(j, before, which, speed);
      if (!joint) return joint.error();
      if (!arm.chain.joints.push_back(*joint)) {
        return error{error_code::limit_exceeded, "the chain from " + which.base_link + " to " + which.handle_link +
                                                     " has more than " + std::to_string(most_joints) + " joints"};
      }
      arm.joint_names.push_back(j.name);
      arm.max_speed_rad_per_s[arm.joint_names.size() - 1] = speed;
      before = {};
    }
    if (arm.chain.joints.empty()) continue;  // fixed to the base: nobody has to hold it
    link_mass& sum = arm.chain.joints.back().link;
    if (result<void> added = add_fixed(r, j.child, before, next, sum); !added) return added.error();
  }
  arm.chain.T_handle = before;
  if (result<void> good = check(arm.chain); !good) return good.error();
  return arm;
}

result<urdf_arm> read_urdf(const std::filesystem::path& file, const urdf_chain& which) {
  std::error_code failed;
  if (!std::filesystem::is_regular_file(file, failed)) {
    return error{error_code::io_failed, "cannot read " + file.string() + ": it is no file"};
  }
  const std::uintmax_t size = std::filesystem::file_size(file, failed);
  if (failed || size > longest_text) {
    return error{error_code::limit_exceeded, "cannot read " + file.string() + ": a URDF has at most 16 MiB"};
  }
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  if (!in) return error{error_code::io_failed, "cannot read " + file.string()};
  result<urdf_arm> arm = parse_urdf(text.view(), which);
  if (!arm) return error{arm.error().code, file.string() + ": " + arm.error().message};
  return arm;
}

}  // namespace asperity
