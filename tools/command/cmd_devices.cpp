// asperity devices: what a session can be felt with.
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "asperity/device/simulated/simulated_device.hpp"
#ifdef ASPERITY_HAS_CAN
#include "can_devices.hpp"
#endif
#include "cli.hpp"
#include "device_document.hpp"
#include "device_panel.hpp"
#include "driver_options.hpp"
#include "gpu_devices.hpp"
#include "known_devices.hpp"
#include "model_report.hpp"
#include "options.hpp"
#include "text.hpp"

namespace asperity::command {
namespace {

json axes(axis_mask mask) {
  static constexpr std::array<const char*, 6> names{"x", "y", "z", "rx", "ry", "rz"};
  json out = json::array();
  for (std::size_t i = 0; i < names.size(); ++i) {
    if ((mask >> i & 1) != 0) out.push_back(names[i]);
  }
  return out;
}

}  // namespace

json to_json(const device_capabilities& c) {
  return {{"name", c.name},
          {"maturity", to_string(c.maturity)},
          {"sensed_axes", axes(c.sensed)},
          {"actuated_axes", axes(c.actuated)},
          {"continuous_force", c.continuous_force_n},
          {"peak_force", c.peak_force_n},
          {"continuous_torque", c.continuous_torque_n_m},
          {"peak_torque", c.peak_torque_n_m},
          {"max_stiffness", c.max_stiffness_n_per_m},
          {"max_stiffness_rate_hz", c.max_stiffness_rate_hz},
          {"workspace", {{"low", command::to_json(c.workspace_low_d)}, {"high", command::to_json(c.workspace_high_d)}}},
          {"nominal_rate_hz", c.nominal_rate_hz},
          {"moving_mass", c.moving_mass_kg},
          {"device_side_watchdog", c.device_side_watchdog}};
}

namespace {

std::string what_it_does(const device_capabilities& c) {
  if (c.actuated == no_axes) return "measures, puts out nothing";
  return brief(c.peak_force_n) + " N and " + brief(c.peak_torque_n_m) + " N m at most, " + brief(c.nominal_rate_hz) +
         " Hz";
}

void add(const device_listing& d, answer& out) {
  json entry = to_json(d.capabilities);
  entry["name"] = d.name;
  entry["driver"] = d.driver;
  entry["identity"] = d.identity;
  entry["path"] = d.path;
  entry["maturity"] = to_string(d.maturity);
  entry["problem"] = d.not_openable ? json(*d.not_openable) : json();
  out.document["devices"].push_back(std::move(entry));
  const std::string where = d.name == d.identity ? d.path : d.name + " at " + d.path + ", driver " + d.driver;
  out.text += row(d.identity, where + ", " + to_string(d.maturity) + ": " +
                                  (d.not_openable ? *d.not_openable : what_it_does(d.capabilities)));
}

result<answer> list_devices(const driver_choice& choice) {
  const device_capabilities c = simulated_capabilities();
  answer out;
  out.document = {{"devices", json::array()},
                  {"drivers", json::array({"simulated"})},
                  {"driver_files", json::array()},
                  {"problems", json::array()}};
  out.document["units"] = "SI";
  add({.driver = "simulated",
       .identity = "simulated",
       .path = "a handle, a hand and their dynamics in software",
       .name = "simulated",
       .maturity = c.maturity,
       .capabilities = c},
      out);

  const result<std::unique_ptr<known_devices>> looked = known_devices::look(choice);
  if (!looked) return looked.error();
  const known_devices& known = **looked;
  for (const device_listing& d : known.directory().devices()) add(d, out);
  for (const std::string& driver : known.drivers()) out.document["drivers"].push_back(driver);
  const auto problem = [&out](const std::string& where, const std::string& why) {
    out.document["problems"].push_back({{"where", where}, {"problem", why}});
    out.text += row(where, why);
  };
  for (const driver_problem& p : known.directory().problems()) problem("driver " + p.driver, p.why.message);
  for (const driver_in_path& d : known.in_path()) {
    out.document["driver_files"].push_back({{"name", d.name},
                                            {"file", d.file},
                                            {"enabled", d.enabled},
                                            {"in_process", d.in_process},
                                            {"problem", d.problem ? json(*d.problem) : json()}});
    if (d.problem) {
      problem(d.file, *d.problem);
    } else if (!d.enabled) {
      out.text +=
          row(d.name,
              d.file + ": a driver that is not enabled, nothing in it was run; asperity devices --enable " + d.name);
    }
  }
#ifdef ASPERITY_HAS_CAN
  add_can_interfaces(out);
#endif
  std::string names = "simulated";
  for (const std::string& driver : known.drivers()) names += ", " + driver;
  out.text += "  Drivers that looked: " + printable(names) + ".\n";
  return out;
}

result<answer> with_gpus(answer devices) {
#ifdef ASPERITY_HAS_GL
  result<answer> gpus = list_gpus();
  if (!gpus) return gpus.error();
  devices.document["gpus"] = gpus->document["gpus"];
  devices.text = gpus->text;
  return devices;
#else
  static_cast<void>(devices);
  return error{error_code::unsupported,
               "OpenGL is not part of this build: configure with -DASPERITY_BUILD_GL=ON and its headers (Debian: "
               "libegl-dev, libgl-dev)"};
#endif
}

}  // namespace

namespace {

struct devices_command {
  bool gpus = false;
  std::optional<std::string> view;
  panel_command panel;  // its drivers are those of the list, too
};

result<answer> show(devices_command options, const common_options& common) {
  panel_command& panel = options.panel;
  if (!options.view) {
    if (panel.device != panel_command().device || panel.view_address != panel_command().view_address || panel.seconds ||
        !panel.firmware.empty()) {
      return error{error_code::invalid_argument,
                   "--device, --firmware, --seconds and --view-address are of the panel of a device: add --view"};
    }
    result<answer> devices = list_devices(panel.drivers);
    return options.gpus && devices ? with_gpus(std::move(devices).value()) : devices;
  }
  if (options.gpus)
    return error{error_code::invalid_argument, "--gpu lists GPUs and --view shows a device: leave one out"};
#ifdef ASPERITY_HAS_VIEW
  panel.view = *options.view;
  return show_device(panel, common);
#else
  static_cast<void>(common);
  return error{error_code::unsupported,
               "--view: this build has no live page, which needs libcivetweb-dev; build with it, or leave --view out"};
#endif
}

}  // namespace

void add_devices(command_line& line) {
  const auto o = std::make_shared<devices_command>();
  CLI::App& sub = line.add("devices",
                           "List the devices that a session can be felt with, or the GPUs that can calculate, or show "
                           "one device on a page",
                           [o](const common_options& common) { return show(*o, common); });
  sub.add_flag("--gpu", o->gpus, "List the GPUs that --backend gl-compute and gl-occlusion can use");
  sub.add_option("--view", o->view,
                 "Show a device on a page of a browser, at this port or 8765: pose, buttons, rate, faults, and a small "
                 "force while a button of the page is held")
      ->expected(0, 1)
      ->type_name("[PORT]");
  sub.add_option("--view-address", o->panel.view_address,
                 "Address of this machine at which the page is; at another one than the loopback no force is offered")
      ->capture_default_str();
  sub.add_option("--device", o->panel.device,
                 "Device of the page: simulated, or the identity, path, driver or part of the name of one on the list")
      ->capture_default_str();
  sub.add_option("--firmware", o->panel.firmware, "Your copy of the firmware of a Novint Falcon");
  sub.add_option("--seconds", o->panel.seconds, "How long the page is there; by default until Ctrl-C")
      ->check(positive_number_error, "NUMBER > 0")
      ->check(CLI::Range(1e-3, 86400.0));
  add_driver_options(sub, o->panel.drivers);
}

}  // namespace asperity::command
