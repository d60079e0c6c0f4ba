#include "mesh_formats.hpp"

#include <cstdint>
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>

#include "attacks.hpp"
#include "file_formats.hpp"
#include "mesh_builder.hpp"

namespace asperity::hostile {
namespace {

template <class T>
void append(std::string& to, const T& value) {
  to.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string words(const vec3& p) {
  std::array<char, 100> out{};
  std::snprintf(out.data(), out.size(), "%.9g %.9g %.9g\n", p.x, p.y, p.z);
  return out.data();
}

void append_floats(std::string& to, const vec3& p) {
  for (glm::length_t k = 0; k < 3; ++k) append(to, static_cast<float>(p[k]));
}

vec3 corner(const triangle_mesh& mesh, std::uint32_t v) {
  return v < mesh.positions.size() ? mesh.positions[v] : vec3(0.0);
}

std::string ply_header(const triangle_mesh& mesh, const char* format) {
  return std::string("ply\nformat ") + format + " 1.0\nelement vertex " + std::to_string(mesh.positions.size()) +
         "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
         std::to_string(mesh.triangles.size()) + "\nproperty list uchar uint vertex_indices\nend_header\n";
}

std::string ascii_ply(const triangle_mesh& mesh) {
  std::string out = ply_header(mesh, "ascii");
  for (const vec3& p : mesh.positions) out += words(p);
  for (const auto& t : mesh.triangles) {
    out += "3 " + std::to_string(t[0]) + ' ' + std::to_string(t[1]) + ' ' + std::to_string(t[2]) + '\n';
  }
  return out;
}

std::string binary_ply(const triangle_mesh& mesh) {
  std::string out = ply_header(mesh, "binary_little_endian");
  for (const vec3& p : mesh.positions) append_floats(out, p);
  for (const auto& t : mesh.triangles) {
    out += '\3';
    append(out, t);
  }
  return out;
}

std::string obj(const triangle_mesh& mesh) {
  std::string out = "# hostile\n";
  for (const vec3& p : mesh.positions) out += "v " + words(p);
  for (const auto& t : mesh.triangles) {
    out += "f " + std::to_string(t[0] + 1ULL) + ' ' + std::to_string(t[1] + 1ULL) + ' ' + std::to_string(t[2] + 1ULL) +
           '\n';
  }
  return out;
}

std::string ascii_stl(const triangle_mesh& mesh) {
  std::string out = "solid hostile\n";
  for (const auto& t : mesh.triangles) {
    out += "facet normal 0 0 0\nouter loop\n";
    for (const std::uint32_t v : t) out += "vertex " + words(corner(mesh, v));
    out += "endloop\nendfacet\n";
  }
  return out + "endsolid hostile\n";
}

std::string binary_stl(const triangle_mesh& mesh) {
  std::string out(80, ' ');
  append(out, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& t : mesh.triangles) {
    append_floats(out, vec3(0.0));
    for (const std::uint32_t v : t) append_floats(out, corner(mesh, v));
    out.append(2, '\0');
  }
  return out;
}

struct document_and_bytes {
  nlohmann::json document;
  std::string bytes;
};

document_and_bytes gltf_of(const triangle_mesh& mesh) {
  document_and_bytes out{tetrahedron(), {}};
  for (const vec3& p : mesh.positions) append_floats(out.bytes, p);
  const std::size_t vertices = out.bytes.size();
  for (const auto& t : mesh.triangles) append(out.bytes, t);
  out.document["buffers"][0]["byteLength"] = out.bytes.size();
  out.document["bufferViews"][0]["byteLength"] = vertices;
  out.document["bufferViews"][1]["byteOffset"] = vertices;
  out.document["bufferViews"][1]["byteLength"] = out.bytes.size() - vertices;
  out.document["accessors"][0]["count"] = mesh.positions.size();
  out.document["accessors"][1]["count"] = 3 * mesh.triangles.size();
  return out;
}

std::string base64(std::string_view bytes) {
  static constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      three = three << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      out += i + k <= bytes.size() ? digits[three >> (18 - 6 * k) & 63U] : '=';
    }
  }
  return out;
}

std::string glb_file(const triangle_mesh& mesh) {
  const document_and_bytes made = gltf_of(mesh);
  return glb(made.document, made.bytes);
}

std::string gltf_file(const triangle_mesh& mesh) {
  document_and_bytes made = gltf_of(mesh);
  made.document["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64(made.bytes);
  return made.document.dump(1);
}

// With the names of their parts, as a bake with --split reads them.
result<triangle_mesh> read_obj(std::string_view bytes, const std::filesystem::path& file, io::reading_watch watch) {
  io::part_list parts;
  return io::read_obj(bytes, file, watch, &parts);
}
result<triangle_mesh> read_gltf(std::string_view bytes, const std::filesystem::path& file, io::reading_watch watch) {
  io::part_list parts;
  return io::read_gltf(bytes, file, watch, &parts);
}

}  // namespace

const std::array<mesh_format, 7>& mesh_formats() {
  static const std::array<mesh_format, 7> all{{
      {"ascii PLY", ".ply", ascii_ply, io::read_ply, true, true},
      {"binary PLY", ".ply", binary_ply, io::read_ply, true, false},
      {"OBJ", ".obj", obj, read_obj, true, true},
      {"ascii STL", ".stl", ascii_stl, io::read_stl, false, true},
      {"binary STL", ".stl", binary_stl, io::read_stl, false, false},
      {"glTF", ".gltf", gltf_file, read_gltf, true, true},
      {"GLB", ".glb", glb_file, read_gltf, true, false},
  }};
  return all;
}

}  // namespace asperity::hostile
