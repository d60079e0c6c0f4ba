// load_probe mesh|model|image|material|recording|bare|bake FILE: loads one file in a process of its own and prints how
// far its memory went (peak resident bytes beyond the start), then "loaded" or the error's message. `bare` takes
// tinygltf without the guard, `bake` bakes the mesh too, with a small texture.
#include <cstdio>
#include <cstring>
#include <string>
#include <string_view>
#include <tiny_gltf.h>
#include <utility>

#include "asperity/bake/bake.hpp"
#include "asperity/device/device_recording.hpp"
#include "asperity/io/image_file.hpp"
#include "asperity/io/material_file.hpp"
#include "asperity/io/mesh_file.hpp"
#include "asperity/io/textured_model_file.hpp"

namespace {

/// A line of /proc/self/status in kB; 0 where it is missing.
unsigned long status_kb(const char* key) {
  unsigned long kb = 0;
  if (std::FILE* const status = std::fopen("/proc/self/status", "r"); status != nullptr) {
    char line[256];
    while (std::fgets(line, sizeof line, status) != nullptr) {
      if (std::strncmp(line, key, std::strlen(key)) == 0) std::sscanf(line + std::strlen(key), ": %lu", &kb);
    }
    std::fclose(status);
  }
  return kb;
}

std::string load_mesh(const char* file) {
  const auto mesh = asperity::io::load_mesh(file);
  return mesh ? "loaded" : mesh.error().message;
}

std::string load_and_bake(const char* file) {
  auto mesh = asperity::io::load_mesh(file);
  if (!mesh) return mesh.error().message;
  asperity::bake::bake_settings options;
  options.triangles = 200;
  options.texture_size = 128;
  options.threads = 1;
  const auto model = asperity::bake::bake(std::move(*mesh), options);
  return model ? "loaded" : model.error().message;
}

std::string load_model(const char* file) {
  const auto model = asperity::io::load_textured_model(file);
  return model ? "loaded" : model.error().message;
}

std::string load_image(const char* file) {
  const auto image = asperity::io::load_image(file);
  return image ? "loaded" : image.error().message;
}

std::string load_material(const char* file) {
  const auto texture = asperity::io::load_normal_texture(file);
  return texture ? "loaded" : texture.error().message;
}

std::string load_recording(const char* file) {
  const auto recording = asperity::load_device_recording(file);
  return recording ? "loaded" : recording.error().message;
}

std::string load_bare(const char* file) {
  tinygltf::TinyGLTF parser;
  tinygltf::Model model;
  std::string problem, warning;
  const bool text = std::string_view(file).ends_with(".gltf");
  const bool good = text ? parser.LoadASCIIFromFile(&model, &problem, &warning, file)
                         : parser.LoadBinaryFromFile(&model, &problem, &warning, file);
  return good ? "loaded" : "refused";
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const std::string_view how = argv[1];
  const unsigned long before = status_kb("VmHWM");
  const std::string said = how == "bare"        ? load_bare(argv[2])
                           : how == "mesh"      ? load_mesh(argv[2])
                           : how == "bake"      ? load_and_bake(argv[2])
                           : how == "image"     ? load_image(argv[2])
                           : how == "material"  ? load_material(argv[2])
                           : how == "recording" ? load_recording(argv[2])
                                                : load_model(argv[2]);
  std::printf("%lu\n%s\n", 1024 * (status_kb("VmHWM") - before), said.c_str());
  return 0;
}
