#include "distance_grid.hpp"

#include <algorithm>
#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>

namespace asperity::rivals {

distance_grid make_distance_grid(const triangle_mesh& mesh, double voxel_m, double band_m) {
  openvdb::initialize();
  std::vector<openvdb::Vec3s> points;
  points.reserve(mesh.positions.size());
  for (const vec3& p : mesh.positions) points.emplace_back(openvdb::Vec3d(p.x, p.y, p.z));
  std::vector<openvdb::Vec3I> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);

  const double half_width = std::max(8.0, band_m / voxel_m);  // voxels
  const auto frame = openvdb::math::Transform::createLinearTransform(voxel_m);
  const auto sparse =
      openvdb::tools::meshToLevelSet<openvdb::FloatGrid>(*frame, points, triangles, static_cast<float>(half_width));
  openvdb::CoordBBox box = sparse->evalActiveVoxelBoundingBox();
  box.expand(1);

  distance_grid out;
  out.voxel_m = voxel_m;
  out.band_m = sparse->background();
  out.origin = voxel_m * vec3(box.min().x(), box.min().y(), box.min().z());
  const openvdb::Coord size = box.dim();
  out.size = {size.x(), size.y(), size.z()};
  out.values.reserve(static_cast<std::size_t>(box.volume()));
  const auto at = sparse->getConstAccessor();
  for (int i = box.min().x(); i <= box.max().x(); ++i) {
    for (int j = box.min().y(); j <= box.max().y(); ++j) {
      for (int k = box.min().z(); k <= box.max().z(); ++k) out.values.push_back(at.getValue({i, j, k}));
    }
  }
  return out;
}

}  // namespace asperity::rivals
