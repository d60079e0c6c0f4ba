// glTF and GLB: the triangles of all nodes of the scene, in the scene's frame.
#include <array>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <limits>
#include <string>
#include <vector>

#include "file_bytes.hpp"
#include "file_formats.hpp"
#include "gltf_document.hpp"
#include "mesh_builder.hpp"

namespace asperity::io {
namespace {

/// Limits for triangles and for vertices. A scene can place one mesh many times over, so the file's size bounds
/// neither.
constexpr std::size_t max_vertices = 8'000'000;

glm::dmat4 local_transform(const tinygltf::Node& node) {
  glm::dmat4 m(1.0);
  if (node.matrix.size() == 16) {
    for (int column = 0; column < 4; ++column) {
      for (int row = 0; row < 4; ++row) m[column][row] = node.matrix[static_cast<std::size_t>(4 * column + row)];
    }
    return m;
  }
  const auto& r = node.rotation;
  if (r.size() == 4) m = glm::mat4_cast(glm::dquat(r[3], r[0], r[1], r[2]));  // glTF stores x y z w
  if (const auto& s = node.scale; s.size() == 3) {
    for (int axis = 0; axis < 3; ++axis) m[axis] *= s[static_cast<std::size_t>(axis)];
  }
  if (const auto& t = node.translation; t.size() == 3) m[3] = {t[0], t[1], t[2], 1.0};
  return m;
}

struct placed_mesh {
  int mesh;
  std::size_t node;
  glm::dmat4 transform;
};

/// Meshes of the default scene; of all nodes without a parent where there is no scene.
std::vector<placed_mesh> placed_meshes(const tinygltf::Model& model) {
  std::vector<std::pair<int, glm::dmat4>> open;
  if (!model.scenes.empty()) {
    const auto scene = model.defaultScene < 0 ? 0U : static_cast<std::size_t>(model.defaultScene);
    const auto& roots = model.scenes[scene].nodes;
    for (auto n = roots.rbegin(); n != roots.rend(); ++n) open.emplace_back(*n, glm::dmat4(1.0));
  } else {
    std::vector<bool> child(model.nodes.size());
    for (const auto& node : model.nodes) {
      for (const int c : node.children) child[static_cast<std::size_t>(c)] = true;
    }
    for (std::size_t n = model.nodes.size(); n-- > 0;) {
      if (!child[n]) open.emplace_back(static_cast<int>(n), glm::dmat4(1.0));
    }
  }
  std::vector<placed_mesh> out;
  std::vector<bool> seen(model.nodes.size());
  while (!open.empty()) {
    const auto [n, parent] = open.back();
    open.pop_back();
    const auto at = static_cast<std::size_t>(n);
    if (seen[at]) reject("nodes[" + std::to_string(n) + "] has two parents or is its own ancestor");
    seen[at] = true;
    const tinygltf::Node& node = model.nodes[at];
    const glm::dmat4 transform = parent * local_transform(node);
    if (node.mesh >= 0) out.push_back({node.mesh, at, transform});
    for (auto c = node.children.rbegin(); c != node.children.rend(); ++c) open.emplace_back(*c, transform);
  }
  return out;
}

/// Refuses a scene that would outgrow the limits, before any of it is built. Throws rejection.
void check_size(const tinygltf::Model& model, const std::vector<placed_mesh>& scene) {
  std::size_t corners = 0;
  std::size_t vertices = 0;
  for (const placed_mesh& placed : scene) {
    for (const auto& primitive : model.meshes[static_cast<std::size_t>(placed.mesh)].primitives) {
      const auto count = [&](int accessor) { return model.accessors[static_cast<std::size_t>(accessor)].count; };
      const int positions = primitive.attributes.at("POSITION");
      vertices += count(positions);
      corners += count(primitive.indices < 0 ? positions : primitive.indices);
      if (corners / 3 > max_mesh_triangles || vertices > max_vertices) {  // checked at each step: no sum can wrap round
        throw rejection{error_code::limit_exceeded, "places more than 8 million triangles or vertices in its scene"};
      }
    }
  }
}

void add_primitive(const gltf_document& document, const tinygltf::Primitive& primitive, const std::string& place,
                   const glm::dmat4& transform, polygon_soup& soup, bool& all_have_uvs, reading_watch& watch) {
  if (primitive.mode == TINYGLTF_MODE_POINTS || primitive.mode == TINYGLTF_MODE_LINE ||
      primitive.mode == TINYGLTF_MODE_LINE_LOOP || primitive.mode == TINYGLTF_MODE_LINE_STRIP) {
    return;  // no surface
  }
  if (primitive.mode != TINYGLTF_MODE_TRIANGLES) {
    throw rejection{error_code::unsupported, place + " is a strip or fan; export it as a list of triangles"};
  }
  const auto positions = document.positions(primitive.attributes.at("POSITION"));
  const auto indices = document.indices(primitive.indices, positions.size());
  if (indices.size() % 3 != 0)
    reject(place + " has " + std::to_string(indices.size()) + " corners, not a multiple of 3");
  const auto uv = primitive.attributes.find("TEXCOORD_0");
  all_have_uvs = all_have_uvs && uv != primitive.attributes.end();
  if (all_have_uvs && document.count(uv->second) != positions.size()) {
    reject(place + " has " + std::to_string(document.count(uv->second)) + " texture coordinates for " +
           std::to_string(positions.size()) + " vertices");
  }
  const auto uvs = all_have_uvs ? document.uvs(uv->second) : std::vector<vec2>();

  const auto first = static_cast<std::uint32_t>(soup.positions.size());
  for (const vec3& p : positions) {
    watch.step();
    soup.positions.emplace_back(transform * glm::dvec4(p, 1.0));
    if (!is_finite(soup.positions.back())) reject(place + " is moved beyond all numbers by its node");
  }
  // A mirroring transform turns triangles inside out; glTF says that their winding turns with it.
  const bool mirrored = glm::determinant(glm::dmat3(transform)) < 0.0;
  const auto first_uv = static_cast<std::uint32_t>(soup.uvs.size());
  soup.uvs.insert(soup.uvs.end(), uvs.begin(), uvs.end());
  for (std::size_t t = 0; t < indices.size(); t += 3) {
    watch.step();
    for (const std::size_t k : mirrored ? std::array<std::size_t, 3>{0, 2, 1} : std::array<std::size_t, 3>{0, 1, 2}) {
      soup.corners.push_back(first + indices[t + k]);
      if (all_have_uvs) soup.corner_uvs.push_back(first_uv + indices[t + k]);
    }
    soup.end_polygon();
  }
}

}  // namespace

result<triangle_mesh> read_gltf(std::string_view bytes, const std::filesystem::path& file, reading_watch watch,
                                part_list* parts) {
  return refusing(file, mesh_mend, [&] {
    polygon_soup soup;
    soup.parts = parts;
    const gltf_document document(bytes, file, buffer_policy::own_folder, watch);
    const tinygltf::Model& model = document.geometry();
    bool all_have_uvs = true;
    const std::vector<placed_mesh> scene = placed_meshes(model);
    check_size(model, scene);
    for (const placed_mesh& placed : scene) {
      if (parts != nullptr) {
        const std::string& name = model.nodes[placed.node].name;
        soup.part =
            parts->number_of(name.empty() ? model.meshes[static_cast<std::size_t>(placed.mesh)].name : name, true);
      }
      const auto& primitives = model.meshes[static_cast<std::size_t>(placed.mesh)].primitives;
      for (std::size_t p = 0; p < primitives.size(); ++p) {
        const std::string place = "meshes[" + std::to_string(placed.mesh) + "].primitives[" + std::to_string(p) + "]";
        add_primitive(document, primitives[p], place, placed.transform, soup, all_have_uvs, watch);
      }
    }
    if (!all_have_uvs) soup.corner_uvs = {};
    return build_mesh(std::move(soup), file, watch);
  });
}

}  // namespace asperity::io
