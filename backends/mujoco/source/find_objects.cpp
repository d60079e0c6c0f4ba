#include "find_objects.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <span>
#include <string_view>

#include "asperity/mujoco/conversions.hpp"

namespace asperity::mujoco {
namespace {

std::string_view word_of(object_kind kind) { return kind == object_kind::body ? "body" : "geom"; }
mjtObj type_of(object_kind kind) { return kind == object_kind::body ? mjOBJ_BODY : mjOBJ_GEOM; }

std::string names_of(const mjModel& m, object_kind kind) {
  constexpr int most = 12;
  const int count = kind == object_kind::body ? m.nbody : m.ngeom;
  std::string out;
  int named = 0;
  for (int id = 0; id < count; ++id) {
    const char* const name = mj_id2name(&m, type_of(kind), id);
    if (name == nullptr || *name == '\0') continue;
    if (++named > most) return out + ", ...";
    out += (out.empty() ? "" : ", ") + std::string(name);
  }
  return out.empty() ? "none has a name" : out;
}

// Extents of a mesh geom's vertices in a frame of the body.
bounds box_of_mesh(const mjModel& m, int geom, const pose& T_bm) {
  const auto mesh = static_cast<std::size_t>(m.geom_dataid[geom]);
  const pose T_mg =
      inverse(T_bm) * pose_from_mujoco(std::span<const double, 3>(m.geom_pos + std::ptrdiff_t{3} * geom, 3),
                                       std::span<const double, 4>(m.geom_quat + std::ptrdiff_t{4} * geom, 4));
  std::vector<vec3> corners;
  const auto first = static_cast<std::size_t>(m.mesh_vertadr[mesh]);
  for (std::size_t i = first; i < first + static_cast<std::size_t>(m.mesh_vertnum[mesh]); ++i) {
    const float* const v = m.mesh_vert + 3 * i;
    corners.push_back(T_mg * vec3(v[0], v[1], v[2]));
  }
  return bounds_of(corners);
}

std::string text_of(const bounds& b) {
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(), "(%.4g %.4g %.4g) to (%.4g %.4g %.4g) m", b.low.x, b.low.y, b.low.z, b.high.x,
                b.high.y, b.high.z);
  return text.data();
}

// A model that is somewhere else than the mesh that it stands for would be felt where nothing is seen.
result<void> check_fits_mesh(const mjModel& m, int geom, const textured_object& object, const std::string& where) {
  constexpr double tolerance = 0.1;  // of the diagonal: the model is a coarse mesh of the same surface
  const bounds mesh = box_of_mesh(m, geom, object.T_om), &model = object.model->box;
  const double most_m = tolerance * std::max(mesh.diagonal(), model.diagonal());
  for (int i = 0; i < 3; ++i) {
    if (std::fabs(mesh.low[i] - model.low[i]) <= most_m && std::fabs(mesh.high[i] - model.high[i]) <= most_m) continue;
    return error{error_code::invalid_argument,
                 where + ": the mesh of geom '" + object.name + "' reaches, as T_om places the model, from " +
                     text_of(mesh) + " and the textured model from " + text_of(model) +
                     ": give the geom's pos and quat of the MJCF as T_om, and bake the model in the mesh's units"};
  }
  return {};
}

}  // namespace

std::string name_of(const mjModel& m, mjtObj kind, int id) {
  const char* const name = mj_id2name(&m, kind, id);
  std::string out = kind == mjOBJ_BODY ? "body " : "geom ";
  if (name == nullptr || *name == '\0') return out.append("number ").append(std::to_string(id));
  return out.append("'").append(name).append("'");
}

result<found_object> find_object(const mjModel& m, const textured_object& object, const std::string& where) {
  const auto bad = [&](const std::string& what) { return error{error_code::invalid_argument, where + ": " + what}; };
  if (!object.model) return bad("there is no textured model: load one with io::load_textured_model()");
  if (!(object.model->mass.volume_m3 > 0.0)) {
    return bad("the textured model '" + object.model->name +
               "' encloses no volume, so it has no inside: bake it from a closed mesh");
  }
  if (!is_valid(object.T_om))
    return bad("T_om is no pose: its quaternion has to be of length 1 and every number finite");
  const int id = mj_name2id(&m, type_of(object.kind), object.name.c_str());
  if (id < 0) {
    const object_kind other = object.kind == object_kind::body ? object_kind::geom : object_kind::body;
    if (!object.name.empty() && mj_name2id(&m, type_of(other), object.name.c_str()) >= 0) {
      return bad("'" + object.name + "' is the name of a " + std::string(word_of(other)) + " and not of a " +
                 std::string(word_of(object.kind)) + ": set object_kind::" + std::string(word_of(other)));
    }
    return bad("the MuJoCo model has no " + std::string(word_of(object.kind)) + " '" + object.name +
               "'; it has: " + names_of(m, object.kind));
  }
  if (object.kind == object_kind::body) return found_object{id, -1, object.T_om};
  const int body = m.geom_bodyid[id];
  if (m.geom_type[id] == mjGEOM_MESH) {
    if (const result<void> fits = check_fits_mesh(m, id, object, where); !fits) return fits.error();
    return found_object{body, id, object.T_om};
  }
  const pose T_bg = pose_from_mujoco(std::span<const double, 3>(m.geom_pos + std::ptrdiff_t{3} * id, 3),
                                     std::span<const double, 4>(m.geom_quat + std::ptrdiff_t{4} * id, 4));
  return found_object{body, id, T_bg * object.T_om};
}

std::vector<int> geoms_of(const mjModel& m, const found_object& object) {
  if (object.geom >= 0) return {object.geom};
  std::vector<int> out;
  for (int i = 0; i < m.body_geomnum[object.body]; ++i) out.push_back(m.body_geomadr[object.body] + i);
  return out;
}

}  // namespace asperity::mujoco
