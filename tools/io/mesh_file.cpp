#include "asperity/io/mesh_file.hpp"

#include <algorithm>
#include <cctype>
#include <string>

#include "asperity/core/float32.hpp"
#include "file_bytes.hpp"
#include "file_formats.hpp"
#include "mesh_builder.hpp"
#include "mesh_parts.hpp"

namespace asperity::io {
namespace {

std::string lower_case_extension(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

bool fits_float32(const vec3& p) { return round_to_float32(p) == p; }

}  // namespace

namespace {

result<triangle_mesh> load(const std::filesystem::path& file, const std::function<bool()>& keep_going,
                           part_list* parts) {
  return without_exceptions(file, [&]() -> result<triangle_mesh> {
    if (const auto regular = check_regular_file(file); !regular) return regular.error();
    const std::string extension = lower_case_extension(file);
    const bool gltf = extension == ".glb" || extension == ".gltf";
    if (extension != ".ply" && extension != ".obj" && extension != ".stl" && !gltf) {
      return fault(error_code::unsupported, file,
                   "has an unknown extension '" + extension + "'; use .ply, .obj, .stl, .gltf or .glb");
    }
    const reading_watch watch(keep_going);
    const auto bytes = read_file(file, max_mesh_bytes, watch);
    if (!bytes) return bytes.error();
    if (gltf) return read_gltf(*bytes, file, watch, parts);
    if (extension == ".obj") return read_obj(*bytes, file, watch, parts);
    return extension == ".ply" ? read_ply(*bytes, file, watch) : read_stl(*bytes, file, watch);
  });
}

}  // namespace

result<triangle_mesh> load_mesh(const std::filesystem::path& file, const std::function<bool()>& keep_going) {
  return load(file, keep_going, nullptr);
}

result<std::vector<mesh_part>> load_mesh_parts(const std::filesystem::path& file,
                                               const std::function<bool()>& keep_going) {
  part_list named;
  const auto mesh = load(file, keep_going, &named);
  if (!mesh) return mesh.error();
  return without_exceptions(file, [&]() -> result<std::vector<mesh_part>> {
    std::vector<mesh_part> out = named_parts(*mesh, named);
    if (out.size() > 1) return out;
    const std::string name = out.empty() ? "" : out.front().name;
    auto surfaces = separate_surfaces(*mesh);
    if (!surfaces) {
      return fault(error_code::limit_exceeded, file,
                   "has more than " + std::to_string(max_mesh_parts) + " surfaces that share no vertex; join them");
    }
    if (surfaces->size() == 1) surfaces->front().name = name;
    return std::move(*surfaces);
  });
}

result<void> save_ply(const triangle_mesh& mesh, const std::filesystem::path& file) {
  return without_exceptions(file, [&]() -> result<void> {
    // float32 where it loses nothing, which is what most tools expect; double otherwise.
    const bool single = std::all_of(mesh.positions.begin(), mesh.positions.end(), fits_float32);
    const std::string type = single ? "float" : "double";
    std::string bytes = "ply\nformat binary_little_endian 1.0\ncomment asperity, metres\nelement vertex " +
                        std::to_string(mesh.positions.size()) + "\nproperty " + type + " x\nproperty " + type +
                        " y\nproperty " + type + " z\nelement face " + std::to_string(mesh.triangles.size()) +
                        "\nproperty list uchar uint vertex_indices\nend_header\n";
    bytes.reserve(bytes.size() + (single ? 12 : 24) * mesh.positions.size() + 13 * mesh.triangles.size());
    for (const vec3& p : mesh.positions) {
      for (const double x : {p.x, p.y, p.z}) {
        if (single) {
          append_number(bytes, static_cast<float>(x));
        } else {
          append_number(bytes, x);
        }
      }
    }
    for (const auto& t : mesh.triangles) {
      bytes += '\3';
      for (const std::uint32_t v : t) append_number(bytes, v);
    }
    return write_file(file, {bytes});
  });
}

}  // namespace asperity::io
