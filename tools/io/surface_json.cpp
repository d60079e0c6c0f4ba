#include "surface_json.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string>

#include "asperity/io/surface_file.hpp"
#include "file_bytes.hpp"
#include "gltf_guard.hpp"

namespace asperity::io {
namespace {

using value = tinygltf::Value;
using object = tinygltf::Value::Object;

friction_combine read_combine(const json_object& from, const char* key) {
  const std::string word = from.text(key);
  for (const friction_combine mode :
       {friction_combine::average, friction_combine::minimum, friction_combine::maximum, friction_combine::multiply}) {
    if (word == to_string(mode)) return mode;
  }
  reject(from.path(key) + " is " + in_quotes(word) + ", not average, minimum, maximum or multiply");
}

}  // namespace

material read_material(const json_object& from) {
  constexpr double usual_friction = 0.6;  // of the extension's schema
  material out;
  if (from.has("name")) out.name = from.text("name");
  out.static_friction = from.has("staticFriction") ? from.number("staticFriction") : usual_friction;
  out.dynamic_friction =
      from.has("dynamicFriction") ? from.number("dynamicFriction") : std::min(usual_friction, out.static_friction);
  if (from.has("frictionCombine")) out.combine = read_combine(from, "frictionCombine");
  if (from.has("extensions") && from.object("extensions").has(extension::haptic_material)) {
    const json_object haptic = from.object("extensions").object(extension::haptic_material);
    if (haptic.whole("version") != extension::haptic_material_version) {
      throw rejection{error_code::unsupported, haptic.path("version") + " is " +
                                                   std::to_string(haptic.whole("version")) +
                                                   ", and this build reads version 1; update asperity"};
    }
    out.stiffness_n_per_m = haptic.number("stiffness_n_per_m");
    out.dissipation_s_per_m = haptic.number("dissipation_s_per_m");
  }
  material unnamed = out;
  unnamed.name.clear();
  if (const result<void> ok = check(unnamed); !ok) reject(from.path() + " is no material: " + ok.error().message);
  return out;
}

object material_object(const material& m) {
  object haptic{{"version", value(extension::haptic_material_version)},
                {"stiffness_n_per_m", value(m.stiffness_n_per_m)},
                {"dissipation_s_per_m", value(m.dissipation_s_per_m)}};
  object out{{"staticFriction", value(m.static_friction)},
             {"dynamicFriction", value(m.dynamic_friction)},
             {"frictionCombine", value(std::string(to_string(m.combine)))},
             {"extensions", value(object{{extension::haptic_material, value(std::move(haptic))}})}};
  if (!m.name.empty()) out["name"] = value(m.name);
  return out;
}

result<material> load_material(const std::filesystem::path& file) {
  static constexpr const char* mend = "see docs/reference/asset-format.md for what a material file holds";
  return without_exceptions(file, [&]() -> result<material> {
    constexpr json_limits limits{.bytes = std::size_t{64} << 10, .items = 1000};
    const result<std::string> bytes = read_file(file, limits.bytes);
    if (!bytes) return bytes.error();
    return refusing(file, mend, [&]() -> result<material> {
      reading_watch watch;
      const json document = parse_bounded(*bytes, limits, watch);
      return read_material(json_object(document, "the material"));
    });
  });
}

}  // namespace asperity::io
