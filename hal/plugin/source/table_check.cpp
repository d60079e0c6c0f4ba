#include "asperity/plugin/table_check.hpp"

#include <cmath>
#include <cstddef>
#include <cstring>
#include <string_view>
#include <utility>

#include "asperity/device/driver_conversion.hpp"

namespace asperity::plugin {
namespace {

constexpr std::size_t longest_text = 256;
constexpr std::uint32_t largest_table = 1U << 16;

bool is_text(std::string_view s) {
  for (const char c : s) {
    const auto u = static_cast<unsigned char>(c);
    if (u < 0x20U || u == 0x7fU) return false;  // what moves a terminal's cursor is no part of a name
  }
  return true;
}

std::optional<table_problem> text_problem(const char* what, const char* text, bool one_word) {
  const auto problem = [what](const char* why) {
    return table_problem{table_fault::text, std::string("the driver's ") + what + " " + why};
  };
  if (text == nullptr) return problem("is missing: it has to be a string literal");
  const std::size_t length = ::strnlen(text, longest_text + 1);
  if (length == 0) return problem("is empty");
  if (length > longest_text) return problem("has no end within 256 bytes");
  const std::string_view s(text, length);
  if (!is_text(s)) return problem("has control characters in it");
  if (one_word && s.find(' ') != std::string_view::npos) return problem("has to be one word");
  return std::nullopt;
}

std::optional<std::string> field_problem(const char* what, std::span<const char> field, bool may_be_empty) {
  const std::optional<std::string_view> text = abi::get_text(field);
  if (!text) return std::string(what) + " has no zero byte at its end";
  if (text->empty() && !may_be_empty) return std::string(what) + " is empty";
  if (!is_text(*text)) return std::string(what) + " has control characters in it";
  return std::nullopt;
}

}  // namespace

const char* to_string(table_fault f) noexcept {
  switch (f) {
    case table_fault::not_loadable:
      return "not loadable";
    case table_fault::no_entry:
      return "no entry";
    case table_fault::refused:
      return "refused by the driver";
    case table_fault::struct_size:
      return "wrong struct_size";
    case table_fault::abi_major:
      return "wrong major version";
    case table_fault::mandatory:
      return "mandatory function missing";
    case table_fault::text:
      return "bad text";
  }
  return "unknown fault";
}

std::optional<table_problem> find_problem(const asperity_driver* table) {
  if (table == nullptr) {
    return table_problem{table_fault::refused, "the driver has no table for interface version " +
                                                   std::to_string(ASPERITY_ABI_MAJOR) + "." +
                                                   std::to_string(ASPERITY_ABI_MINOR) + ": it was built for another"};
  }
  constexpr std::size_t versions_end = offsetof(asperity_driver, maturity);
  if (table->struct_size >= versions_end && table->abi_major != ASPERITY_ABI_MAJOR) {
    return table_problem{table_fault::abi_major,
                         "the driver was built for major version " + std::to_string(table->abi_major) +
                             " of the interface and this host has " + std::to_string(ASPERITY_ABI_MAJOR) +
                             ": build it against this version's driver_abi.h"};
  }
  constexpr std::size_t mandatory_end = offsetof(asperity_driver, attach);
  if (table->struct_size < mandatory_end || table->struct_size > largest_table || table->struct_size % 8 != 0) {
    return table_problem{table_fault::struct_size, "the table says that it has " + std::to_string(table->struct_size) +
                                                       " bytes; a driver's table has at least " +
                                                       std::to_string(mandatory_end) +
                                                       ": set struct_size to sizeof(struct asperity_driver)"};
  }
  const asperity_driver t = abi::copy_in(*table);
  const std::pair<const char*, bool> mandatory[] = {
      {"list", t.list != nullptr},       {"make", t.make != nullptr},
      {"destroy", t.destroy != nullptr}, {"capabilities", t.capabilities != nullptr},
      {"state", t.state != nullptr},     {"open", t.open != nullptr},
      {"arm", t.arm != nullptr},         {"clear_fault", t.clear_fault != nullptr},
      {"disarm", t.disarm != nullptr},   {"close", t.close != nullptr},
      {"read", t.read != nullptr},       {"write", t.write != nullptr}};
  for (const auto& [name, there] : mandatory) {
    if (!there) {
      return table_problem{table_fault::mandatory,
                           std::string("the driver's table has no ") + name + "(), which is mandatory"};
    }
  }
  if (auto p = text_problem("name", t.name, true)) return p;
  if (auto p = text_problem("version", t.version, false)) return p;
  if (auto p = text_problem("licence", t.licence, false)) return p;
  if (auto p = text_problem("vendor", t.vendor, false)) return p;
  if (t.maturity > ASPERITY_MATURITY_HARDWARE_VERIFIED) {
    return table_problem{table_fault::text, "the driver's maturity is not one of the three that there are"};
  }
  return std::nullopt;
}

std::optional<std::string> find_problem(const asperity_capabilities& c) {
  if (auto p = field_problem("the device's name", c.name, false)) return p;
  if (c.maturity > ASPERITY_MATURITY_HARDWARE_VERIFIED) return "the maturity is not one of the three that there are";
  if ((c.sensed & ~ASPERITY_AXES_ALL) != 0 || (c.actuated & ~ASPERITY_AXES_ALL) != 0) {
    return "there are more axes than six in the masks of axes";
  }
  const std::pair<const char*, double> numbers[] = {{"continuous_force_n", c.continuous_force_n},
                                                    {"peak_force_n", c.peak_force_n},
                                                    {"continuous_torque_n_m", c.continuous_torque_n_m},
                                                    {"peak_torque_n_m", c.peak_torque_n_m},
                                                    {"force_slew_n_per_s", c.force_slew_n_per_s},
                                                    {"torque_slew_n_m_per_s", c.torque_slew_n_m_per_s},
                                                    {"max_stiffness_n_per_m", c.max_stiffness_n_per_m},
                                                    {"max_stiffness_n_m_per_rad", c.max_stiffness_n_m_per_rad},
                                                    {"max_stiffness_rate_hz", c.max_stiffness_rate_hz},
                                                    {"position_resolution_m", c.position_resolution_m},
                                                    {"rotation_resolution_rad", c.rotation_resolution_rad},
                                                    {"nominal_rate_hz", c.nominal_rate_hz},
                                                    {"minimum_rate_hz", c.minimum_rate_hz},
                                                    {"worst_latency_ns", static_cast<double>(c.worst_latency_ns)},
                                                    {"moving_mass_kg", c.moving_mass_kg},
                                                    {"moving_inertia_kg_m2", c.moving_inertia_kg_m2}};
  for (const auto& [name, value] : numbers) {
    if (!(std::isfinite(value) && value >= 0.0)) return std::string(name) + " is negative or not a number";
  }
  if (c.continuous_force_n > c.peak_force_n) return "continuous_force_n is above peak_force_n";
  if (c.continuous_torque_n_m > c.peak_torque_n_m) return "continuous_torque_n_m is above peak_torque_n_m";
  for (int i = 0; i < 3; ++i) {
    if (!std::isfinite(c.workspace_low_d_m[i]) || !std::isfinite(c.workspace_high_d_m[i]) ||
        c.workspace_low_d_m[i] > c.workspace_high_d_m[i]) {
      return "the workspace is not a box: a corner is not finite, or low lies above high";
    }
  }
  if (!std::isfinite(c.gripper_low_m) || !std::isfinite(c.gripper_high_m) || c.gripper_low_m > c.gripper_high_m) {
    return "the gripper opens by no way: gripper_low_m or gripper_high_m is not finite, or low lies above high";
  }
  return std::nullopt;
}

std::optional<std::string> find_problem(const asperity_listing& l) {
  if (auto p = field_problem("identity", l.identity, false)) return p;
  if (auto p = field_problem("path", l.path, true)) return p;
  if (auto p = field_problem("name", l.name, false)) return p;
  if (auto p = field_problem("not_openable", l.not_openable, true)) return p;
  if (l.maturity > ASPERITY_MATURITY_HARDWARE_VERIFIED) return "the maturity is not one of the three that there are";
  return std::nullopt;
}

}  // namespace asperity::plugin
