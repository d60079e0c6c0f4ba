#include "mesh_placing.hpp"

#include <cmath>
#include <string>
#include <vector>

#include "asperity/model/textured_model.hpp"
#include "options.hpp"

namespace asperity::command {
namespace {

const std::vector<std::string> axis_names{"x", "y", "z", "-x", "-y", "-z"};

}  // namespace

void add_placing_options(CLI::App& sub, const std::shared_ptr<mesh_placing>& placing, const unit_option_pair& units) {
  sub.add_option_function<double>(
         "--fit", [placing](double value) { placing->fit_m = value; },
         "Scale the meshes so that the diagonal of the full mesh measures so many metres")
      ->check(positive_number_error, "NUMBER > 0")
      ->excludes(units.units)
      ->excludes(units.scale);
  sub.add_option("--up", placing->up, "Axis of the meshes that points up: x, y, z, -x, -y or -z; it becomes z")
      ->check(CLI::IsMember(axis_names))
      ->capture_default_str();
}

CLI::Option* add_original_up(CLI::App& sub, std::string& up, CLI::Option* original) {
  return sub.add_option("--original-up", up, "With --original: the axis that --up named in the bake")
      ->check(CLI::IsMember(axis_names))
      ->needs(original)
      ->capture_default_str();
}

result<void> fit_scale(const mesh_placing& placing, const std::string& file, const triangle_mesh& mesh,
                       mesh_units& units) {
  if (!placing.fit_m) return {};
  const double diagonal = bounds_of(mesh.positions).diagonal();
  const double scale = *placing.fit_m / diagonal;
  if (!std::isfinite(diagonal) || !std::isfinite(scale) || !(scale > 0.0))
    return error{error_code::bad_mesh, "--fit: " + file + " has no extent that could be scaled; export it again"};
  units.scale = scale;
  return {};
}

void turn_up(const std::string& up, triangle_mesh& mesh) {
  const auto turned = [&](const vec3& p) -> vec3 {
    if (up == "x") return {-p.z, p.y, p.x};
    if (up == "-x") return {p.z, p.y, -p.x};
    if (up == "y") return {p.x, -p.z, p.y};
    if (up == "-y") return {p.x, p.z, -p.y};
    if (up == "-z") return {p.x, -p.y, -p.z};
    return p;
  };
  for (vec3& p : mesh.positions) p = turned(p);
}

}  // namespace asperity::command
