#include "law/truth/truth_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <glm/common.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "asperity/bake/repair.hpp"
#include "asperity/io/mesh_file.hpp"
#include "asperity/io/textured_model_file.hpp"
#include "law/truth/made_or_thrown.hpp"
#include "model/surface_index.hpp"
#include "support/real_meshes.hpp"

namespace asperity::truth {
namespace {

namespace fs = std::filesystem;

struct scan {
  const char *name, *file;
  bool has_holes;
};
constexpr std::array<scan, 3> scans{{{"igea", "igea.ply", false},
                                     {"rocker-arm", "rocker-arm.obj", false},
                                     {"stanford-bunny", "stanford-bunny.obj", true}}};

// As its bake took it: at the scale that the bake told, its holes closed.
triangle_mesh load_scan(const scan& of) {
  const fs::path bake_report_path = fs::path(ASPERITY_TEST_MODELS_DIR) / "real" / (std::string(of.name) + ".json");
  std::ifstream in(bake_report_path);
  std::ostringstream text;
  if (!(text << in.rdbuf())) {
    throw std::runtime_error("there is no " + bake_report_path.string() + "; ctest -R real_models makes it");
  }
  triangle_mesh full = made_or_thrown(io::load_mesh(test_support::real_mesh_folder() / of.file));
  const double scale = nlohmann::json::parse(text.str()).at("scale");
  for (vec3& p : full.positions) p *= scale;
  if (of.has_holes) {
    if (const auto closed = bake::close_holes(full); !closed) throw std::runtime_error(closed.error().message);
  }
  return full;
}

}  // namespace

std::string why_without_scans() {
  for (const scan& s : scans) {
    if (std::string why = test_support::why_without(s.file); !why.empty()) return why;
  }
  return "";
}

field_body_ptr built_field_body(const textured_model& model, const field_body_settings& settings) {
  return std::make_shared<const field_body>(made_or_thrown(make_field_body(model, settings)));
}

const truth_body& get_body(const std::string& name) {
  static std::map<std::string, truth_body> read;
  if (const auto known = read.find(name); known != read.end()) return known->second;
  const fs::path folder = ASPERITY_TEST_MODELS_DIR;
  truth_body out;
  out.name = name;
  const auto found = std::find_if(scans.begin(), scans.end(), [&](const scan& s) { return name == s.name; });
  const bool is_scan = found != scans.end();
  out.full = is_scan ? load_scan(*found) : made_or_thrown(io::load_mesh(folder / (name + ".ply")));
  out.model = std::make_shared<const textured_model>(
      made_or_thrown(io::load_textured_model((is_scan ? folder / "real" : folder) / (name + ".glb"))));
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
  for (std::size_t i = 0; i < body.samples.samples().size(); i += kept) left.push_back(body.samples.samples()[i]);
  return std::make_shared<const field_body>(field_body{body.field, sample_tree(std::move(left))});
}

}  // namespace asperity::truth
