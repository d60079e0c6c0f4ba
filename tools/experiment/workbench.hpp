// What every experiment is given: baked models, renderers of every kind, and somebody to tell how far it is.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "asperity/core/status.hpp"
#include "asperity/model/scene.hpp"
#include "findings.hpp"
#include "model_shelf.hpp"
#include "render_choice.hpp"

namespace asperity::experiment {

/// One kind of renderer that an experiment is run with.
struct variant {
  std::string name;  ///< for statements and files: lower case, digits and underscores
  std::string says;  ///< for legends
  command::render_options options;
  bool may_be_missing = false;  ///< of a backend on a GPU: this machine or this build may have none
};

struct workbench_settings {
  std::filesystem::path models;  ///< folder of baked models; what is missing there is baked and kept
  bool brief = false;            ///< a share of each experiment, for tests: fewer variants, shorter motions
  bool gpu = true;               ///< backends on a GPU too, where there is one
  /// What experiments on forces are run with; empty: the usual ones, see workbench::variants().
  std::vector<variant> variants;
  /// Makes every renderer; by default the one that the options of the variant ask for. A test that breaks the code on
  /// purpose gives its own.
  std::function<result<any_renderer>(scene, const variant&)> make_renderer;
  std::function<void(std::string_view what, double done)> progress;  ///< told of every stage and its share, 0 to 1
  std::function<bool()> cancelled;                                   ///< asked between trials
};

/// Not for two threads.
class workbench {
 public:
  explicit workbench(workbench_settings settings);

  [[nodiscard]] model_shelf& models() noexcept { return models_; }

  /// The renderer of a variant. @return what its maker says
  [[nodiscard]] result<any_renderer> make_renderer(scene bodies, const variant& kind) const;

  /// The renderers that an experiment on forces is run with: contacts as one potential, the paper's with either
  /// gradient and, where the run is not brief, those on a GPU.
  [[nodiscard]] const std::vector<variant>& variants() const noexcept { return settings_.variants; }
  /// Runs the experiment `name` with one kind after the other. Where one that may be missing fails, `out` gets a note
  /// that says why it was left out. @return the first other error | cancelled
  [[nodiscard]] result<void> with_each(std::string_view name, std::span<const variant> kinds, findings& out,
                                       const std::function<result<void>(const variant&)>& run) const;
  [[nodiscard]] bool brief() const noexcept { return settings_.brief; }
  void progress(std::string_view what, double done) const;
  /// cancelled where somebody wants the experiments to end, else nothing
  [[nodiscard]] result<void> go_on() const;

 private:
  workbench_settings settings_;
  model_shelf models_;
};

/// The paper's contacts on the CPU with the soft maximum: for experiments that need one kind only and its contacts.
[[nodiscard]] variant window_soft();
/// The paper's own scheme: central differences.
[[nodiscard]] variant window_central();
/// Contacts as one potential, the library's default.
[[nodiscard]] variant least_motion_contacts();

}  // namespace asperity::experiment
