// Textured model from .glb: guard, then the extension, then the model check.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "asperity/field/packed_field.hpp"
#include "asperity/io/textured_model_file.hpp"
#include "asperity/model/validate.hpp"
#include "file_bytes.hpp"
#include "file_formats.hpp"
#include "gltf_document.hpp"
#include "haptic_texture_extension.hpp"
#include "image_formats.hpp"
#include "surface_json.hpp"

namespace asperity::io {
namespace {

/// Bytes of the buffer view that a field names. Throws rejection.
std::size_t view_size(const gltf_document& document, const json_object& from, const char* key) {
  return document.view_bytes(from.index(key, document.geometry().bufferViews.size())).size();
}

/// All numbers of a buffer view. Throws rejection where its length is no multiple of theirs.
template <class T>
std::vector<T> numbers(const gltf_document& document, const json_object& from, const char* key) {
  const std::size_t view = from.index(key, document.geometry().bufferViews.size());
  const std::string_view bytes = document.view_bytes(view);
  if (bytes.size() % sizeof(T) != 0) {
    reject(from.path(key) + " has " + std::to_string(bytes.size()) + " bytes, not a multiple of " +
           std::to_string(sizeof(T)));
  }
  std::vector<T> out(bytes.size() / sizeof(T));
  std::memcpy(out.data(), bytes.data(), bytes.size());
  return out;
}

/// The mesh that carries the extension.
std::size_t find_mesh(const json_object& root) {
  std::optional<std::size_t> found;
  for (std::size_t m = 0; m < root.array("meshes").size(); ++m) {
    const json_object mesh = root.element("meshes", m);
    if (!mesh.has("extensions") || !mesh.object("extensions").has(extension::name)) continue;
    if (found) throw rejection{error_code::unsupported, "has more than one mesh with a haptic texture; split the file"};
    found = m;
  }
  if (!found) {
    throw rejection{
        error_code::bad_texture,
        std::string("has no haptic texture (no mesh has the extension ") + extension::name +
            "): it was never baked, or another tool rewrote it and dropped the extension; make bake the last step"};
  }
  return *found;
}

coarse_mesh read_mesh(const gltf_document& document, std::size_t m, const json_object& haptic) {
  const auto& primitives = document.geometry().meshes[m].primitives;
  if (primitives.size() != 1 || primitives[0].mode != TINYGLTF_MODE_TRIANGLES ||
      primitives[0].attributes.count("TEXCOORD_0") == 0) {
    reject("meshes[" + std::to_string(m) + "] is not a single list of triangles with TEXCOORD_0");
  }
  const int position = primitives[0].attributes.at("POSITION");
  const int uv = primitives[0].attributes.at("TEXCOORD_0");
  const int index = primitives[0].indices;
  const json_object merged = haptic.object("meshVertices");
  const std::uint64_t count = merged.whole("count");
  const std::size_t vertices = document.count(position);
  const std::size_t corners = index < 0 ? vertices : document.count(index);
  // Every size is compared before anything of that size is made.
  const std::size_t entries = view_size(document, merged, "bufferView") / sizeof(std::uint32_t);
  if (document.count(uv) != vertices || entries != vertices || count > vertices) {
    reject("the mesh has " + std::to_string(vertices) + " positions, " + std::to_string(document.count(uv)) +
           " texture coordinates, " + std::to_string(entries) + " entries and " + std::to_string(count) +
           " vertices in " + merged.path());
  }
  if (corners % 3 != 0) reject("the mesh has " + std::to_string(corners) + " corners, not a multiple of 3");
  if (corners / 3 > max_coarse_triangles || vertices > 3 * max_coarse_triangles) {
    throw rejection{error_code::limit_exceeded, "the mesh has " + std::to_string(corners / 3) + " triangles and " +
                                                    std::to_string(vertices) + " vertices, more than the limit of " +
                                                    std::to_string(max_coarse_triangles) +
                                                    " triangles with three vertices each; bake it with fewer"};
  }
  const auto positions = document.positions(position);
  const auto uvs = document.uvs(uv);
  const auto indices = document.indices(index, vertices);
  const auto mesh_vertex = numbers<std::uint32_t>(document, merged, "bufferView");

  coarse_mesh mesh;
  mesh.positions.resize(static_cast<std::size_t>(count));
  std::vector<bool> set(mesh.positions.size());
  for (std::size_t i = 0; i < mesh_vertex.size(); ++i) {
    const std::uint32_t v = mesh_vertex[i];
    if (v >= count || (set[v] && mesh.positions[v] != positions[i])) {
      reject(merged.path() + " entry " + std::to_string(i) + " merges positions that differ or names vertex " +
             std::to_string(v) + " of " + std::to_string(count));
    }
    mesh.positions[v] = positions[i];
    set[v] = true;
  }
  mesh.triangles.resize(indices.size() / 3);
  for (std::size_t corner = 0; corner < indices.size(); ++corner) {
    mesh.triangles[corner / 3].vertex[corner % 3] = mesh_vertex[indices[corner]];
    mesh.triangles[corner / 3].uv[corner % 3] = uvs[indices[corner]];
  }
  return mesh;
}

haptic_texture read_texture(const gltf_document& document, const json_object& from) {
  constexpr std::uint64_t largest_side = 16384;
  haptic_texture texture;
  const std::uint64_t width = from.whole("width");
  const std::uint64_t height = from.whole("height");
  if (width == 0 || height == 0 || width > largest_side || height > largest_side) {
    reject(from.path() + " is " + std::to_string(width) + " x " + std::to_string(height) +
           " texels, and both must be 1 to " + std::to_string(largest_side));
  }
  if (from.whole("componentType") != extension::float32_component || from.whole("components") != 3 ||
      from.text("rowOrder") != extension::row_order) {
    throw rejection{error_code::unsupported,
                    from.path() + " holds texels of another kind than three float32, row v = 0 first"};
  }
  texture.width = static_cast<std::uint32_t>(width);
  texture.height = static_cast<std::uint32_t>(height);
  const std::size_t bytes = view_size(document, from, "bufferView");
  if (bytes != width * height * sizeof(glm::vec3)) {
    throw rejection{error_code::bad_texture, from.path("bufferView") + " holds " + std::to_string(bytes) +
                                                 " bytes, not the " +
                                                 std::to_string(width * height * sizeof(glm::vec3)) + " of " +
                                                 std::to_string(width) + " x " + std::to_string(height) + " texels"};
  }
  texture.texels = numbers<glm::vec3>(document, from, "bufferView");
  return texture;
}

std::vector<convex_piece> read_pieces(const gltf_document& document, const json_object& from, const coarse_mesh& mesh) {
  // A piece covers a triangle at least, has no vertices but theirs, and a hull of two faces for each of those at most.
  const std::size_t covered = mesh.triangles.size();
  for (const auto& [key, most] : {std::pair{"table", extension::table_columns * sizeof(std::uint32_t) * covered},
                                  std::pair{"vertices", 3 * sizeof(std::uint32_t) * covered},
                                  std::pair{"hull", std::size_t{6} * 3 * sizeof(std::uint32_t) * covered},
                                  std::pair{"triangles", sizeof(std::uint32_t) * covered}}) {
    if (const std::size_t bytes = view_size(document, from, key); bytes > most) {
      reject(from.path(key) + " has " + std::to_string(bytes) + " bytes, more than the " + std::to_string(most) +
             " that the pieces of " + std::to_string(covered) + " triangles can take");
    }
  }
  const auto table = numbers<std::uint32_t>(document, from, "table");
  const auto vertices = numbers<std::uint32_t>(document, from, "vertices");
  const auto hull = numbers<std::array<std::uint32_t, 3>>(document, from, "hull");
  const auto triangles = numbers<std::uint32_t>(document, from, "triangles");
  if (table.size() % extension::table_columns != 0 || from.whole("count") != table.size() / extension::table_columns) {
    reject(from.path("table") + " does not hold four numbers for each piece");
  }
  std::vector<convex_piece> pieces;
  pieces.reserve(table.size() / extension::table_columns);
  std::size_t vertex = 0;
  std::size_t face = 0;
  std::size_t triangle = 0;
  for (std::size_t row = 0; row < table.size(); row += extension::table_columns) {
    const std::uint32_t* counts = table.data() + row;
    if (counts[0] > vertices.size() - vertex || counts[1] > hull.size() - face ||
        counts[2] > triangles.size() - triangle) {
      reject(from.path("table") + " row " + std::to_string(pieces.size()) + " takes more than the arrays hold");
    }
    convex_piece piece;
    for (const std::size_t end = vertex + counts[0]; vertex < end; ++vertex) {
      if (vertices[vertex] >= mesh.positions.size()) {
        reject(from.path("vertices") + " entry " + std::to_string(vertex) + " names vertex " +
               std::to_string(vertices[vertex]) + " of " + std::to_string(mesh.positions.size()));
      }
      piece.vertices.push_back(mesh.positions[vertices[vertex]]);
    }
    const auto offset = [](std::size_t n) { return static_cast<std::ptrdiff_t>(n); };
    piece.hull.assign(hull.begin() + offset(face), hull.begin() + offset(face + counts[1]));
    piece.triangles.assign(triangles.begin() + offset(triangle), triangles.begin() + offset(triangle + counts[2]));
    face += counts[1];
    triangle += counts[2];
    piece.flat = (counts[3] & extension::flag_flat) != 0;
    pieces.push_back(std::move(piece));
  }
  if (vertex != vertices.size() || face != hull.size() || triangle != triangles.size()) {
    reject(from.path("table") + " leaves part of the arrays to no piece");
  }
  return pieces;
}

length_spread read_spread(const json_object& from) {
  return {from.number("median_m"), from.number("p99_m"), from.number("max_m")};
}

bake_quality read_quality(const json_object& from) {
  bake_quality out;
  out.to_original = read_spread(from.object("to_original"));
  out.to_textured = read_spread(from.object("to_textured"));
  out.to_original_rms_m = from.number("to_original_rms_m");
  out.to_textured_rms_m = from.number("to_textured_rms_m");
  out.crack_max_m = from.number("crack_max_m");
  out.texel_m = from.number("texel_m");
  out.atlas_utilisation = from.number("atlas_utilisation");
  out.texel_spacing = read_spread(from.object("texel_spacing"));
  out.lost_share = from.number("lost_share");
  out.lost_part_share = from.number("lost_part_share");
  out.lost_part_centre = from.vector("lost_part_centre");
  out.lost_part_low = from.vector("lost_part_low");
  out.lost_part_high = from.vector("lost_part_high");
  out.surface_to_hull_max_m = from.number("surface_to_hull_max_m");
  out.bridged_air_max_m = from.number("bridged_air_max_m");
  return out;
}

bake_report read_report(const json_object& from) {
  bake_report report;
  report.rms_error_m = from.number("rms_error_m");
  report.max_error_m = from.number("max_error_m");
  report.peak_to_valley_m = from.number("relief_m");
  report.max_displacement_m = from.number("max_displacement_m");
  report.full_triangles = static_cast<std::size_t>(from.whole("full_triangles"));
  report.fallback_texels = static_cast<std::size_t>(from.whole("fallback_texels"));
  report.texels = static_cast<std::size_t>(from.whole("texels"));
  if (from.has("quality")) report.quality = read_quality(from.object("quality"));
  return report;
}

/// The field that the bake made; nothing where the file keeps none, or one of another version or model.
field_body_ptr read_field(const gltf_document& document, const json_object& from, const textured_model& model) {
  if (from.whole("version") != packed_field_version) return nullptr;
  const std::string_view bytes = document.view_bytes(from.index("bufferView", document.geometry().bufferViews.size()));
  result<field_body> body = unpack_field(std::as_bytes(std::span(bytes)));
  if (!body) throw rejection{body.error().code, from.path() + ": " + body.error().message};
  if (!is_made_of(*body, model, body->made_with)) return nullptr;
  return std::make_shared<const field_body>(std::move(*body));
}

/// A list of numbers of physics materials, each of which there is; the first is that of the colliders.
std::vector<material> listed_materials(const json_object& root, const json_object& from, std::size_t first) {
  const json_object bodies = root.object("extensions").object(extension::rigid_bodies);
  const std::size_t known = bodies.array("physicsMaterials").size();
  const json& list = from.array("physicsMaterials");
  if (list.size() < 2 || list.size() > most_materials) {
    reject(from.path("physicsMaterials") + " lists " + std::to_string(list.size()) + " materials, not 2 to " +
           std::to_string(most_materials));
  }
  std::vector<material> out;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const std::string place = from.path("physicsMaterials") + "[" + std::to_string(i) + "]";
    if (!list[i].is_number_unsigned() || list[i].get<std::uint64_t>() >= known) {
      reject(place + " is not the number of one of " + std::to_string(known) + " physics materials");
    }
    const auto number = list[i].get<std::size_t>();
    if (i == 0 && number != first) {
      reject(place + " is " + std::to_string(number) + ", and the colliders of the mesh name " + std::to_string(first));
    }
    if (i > 0) out.push_back(read_material(bodies.element("physicsMaterials", number)));
  }
  return out;
}

/// The map of materials. @param first the physics material of the colliders
material_map read_map(const gltf_document& document, const json_object& root, const json_object& from,
                      const haptic_texture& texture, std::optional<std::size_t> first, reading_watch& watch) {
  if (from.whole("version") != extension::materials_version) {
    throw rejection{error_code::unsupported, from.path("version") + " is " + std::to_string(from.whole("version")) +
                                                 ", and this build reads version 1; update asperity"};
  }
  if (!first) reject(from.path() + " maps materials, and no collider of the mesh names the first of them");
  const json_object image = root.element("images", from.index("image", root.array("images").size()));
  if (image.text("mimeType") != extension::materials_mime_type) reject(image.path("mimeType") + " is not image/png");
  const std::string_view bytes = document.view_bytes(image.index("bufferView", document.geometry().bufferViews.size()));
  const result<map_image> numbers = decode_png(bytes, image.path(), watch);
  if (!numbers) throw rejection{numbers.error().code, numbers.error().message};
  if (numbers->width != texture.width || numbers->height != texture.height || numbers->channels != 1 ||
      numbers->bits != 8) {
    throw rejection{error_code::bad_texture, image.path() + " is not a grey image of 8 bits with the " +
                                                 std::to_string(texture.width) + " x " +
                                                 std::to_string(texture.height) + " texels of the haptic texture"};
  }
  material_map out{.others = listed_materials(root, from, *first)};
  out.texels.reserve(numbers->samples.size());
  for (const float n : numbers->samples) out.texels.push_back(static_cast<std::uint8_t>(std::lround(255.0F * n)));
  return out;
}

/// Which physics material the colliders on the nodes that place this mesh name; nothing where none has one.
std::optional<std::size_t> named_material(const json_object& root, std::size_t mesh) {
  std::optional<std::size_t> named;
  for (std::size_t n = 0; n < root.array("nodes").size(); ++n) {
    const json_object node = root.element("nodes", n);
    if (!node.has("mesh") || node.whole("mesh") != mesh || !node.has("extensions")) continue;
    const json_object extensions = node.object("extensions");
    if (!extensions.has(extension::rigid_bodies)) continue;
    const json_object body = extensions.object(extension::rigid_bodies);
    if (!body.has("collider") || !body.object("collider").has("physicsMaterial")) continue;
    const std::size_t index = static_cast<std::size_t>(body.object("collider").whole("physicsMaterial"));
    if (named && *named != index) reject("nodes place the mesh with more than one physics material; leave it one");
    named = index;
  }
  return named;
}

material read_surface(const json_object& root, std::size_t named) {
  const json_object bodies = root.object("extensions").object(extension::rigid_bodies);
  if (named >= bodies.array("physicsMaterials").size()) {
    reject(bodies.path("physicsMaterials") + " has no material " + std::to_string(named) + ", which a node names");
  }
  return read_material(bodies.element("physicsMaterials", named));
}

textured_model read_model(const gltf_document& document, reading_watch& watch) {
  const json_object root(document.source(), "the document");
  const std::size_t m = find_mesh(root);
  const json_object mesh = root.element("meshes", m);
  const json_object haptic(mesh.object("extensions").raw(extension::name), extension::name);
  if (haptic.whole("version") != extension::version) {
    throw rejection{error_code::unsupported, haptic.path("version") + " is " + std::to_string(haptic.whole("version")) +
                                                 ", and this build reads version 1; update asperity or bake again"};
  }
  if (haptic.text("units") != extension::units) {
    throw rejection{error_code::unsupported, haptic.path("units") + " is not m"};
  }
  textured_model model;
  if (mesh.has("name")) model.name = mesh.text("name");
  model.mesh = read_mesh(document, m, haptic);
  model.texture = read_texture(document, haptic.object("texture"));
  model.pieces = read_pieces(document, haptic.object("pieces"), model.mesh);
  model.report = read_report(haptic.object("report"));
  const std::optional<std::size_t> named = named_material(root, m);
  if (named) model.surface = read_surface(root, *named);
  if (haptic.has("materials")) {
    model.surface_map = read_map(document, root, haptic.object("materials"), model.texture, named, watch);
  }
  if (haptic.has("field")) model.field = read_field(document, haptic.object("field"), model);
  return model;
}

result<textured_model> read_checked(std::string_view bytes, const std::filesystem::path& file, reading_watch& watch) {
  static constexpr const char* mend = "bake the model again";
  result<textured_model> read = refusing(file, mend, [&]() -> result<textured_model> {
    return read_model(gltf_document(bytes, file, buffer_policy::own_chunk_only, watch), watch);
  });
  if (!read) return read;
  if (const auto valid = validate(*read); !valid) {
    return fault(valid.error().code, file, with_mend(valid.error().message, mend));
  }
  read->mass = compute_mass_properties(read->mesh);
  read->box = bounds_of(read->mesh.positions);
  return read;
}

}  // namespace

result<textured_model> read_textured_model(std::string_view bytes, const std::filesystem::path& file,
                                           reading_watch watch) {
  return without_exceptions(file, [&] { return read_checked(bytes, file, watch); });
}

result<textured_model> load_textured_model(const std::filesystem::path& file, const std::function<bool()>& keep_going) {
  return without_exceptions(file, [&]() -> result<textured_model> {
    reading_watch watch(keep_going);
    const auto bytes = read_file(file, max_model_bytes, watch);
    if (!bytes) return bytes.error();
    return read_checked(*bytes, file, watch);
  });
}

}  // namespace asperity::io
