// What the MuJoCo examples share: two textured models and an MJCF from the command line or a text.
#pragma once

#include <array>
#include <cstdio>
#include <cstring>
#include <memory>
#include <mujoco/mujoco.h>
#include <string>
#include <utility>

#include <asperity/asperity.hpp>
#include <asperity/io/textured_model_file.hpp>

/// Null, and a line on the terminal, where the file is none.
inline asperity::model_ptr load(const char* file) {
  auto model = asperity::io::load_textured_model(file);
  if (!model) return std::puts(model.error().message.c_str()), nullptr;
  return std::make_shared<const asperity::textured_model>(std::move(*model));
}

struct ends_mujoco {
  void operator()(mjModel* m) const { mj_deleteModel(m); }
  void operator()(mjData* d) const { mj_deleteData(d); }
};
using mujoco_model = std::unique_ptr<mjModel, ends_mujoco>;
using mujoco_data = std::unique_ptr<mjData, ends_mujoco>;

/// A model from the text of an MJCF; null, and a line on the terminal, where MuJoCo refuses it.
inline mujoco_model model_of(const std::string& mjcf) {
  const auto files = std::make_unique<mjVFS>();  // too large for a stack
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), "scene.xml", static_cast<int>(mjcf.size()));
  std::memcpy(files->filedata[0], mjcf.data(), mjcf.size());
  std::array<char, 500> why{};
  mujoco_model out(mj_loadXML("scene.xml", files.get(), why.data(), static_cast<int>(why.size())));
  mj_deleteVFS(files.get());
  if (!out) std::puts(why.data());
  return out;
}
