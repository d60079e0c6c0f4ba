// The benchmark models with their originals, as the tests have made them.
#pragma once

#include <filesystem>
#include <gtest/gtest.h>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "asperity/io/mesh_file.hpp"
#include "asperity/io/textured_model_file.hpp"
#include "law/oracle/against_originals.hpp"

namespace asperity::oracle {

/// A failure of the test, and a body without model, where it cannot be read. Each is read once per program, so that
/// whoever feels the same two bodies again finds their cells cut already.
inline const original_and_bake& load_benchmark_body(const std::string& name) {
  static std::map<std::string, original_and_bake> read;
  if (const auto known = read.find(name); known != read.end()) return known->second;
  const std::filesystem::path folder = ASPERITY_TEST_MODELS_DIR;
  auto full = io::load_mesh(folder / (name + ".ply"));
  auto model = io::load_textured_model(folder / (name + ".glb"));
  if (!full || !model) {
    ADD_FAILURE() << (full ? model.error().message : full.error().message);
    return read[name];
  }
  return read[name] = {name, std::move(full).value(), std::make_shared<const textured_model>(std::move(model).value())};
}

}  // namespace asperity::oracle
