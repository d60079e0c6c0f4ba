#include "law/truth/truth_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/common.hpp>
#include <map>
#include <utility>

#include "asperity/io/mesh_file.hpp"
#include "asperity/io/textured_model_file.hpp"
#include "law/oracle/real_bodies.hpp"
#include "law/truth/made_or_thrown.hpp"
#include "model/surface_index.hpp"

namespace asperity::truth {
namespace fs = std::filesystem;

std::string why_without_scans() { return oracle::why_without_real_meshes(); }

field_body_ptr built_field_body(const textured_model& model, const field_body_settings& settings) {
  return std::make_shared<const field_body>(made_or_thrown(make_field_body(model, settings)));
}

const truth_body& get_body(const std::string& name) {
  static std::map<std::string, truth_body> read;
  if (const auto known = read.find(name); known != read.end()) return known->second;
  truth_body out;
  out.name = name;
  if (std::find(scan_names.begin(), scan_names.end(), name) != scan_names.end()) {
    const oracle::original_and_bake& scan = oracle::load_real_body(name);
    out.full = scan.full;
    out.model = scan.model;
  } else {
    const fs::path folder = ASPERITY_TEST_MODELS_DIR;
    out.full = made_or_thrown(io::load_mesh(folder / (name + ".ply")));
    out.model =
        std::make_shared<const textured_model>(made_or_thrown(io::load_textured_model(folder / (name + ".glb"))));
  }
  out.field = built_field_body(*out.model);
  return read[name] = std::move(out);
}

truth_pair pair_of(const truth_body& probe, const truth_body& fixed) {
  return {{probe.model, {fixed.model}}, std::make_shared<const field_scene>(field_scene{probe.field, {fixed.field}})};
}

textured_model with_shifted_relief(const textured_model& model) {
  textured_model out = model;
  const detail::surface_index index(model);
  const haptic_texture& from = model.texture;
  constexpr double beyond = 2.0;  // texels: bilinear lookups take what lies in the gutter
  for (std::uint32_t t = 0; t < model.mesh.triangles.size(); ++t) {
    const detail::texel_triangle& z = index.texels[t];
    if (!z.usable) continue;
    const vec3 per_column = z.per_texel(corners(model.mesh, t))[0];
    const auto low = glm::max(glm::min(z.corner[0], glm::min(z.corner[1], z.corner[2])) - beyond, vec2(0.0));
    const auto high = glm::max(z.corner[0], glm::max(z.corner[1], z.corner[2])) + beyond;
    const auto columns = std::min(static_cast<std::size_t>(high.x) + 1, std::size_t{from.width} - 1);
    const auto rows = std::min(static_cast<std::size_t>(high.y) + 1, std::size_t{from.height});
    for (auto j = static_cast<std::size_t>(low.y); j < rows; ++j) {
      for (auto i = static_cast<std::size_t>(low.x); i < columns; ++i) {
        const vec2 at(static_cast<double>(i), static_cast<double>(j));
        const vec3 next = from.at(i + 1, j);
        if (z.within(at, z.barycentric(at), beyond) && is_finite(next)) {
          out.texture.texels[j * from.width + i] = glm::vec3(next - per_column);
        }
      }
    }
  }
  return out;
}

field_body_ptr with_fewer_samples(const field_body& body, std::size_t kept) {
  std::vector<field_sample> left;
  for (const sample_tree* of : {&body.samples, &body.plain}) {
    for (std::size_t i = 0; i < of->samples().size(); i += kept) left.push_back(of->samples()[i]);
  }
  return std::make_shared<const field_body>(field_body{body.field, sample_tree(std::move(left))});
}

}  // namespace asperity::truth
