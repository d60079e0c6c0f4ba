// MuJoCo: contacts of two mesh geoms, which it takes for their convex hulls.
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <memory>
#include <mujoco/mujoco.h>
#include <string>
#include <utility>

#include "contender.hpp"

namespace asperity::rivals {
namespace {

template <class T, void (*destroy)(T*)>
struct destroyer {
  void operator()(T* it) const noexcept { destroy(it); }
};
using model_holder = std::unique_ptr<mjModel, destroyer<mjModel, mj_deleteModel>>;
using data_holder = std::unique_ptr<mjData, destroyer<mjData, mj_deleteData>>;

void add_mesh(std::string& xml, const char* name, const triangle_mesh& mesh) {
  xml += std::string("<mesh name=\"") + name + "\" vertex=\"";
  std::array<char, 96> text{};
  for (const vec3& p : mesh.positions) {
    std::snprintf(text.data(), text.size(), "%.9g %.9g %.9g ", p.x, p.y, p.z);
    xml += text.data();
  }
  xml += "\"/>\n";
}

/// A scene of two mesh geoms, the probe on a free joint. Vertices alone: MuJoCo makes the hull of them.
std::string scene_xml(const body_pair& bodies) {
  std::string xml =
      "<mujoco><compiler inertiafromgeom=\"true\" boundmass=\"0.001\" boundinertia=\"1e-9\"/>"
      "<size nconmax=\"200\"/><asset>\n";
  add_mesh(xml, "probe", bodies.probe);
  add_mesh(xml, "fixed", bodies.fixed);
  xml +=
      "</asset><worldbody><geom type=\"mesh\" mesh=\"fixed\" margin=\"0\"/>"
      "<body><freejoint/><geom type=\"mesh\" mesh=\"probe\" margin=\"0\"/></body></worldbody></mujoco>";
  return xml;
}

class mujoco_contender final : public contender {
 public:
  mujoco_contender(model_holder model, data_holder data) : model_(std::move(model)), data_(std::move(data)) {}

  felt feel(const pose& T_wa) override {
    const vec3& p = T_wa.position;
    const quat& q = T_wa.rotation;
    const std::array<double, 7> at{p.x, p.y, p.z, q.w, q.x, q.y, q.z};
    std::copy(at.begin(), at.end(), data_->qpos);
    mj_kinematics(model_.get(), data_.get());
    mj_collision(model_.get(), data_.get());
    felt out;
    for (int i = 0; i < data_->ncon; ++i) {
      const mjContact& c = data_->contact[i];
      if (!(c.dist < 0.0)) continue;
      ++out.contacts;
      out.touches = true;
      out.depth_m = std::max(out.depth_m, -c.dist);
      // The frame's first axis points from geom1 to geom2; the probe is the later geom.
      out.force_w += -c.dist * vec3(c.frame[0], c.frame[1], c.frame[2]);
    }
    return out;
  }

 private:
  model_holder model_;
  data_holder data_;
};

}  // namespace

result<contender_ptr> make_mujoco(const body_pair& bodies) {
  const std::string xml = scene_xml(bodies);
  const auto files = std::make_unique<mjVFS>();  // two megabytes: not for the stack
  mj_defaultVFS(files.get());
  constexpr const char* name = "pair.xml";
  std::array<char, 1000> fault{};
  model_holder model;
  if (mj_makeEmptyFileVFS(files.get(), name, static_cast<int>(xml.size())) == 0) {
    std::memcpy(files->filedata[mj_findFileVFS(files.get(), name)], xml.data(), xml.size());
    model.reset(mj_loadXML(name, files.get(), fault.data(), static_cast<int>(fault.size())));
  }
  mj_deleteVFS(files.get());
  mj_freeLastXML();  // otherwise MuJoCo keeps the meshes of the last scene until the next
  data_holder data(model ? mj_makeData(model.get()) : nullptr);
  if (!data) return error{error_code::bad_mesh, "MuJoCo could not load " + bodies.name + ": " + fault.data()};
  return contender_ptr(std::make_unique<mujoco_contender>(std::move(model), std::move(data)));
}

}  // namespace asperity::rivals
