#include "asperity/urdf/read_urdf.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>
#include <system_error>
#include <tinyxml2.h>
#include <utility>

namespace asperity {
namespace {

using tinyxml2::XMLElement;
constexpr std::size_t longest_text = std::size_t{16} << 20;
constexpr std::size_t most_links = 1000;

error wrong(const XMLElement* at, const std::string& what) {
  return {error_code::bad_format, "URDF, line " + std::to_string(at->GetLineNum()) + ": " + what};
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
  return wrong(
      e, std::string(name) + "=\"" + text + "\" is not " + std::to_string(N) + " finite number" + (N == 1 ? "" : "s"));
}

result<pose> origin_of(const XMLElement* parent) {
  const XMLElement* e = parent->FirstChildElement("origin");
  if (e == nullptr) return pose{};
  const std::array<double, 3> zero{};
  const auto xyz = attribute<3>(e, "xyz", zero);
  if (!xyz) return xyz.error();
  const auto rpy = attribute<3>(e, "rpy", zero);
  if (!rpy) return rpy.error();
  const auto& [roll, pitch, yaw] = *rpy;
  // About the fixed axes x, y, z in this order.
  const quat r = exp_rotation({0.0, 0.0, yaw}) * exp_rotation({0.0, pitch, 0.0}) * exp_rotation({roll, 0.0, 0.0});
  return pose{r, {(*xyz)[0], (*xyz)[1], (*xyz)[2]}};
}

result<link_mass> mass_of(const XMLElement* link) {
  const XMLElement* e = link->FirstChildElement("inertial");
  if (e == nullptr) return link_mass{};
  const result<pose> at = origin_of(e);
  if (!at) return at.error();
  const XMLElement* m = e->FirstChildElement("mass");
  const XMLElement* i = e->FirstChildElement("inertia");
  if (m == nullptr || i == nullptr) return wrong(e, "<inertial> needs <mass> and <inertia>");
  const auto mass = attribute<1>(m, "value", std::nullopt);
  if (!mass) return mass.error();
  if ((*mass)[0] < 0.0) return wrong(m, "the mass is negative");
  std::array<double, 6> t{};
  const char* const names[] = {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"};
  for (std::size_t k = 0; k < 6; ++k) {
    const auto x =
        attribute<1>(i, names[k], k == 1 || k == 2 || k == 4 ? std::optional(std::array{0.0}) : std::nullopt);
    if (!x) return x.error();
    t[k] = (*x)[0];
  }
  const mat3 inertia{t[0], t[1], t[2], t[1], t[3], t[4], t[2], t[4], t[5]};
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
    if (!r.links.emplace(name_of(e), e).second) return wrong(e, "there are two links of the name " + name_of(e));
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
      return wrong(e, "joint " + j.name + " joins a link that is not there");
    }
    const result<pose> at = origin_of(e);
    if (!at) return at.error();
    j.T_parent = *at;
    if (!r.joint_to.emplace(j.child, r.joints.size()).second) {
      return wrong(e, "link " + j.child + " has two parents: an arm is a tree");
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
    if (++seen > r.links.size()) return wrong(r.links.at(link), "link " + link + " hangs on itself");
    const result<link_mass> own = mass_of(r.links.at(at.name));
    if (!own) return own.error();
    if (at.moved_by == nullptr) {
      sum.add(*own, at.T);
    } else if (own->mass_kg > 0.0) {
      return wrong(at.moved_by->element, "joint " + at.moved_by->name +
                                             " moves a mass beside the chain, which the arm could not hold: fix it, or "
                                             "take another handle_link");
    }
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
    return wrong(j.element, "joint " + j.name + " mimics another; each joint of the chain needs a motor of its own");
  }
  if (j.type != "revolute" && j.type != "continuous") {
    return wrong(j.element, "joint " + j.name + " is of type " + j.type +
                                "; a chain has revolute, continuous and fixed "
                                "joints only");
  }
  chain_joint out;
  out.T_parent = before * j.T_parent;
  out.axis = {1.0, 0.0, 0.0};
  if (const XMLElement* e = j.element->FirstChildElement("axis")) {
    const auto axis = attribute<3>(e, "xyz", std::nullopt);
    if (!axis) return axis.error();
    const vec3 a{(*axis)[0], (*axis)[1], (*axis)[2]};
    if (!(glm::length(a) > 1e-9)) return wrong(e, "the axis of joint " + j.name + " has no direction");
    out.axis = glm::normalize(a);
  }
  out.lower_rad = -which.continuous_range_rad;
  out.upper_rad = which.continuous_range_rad;
  const XMLElement* e = j.element->FirstChildElement("limit");
  if (e == nullptr) {
    if (j.type == "revolute") return wrong(j.element, "revolute joint " + j.name + " has no <limit>");
    return out;
  }
  const std::array<double, 1> zero{};
  const auto effort = attribute<1>(e, "effort", zero);
  if (!effort) return effort.error();
  const auto velocity = attribute<1>(e, "velocity", zero);
  if (!velocity) return velocity.error();
  out.max_torque_n_m = (*effort)[0];
  speed = (*velocity)[0];
  if (j.type == "revolute") {
    const auto lower = attribute<1>(e, "lower", zero);
    if (!lower) return lower.error();
    const auto upper = attribute<1>(e, "upper", zero);
    if (!upper) return upper.error();
    out.lower_rad = (*lower)[0];
    out.upper_rad = (*upper)[0];
    if (!(out.lower_rad < out.upper_rad)) return wrong(e, "the limits of joint " + j.name + " are not in rising order");
  }
  return out;
}

}  // namespace

result<urdf_arm> parse_urdf(std::string_view text, const urdf_chain& which) {
  if (text.size() > longest_text) {
    return error{error_code::limit_exceeded, "the URDF is longer than 16 MiB, which no arm's is"};
  }
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
    if (!r.links.contains(*link)) return wrong(root, "the robot has no link \"" + *link + "\"");
  }

  std::vector<std::size_t> way;  // joints from the handle back to the base
  std::string link = which.handle_link;
  while (link != which.base_link) {
    const auto up = r.joint_to.find(link);
    if (up == r.joint_to.end() || way.size() > r.joints.size()) {
      return wrong(root, "link \"" + which.handle_link + "\" does not hang on link \"" + which.base_link + "\"");
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
