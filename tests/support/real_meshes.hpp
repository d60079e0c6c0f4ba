// Where meshes are that nobody made for these tests: the folder that ASPERITY_MODELS names, or shared/models beside the
// checkout (ASPERITY_MODELS_BESIDE, set by CMake).
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

namespace asperity::test_support {

[[nodiscard]] inline std::filesystem::path real_mesh_folder() {
  const char* const set = std::getenv("ASPERITY_MODELS");
  return set == nullptr || *set == '\0' ? ASPERITY_MODELS_BESIDE : set;
}

/// Why a test of this mesh has to be skipped; empty where the mesh is there.
[[nodiscard]] inline std::string why_without(const std::string& file) {
  const std::filesystem::path folder = real_mesh_folder();
  std::error_code ignored;
  if (std::filesystem::exists(folder / file, ignored)) return "";
  return "there is no " + file + " in " + folder.string() + "; ASPERITY_MODELS names another folder";
}

}  // namespace asperity::test_support
