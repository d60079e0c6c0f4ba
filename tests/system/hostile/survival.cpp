#include "survival.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <memory>

#include "asperity/io/image_file.hpp"
#include "asperity/model/validate.hpp"
#include "asperity/window/window_renderer.hpp"
#include "support/kept_bodies.hpp"

namespace asperity::hostile {
namespace {

std::optional<std::string> complaint(const error& e) {
  if (e.message.size() > 600) return "a message of " + std::to_string(e.message.size()) + " bytes";
  if (!std::all_of(e.message.begin(), e.message.end(), [](unsigned char c) { return c >= ' ' && c <= '~'; })) {
    return "a message that is not one printable line";
  }
  if (e.message.find("; ") == std::string::npos) return "a message without a mend: " + e.message;
  return std::nullopt;
}

/// Small: the renderer is made thousands of times.
window_renderer_settings small_settings() {
  window_renderer_settings s;
  s.finder.close_pairs = 64;
  s.finder.clusters = 4;
  s.depth.grid = 8;
  s.limits = {.contacts = 4, .triangles = 256};
  return s;
}

// A model that passed as valid must carry a tick against itself.
template <class Made>
std::optional<std::string> complaint_of_tick(Made feel, const textured_model& model) {
  if (!feel) return "no renderer: " + feel.error().message;
  // Turned a little and sunk into itself by a tenth, so that there is something to feel.
  const vec3 size = model.box.high - model.box.low;
  const std::array<pose, 1> T_wb{};
  const pose T_wa{glm::normalize(quat(1.0, 0.02, 0.03, 0.0)), {0.0, 0.0, 0.9 * size.z}};
  tick out;
  const status s = feel->step({T_wa, T_wb}, out);
  if (s != status::ok && s != status::capacity_reached) return std::string("a tick that is ") + to_string(s);
  if (!is_finite(out.force.on_probe_w)) return "a force that is not finite";
  return std::nullopt;
}

}  // namespace

std::optional<std::string> complaint(const result<map_image>& image) {
  if (!image) return complaint(image.error());
  const std::size_t samples = std::size_t{image->width} * image->height * image->channels;
  if (samples == 0 || image->width > io::max_image_side || image->height > io::max_image_side ||
      samples > io::max_image_samples) {
    return "an image of " + std::to_string(image->width) + " x " + std::to_string(image->height) + " pixels";
  }
  if (image->channels != 1 && image->channels != 3)
    return "an image of " + std::to_string(image->channels) + " channels";
  if (image->samples.size() != samples) return "an image with " + std::to_string(image->samples.size()) + " samples";
  if (!std::all_of(image->samples.begin(), image->samples.end(), [](float s) { return std::isfinite(s); })) {
    return "a sample that is not finite";
  }
  return std::nullopt;
}

std::optional<std::string> complaint(const result<triangle_mesh>& mesh) {
  if (!mesh) return complaint(mesh.error());
  for (const vec3& p : mesh->positions) {
    if (!is_finite(p)) return "a position that is not finite";
  }
  for (const auto& t : mesh->triangles) {
    if (std::any_of(t.begin(), t.end(), [&](std::uint32_t v) { return v >= mesh->positions.size(); })) {
      return "an index out of range";
    }
  }
  if (mesh->triangles.empty()) return "a mesh without triangles";
  if (!mesh->uvs.empty() && mesh->uvs.size() != mesh->triangles.size()) return "too few texture coordinates";
  return std::nullopt;
}

std::optional<std::string> complaint(const result<textured_model>& loaded) {
  if (!loaded) return complaint(loaded.error());
  if (const auto valid = validate(*loaded); !valid) return "an invalid model: " + valid.error().message;
  const auto model = std::make_shared<const textured_model>(*loaded);
  if (auto bad = complaint_of_tick(make_window_renderer({model, {model}}, small_settings()), *model)) return bad;
  // Making fields takes longer than all the rest; one model in 64, the first among them, is enough of it.
  static std::uint64_t models = 0;
  if (models++ % 64 != 0) return std::nullopt;
  least_motion_renderer_settings few;
  few.bodies.field.pitch_m = model->box.diagonal() / 40.0;
  few.bodies.field.relief_bytes = 4'000'000;
  few.limits.leaves = 256;
  few.force.most_readings = 4096;
  few.force.most_samples = 256;
  auto shared = test_support::build_renderer({model, {model}}, few);
  // A body without an inside, and a field that would be too large, are refused with their reason.
  if (!shared) {
    for (const error_code reason : {error_code::invalid_argument, error_code::bad_mesh, error_code::limit_exceeded}) {
      if (shared.error().code == reason) return complaint(shared.error());
    }
  }
  return complaint_of_tick(std::move(shared), *model);
}

std::string kind_of(std::string_view message) {
  std::string out;
  bool quoted = false;
  const std::size_t file = message.find(": ");
  for (const char c : message.substr(file == std::string_view::npos ? 0 : file + 2)) {
    if (c == '\'') quoted = !quoted;
    if (quoted) continue;
    const bool digit = std::isdigit(static_cast<unsigned char>(c)) != 0;
    if (!digit) out += c;
    if (digit && (out.empty() || out.back() != '#')) out += '#';
  }
  return out;
}

}  // namespace asperity::hostile
