// Bullet's GImpact: two trees of boxes over triangles, in double precision.
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <algorithm>
#include <btBulletCollisionCommon.h>
#include <memory>
#include <type_traits>
#include <vector>

#include "contender.hpp"

namespace asperity::rivals {
namespace {

static_assert(std::is_same_v<btScalar, double>, "link Bullet's double-precision build, bullet-float64");

/// Triangles that come this near count as touching, of each body; Bullet's usual 40 mm would be larger than the bodies.
constexpr double margin_m = 1e-9;

/// A mesh as Bullet reads it, in memory of its own.
struct gimpact_body {
  std::vector<double> points;
  std::vector<int> corners;
  std::unique_ptr<btTriangleIndexVertexArray> mesh;
  std::unique_ptr<btGImpactMeshShape> shape;
  btCollisionObject object;

  explicit gimpact_body(const triangle_mesh& from) {
    for (const vec3& p : from.positions) points.insert(points.end(), {p.x, p.y, p.z});
    for (const auto& t : from.triangles) {
      for (const std::uint32_t v : t) corners.push_back(static_cast<int>(v));
    }
    constexpr int triangle_bytes = 3 * sizeof(int), point_bytes = 3 * sizeof(double);
    mesh = std::make_unique<btTriangleIndexVertexArray>(static_cast<int>(from.triangles.size()), corners.data(),
                                                        triangle_bytes, static_cast<int>(from.positions.size()),
                                                        points.data(), point_bytes);
    shape = std::make_unique<btGImpactMeshShape>(mesh.get());
    shape->setMargin(margin_m);
    shape->updateBound();
    object.setCollisionShape(shape.get());
  }
};

/// Takes every contact, where Bullet's own result keeps four.
class every_contact final : public btManifoldResult {
 public:
  using btManifoldResult::btManifoldResult;
  felt out;

  void addContactPoint(const btVector3& normal_on_b_w, const btVector3&, btScalar distance) override {
    const double depth_m = -distance;
    if (!(depth_m > 0.0)) return;
    ++out.contacts;
    out.touches = true;
    out.depth_m = std::max(out.depth_m, depth_m);
    out.force_w += depth_m * vec3(normal_on_b_w.x(), normal_on_b_w.y(), normal_on_b_w.z());
  }
};

class gimpact_contender final : public contender {
 public:
  explicit gimpact_contender(const body_pair& bodies)
      : probe_(bodies.probe), fixed_(bodies.fixed), dispatcher_(&configuration_) {
    btGImpactCollisionAlgorithm::registerAlgorithm(&dispatcher_);
  }

  felt feel(const pose& T_wa) override {
    const quat& q = T_wa.rotation;
    const vec3& p = T_wa.position;
    probe_.object.setWorldTransform(btTransform(btQuaternion(q.x, q.y, q.z, q.w), btVector3(p.x, p.y, p.z)));
    const btCollisionObjectWrapper a(nullptr, probe_.shape.get(), &probe_.object, probe_.object.getWorldTransform(), -1,
                                     -1);
    const btCollisionObjectWrapper b(nullptr, fixed_.shape.get(), &fixed_.object, fixed_.object.getWorldTransform(), -1,
                                     -1);
    btCollisionAlgorithm* const algorithm = dispatcher_.findAlgorithm(&a, &b, nullptr, BT_CONTACT_POINT_ALGORITHMS);
    every_contact found(&a, &b);
    const btDispatcherInfo info;
    algorithm->processCollision(&a, &b, info, &found);
    algorithm->~btCollisionAlgorithm();
    dispatcher_.freeCollisionAlgorithm(algorithm);
    return found.out;
  }

 private:
  gimpact_body probe_, fixed_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
};

}  // namespace

result<contender_ptr> make_gimpact(const body_pair& bodies) {
  return contender_ptr(std::make_unique<gimpact_contender>(bodies));
}

}  // namespace asperity::rivals
