#include "model_shelf.hpp"

#include <memory>
#include <system_error>
#include <utility>

#include "asperity/io/textured_model_file.hpp"
#include "output_file.hpp"

namespace asperity::experiment {

model_shelf::model_shelf(std::filesystem::path folder, progress report)
    : folder_(std::move(folder)), report_(std::move(report)) {}

result<model_ptr> model_shelf::benchmark(models::benchmark which) {
  bake::bake_settings options;
  options.triangles = models::coarse_triangle_count(which);
  options.coarse = models::make_coarse(which);
  return baked(
      std::string(models::to_string(which)), [which] { return models::make_full(which); }, std::move(options));
}

result<model_ptr> model_shelf::baked(const std::string& name, const std::function<triangle_mesh()>& full,
                                     bake::bake_settings options) {
  if (const auto found = kept_.find(name); found != kept_.end()) return found->second;
  const auto keep = [&](result<textured_model> model) -> result<model_ptr> {
    if (!model) return model.error();
    return kept_[name] = std::make_shared<const textured_model>(std::move(model).value());
  };
  const std::filesystem::path file = folder_.empty() ? folder_ : folder_ / (name + ".glb");
  std::error_code ignored;
  if (!file.empty()) {
    if (std::filesystem::exists(file, ignored)) return keep(io::load_textured_model(file));
    if (const result<void> ok = command::check_writable(file); !ok) return ok.error();
  }
  options.name = name;
  options.progress = [&](std::string_view stage, double done) {
    return report_("baking " + name + ", " + std::string(stage), done);
  };
  result<textured_model> model = bake::bake(full(), options);
  if (!model) return model.error();
  if (!file.empty()) {
    if (const result<void> saved = io::save_textured_model(*model, file); !saved) return saved.error();
  }
  return keep(std::move(model));
}

}  // namespace asperity::experiment
