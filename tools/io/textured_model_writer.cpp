// Textured model to .glb: ordinary glTF geometry, and the extension beside it.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <tiny_gltf.h>
#include <tuple>
#include <utility>
#include <vector>

#include "asperity/core/float32.hpp"
#include "asperity/field/packed_field.hpp"
#include "asperity/io/textured_model_file.hpp"
#include "asperity/model/validate.hpp"
#include "file_bytes.hpp"
#include "haptic_texture_extension.hpp"
#include "image_formats.hpp"
#include "relief_image.hpp"
#include "report_object.hpp"
#include "surface_json.hpp"

namespace asperity::io {
namespace {

using value = tinygltf::Value;
using object = tinygltf::Value::Object;

/// Names come from file names, which may be any bytes; JSON holds UTF-8. What is none becomes U+FFFD.
std::string as_utf8(const std::string& name) {
  using nlohmann::json;
  return json::parse(json(name).dump(-1, ' ', false, json::error_handler_t::replace)).get<std::string>();
}

/// Positions and texture coordinates as float32, the name as UTF-8.
textured_model rounded(textured_model model) {
  model.name = as_utf8(model.name);
  if (model.surface) model.surface->name = as_utf8(model.surface->name);
  for (material& m : model.surface_map.others) m.name = as_utf8(m.name);
  for (vec3& p : model.mesh.positions) p = round_to_float32(p);
  for (coarse_triangle& t : model.mesh.triangles) {
    for (vec2& uv : t.uv) uv = round_to_float32(uv);
  }
  for (convex_piece& piece : model.pieces) {
    for (vec3& p : piece.vertices) p = round_to_float32(p);
  }
  return model;
}

/// glTF vertices: one for each pair of mesh vertex and texture coordinates, in the order of first use.
struct split_vertices {
  std::vector<std::uint32_t> mesh_vertex;
  std::vector<glm::vec2> uv;
  std::vector<std::uint32_t> indices;
};

split_vertices split_at_seams(const coarse_mesh& mesh) {
  split_vertices out;
  std::map<std::tuple<std::uint32_t, float, float>, std::uint32_t> known;
  for (const coarse_triangle& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::vec2 uv(t.uv[k]);
      const auto next = static_cast<std::uint32_t>(out.uv.size());
      const auto [entry, fresh] = known.try_emplace({t.vertex[k], uv.x, uv.y}, next);
      if (fresh) {
        out.mesh_vertex.push_back(t.vertex[k]);
        out.uv.push_back(uv);
      }
      out.indices.push_back(entry->second);
    }
  }
  return out;
}

/// Collects the BIN chunk, view by view.
class glb_builder {
 public:
  tinygltf::Model model;

  template <class T>
  int add_view(const std::vector<T>& items, int target = 0) {
    return add_view(std::string_view(reinterpret_cast<const char*>(items.data()), items.size() * sizeof(T)), target);
  }
  int add_view(std::string_view bytes, int target = 0) {
    bytes_.resize((bytes_.size() + 3) / 4 * 4);
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = bytes_.size();
    view.byteLength = bytes.size();
    view.target = target;
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    model.bufferViews.push_back(std::move(view));
    return static_cast<int>(model.bufferViews.size()) - 1;
  }

  int add_accessor(int view, std::size_t count, int component, int type) {
    tinygltf::Accessor a;
    a.bufferView = view;
    a.count = count;
    a.componentType = component;
    a.type = type;
    model.accessors.push_back(std::move(a));
    return static_cast<int>(model.accessors.size()) - 1;
  }

  std::string finish() {
    bytes_.resize((bytes_.size() + 3) / 4 * 4);
    model.buffers.resize(1);
    model.buffers[0].data = std::move(bytes_);
    std::ostringstream stream;
    tinygltf::TinyGLTF().WriteGltfSceneToStream(&model, stream, false, true);
    return std::move(stream).str();
  }

 private:
  std::vector<unsigned char> bytes_;
};

/// Coarse mesh as a primitive with POSITION, TEXCOORD_0 and indices.
tinygltf::Primitive add_geometry(const coarse_mesh& mesh, const split_vertices& split, glb_builder& glb) {
  std::vector<glm::vec3> positions;
  for (const std::uint32_t v : split.mesh_vertex) positions.emplace_back(mesh.positions[v]);
  tinygltf::Primitive primitive;
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  primitive.material = 0;
  const int position = glb.add_accessor(glb.add_view(positions, TINYGLTF_TARGET_ARRAY_BUFFER), positions.size(),
                                        TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3);
  glm::vec3 low = positions.front();
  glm::vec3 high = positions.front();
  for (const glm::vec3& p : positions) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  glb.model.accessors.back().minValues = {double{low.x}, double{low.y}, double{low.z}};
  glb.model.accessors.back().maxValues = {double{high.x}, double{high.y}, double{high.z}};
  primitive.attributes["POSITION"] = position;
  primitive.attributes["TEXCOORD_0"] =
      glb.add_accessor(glb.add_view(split.uv, TINYGLTF_TARGET_ARRAY_BUFFER), split.uv.size(),
                       TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC2);
  primitive.indices =
      glb.add_accessor(glb.add_view(split.indices, TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER), split.indices.size(),
                       TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR);
  return primitive;
}

/// Material with the relief as its base colour. Tools drop texture coordinates that no material uses.
void add_material(const textured_model& model, glb_builder& glb) {
  tinygltf::Image image;
  image.name = "relief";
  image.mimeType = "image/png";
  image.bufferView = glb.add_view(relief_png(model));
  glb.model.images.push_back(std::move(image));
  tinygltf::Texture texture;
  texture.source = 0;
  glb.model.textures.push_back(std::move(texture));
  tinygltf::Material material;
  material.name = "relief";
  material.pbrMetallicRoughness.baseColorTexture.index = 0;
  material.pbrMetallicRoughness.metallicFactor = 0.0;
  material.pbrMetallicRoughness.roughnessFactor = 0.9;
  glb.model.materials.push_back(std::move(material));
}

/// @return false where a hull vertex is no vertex of the coarse mesh
bool add_pieces(const textured_model& model, glb_builder& glb, object& to) {
  const auto key = [](const vec3& p) { return std::tuple(p.x, p.y, p.z); };
  std::map<std::tuple<double, double, double>, std::uint32_t> vertex_at;
  for (std::size_t v = 0; v < model.mesh.positions.size(); ++v) {
    vertex_at.try_emplace(key(model.mesh.positions[v]), static_cast<std::uint32_t>(v));
  }
  std::vector<std::uint32_t> table;
  std::vector<std::uint32_t> vertices;
  std::vector<std::uint32_t> hull;
  std::vector<std::uint32_t> triangles;
  for (const convex_piece& piece : model.pieces) {
    for (const vec3& p : piece.vertices) {
      const auto at = vertex_at.find(key(p));
      if (at == vertex_at.end()) return false;
      vertices.push_back(at->second);
    }
    for (const auto& face : piece.hull) hull.insert(hull.end(), face.begin(), face.end());
    triangles.insert(triangles.end(), piece.triangles.begin(), piece.triangles.end());
    table.push_back(static_cast<std::uint32_t>(piece.vertices.size()));
    table.push_back(static_cast<std::uint32_t>(piece.hull.size()));
    table.push_back(static_cast<std::uint32_t>(piece.triangles.size()));
    table.push_back(piece.flat ? extension::flag_flat : 0);
  }
  object pieces;
  pieces["count"] = value(static_cast<int>(model.pieces.size()));
  pieces["table"] = value(glb.add_view(table));
  pieces["vertices"] = value(glb.add_view(vertices));
  pieces["hull"] = value(glb.add_view(hull));
  pieces["triangles"] = value(glb.add_view(triangles));
  to["pieces"] = value(std::move(pieces));
  return true;
}

/// What the body is like to touch: physics materials, and a collider on the node that names the first of them.
void add_surface(const textured_model& model, tinygltf::Node& node, glb_builder& glb) {
  const object collider{{"geometry", value(object{{"node", value(0)}})}, {"physicsMaterial", value(0)}};
  node.extensions[extension::rigid_bodies] = value(object{{"collider", value(collider)}});
  tinygltf::Value::Array materials{value(material_object(*model.surface))};
  for (const material& m : model.surface_map.others) materials.emplace_back(material_object(m));
  glb.model.extensions[extension::rigid_bodies] = value(object{{"physicsMaterials", value(materials)}});
  glb.model.extensionsUsed.emplace_back(extension::rigid_bodies);
  glb.model.extensionsUsed.emplace_back(extension::haptic_material);
}

/// Which texel is of which physics material: an image of numbers, and the list that they count in.
object materials_object(const textured_model& model, glb_builder& glb) {
  const std::string_view numbers(reinterpret_cast<const char*>(model.surface_map.texels.data()),
                                 model.surface_map.texels.size());
  tinygltf::Image image;
  image.name = "materials";
  image.mimeType = extension::materials_mime_type;
  image.bufferView = glb.add_view(encode_grey_png(model.texture.width, model.texture.height, numbers));
  glb.model.images.push_back(std::move(image));
  tinygltf::Value::Array list;
  for (std::size_t i = 0; i < material_count(model); ++i) list.emplace_back(static_cast<int>(i));
  return {{"version", value(extension::materials_version)},
          {"image", value(static_cast<int>(glb.model.images.size()) - 1)},
          {"physicsMaterials", value(std::move(list))}};
}

result<void> write(const textured_model& given, const std::filesystem::path& file) {
  const textured_model model = rounded(given);
  // What is written must load again, so it passes the same check first.
  if (const auto valid = validate(model); !valid) {
    return fault(valid.error().code, file, "is not written: " + valid.error().message);
  }
  if (!has_finite_figures(model.report)) {
    return fault(error_code::invalid_argument, file,
                 "is not written: its bake report holds a number that is not finite");
  }
  const split_vertices split = split_at_seams(model.mesh);
  glb_builder glb;
  tinygltf::Mesh mesh;
  mesh.name = model.name;
  mesh.primitives.push_back(add_geometry(model.mesh, split, glb));
  add_material(model, glb);

  object haptic;
  haptic["version"] = value(extension::version);
  haptic["units"] = value(std::string(extension::units));
  object vertices;
  vertices["bufferView"] = value(glb.add_view(split.mesh_vertex));
  vertices["componentType"] = value(extension::uint32_component);
  vertices["count"] = value(static_cast<int>(model.mesh.positions.size()));
  haptic["meshVertices"] = value(std::move(vertices));
  object texture;
  texture["width"] = value(static_cast<int>(model.texture.width));
  texture["height"] = value(static_cast<int>(model.texture.height));
  texture["bufferView"] = value(glb.add_view(model.texture.texels));
  texture["componentType"] = value(extension::float32_component);
  texture["components"] = value(3);
  texture["rowOrder"] = value(std::string(extension::row_order));
  haptic["texture"] = value(std::move(texture));
  if (!add_pieces(model, glb, haptic)) {
    return fault(
        error_code::bad_mesh, file,
        "is not written: a convex piece has a hull vertex that is no vertex of the coarse mesh; bake it again");
  }
  haptic["report"] = value(report_object(model.report));
  if (model.field && is_made_of(*model.field, model, model.field->made_with)) {
    object field;
    field["version"] = value(static_cast<int>(packed_field_version));
    field["bufferView"] = value(glb.add_view(pack_field(*model.field)));
    haptic["field"] = value(std::move(field));
  }
  if (!model.surface_map.empty()) haptic["materials"] = value(materials_object(model, glb));
  mesh.extensions[extension::name] = value(std::move(haptic));
  glb.model.extensionsUsed.emplace_back(extension::name);

  glb.model.meshes.push_back(std::move(mesh));
  tinygltf::Node node;
  node.mesh = 0;
  node.name = model.name;
  if (model.surface) add_surface(model, node, glb);
  glb.model.nodes.push_back(std::move(node));
  tinygltf::Scene scene;
  scene.nodes.push_back(0);
  glb.model.scenes.push_back(std::move(scene));
  glb.model.defaultScene = 0;
  glb.model.asset.version = "2.0";
  glb.model.asset.generator = "asperity";
  const std::string bytes = glb.finish();
  if (bytes.size() > max_model_bytes) {
    return fault(error_code::limit_exceeded, file,
                 "is not written: it would take " + std::to_string(bytes.size()) +
                     " bytes, more than a textured model may have; bake with a smaller texture");
  }
  return write_file(file, {bytes});
}

}  // namespace

result<void> save_textured_model(const textured_model& model, const std::filesystem::path& file) {
  return without_exceptions(file, [&] { return write(model, file); });
}

textured_model as_saved(textured_model model) {
  textured_model out = rounded(std::move(model));
  out.mass = compute_mass_properties(out.mesh);
  out.box = bounds_of(out.mesh.positions);
  return out;
}

}  // namespace asperity::io
