#include "material_option.hpp"

#include <filesystem>
#include <system_error>

#include "asperity/io/surface_file.hpp"
#include "text.hpp"

namespace asperity::command {
namespace {

// "3 N/mm, 2 s/m, friction 1 at rest, 0.8 slipping"
std::string law_text(double stiffness_n_per_m, double dissipation_s_per_m, double at_rest, double slipping) {
  std::string out = brief(1e-3 * stiffness_n_per_m) + " N/mm, " + brief(dissipation_s_per_m) + " s/m, ";
  if (!(at_rest > 0.0)) return out + "no friction";
  return out + "friction " + brief(at_rest) + " at rest, " + brief(slipping) + " slipping";
}

}  // namespace

result<material> read_material_option(const std::string& name_or_file) {
  result<material> preset = preset_material(name_or_file);
  if (preset) return preset;
  std::error_code unknown;
  if (std::filesystem::exists(name_or_file, unknown)) return io::load_material(name_or_file);
  return error{error_code::invalid_argument, "--material: " + preset.error().message + ", or a file"};
}

json to_json(const material& m) {
  return {{"name", m.name},
          {"stiffness", m.stiffness_n_per_m},
          {"dissipation", m.dissipation_s_per_m},
          {"friction",
           {{"static", m.static_friction}, {"dynamic", m.dynamic_friction}, {"combine", to_string(m.combine)}}}};
}

json to_json(const surface_pair& pair) {
  return {{"stiffness", pair.stiffness_n_per_m},
          {"dissipation", pair.dissipation_s_per_m},
          {"friction", {{"static", pair.static_friction}, {"dynamic", pair.dynamic_friction}}}};
}

std::string to_text(const material& m) {
  const std::string law = law_text(m.stiffness_n_per_m, m.dissipation_s_per_m, m.static_friction, m.dynamic_friction);
  return (m.name.empty() ? "" : m.name + ": ") + law + " (" + to_string(m.combine) + ")";
}

std::string to_text(const surface_pair& pair) {
  return law_text(pair.stiffness_n_per_m, pair.dissipation_s_per_m, pair.static_friction, pair.dynamic_friction);
}

}  // namespace asperity::command
