#include "file_names.hpp"

#include <charconv>
#include <cstdint>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>

#include "io/new_file.hpp"

namespace asperity::command {
namespace {

namespace fs = std::filesystem;

// Where a file will be that is not there yet.
fs::path place_of(const fs::path& file) {
  std::error_code failed;
  const fs::path target = io::behind_links(fs::absolute(file, failed));
  const fs::path place = fs::weakly_canonical(target, failed);
  return failed ? target.lexically_normal() : place;
}

// A relative reference of a glTF file as a path: %20 is a space.
std::string unescaped(const std::string& uri) {
  std::string out;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    unsigned value = 0;
    const char* const first = uri.data() + i + 1;
    if (uri[i] == '%' && i + 2 < uri.size() && std::from_chars(first, first + 2, value, 16).ptr == first + 2) {
      out += static_cast<char>(value);
      i += 2;
    } else {
      out += uri[i];
    }
  }
  return out;
}

}  // namespace

std::vector<named_file> mesh_files(const fs::path& mesh, const std::string& option) {
  if (mesh.empty()) return {};
  std::vector<named_file> out{{option, mesh}};
  std::error_code failed;
  constexpr std::uintmax_t largest = std::uintmax_t{1} << 28U;
  if (mesh.extension() != ".gltf" || !fs::is_regular_file(mesh, failed) || fs::file_size(mesh, failed) > largest) {
    return out;
  }
  std::ifstream in(mesh);
  const nlohmann::json document = nlohmann::json::parse(in, nullptr, false);
  for (const char* kind : {"buffers", "images"}) {
    if (!document.is_object() || !document.contains(kind) || !document[kind].is_array()) continue;
    for (const nlohmann::json& each : document[kind]) {
      if (!each.is_object() || !each.contains("uri") || !each["uri"].is_string()) continue;
      const std::string uri = each["uri"];
      if (!uri.starts_with("data:")) out.push_back({option, mesh.parent_path() / unescaped(uri)});
    }
  }
  return out;
}

bool is_one_file(const fs::path& a, const fs::path& b) {
  if (a.empty() || b.empty()) return false;
  std::error_code failed;
  const bool there_a = fs::exists(a, failed), there_b = fs::exists(b, failed);
  if (there_a != there_b) return false;
  if (!there_a) return place_of(a) == place_of(b);
  return !fs::is_character_file(a, failed) && fs::equivalent(a, b, failed);
}

result<void> check_outputs(std::span<const named_file> inputs, std::span<const named_file> outputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    for (const named_file& in : inputs) {
      if (!is_one_file(outputs[i].file, in.file)) continue;
      return error{error_code::invalid_argument, outputs[i].option + ' ' + outputs[i].file.string() +
                                                     " would replace what " + in.option + " reads, " +
                                                     in.file.string() + ": give another name"};
    }
    for (std::size_t j = 0; j < i; ++j) {
      if (!is_one_file(outputs[i].file, outputs[j].file)) continue;
      return error{error_code::invalid_argument, outputs[j].option + " and " + outputs[i].option +
                                                     " name the same file, " + outputs[i].file.string() +
                                                     ": give two names"};
    }
  }
  return {};
}

}  // namespace asperity::command
