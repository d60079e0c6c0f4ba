// What asperity bake tells of its work.
#pragma once

#include <chrono>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "asperity/bake/repair.hpp"
#include "asperity/model/textured_model.hpp"
#include "cli.hpp"
#include "relief_options.hpp"

namespace asperity::command {

/// Wall time of each stage, told apart by the names that the work reports.
class stage_clock {
 public:
  void enter(std::string_view stage) {
    if (!stages_.empty() && stages_.back().first == stage) return;
    leave();
    stages_.emplace_back(std::string(stage), 0.0);
    since_ = std::chrono::steady_clock::now();
  }
  void leave() {
    if (stages_.empty() || stages_.back().second != 0.0) return;
    stages_.back().second = std::chrono::duration<double>(std::chrono::steady_clock::now() - since_).count();
  }
  [[nodiscard]] const std::vector<std::pair<std::string, double>>& stages() const { return stages_; }

 private:
  std::vector<std::pair<std::string, double>> stages_;
  std::chrono::steady_clock::time_point since_;
};

/// A bake that is done. What it refers to stays with the caller.
struct finished_bake {
  const std::string& source;
  const std::string& file;
  const textured_model& model;
  double scale = 1.0;  ///< metres per unit
  bool kept_uvs = false;
  const bake::repair_report& repaired;
  const relief_job& relief;
  const stage_clock& clock;
};

/// The document and the report of a bake. @param notes  warnings, besides those that the model itself deserves
[[nodiscard]] answer report_bake(const finished_bake& done, std::vector<std::string> notes);

}  // namespace asperity::command
