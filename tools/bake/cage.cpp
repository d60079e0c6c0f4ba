#include "bake/cage.hpp"

#include <sstream>
#include <vector>

#include "bake/geometry.hpp"
#include "bake/parallel.hpp"

namespace asperity::bake {
namespace {

struct farthest {
  double distance_m = 0.0;
  vec3 at{0.0};

  void take(double distance, const vec3& p) noexcept {
    if (distance > distance_m) *this = {distance, p};
  }
};

}  // namespace

result<double> measure_cage(const triangle_mesh& full, const triangle_bvh& full_tree, const triangle_mesh& coarse,
                            unsigned threads, stage_monitor& monitor) {
  const double diagonal = bounds_of(full.positions).diagonal();
  const double ratio = bounds_of(coarse.positions).diagonal() / diagonal;
  std::ostringstream text;
  if (ratio > 10.0 || ratio < 0.1) {
    text << "the coarse mesh is " << (ratio > 1.0 ? ratio : 1.0 / ratio) << " times "
         << (ratio > 1.0 ? "larger" : "smaller") << " than the original; bring both to metres";
    return error{error_code::bad_mesh, text.str()};
  }

  farthest worst;
  for (const vec3& p : coarse.positions) worst.take(full_tree.closest(p).distance_m, p);
  for (const index_triangle& t : coarse.triangles) {
    const auto c = corners(coarse.positions, t);
    const vec3 centre = (c[0] + c[1] + c[2]) / 3.0;
    worst.take(full_tree.closest(centre).distance_m, centre);
  }
  const triangle_bvh coarse_tree(coarse.positions, coarse.triangles);
  std::vector<farthest> of_block(block_count(full.positions.size()));
  const auto visit = [&](std::size_t block, std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v)
      of_block[block].take(coarse_tree.closest(full.positions[v]).distance_m, full.positions[v]);
  };
  if (!parallel_blocks(full.positions.size(), threads, monitor, 0.5, 1.0, visit))
    return error{error_code::cancelled, "the bake was cancelled"};
  for (const farthest& f : of_block) worst.take(f.distance_m, f.at);

  if (worst.distance_m > widest_cage_in_diagonals * diagonal) {
    text << "the coarse mesh and the original are " << worst.distance_m << " m apart at (" << worst.at.x << ", "
         << worst.at.y << ", " << worst.at.z << ") m, more than " << 100.0 * widest_cage_in_diagonals
         << " % of the diagonal; align the two, or use more coarse triangles";
    return error{error_code::bad_mesh, text.str()};
  }
  return worst.distance_m;
}

}  // namespace asperity::bake
