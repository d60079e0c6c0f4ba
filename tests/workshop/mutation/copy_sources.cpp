#include "workshop/mutation/copy_sources.hpp"

#include <cstdio>
#include <set>
#include <string>
#include <system_error>
#include <vector>

#include "workshop/mutation/trial.hpp"

namespace asperity::mutation {
namespace {

namespace fs = std::filesystem;

result<std::set<std::string>> names_of_sources(const fs::path& root) {
  FILE* const listing = popen(("git -C '" + root.string() + "' ls-files -co --exclude-standard -z").c_str(), "r");
  if (listing == nullptr) return error{error_code::io_failed, "git cannot be started"};
  std::set<std::string> names;
  std::string name;
  for (int c = std::fgetc(listing); c != EOF; c = std::fgetc(listing)) {
    if (c != '\0') {
      name += static_cast<char>(c);
      continue;
    }
    if (fs::is_regular_file(root / name)) names.insert(name);
    name.clear();
  }
  if (pclose(listing) != 0 || names.empty()) {
    return error{error_code::io_failed, root.string() + ": git cannot list the sources; is this a checkout?"};
  }
  return names;
}

void remove_others(const fs::path& copy, const std::set<std::string>& names) {
  std::vector<fs::path> others;
  for (const auto& entry : fs::recursive_directory_iterator(copy)) {
    if (entry.is_regular_file() && names.count(entry.path().lexically_relative(copy).string()) == 0) {
      others.push_back(entry.path());
    }
  }
  for (const fs::path& other : others) fs::remove(other);
}

}  // namespace

result<void> copy_sources(const fs::path& root, const fs::path& copy) {
  const result<std::set<std::string>> names = names_of_sources(root);
  if (!names) return names.error();
  std::error_code failed;
  fs::create_directories(copy, failed);
  if (failed) return error{error_code::io_failed, copy.string() + ": " + failed.message()};
  for (const std::string& name : *names) {
    const result<std::string> text = read_text(root / name);
    if (!text) return text.error();
    const result<std::string> there = read_text(copy / name);
    if (there && *there == *text) continue;
    fs::create_directories((copy / name).parent_path(), failed);
    fs::copy_file(root / name, copy / name, fs::copy_options::overwrite_existing, failed);
    if (failed) return error{error_code::io_failed, (copy / name).string() + ": " + failed.message()};
    fs::last_write_time(copy / name, fs::file_time_type::clock::now(), failed);
  }
  remove_others(copy, *names);
  return {};
}

}  // namespace asperity::mutation
