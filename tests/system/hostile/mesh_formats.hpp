// Any mesh, written in every format that a bake reads.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>

#include "asperity/core/status.hpp"
#include "asperity/model/triangle_mesh.hpp"
#include "reading_watch.hpp"

namespace asperity::hostile {

struct mesh_format {
  const char* name;
  const char* extension;
  std::string (*write)(const triangle_mesh&);  ///< positions and indices as they are, right or wrong
  result<triangle_mesh> (*read)(std::string_view bytes, const std::filesystem::path& file, io::reading_watch watch);
  bool indexed;  ///< vertices are shared; otherwise the reader joins those that lie in one place
  bool text;
};

/// PLY ascii and binary, OBJ, STL ascii and binary, glTF (with its buffer as text) and GLB.
[[nodiscard]] const std::array<mesh_format, 7>& mesh_formats();

}  // namespace asperity::hostile
