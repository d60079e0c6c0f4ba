#include "bake/uv_room.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "bake/atlas.hpp"
#include "bake/geometry.hpp"
#include "bake/texel_map.hpp"
#include "bake/triangle_bvh.hpp"

namespace asperity::bake {
namespace {

constexpr double most_boxes = 64.0;
constexpr std::uint32_t band_rows = 64;
constexpr double same_surface_texels = 6.0 * gutter_texels;

// How far apart the two are along the best of their edges' normals; negative where they overlap.
double separation(const image_triangle& a, const image_triangle& b) noexcept {
  double most = -std::numeric_limits<double>::infinity();
  for (const auto& [of, other] : {std::pair{&a, &b}, std::pair{&b, &a}}) {
    const double turn = of->twice_area < 0.0 ? -1.0 : 1.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const vec2 edge = of->c[(k + 1) % 3] - of->c[k];
      double least = std::numeric_limits<double>::infinity();
      for (const vec2& p : other->c) least = std::min(least, -turn * image_triangle::cross(edge, p - of->c[k]));
      most = std::max(most, least / glm::length(edge));
    }
  }
  return most;
}

// Distance of two triangles that do not overlap.
double distance(const image_triangle& a, const image_triangle& b) noexcept {
  double least = std::numeric_limits<double>::infinity();
  for (const vec2& p : a.c) least = std::min(least, glm::length(p - b.clamp(p)));
  for (const vec2& p : b.c) least = std::min(least, glm::length(p - a.clamp(p)));
  return least;
}

bool share_a_vertex(const index_triangle& a, const index_triangle& b) noexcept {
  return std::ranges::any_of(a, [&](std::uint32_t v) { return v == b[0] || v == b[1] || v == b[2]; });
}

// A triangle whose gutter a texel lies in.
struct neighbour {
  std::uint32_t texel;  // number in its band
  std::uint32_t triangle;
  double distance;  // of the texel's centre, texels

  friend bool operator<(const neighbour& a, const neighbour& b) noexcept {
    return a.texel != b.texel         ? a.texel < b.texel
           : a.distance != b.distance ? a.distance < b.distance
                                      : a.triangle < b.triangle;
  }
};

class crowding_search {
 public:
  crowding_search(const triangle_mesh& mesh, std::span<const image_triangle> image, std::uint32_t size)
      : mesh_(mesh), image_(image), size_(size) {
    maps_.reserve(image.size());
    for (std::size_t t = 0; t < image.size(); ++t)
      maps_.emplace_back(corners(mesh.positions, mesh.triangles[t]), image[t]);
  }

  std::optional<triangle_pair> run() {
    std::vector<std::vector<std::uint32_t>> reaching((size_ + band_rows - 1) / band_rows);
    for (std::uint32_t t = 0; t < image_.size(); ++t) {
      const auto [first, last] = range(image_[t].low().y, image_[t].high().y);
      for (std::uint32_t band = first / band_rows; band <= last / band_rows; ++band) reaching[band].push_back(t);
    }
    for (std::uint32_t band = 0; band < reaching.size(); ++band) search(band * band_rows, reaching[band]);
    return nearest_;
  }

 private:
  // Texels whose centre may be within a gutter of [low, high].
  [[nodiscard]] std::array<std::uint32_t, 2> range(double low, double high) const noexcept {
    const auto index = [&](double x) {
      return static_cast<std::uint32_t>(std::clamp(std::floor(x), 0.0, static_cast<double>(size_ - 1)));
    };
    return {index(low - gutter_texels), index(high + gutter_texels)};
  }

  void search(std::uint32_t first_row, const std::vector<std::uint32_t>& triangles) {
    near_.clear();
    for (const std::uint32_t t : triangles) collect(first_row, t);
    std::sort(near_.begin(), near_.end());
    for (std::size_t i = 0, j = 0; i < near_.size(); i = j) {
      while (j < near_.size() && near_[j].texel == near_[i].texel) ++j;
      const std::uint32_t row = first_row + near_[i].texel / size_;
      const vec2 p{near_[i].texel % size_ + 0.5, row + 0.5};
      if (j - i > 1) judge(std::span(near_).subspan(i, j - i), p);
    }
  }

  void collect(std::uint32_t first_row, std::uint32_t t) {
    const image_triangle& triangle = image_[t];
    const auto [left, right] = range(triangle.low().x, triangle.high().x);
    const auto [low, high] = range(triangle.low().y, triangle.high().y);
    for (std::uint32_t j = std::max(low, first_row); j <= std::min(high, first_row + band_rows - 1); ++j)
      for (std::uint32_t i = left; i <= right; ++i) {
        const vec2 p{i + 0.5, j + 0.5};
        const double d = glm::length(p - triangle.clamp(p));
        if (d <= gutter_texels && !is_deep_inside(triangle, p)) near_.push_back({(j - first_row) * size_ + i, t, d});
      }
  }

  // Nothing else can be near.
  [[nodiscard]] static bool is_deep_inside(const image_triangle& t, const vec2& p) noexcept {
    const std::array<double, 3> b = t.coordinates(p);
    for (std::size_t k = 0; k < 3; ++k) {
      const double side = glm::length(t.c[(k + 2) % 3] - t.c[(k + 1) % 3]);
      if (b[k] * std::abs(t.twice_area) < (gutter_texels + uv_slack_texels) * side) return false;
    }
    return true;
  }

  // From the triangle that owns the texel to all that are the same surface there; what is left over is another one.
  void judge(std::span<const neighbour> around, const vec2& p) {
    rest_.assign(around.begin() + 1, around.end());
    reached_.assign(1, around.front().triangle);
    for (std::size_t i = 0; i < reached_.size() && !rest_.empty(); ++i)
      std::erase_if(rest_, [&](const neighbour& n) {
        if (!same_surface(reached_[i], n.triangle, p)) return false;
        reached_.push_back(n.triangle);
        return true;
      });
    if (rest_.empty()) return;
    const std::uint32_t a = around.front().triangle;
    const std::uint32_t b = rest_.front().triangle;
    const double apart = distance(image_[a], image_[b]);
    if (!nearest_ || apart < nearest_->apart_texels) nearest_ = {std::min(a, b), std::max(a, b), apart};
  }

  [[nodiscard]] bool same_surface(std::uint32_t a, std::uint32_t b, const vec2& p) const noexcept {
    if (!share_a_vertex(mesh_.triangles[a], mesh_.triangles[b])) return false;
    const double texel_m = std::max(maps_[a].wide_m(), maps_[b].wide_m());
    return glm::length(maps_[a].point(p) - maps_[b].point(p)) <= same_surface_texels * texel_m;
  }

  const triangle_mesh& mesh_;
  std::span<const image_triangle> image_;
  std::uint32_t size_;
  std::vector<texel_map> maps_;
  std::vector<neighbour> near_;
  std::vector<neighbour> rest_;
  std::vector<std::uint32_t> reached_;
  std::optional<triangle_pair> nearest_;
};

}  // namespace

result<void> check_boxes(std::span<const image_triangle> image, std::uint32_t texture_size) {
  const double side = texture_size;
  double boxes = 0.0;
  for (const image_triangle& t : image) {
    const vec2 size = t.high() - t.low() + 2.0 * gutter_texels;
    boxes += size.x * size.y;
  }
  if (boxes <= most_boxes * side * side) return {};
  return error{error_code::limit_exceeded,
               "the triangles of the coarse mesh are needles that cross its texture over and over; remesh it, or bake "
               "without --keep-uvs"};
}

std::optional<triangle_pair> find_overlap(std::span<const image_triangle> image) {
  std::vector<vec3> positions;
  std::vector<index_triangle> triangles;
  for (const image_triangle& t : image) {
    const auto v = static_cast<std::uint32_t>(positions.size());
    triangles.push_back({v, v + 1, v + 2});
    for (const vec2& p : t.c) positions.emplace_back(p, 0.0);
  }
  const triangle_bvh tree(positions, triangles);
  for (std::uint32_t t = 0; t < image.size(); ++t) {
    std::uint32_t first = no_halfedge;
    tree.visit_box(vec3(image[t].low(), 0.0), vec3(image[t].high(), 0.0), [&](std::uint32_t other) {
      if (other > t && other < first && separation(image[t], image[other]) < -uv_slack_texels) first = other;
    });
    if (first != no_halfedge) return triangle_pair{t, first, 0.0};
  }
  return std::nullopt;
}

std::optional<triangle_pair> find_crowding(const triangle_mesh& mesh, std::span<const image_triangle> image,
                                           std::uint32_t texture_size) {
  return crowding_search(mesh, image, texture_size).run();
}

}  // namespace asperity::bake
