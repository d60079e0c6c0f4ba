#include "bake/project.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "bake/geometry.hpp"
#include "bake/image_triangle.hpp"
#include "bake/parallel.hpp"

namespace asperity::bake {
namespace {

using barycentric = std::array<double, 3>;

struct owner {
  std::uint32_t triangle = no_halfedge;
  float distance = std::numeric_limits<float>::infinity();  // texels between texel centre and triangle; 0 inside
};

// The triangle that each texel belongs to: the nearest one within the gutter's width.
std::vector<owner> assign_texels(const atlas& charts, std::uint32_t size) {
  std::vector<owner> owners(std::size_t{size} * size);
  const auto clamp_index = [size](double x) {
    return static_cast<std::uint32_t>(std::clamp(std::floor(x), 0.0, static_cast<double>(size - 1)));
  };
  for (std::uint32_t t = 0; t < charts.uv.size(); ++t) {
    const image_triangle triangle(charts.uv[t], size);
    const vec2 low = triangle.low() - gutter_texels;
    const vec2 high = triangle.high() + gutter_texels;
    for (std::uint32_t j = clamp_index(low.y); j <= clamp_index(high.y); ++j)
      for (std::uint32_t i = clamp_index(low.x); i <= clamp_index(high.x); ++i) {
        const vec2 p{i + 0.5, j + 0.5};
        const auto distance = static_cast<float>(glm::length(p - triangle.clamp(p)));
        owner& o = owners[std::size_t{j} * size + i];
        if (static_cast<double>(distance) <= gutter_texels && distance < o.distance) o = {t, distance};
      }
  }
  return owners;
}

// Points across a texel at which a filter looks: detail finer than a quarter of a texel may slip through.
constexpr int footprint_points = 4;

// What one block of texels adds to the report.
struct tally {
  std::size_t texels = 0;
  std::size_t fallback_texels = 0;
  double highest = -std::numeric_limits<double>::infinity();
  double lowest = std::numeric_limits<double>::infinity();
  double farthest = 0.0;
  bool broken = false;  // a height was not finite
};

class projector {
 public:
  projector(const triangle_mesh& coarse, const crease_normals& directions, const triangle_bvh& full, double range_m,
            const added_relief* added, texel_filter filter)
      : coarse_(coarse), directions_(directions), full_(full), range_m_(range_m), added_(added), filter_(filter) {}

  // The plane of coarse triangle t.
  [[nodiscard]] vec3 base(std::uint32_t t, const barycentric& b) const noexcept {
    const auto c = corners(coarse_.positions, coarse_.triangles[t]);
    return b[0] * c[0] + b[1] * c[1] + b[2] * c[2];
  }

  // What the texel around place p of the image keeps, of coarse triangle t.
  vec3 operator()(std::uint32_t t, const image_triangle& image, const vec2& p, tally* count) const {
    const barycentric b = image.coordinates(p);
    const vec3 foot = base(t, b);
    const vec3 d = directions_.at(t, b);
    const met at = meet(foot, d);
    const vec3 q = at.crossed && filter_ != texel_filter::point ? foot + offset_over(t, image, p) * d : at.point;
    if (count != nullptr) {
      const double offset = glm::dot(q - foot, d);
      ++count->texels;
      if (!at.crossed) ++count->fallback_texels;
      count->highest = std::max(count->highest, offset);
      count->lowest = std::min(count->lowest, offset);
      count->farthest = std::max(count->farthest, glm::length(q - foot));
    }
    return q;
  }

 private:
  struct met {
    vec3 point;    // of the original, with its relief
    bool crossed;  // on the line along d; otherwise the closest point
  };

  [[nodiscard]] met meet(const vec3& p, const vec3& d) const {
    const auto crossing = full_.nearest_front_crossing(p, d, range_m_);
    const auto nearest = crossing ? triangle_bvh::nearest{} : full_.closest(p);
    vec3 q = crossing ? crossing->point : nearest.point;
    if (added_ != nullptr) q += rise(crossing ? crossing->triangle : nearest.triangle, q, d) * d;
    return {q, crossing.has_value()};
  }

  // The filtered offset of the footprint around p. What of it is beyond the triangle is asked at the triangle's edge.
  // The middle has met the original, but with an even number of points it is none of them: it is asked as well where
  // none of the others has met it.
  [[nodiscard]] double offset_over(std::uint32_t t, const image_triangle& image, const vec2& p) const {
    const bool highest = filter_ == texel_filter::highest;
    double sum = 0.0;
    double top = -std::numeric_limits<double>::infinity();
    int count = 0;
    const auto take = [&](const vec2& at) {
      const barycentric b = image.coordinates(image.clamp(at));
      const vec3 foot = base(t, b);
      const vec3 d = directions_.at(t, b);
      const met found = meet(foot, d);
      if (!found.crossed) return;
      const double offset = glm::dot(found.point - foot, d);
      sum += offset;
      top = std::max(top, offset);
      ++count;
    };
    const auto step = [](int i) { return (i + 0.5) / footprint_points - 0.5; };
    for (int j = 0; j < footprint_points; ++j)
      for (int i = 0; i < footprint_points; ++i) take(p + vec2{step(i), step(j)});
    if (count == 0) take(p);
    if (count == 0) return 0.0;
    return highest ? top : sum / count;
  }

  // How far to go along d to be at the height of the relief over the plane of triangle t.
  [[nodiscard]] double rise(std::uint32_t t, const vec3& q, const vec3& d) const {
    constexpr double least_cosine = 0.5;  // at an edge sharper than 120 degrees the relief is cut off
    const vec3 n = unit_normal(corners(added_->original.positions, added_->original.triangles[t]));
    return added_->at(t, q) / std::max(glm::dot(n, d), least_cosine);
  }

  const triangle_mesh& coarse_;
  const crease_normals& directions_;
  const triangle_bvh& full_;
  double range_m_;
  const added_relief* added_;
  texel_filter filter_;
};

}  // namespace

result<projection> project(const triangle_mesh& coarse, const atlas& charts, const crease_normals& directions,
                           const triangle_bvh& full, double range_m, std::uint32_t texture_size, unsigned threads,
                           stage_monitor& monitor, const added_relief* heights, texel_filter filter) {
  const std::vector<owner> owners = assign_texels(charts, texture_size);
  const projector surface(coarse, directions, full, range_m, heights, filter);
  const glm::vec3 nowhere(std::numeric_limits<float>::quiet_NaN());
  projection out;
  out.texture = {texture_size, texture_size, std::vector<glm::vec3>(owners.size(), nowhere)};
  out.chart.assign(owners.size(), no_halfedge);
  std::vector<tally> of_block(block_count(owners.size()));
  const auto fill = [&](std::size_t block, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const owner& o = owners[i];
      if (o.triangle == no_halfedge) continue;
      const image_triangle triangle(charts.uv[o.triangle], texture_size);
      const std::size_t row = i / texture_size;
      const vec2 p{static_cast<double>(i % texture_size) + 0.5, static_cast<double>(row) + 0.5};
      vec3 q;
      if (o.distance == 0.0F) {
        out.chart[i] = charts.chart[o.triangle];
        q = surface(o.triangle, triangle, p, &of_block[block]);
      } else {
        const vec2 edge = triangle.clamp(p);
        const vec2 mirror = triangle.clamp(2.0 * edge - p);
        const auto displacement = [&](const vec2& at) {
          return surface(o.triangle, triangle, at, nullptr) - surface.base(o.triangle, triangle.coordinates(at));
        };
        q = surface.base(o.triangle, triangle.coordinates(p)) + 2.0 * displacement(edge) - displacement(mirror);
      }
      if (!is_finite(q)) of_block[block].broken = true;
      out.texture.texels[i] = glm::vec3(q);
    }
  };
  if (!parallel_blocks(owners.size(), threads, monitor, 0.0, 1.0, fill))
    return error{error_code::cancelled, "the bake was cancelled"};

  tally all;
  for (const tally& b : of_block) {
    all.texels += b.texels;
    all.fallback_texels += b.fallback_texels;
    all.highest = std::max(all.highest, b.highest);
    all.lowest = std::min(all.lowest, b.lowest);
    all.farthest = std::max(all.farthest, b.farthest);
    all.broken = all.broken || b.broken;
  }
  if (all.broken) return error{error_code::bad_texture, "the relief has a height that is not finite; mend its source"};
  out.texels = all.texels;
  out.fallback_texels = all.fallback_texels;
  if (all.texels > 0) {
    out.highest_m = all.highest;
    out.lowest_m = all.lowest;
  }
  out.max_displacement_m = all.farthest;
  return out;
}

}  // namespace asperity::bake
