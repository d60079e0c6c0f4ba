// What became of every bug, kept in a file between runs, and the page that says so.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "workshop/mutation/trial.hpp"

namespace asperity::mutation {

/// Outcomes by the bug's name. Each is kept with a digest of the broken source and of the tests' names.
class ledger {
 public:
  /// Reads what the file holds; nothing where there is none.
  explicit ledger(std::filesystem::path file);

  /// What became of the bug as it would be planted today; nothing where that is not known.
  [[nodiscard]] const outcome* find(const std::string& name, const std::string& digest) const;

  /// Also adds a line to the file, so that a run that is ended loses nothing.
  result<void> add(const std::string& name, const std::string& digest, const outcome& o);

 private:
  struct entry {
    std::string digest;
    outcome what;
  };
  std::filesystem::path file_;
  std::map<std::string, entry> entries_;
};

[[nodiscard]] std::string digest_of(const std::string& broken_source, const bug& what);

struct finding {
  bug what;
  outcome became;
};

/// "70 bugs: 69 caught, 1 survived, 0 not built"
[[nodiscard]] std::string totals(const std::vector<finding>& findings);

/// The page of docs/reference. @param date "2026-11-22"
[[nodiscard]] std::string page(const std::vector<finding>& findings, const std::string& date);

}  // namespace asperity::mutation
