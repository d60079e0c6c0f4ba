// The normal texture of a glTF asset.
#include <cmath>
#include <optional>
#include <string>

#include "asperity/io/material_file.hpp"
#include "file_bytes.hpp"
#include "gltf_document.hpp"
#include "image_formats.hpp"

namespace asperity::io {
namespace {

constexpr std::uintmax_t max_image_bytes = std::uintmax_t{1} << 30;

[[noreturn]] void not_supported(std::string what) { throw rejection{error_code::unsupported, std::move(what)}; }

/// The material that all primitives share. Throws rejection.
std::size_t only_material(const json_object& root) {
  std::optional<std::size_t> found;
  for (std::size_t m = 0; m < root.array("meshes").size(); ++m) {
    const json_object mesh = root.element("meshes", m);
    for (std::size_t p = 0; p < mesh.array("primitives").size(); ++p) {
      const json_object primitive = mesh.element("primitives", p);
      const std::uint64_t mode = primitive.whole("mode", 4);
      if (!primitive.object("attributes").has("POSITION") || mode < 4) continue;  // points and lines have no surface
      if (!primitive.has("material")) not_supported(primitive.path() + " has no material, so no normal texture");
      const std::size_t material = primitive.index("material", root.array("materials").size());
      if (found && *found != material)
        not_supported("has several materials (" + primitive.path("material") +
                      " is another one): join them to one with one normal texture, or bake their meshes apart");
      found = material;
    }
  }
  if (!found) not_supported("has no triangles, so no material to take a normal texture from");
  return *found;
}

map_wrap wrap_of(const json_object& sampler, const char* key) {
  switch (sampler.whole(key, 10497)) {
    case 33071:
      return map_wrap::clamp;
    case 33648:
      return map_wrap::mirrored;
    case 10497:
      return map_wrap::repeat;
    default:
      reject(sampler.path(key) + " is no wrapping that glTF knows");
  }
}

std::string image_bytes(const gltf_document& document, const json_object& image, const std::filesystem::path& file,
                        reading_watch& watch) {
  if (!image.has("bufferView"))
    return gltf_document::outside_bytes(image.text("uri"), image.path("uri"), file, max_image_bytes, watch);
  return std::string(document.view_bytes(image.index("bufferView", document.geometry().bufferViews.size())));
}

normal_texture read_normal_texture(std::string_view bytes, const std::filesystem::path& file, reading_watch& watch) {
  const gltf_document document(bytes, file, buffer_policy::own_folder, watch);
  const json_object root(document.source(), "the document");
  const json_object material = root.element("materials", only_material(root));
  if (!material.has("normalTexture"))
    not_supported(material.path() + " has no normalTexture; give the map with --normal-map or --height-map");
  const json_object use = material.object("normalTexture");
  if (use.has("extensions") && use.object("extensions").has("KHR_texture_transform"))
    not_supported(use.path() + " has a texture transform; export it with the transform applied to the UVs");
  if (use.whole("texCoord", 0) != 0)
    not_supported(use.path() + " uses a second set of texture coordinates; export it with one");

  normal_texture out;
  out.scale = use.has("scale") ? use.number("scale") : 1.0;
  const json_object texture = root.element("textures", use.index("index", root.array("textures").size()));
  if (!texture.has("source")) not_supported(texture.path() + " has no PNG or JPEG source; export it with one");
  if (texture.has("sampler")) {
    const json_object sampler = root.element("samplers", texture.index("sampler", root.array("samplers").size()));
    out.wrap_u = wrap_of(sampler, "wrapS");
    out.wrap_v = wrap_of(sampler, "wrapT");
  }
  const json_object image = root.element("images", texture.index("source", root.array("images").size()));
  auto pixels = decode_image(image_bytes(document, image, file, watch), image.path(), watch);
  if (!pixels) throw rejection{pixels.error().code, pixels.error().message};
  out.image = std::move(pixels).value();
  return out;
}

}  // namespace

result<normal_texture> load_normal_texture(const std::filesystem::path& file, const std::function<bool()>& keep_going) {
  return without_exceptions(file, [&]() -> result<normal_texture> {
    reading_watch watch(keep_going);
    const auto bytes = read_file(file, max_mesh_bytes, watch);
    if (!bytes) return bytes.error();
    return refusing(file, "export the asset again",
                    [&]() -> result<normal_texture> { return read_normal_texture(*bytes, file, watch); });
  });
}

}  // namespace asperity::io
