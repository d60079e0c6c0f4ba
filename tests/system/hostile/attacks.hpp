// Files made to break a loader, made by the tests themselves: one generator for each.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "unit/io/glb_editor.hpp"

namespace asperity::hostile {

/// A file that means harm, and the words with which it is refused.
struct attack {
  std::string name;
  std::string file;                                         ///< its extension chooses the reader
  std::string mesh_says;                                    ///< part of load_mesh()'s message; empty: it loads
  std::string model_says;                                   ///< part of load_textured_model()'s; empty: it loads
  std::function<void(const std::filesystem::path&)> plant;  ///< writes the file, and what belongs to it, into a folder
};

/// The attacks on containers and JSON.
[[nodiscard]] std::vector<attack> container_attacks();
/// Those that want a file opened, or not to end.
[[nodiscard]] std::vector<attack> path_attacks();
/// Those that lie about buffers, geometry, scenes and the extension.
[[nodiscard]] std::vector<attack> geometry_attacks();

/// A file of the system that no reader has any business with, and that nothing else opens while the tests run: a
/// graphics driver in a neighbouring test looks its user up in /etc/passwd.
inline constexpr const char* system_file = "/etc/issue";

/// Message of a reader that does not read this kind of file at all.
inline constexpr const char* no_glb = "does not begin with 'glTF'";
/// Message about a .glb without the extension.
inline constexpr const char* never_baked = "has no haptic texture";

void write(const std::filesystem::path& file, const std::string& bytes);

/// A textured model as a .glb.
[[nodiscard]] const std::string& good_model();
/// The same of a box of three materials, by a map.
[[nodiscard]] const std::string& good_mapped_model();
/// A tetrahedron: its document, with one buffer of bytes that `tetrahedron_bytes()` gives.
[[nodiscard]] nlohmann::json tetrahedron();
[[nodiscard]] std::string tetrahedron_bytes();
/// A document with a BIN chunk as a .glb.
[[nodiscard]] std::string glb(const nlohmann::json& document, const std::string& bin);
[[nodiscard]] std::string glb(const std::string& json_text, const std::string& bin);

}  // namespace asperity::hostile
