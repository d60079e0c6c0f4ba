// Baked models, made when they are first asked for and kept.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "asperity/bake/bake.hpp"
#include "asperity/core/status.hpp"
#include "asperity/model/scene.hpp"
#include "benchmark_models.hpp"

namespace asperity::experiment {

/// Not for two threads.
class model_shelf {
 public:
  /// Told of every stage of a bake and its share, 0 to 1. False ends the bake.
  using progress = std::function<bool(std::string_view what, double done)>;

  /// @param folder  where models are looked for and kept as files, .glb; empty: in memory alone
  model_shelf(std::filesystem::path folder, progress report);

  /// One of the paper's models, baked with the paper's coarse triangle count.
  /// @return what bake() or the file says | cancelled
  [[nodiscard]] result<model_ptr> benchmark(models::benchmark which);
  /// A model of one's own. `name` tells it from every other one, its numbers included: a file of that name is taken as
  /// it is. @return the same
  [[nodiscard]] result<model_ptr> baked(const std::string& name, const std::function<triangle_mesh()>& full,
                                        bake::bake_settings options);

 private:
  std::filesystem::path folder_;
  progress report_;
  std::map<std::string, model_ptr, std::less<>> kept_;
};

}  // namespace asperity::experiment
