#include "mesh_units.hpp"

#include <array>
#include <cmath>

#include "model_report.hpp"
#include "options.hpp"
#include "text.hpp"

namespace asperity::command {
namespace {

struct length_unit {
  const char* name;
  double metres;
};
constexpr std::array<length_unit, 4> length_units{{{"m", 1.0}, {"cm", 1e-2}, {"mm", 1e-3}, {"in", 0.0254}}};

result<void> check_size(const mesh_units& said, const std::string& file, const triangle_mesh& mesh) {
  if (said.scale || said.units || mesh.positions.empty()) return {};
  if (extension_error(file, {".gltf", ".glb"}).empty()) return {};
  vec3 low = mesh.positions.front();
  vec3 high = low;
  for (const vec3& p : mesh.positions) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  const double diagonal = glm::length(high - low);
  // Without any size, or with none that is a number, the mesh has another fault, which the bake names.
  if (!std::isfinite(diagonal) || diagonal == 0.0 || is_sensible_size(diagonal)) return {};
  std::string choices;
  for (const length_unit& u : length_units) {
    if (is_sensible_size(diagonal * u.metres))
      choices += (choices.empty() ? "" : ", or ") + std::string("--units ") + u.name + " (" +
                 length_text(diagonal * u.metres) + ")";
  }
  return error{error_code::invalid_argument,
               file + ": its diagonal would be " + length_text(diagonal) + " if its unit is the metre, outside " +
                   sensible_sizes() + "; say the unit: " + (choices.empty() ? "" : choices + ", or ") +
                   "--units m if it is that large or small, or --scale with metres per unit"};
}

}  // namespace

double mesh_units::metres_per_unit() const {
  if (scale) return *scale;
  for (const length_unit& u : length_units)
    if (units == u.name) return u.metres;
  return 1.0;
}

unit_option_pair add_unit_options(CLI::App& sub, const std::shared_ptr<mesh_units>& units, const std::string& whose) {
  auto* scale = sub.add_option_function<double>(
                       "--scale", [units](double value) { units->scale = value; },
                       "Metres per unit of " + whose + " (0.001 for millimetres)")
                    ->check(positive_number_error, "NUMBER > 0");
  auto* unit = sub.add_option_function<std::string>(
                      "--units", [units](const std::string& value) { units->units = value; },
                      "Unit of " + whose + ": m, cm, mm or in")
                   ->check(CLI::IsMember({"m", "cm", "mm", "in"}))
                   ->excludes(scale);
  return {unit, scale};
}

void scale_to_metres(const mesh_units& units, triangle_mesh& mesh) {
  const double factor = units.metres_per_unit();
  if (factor == 1.0) return;
  for (vec3& p : mesh.positions) p *= factor;
}

result<void> bring_to_metres(const mesh_units& units, const std::string& file, triangle_mesh& mesh) {
  if (const result<void> ok = check_size(units, file, mesh); !ok) return ok.error();
  scale_to_metres(units, mesh);
  return {};
}

}  // namespace asperity::command
