#include "view/scene_document.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "asperity/core/printable.hpp"
#include "view/shown_mesh.hpp"

namespace asperity::view {
namespace {

using json = nlohmann::ordered_json;

json numbers(const vec3& v) { return {v.x, v.y, v.z}; }

json numbers(const pose& T) {
  json out = numbers(T.position);
  for (const double q : to_xyzw(T.rotation)) out.push_back(q);
  return out;
}

template <class Enum>
json names(int count) {
  json out = json::array();
  for (int i = 0; i < count; ++i) out.push_back(to_string(static_cast<Enum>(i)));
  return out;
}

const char* to_string(page_mode m) {
  switch (m) {
    case page_mode::live:
      return "live";
    case page_mode::replay:
      return "replay";
    case page_mode::model:
      return "model";
    case page_mode::gallery:
      return "gallery";
  }
  return "";
}

json facts(const textured_model& model) {
  const bake_report& r = model.report;
  json out = {{"coarse_triangles", model.mesh.triangles.size()},
              {"pieces", model.pieces.size()},
              {"texture", {model.texture.width, model.texture.height}},
              {"texels", r.texels},
              {"full_triangles", r.full_triangles},
              {"rms_error_m", r.rms_error_m},
              {"max_error_m", r.max_error_m},
              {"peak_to_valley_m", r.peak_to_valley_m}};
  if (r.quality) out["texel_m"] = r.quality->texel_m;
  return out;
}

}  // namespace

page_content make_content(const page_scene& scene, const std::vector<shown_recording>& recordings,
                          std::size_t most_points) {
  page_content out;
  std::vector<const textured_model*> models;
  std::vector<const triangle_mesh*> originals;
  for (const shown_body& b : scene.bodies) {
    if (std::find(models.begin(), models.end(), b.model.get()) != models.end()) continue;
    models.push_back(b.model.get());
    originals.push_back(b.original.get());
  }
  std::vector<shown_mesh> meshes;
  for (std::size_t i = 0; i < models.size(); ++i) {
    meshes.push_back(show_mesh(*models[i], most_points / models.size(), originals[i]));
  }
  json bodies = json::array();
  for (const shown_body& b : scene.bodies) {
    const std::ptrdiff_t at = std::find(models.begin(), models.end(), b.model.get()) - models.begin();
    const shown_mesh& mesh = meshes[static_cast<std::size_t>(at)];
    bodies.push_back({{"name", printable(b.name)},
                      {"mesh", at},
                      {"pose", numbers(b.T_w)},
                      {"centre_of_mass", numbers(b.model->mass.centre_of_mass)},
                      {"size_m", b.model->box.diagonal()},
                      {"points", mesh.points},
                      {"triangles", mesh.triangles},
                      {"step_m", mesh.step_m},
                      {"relief_m", {mesh.low_m, mesh.high_m}},
                      {"error_m", mesh.errors ? json{{"high", mesh.errors->high_m},
                                                     {"rms", mesh.errors->rms_m},
                                                     {"largest", mesh.errors->largest_m}}
                                              : json()},
                      {"facts", facts(*b.model)}});
  }
  for (shown_mesh& mesh : meshes) out.meshes.push_back(std::move(mesh.bytes));
  json recorded = json::array();
  for (const shown_recording& r : recordings) {
    recorded.push_back({{"name", printable(r.name)},
                        {"rows", r.rows.size()},
                        {"from_s", r.rows.front().time_s},
                        {"to_s", r.rows.back().time_s},
                        {"period_s", r.period_s()}});
    append_rows(out.rows.emplace_back(), r.rows);
  }
  json listed = json::array();
  for (const std::string& name : scene.listed) listed.push_back(printable(name));
  const json document = {
      {"schema", "asperity.view/1"},
      {"mode", to_string(scene.mode)},
      {"title", printable(scene.title)},
      {"virtual_clock", scene.virtual_clock},
      {"leads", scene.leads},
      {"listed", std::move(listed)},
      {"device_period_s", scene.device_period_s},
      {"most_force_n", scene.most_force_n},
      {"device_axes",
       {scene.map.T_wd.rotation.x, scene.map.T_wd.rotation.y, scene.map.T_wd.rotation.z, scene.map.T_wd.rotation.w}},
      {"motion_scale", scene.map.scale},
      {"columns", trace_columns},
      {"names",
       {{"sample", names<sample_verdict>(7)},
        {"device", names<device_state>(device_state_count)},
        {"fault", names<gate_fault>(gate_fault_count)},
        {"status", names<status>(8)},
        {"flags",
         {"beyond_field", "passed", "not_held", "planes_left_out", "unbalanced", "friction_left_out", "body_lost",
          "stands_back"}}}},
      {"recordings", std::move(recorded)},
      {"bodies", std::move(bodies)}};
  // File names need not be UTF-8; JSON must be.
  out.document = document.dump(-1, ' ', false, json::error_handler_t::replace);
  return out;
}

void append_rows(std::string& to, const std::vector<trace_row>& rows) {
  const auto bytes = [&](const auto& value) { to.append(reinterpret_cast<const char*>(&value), sizeof value); };
  to.reserve(to.size() + rows.size() * (sizeof(double) + sizeof(float) * trace_width));
  for (const trace_row& r : rows) bytes(r.time_s);
  for (const trace_row& r : rows) bytes(r.values);
}

}  // namespace asperity::view
