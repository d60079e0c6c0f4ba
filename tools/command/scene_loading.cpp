#include "scene_loading.hpp"

#include <memory>
#include <utility>

#include "asperity/io/textured_model_file.hpp"
#include "interrupt.hpp"
#include "text.hpp"

namespace asperity::command {
namespace {

constexpr double largest_size_ratio = 500.0;

result<model_ptr> load(const std::string& file) {
  result<textured_model> model = io::load_textured_model(file, not_interrupted);
  if (!model) return model.error();
  return model_ptr(std::make_shared<const textured_model>(std::move(model).value()));
}

}  // namespace

result<scene> load_scene(const std::string& probe, const std::vector<std::string>& fixed, bool allow_scale_mismatch) {
  scene out;
  result<model_ptr> a = load(probe);
  if (!a) return a.error();
  out.probe = std::move(a).value();
  for (const std::string& file : fixed) {
    result<model_ptr> b = load(file);
    if (!b) return b.error();
    const double size_a = out.probe->box.diagonal();
    const double size_b = (*b)->box.diagonal();
    const bool mismatch = size_a > largest_size_ratio * size_b || size_b > largest_size_ratio * size_a;
    if (mismatch && !allow_scale_mismatch) {
      const bool a_is_larger = size_a > size_b;
      const double ratio = a_is_larger ? size_a / size_b : size_b / size_a;
      return error{error_code::invalid_argument,
                   "the probe " + probe + " (diagonal " + length_text(size_a) + ") is " + brief(ratio) + " times " +
                       (a_is_larger ? "larger" : "smaller") + " than " + file + " (" + length_text(size_b) +
                       "): is one of them in millimetres? Bake it again with --scale 0.001, or pass "
                       "--allow-scale-mismatch if this is meant"};
    }
    out.fixed.push_back(std::move(b).value());
  }
  return out;
}

}  // namespace asperity::command
