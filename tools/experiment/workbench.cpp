#include "workbench.hpp"

#include <memory>
#include <system_error>
#include <utility>

#include "asperity/io/textured_model_file.hpp"
#include "output_file.hpp"

namespace asperity::experiment {
namespace {

variant on_cpu(std::string name, std::string says, const char* contacts, const char* gradient) {
  variant out{std::move(name), std::move(says), {}};
  out.options.contacts = contacts;
  if (gradient != nullptr) out.options.gradient = gradient;
  return out;
}

variant on_gpu(std::string name, std::string says, const char* backend, const char* gradient) {
  variant out = on_cpu(std::move(name), std::move(says), "paper", gradient);
  out.options.backend = backend;
  out.may_be_missing = true;
  return out;
}

}  // namespace

variant shared_contacts() { return on_cpu("shared", "one potential", "shared", nullptr); }
variant paper_soft() { return on_cpu("paper_soft", "paper's contacts, soft maximum", "paper", "soft"); }
variant paper_central() { return on_cpu("paper_central", "paper's contacts, central differences", "paper", "central"); }

workbench::workbench(workbench_settings settings) : settings_(std::move(settings)) {
  if (!settings_.make_renderer) {
    settings_.make_renderer = [](scene bodies, const variant& kind) {
      return command::make_chosen_renderer(std::move(bodies), kind.options);
    };
  }
  variants_ = {shared_contacts(), paper_soft(), paper_central()};
  if (settings_.brief || !settings_.gpu) return;
  variants_.push_back(on_gpu("gl_compute_soft", "compute shaders, soft maximum", "gl-compute", "soft"));
  variants_.push_back(
      on_gpu("gl_occlusion_central", "occlusion queries, central differences", "gl-occlusion", nullptr));
}

void workbench::progress(std::string_view what, double done) const {
  if (settings_.progress) settings_.progress(what, done);
}

result<void> workbench::go_on() const {
  if (!settings_.cancelled || !settings_.cancelled()) return {};
  return error{error_code::cancelled, "interrupted: the experiments that were finished are written"};
}

result<model_ptr> workbench::benchmark(models::benchmark which) {
  bake::bake_options options;
  options.triangles = models::coarse_triangle_count(which);
  options.coarse = models::make_coarse(which);
  return baked(
      std::string(models::to_string(which)), [which] { return models::make_full(which); }, std::move(options));
}

result<model_ptr> workbench::baked(const std::string& name, const std::function<triangle_mesh()>& full,
                                   bake::bake_options options) {
  if (const auto found = kept_.find(name); found != kept_.end()) return found->second;
  const std::filesystem::path file = settings_.models / (name + ".glb");
  const auto keep = [&](result<textured_model> model) -> result<model_ptr> {
    if (!model) return model.error();
    return kept_[name] = std::make_shared<const textured_model>(std::move(model).value());
  };
  std::error_code ignored;
  if (std::filesystem::exists(file, ignored)) return keep(io::load_textured_model(file));
  if (const result<void> ok = command::check_writable(file); !ok) return ok.error();
  options.name = name;
  options.progress = [&](std::string_view stage, double done) {
    progress("baking " + name + ", " + std::string(stage), done);
    return go_on().has_value();
  };
  result<textured_model> model = bake::bake(full(), options);
  if (!model) return model.error();
  if (const result<void> saved = io::save_textured_model(*model, file); !saved) return saved.error();
  return keep(std::move(model));
}

result<command::chosen_renderer> workbench::make_renderer(scene bodies, const variant& kind) const {
  return settings_.make_renderer(std::move(bodies), kind);
}

}  // namespace asperity::experiment
