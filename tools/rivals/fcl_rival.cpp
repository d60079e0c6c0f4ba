// FCL: two trees of triangles.
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/collision_object.h>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "contender.hpp"

namespace asperity::rivals {
namespace {

using tree = fcl::BVHModel<fcl::OBBRSSd>;

std::shared_ptr<tree> tree_of(const triangle_mesh& mesh) {
  std::vector<fcl::Vector3d> points;
  points.reserve(mesh.positions.size());
  for (const vec3& p : mesh.positions) points.emplace_back(p.x, p.y, p.z);
  std::vector<fcl::Triangle> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  auto out = std::make_shared<tree>();
  if (out->beginModel(static_cast<int>(triangles.size()), static_cast<int>(points.size())) != fcl::BVH_OK ||
      out->addSubModel(points, triangles) != fcl::BVH_OK || out->endModel() != fcl::BVH_OK) {
    return nullptr;
  }
  return out;
}

class fcl_contender final : public contender {
 public:
  fcl_contender(std::shared_ptr<tree> probe, std::shared_ptr<tree> fixed)
      : probe_(std::move(probe)), fixed_(std::move(fixed)) {
    all_.num_max_contacts = std::numeric_limits<int>::max();
    all_.enable_contact = true;
  }

  felt feel(const pose& T_wa) override {
    const quat& q = T_wa.rotation;
    const vec3& p = T_wa.position;
    probe_.setTransform(fcl::Quaterniond(q.w, q.x, q.y, q.z), fcl::Vector3d(p.x, p.y, p.z));
    found_.clear();
    fcl::collide(&probe_, &fixed_, all_, found_);
    felt out;
    out.contacts = found_.numContacts();
    out.touches = out.contacts > 0;
    for (std::size_t i = 0; i < out.contacts; ++i) {
      const fcl::Contactd& c = found_.getContact(i);
      out.depth_m = std::max(out.depth_m, c.penetration_depth);
      // The normal points from the first object, the probe, to the second.
      out.force_w -= c.penetration_depth * vec3(c.normal[0], c.normal[1], c.normal[2]);
    }
    return out;
  }

 private:
  fcl::CollisionObjectd probe_, fixed_;
  fcl::CollisionRequestd all_;
  fcl::CollisionResultd found_;
};

}  // namespace

result<contender_ptr> make_fcl(const body_pair& bodies) {
  auto probe = tree_of(bodies.probe), fixed = tree_of(bodies.fixed);
  if (!probe || !fixed) return error{error_code::bad_mesh, "FCL could not build a tree of " + bodies.name};
  return contender_ptr(std::make_unique<fcl_contender>(std::move(probe), std::move(fixed)));
}

}  // namespace asperity::rivals
