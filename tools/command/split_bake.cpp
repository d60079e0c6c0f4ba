#include "split_bake.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <set>
#include <system_error>
#include <unistd.h>
#include <utility>

#include "text.hpp"

namespace asperity::command {
namespace {

constexpr std::size_t longest_name = 60;

// A group's name as a part of a file's: letters, digits, dot, dash and underscore.
std::string file_part(const std::string& name) {
  std::string out;
  for (const char c : name.substr(0, longest_name)) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_' || c == '.';
    out += plain ? c : '_';
  }
  return out;
}

void replace_all(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
}

// Files that are gone when nobody kept them.
class unfinished_files {
 public:
  explicit unfinished_files(std::vector<std::string> files) : files_(std::move(files)) {}
  unfinished_files(const unfinished_files&) = delete;
  unfinished_files& operator=(const unfinished_files&) = delete;
  ~unfinished_files() {
    std::error_code ignored;
    for (const std::string& file : files_) std::filesystem::remove(file, ignored);
  }
  [[nodiscard]] const std::string& operator[](std::size_t k) const { return files_[k]; }

 private:
  std::vector<std::string> files_;
};

}  // namespace

std::vector<std::string> files_of_parts(const std::vector<io::mesh_part>& parts, const std::string& out) {
  const std::filesystem::path path(out);
  std::vector<std::string> files;
  std::set<std::string> taken;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    std::string name = file_part(parts[k].name);
    if (name.empty()) name = std::to_string(k + 1);
    while (!taken.insert(name).second) name += "-" + std::to_string(k + 1);
    files.push_back((path.parent_path() / (path.stem().string() + "-" + name + ".glb")).string());
  }
  return files;
}

result<answer> bake_parts(const std::string& source, const std::vector<std::string>& files,
                          const std::function<result<answer>(std::size_t, const std::string&)>& bake_part) {
  std::vector<std::string> names;
  for (const std::string& file : files) {
    const std::filesystem::path path(file);
    names.push_back(
        (path.parent_path() / ("." + path.stem().string() + "." + std::to_string(getpid()) + ".glb")).string());
  }
  const unfinished_files unfinished(names);
  answer out;
  out.document = {{"source", source}, {"models", json::array()}};
  for (std::size_t k = 0; k < files.size(); ++k) {
    result<answer> part = bake_part(k, unfinished[k]);
    if (!part)
      return error{part.error().code, part.error().message + " (part " + std::to_string(k + 1) + " of " +
                                          std::to_string(files.size()) + ", " +
                                          std::filesystem::path(files[k]).filename().string() + "; none was written)"};
    part->document["file"] = files[k];
    replace_all(part->text, printable(unfinished[k]), printable(files[k]));
    out.document["models"].push_back(std::move(part->document));
    out.text += part->text;
  }
  for (std::size_t k = 0; k < files.size(); ++k) {
    std::error_code failed;
    std::filesystem::rename(unfinished[k], files[k], failed);
    if (failed)
      return error{error_code::io_failed, files[k] + " could not be written: " + failed.message() + "; " +
                                              std::to_string(k) + " of " + std::to_string(files.size()) +
                                              " models have been"};
  }
  return out;
}

}  // namespace asperity::command
