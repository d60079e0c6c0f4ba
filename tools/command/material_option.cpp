#include "material_option.hpp"

#include <charconv>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

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

result<material> read_material_option(const std::string& name_or_file, const std::string& option) {
  result<material> preset = preset_material(name_or_file);
  if (preset) return preset;
  std::error_code unknown;
  if (std::filesystem::exists(name_or_file, unknown)) return io::load_material(name_or_file);
  return error{error_code::invalid_argument, option + ": " + preset.error().message + ", or a file"};
}

result<bake::material_colour> read_material_at(const std::string& text) {
  const auto bad = [&](const std::string& what) {
    return error{error_code::invalid_argument, "--material-at " + text + ": " + what};
  };
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) return bad("give COLOUR=NAME or COLOUR=FILE, as ff0000=rubber or 0=steel");
  std::string_view colour = std::string_view(text).substr(0, equals);
  const bool marked = colour.starts_with('#');
  if (marked) colour.remove_prefix(1);
  const bool hex = colour.size() == 6;
  std::uint32_t value = 0;
  const auto [end, fault] = std::from_chars(colour.data(), colour.data() + colour.size(), value, hex ? 16 : 10);
  if (fault != std::errc() || end != colour.data() + colour.size() || (!hex && (marked || value > 255))) {
    return bad("the colour is neither of six hexadecimal digits, as ff0000 for red, nor a grey level from 0 to 255");
  }
  bake::material_colour out;
  for (std::size_t c = 0; c < 3; ++c) {
    out.rgb[c] = static_cast<std::uint8_t>(hex ? value >> (8 * (2 - c)) & 0xffU : value);
  }
  result<material> is = read_material_option(text.substr(equals + 1), "--material-at " + text.substr(0, equals));
  if (!is) return is.error();
  out.is = std::move(*is);
  return out;
}

std::string file_of_material_at(const std::string& text) {
  const std::size_t equals = text.find('=');
  const std::string named = equals == std::string::npos ? "" : text.substr(equals + 1);
  return preset_material(named) ? "" : named;
}

json materials_json(const textured_model& model) {
  json out = json::array();
  if (model.surface_map.empty()) return out;
  const std::vector<double> shares = material_shares(model);
  for (std::size_t i = 0; i < shares.size(); ++i) {
    json m = to_json(*material_of(model, i));
    m["share"] = shares[i];
    out.push_back(std::move(m));
  }
  return out;
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
