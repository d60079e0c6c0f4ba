#include "run_coupling.hpp"

#include "asperity/control/virtual_coupling.hpp"
#include "text.hpp"

namespace asperity::command {
namespace {

const char* name_of(coupling_source s) {
  switch (s) {
    case coupling_source::usual:
      return "default";
    case coupling_source::device:
      return "device";
    case coupling_source::given:
      return "option";
  }
  return "unknown";
}

const char* words_of(coupling_source s) {
  switch (s) {
    case coupling_source::usual:
      return "by default";
    case coupling_source::device:
      return "as the device can show";
    case coupling_source::given:
      return "as asked for";
  }
  return "unknown";
}

virtual_coupling made_of(const chosen_coupling& chosen, const probe_settings& probe) {
  const mat3& i = probe.inertia_kg_m2;
  return {chosen.settings, probe.mass_kg, (i[0][0] + i[1][1] + i[2][2]) / 3.0};
}

}  // namespace

chosen_coupling coupling_of(const run_command& options, const device_capabilities& device, double scale) {
  chosen_coupling out;
  if (formulation_name(options.render) == "planes") {
    out.settings = coupling_for(device, options.device_rate_hz, scale);
    if (device.max_stiffness_n_per_m > 0.0) out.translation = coupling_source::device;
    if (device.max_stiffness_n_m_per_rad > 0.0) out.rotation = coupling_source::device;
  }
  if (options.coupling_n_per_m) {
    out.settings.stiffness_n_per_m = *options.coupling_n_per_m;
    out.translation = coupling_source::given;
  }
  if (options.coupling_n_m_per_rad) {
    out.settings.stiffness_n_m_per_rad = *options.coupling_n_m_per_rad;
    out.rotation = coupling_source::given;
  }
  return out;
}

json to_json(const chosen_coupling& chosen, const probe_settings& probe) {
  const virtual_coupling c = made_of(chosen, probe);
  return {{"translation",
           {{"stiffness", c.stiffness_n_per_m()},
            {"damping", c.damping_n_s_per_m()},
            {"from", name_of(chosen.translation)}}},
          {"rotation",
           {{"stiffness", c.stiffness_n_m_per_rad()},
            {"damping", c.damping_n_m_s_per_rad()},
            {"from", name_of(chosen.rotation)}}}};
}

std::string to_text(const chosen_coupling& chosen, const probe_settings& probe) {
  const virtual_coupling c = made_of(chosen, probe);
  const bool alike = chosen.translation == chosen.rotation;
  return brief(1e-3 * c.stiffness_n_per_m()) + " N/mm" +
         (alike ? "" : std::string(" ") + words_of(chosen.translation)) + " and " + brief(c.stiffness_n_m_per_rad()) +
         " N m/rad " + words_of(chosen.rotation);
}

}  // namespace asperity::command
