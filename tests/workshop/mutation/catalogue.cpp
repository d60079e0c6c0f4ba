#include "workshop/mutation/catalogue.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>

namespace asperity::mutation {
namespace {

std::string trimmed(const std::string& s) {
  const std::size_t first = s.find_first_not_of(" \t\r");
  if (first == std::string::npos) return {};
  return s.substr(first, s.find_last_not_of(" \t\r") - first + 1);
}

class catalogue_reader {
 public:
  explicit catalogue_reader(const std::string& where) : where_(where) {}

  result<std::vector<bug>> read(const std::string& text) {
    std::istringstream lines(text);
    std::string line;
    while (std::getline(lines, line)) {
      ++number_;
      line = trimmed(line);
      if (line.empty() || line.front() == '#') continue;
      const std::size_t space = std::min(line.find(' '), line.size());
      const result<void> taken = take(line.substr(0, space), trimmed(line.substr(space)));
      if (!taken) return taken.error();
    }
    const result<void> whole = finish();
    if (!whole) return whole.error();
    return std::move(bugs_);
  }

 private:
  result<void> take(const std::string& key, const std::string& rest) {
    if (rest.empty()) return fault("'" + key + "' has nothing behind it");
    if (key == "room" || key == "file" || key == "tests" || key == "bug") {
      const result<void> whole = finish();
      if (!whole) return whole;
      if (key == "room") now_.room = rest;
      if (key == "file") now_.file = rest;
      if (key == "tests") {
        std::istringstream words(rest);
        now_.tests.assign(std::istream_iterator<std::string>(words), {});
      }
      if (key == "bug") {
        now_.name = rest;
        if (!names_.insert(rest).second) return fault("there are two bugs '" + rest + "'");
      }
      return {};
    }
    if (now_.name.empty()) return fault("'" + key + "' stands in front of every bug");
    if (key == "in") {
      in_ = rest;
    } else if (in_.empty()) {
      return fault("'" + key + "' of the bug '" + now_.name + "' needs an 'in FUNCTION' in front of it");
    } else {
      now_.edits.push_back({in_, key + ' ' + rest});
    }
    return {};
  }

  // Ends the bug that is being read, if there is one.
  result<void> finish() {
    if (now_.name.empty()) return {};
    if (now_.room.empty() || now_.file.empty() || now_.tests.empty() || now_.edits.empty()) {
      return fault("the bug '" + now_.name + "' has no room, file, tests or change");
    }
    bugs_.push_back(now_);
    now_.name.clear();
    now_.edits.clear();
    in_.clear();
    return {};
  }

  [[nodiscard]] error fault(const std::string& what) const {
    return {error_code::bad_format, where_ + ':' + std::to_string(number_) + ": " + what};
  }

  std::string where_;
  int number_ = 0;
  bug now_;
  std::string in_;
  std::set<std::string> names_;
  std::vector<bug> bugs_;
};

}  // namespace

result<std::vector<bug>> read_catalogue(const std::string& text, const std::string& where) {
  return catalogue_reader(where).read(text);
}

result<std::vector<bug>> read_catalogues(const std::string& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code failed;
  for (const auto& entry : std::filesystem::directory_iterator(folder, failed)) {
    if (entry.path().extension() == ".txt") files.push_back(entry.path());
  }
  if (files.empty()) return error{error_code::io_failed, folder + ": no catalogue (*.txt) is there"};
  std::sort(files.begin(), files.end());
  std::vector<bug> all;
  for (const auto& file : files) {
    std::ifstream in(file);
    std::ostringstream text;
    text << in.rdbuf();
    result<std::vector<bug>> some = read_catalogue(text.str(), file.string());
    if (!some) return some.error();
    for (bug& b : *some) {
      const bool taken = std::any_of(all.begin(), all.end(), [&](const bug& a) { return a.name == b.name; });
      if (taken) return error{error_code::bad_format, file.string() + ": '" + b.name + "' is in another file too"};
      all.push_back(std::move(b));
    }
  }
  return all;
}

}  // namespace asperity::mutation
