// Which bodies are pressed on which: solids of support/press_bodies.hpp, the benchmark models and the scans.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "law/presses/press_touch.hpp"
#include "support/press_bodies.hpp"

namespace asperity::presses {

using test_support::press_bake;

/// One ordered pair.
struct press_pair {
  std::string probe, fixed;
  touch_region region;  ///< empty: wherever they touch

  [[nodiscard]] std::string name() const { return probe + " on " + fixed; }
};

/// Every pair of the acceptance, in the order of the tables. Pointed probes touch with their tips and hollow bodies on
/// their inner walls.
[[nodiscard]] std::vector<press_pair> press_pairs();

/// Every ordered pair of two benchmark models.
[[nodiscard]] std::vector<press_pair> benchmark_pairs();

/// A body with its original.
struct press_body {
  std::string name;
  triangle_mesh full;
  model_ptr model;  ///< none where only the original was asked for
  /// How far the model's surface lies from the original at most, as its bake has measured; 0 without a model.
  [[nodiscard]] double error_m() const { return model == nullptr ? 0.0 : model->report.max_error_m; }
};

/// Why a body cannot be had, in a sentence, where it is a scan that is not on this machine; otherwise empty.
[[nodiscard]] std::string why_without_body(std::string_view name);

/// Bodies by name, each made or read once.
class press_shelf {
 public:
  /// @param solids how solids become models, or nothing for originals alone; benchmark models and scans are taken as
  ///               their own tests baked them
  explicit press_shelf(std::optional<press_bake> solids) : solids_(solids) {}

  /// @return io_failed where a file is missing, with what makes it; invalid_argument where the name is unknown
  [[nodiscard]] result<const press_body*> get(const std::string& name);

 private:
  std::optional<press_bake> solids_;
  std::map<std::string, press_body> made_;
};

}  // namespace asperity::presses
