#include "scene_loading.hpp"

#include <cstddef>
#include <future>
#include <memory>
#include <utility>

#include "asperity/io/textured_model_file.hpp"
#include "heap_room.hpp"
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

// All at once, in threads of their own where the system has some.
std::vector<std::future<result<model_ptr>>> loading(const std::string& probe, const std::vector<std::string>& fixed) {
  share_heap();
  std::vector<std::future<result<model_ptr>>> out;
  out.push_back(std::async(load, probe));
  for (const std::string& file : fixed) out.push_back(std::async(load, file));
  return out;
}

error sizes_differ(const std::string& probe, double size_a, const std::string& file, double size_b) {
  const bool a_is_larger = size_a > size_b;
  std::string text = "the probe ";
  text.append(probe).append(" (diagonal ").append(length_text(size_a)).append(") is ");
  text.append(brief(a_is_larger ? size_a / size_b : size_b / size_a)).append(" times ");
  text.append(a_is_larger ? "larger" : "smaller").append(" than ").append(file);
  text.append(" (").append(length_text(size_b));
  text.append(
      "): is one of them in millimetres? Bake it again with --scale 0.001, or pass --allow-scale-mismatch if this is "
      "meant");
  return {error_code::invalid_argument, std::move(text)};
}

}  // namespace

result<scene> load_scene(const std::string& probe, const std::vector<std::string>& fixed, bool allow_scale_mismatch) {
  std::vector<std::future<result<model_ptr>>> models = loading(probe, fixed);
  scene out;
  result<model_ptr> a = models[0].get();
  if (!a) return a.error();
  out.probe = std::move(a).value();
  for (std::size_t i = 0; i < fixed.size(); ++i) {
    result<model_ptr> b = models[i + 1].get();
    if (!b) return b.error();
    const double size_a = out.probe->box.diagonal();
    const double size_b = (*b)->box.diagonal();
    const bool mismatch = size_a > largest_size_ratio * size_b || size_b > largest_size_ratio * size_a;
    if (mismatch && !allow_scale_mismatch) return sizes_differ(probe, size_a, fixed[i], size_b);
    out.fixed.push_back(std::move(b).value());
  }
  return out;
}

}  // namespace asperity::command
