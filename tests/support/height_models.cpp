#include "support/height_models.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

namespace asperity::test_support {
namespace {

class plate_builder {
 public:
  explicit plate_builder(const plate_spec& s) : s_(s) {}

  [[nodiscard]] model_ptr build() {
    model_.name = "plate";
    s_.disc ? fan() : grid();
    walls_and_bottom();
    for (vec3& p : model_.mesh.positions) p = s_.T_body_plate * p;
    model_.mass = compute_mass_properties(model_.mesh);
    model_.mass.centre_of_mass = s_.T_body_plate * s_.centre_of_mass;
    model_.box = {model_.mesh.positions.front(), model_.mesh.positions.front()};
    for (const vec3& p : model_.mesh.positions) {
      model_.box.low = glm::min(model_.box.low, p);
      model_.box.high = glm::max(model_.box.high, p);
    }
    return std::make_shared<const textured_model>(std::move(model_));
  }

 private:
  using vertex = std::uint32_t;
  static constexpr std::uint32_t wall_texels = 8;

  [[nodiscard]] static std::uint32_t wall_left(std::size_t k) {
    return static_cast<std::uint32_t>(k) * (wall_texels + 2 * plate_gutter);
  }

  void resize_texture(std::uint32_t width, std::uint32_t height) {
    model_.texture.width = width;
    model_.texture.height = height;
    model_.texture.texels.assign(std::size_t{width} * height, glm::vec3(0.0F));
  }
  void fill(std::uint32_t left, std::uint32_t low, std::uint32_t size_x, std::uint32_t size_y,
            const std::function<vec3(double, double)>& at) {
    for (std::uint32_t j = 0; j < size_y + 2 * plate_gutter; ++j) {
      for (std::uint32_t i = 0; i < size_x + 2 * plate_gutter; ++i) {
        const vec3 p = s_.T_body_plate * at((i + 0.5 - plate_gutter) / size_x, (j + 0.5 - plate_gutter) / size_y);
        model_.texture.texels[std::size_t{low + j} * model_.texture.width + left + i] = glm::vec3(p);
      }
    }
  }
  [[nodiscard]] vec2 uv(std::uint32_t left, std::uint32_t low, std::uint32_t size_x, std::uint32_t size_y, double a,
                        double b) const {
    return {(left + plate_gutter + a * size_x) / model_.texture.width,
            (low + plate_gutter + b * size_y) / model_.texture.height};
  }
  [[nodiscard]] vec3 fine(double x, double y) const { return {x, y, s_.height ? s_.height(x, y) : 0.0}; }
  [[nodiscard]] vertex add_top(double x, double y) {
    model_.mesh.positions.emplace_back(x, y, s_.coarse_height ? s_.coarse_height(x, y) : 0.0);
    return static_cast<vertex>(model_.mesh.positions.size() - 1);
  }
  void add(std::array<vertex, 3> v, std::array<vec2, 3> z) { model_.mesh.triangles.push_back({v, z}); }

  void grid() {
    const std::uint32_t nx = s_.cells_x, ny = s_.cells_y;
    const std::uint32_t charts_x = s_.chart_per_cell ? nx : 1, charts_y = s_.chart_per_cell ? ny : 1;
    const std::uint32_t tx = s_.texels / charts_x, ty = s_.texels / charts_y;
    top_height_ = charts_y * (ty + 2 * plate_gutter);
    resize_texture(std::max(charts_x * (tx + 2 * plate_gutter), wall_left(2 * (nx + ny))),
                   top_height_ + 2 * (16 + 2 * plate_gutter));
    const auto x_of = [&](double a) { return s_.half_x * (2.0 * a - 1.0); };
    const auto y_of = [&](double b) { return s_.half_y * (2.0 * b - 1.0); };
    for (std::uint32_t cj = 0; cj < charts_y; ++cj) {
      for (std::uint32_t ci = 0; ci < charts_x; ++ci) {
        fill(ci * (tx + 2 * plate_gutter), cj * (ty + 2 * plate_gutter), tx, ty,
             [&](double a, double b) { return fine(x_of((ci + a) / charts_x), y_of((cj + b) / charts_y)); });
      }
    }
    for (std::uint32_t j = 0; j <= ny; ++j) {
      for (std::uint32_t i = 0; i <= nx; ++i) static_cast<void>(add_top(x_of(double(i) / nx), y_of(double(j) / ny)));
    }
    for (std::uint32_t j = 0; j < ny; ++j) {
      for (std::uint32_t i = 0; i < nx; ++i) {
        const auto at = [&](std::uint32_t di, std::uint32_t dj) { return (j + dj) * (nx + 1) + i + di; };
        const auto z = [&](std::uint32_t di, std::uint32_t dj) {
          return s_.chart_per_cell ? uv(i * (tx + 2 * plate_gutter), j * (ty + 2 * plate_gutter), tx, ty, di, dj)
                                   : uv(0, 0, tx, ty, double(i + di) / nx, double(j + dj) / ny);
        };
        // The diagonal alternates, so that no direction of the plane is special.
        if ((i + j) % 2 == 0) {
          add({at(0, 0), at(1, 0), at(1, 1)}, {z(0, 0), z(1, 0), z(1, 1)});
          add({at(0, 0), at(1, 1), at(0, 1)}, {z(0, 0), z(1, 1), z(0, 1)});
        } else {
          add({at(0, 0), at(1, 0), at(0, 1)}, {z(0, 0), z(1, 0), z(0, 1)});
          add({at(1, 0), at(1, 1), at(0, 1)}, {z(1, 0), z(1, 1), z(0, 1)});
        }
      }
    }
    for (std::uint32_t i = 0; i < nx; ++i) rim_.push_back(i);
    for (std::uint32_t j = 0; j < ny; ++j) rim_.push_back(j * (nx + 1) + nx);
    for (std::uint32_t i = nx; i > 0; --i) rim_.push_back(ny * (nx + 1) + i);
    for (std::uint32_t j = ny; j > 0; --j) rim_.push_back(j * (nx + 1));
  }

  void fan() {
    constexpr std::uint32_t sides = 360;
    top_height_ = s_.texels + 2 * plate_gutter;
    resize_texture(std::max(top_height_, wall_left(2)), top_height_ + 2 * (16 + 2 * plate_gutter));
    fill(0, 0, s_.texels, s_.texels,
         [&](double a, double b) { return fine(s_.half_x * (2.0 * a - 1.0), s_.half_x * (2.0 * b - 1.0)); });
    const auto z = [&](vertex k) {
      const vec3& p = model_.mesh.positions[k];
      return uv(0, 0, s_.texels, s_.texels, 0.5 + 0.5 * p.x / s_.half_x, 0.5 + 0.5 * p.y / s_.half_x);
    };
    const vertex centre = add_top(0.0, 0.0);
    for (std::uint32_t k = 0; k < sides; ++k) {
      const double t = 2.0 * std::numbers::pi * k / sides;
      rim_.push_back(add_top(s_.half_x * std::cos(t), s_.half_x * std::sin(t)));
    }
    for (std::uint32_t k = 0; k < sides; ++k) {
      const std::array<vertex, 3> v{centre, rim_[k], rim_[(k + 1) % sides]};
      add(v, {z(v[0]), z(v[1]), z(v[2])});
    }
  }

  void walls_and_bottom() {
    const std::uint32_t wall_low = top_height_, bottom_low = top_height_ + 16 + 2 * plate_gutter;
    const double reach = std::max(s_.half_x, s_.half_y);
    const std::size_t n = rim_.size();
    const auto rim_at = [&](std::size_t k) { return model_.mesh.positions[rim_[k % n]]; };
    const auto wall = [&](std::size_t k, double a, double b) {
      const vec3 top = glm::mix(rim_at(k), rim_at(k + 1), a);
      return vec3(top.x, top.y, -s_.thickness + b * (top.z + s_.thickness));
    };
    // A chart per wall keeps its corners sharp; the walls of a disc share one, which nothing looks at.
    const std::size_t charts = s_.disc ? 1 : n;
    for (std::size_t k = 0; k < charts; ++k) {
      fill(wall_left(k), wall_low, wall_texels, 16, [&](double a, double b) { return wall(k, a, b); });
    }
    fill(0, bottom_low, 16, 16,
         [&](double a, double b) { return vec3(reach * (2.0 * a - 1.0), reach * (2.0 * b - 1.0), -s_.thickness); });
    std::vector<vertex> low;
    for (std::size_t k = 0; k < n; ++k) {
      const vec3 p = rim_at(k);
      low.push_back(static_cast<vertex>(model_.mesh.positions.size()));
      model_.mesh.positions.emplace_back(p.x, p.y, -s_.thickness);
    }
    const auto centre = static_cast<vertex>(model_.mesh.positions.size());
    model_.mesh.positions.emplace_back(0.0, 0.0, -s_.thickness);
    for (std::size_t k = 0; k < n; ++k) {
      const std::size_t k1 = (k + 1) % n;
      const auto w = [&](double a, double b) {
        return uv(wall_left(s_.disc ? 0 : k), wall_low, wall_texels, 16, a, b);
      };
      add({low[k], low[k1], rim_[k1]}, {w(0, 0), w(1, 0), w(1, 1)});
      add({low[k], rim_[k1], rim_[k]}, {w(0, 0), w(1, 1), w(0, 1)});
      const auto f = [&](vertex v) {
        const vec3& p = model_.mesh.positions[v];
        return uv(0, bottom_low, 16, 16, 0.5 + 0.5 * p.x / reach, 0.5 + 0.5 * p.y / reach);
      };
      add({centre, low[k1], low[k]}, {f(centre), f(low[k1]), f(low[k])});
    }
  }

  const plate_spec& s_;
  textured_model model_;
  std::uint32_t top_height_ = 0;
  std::vector<vertex> rim_;  ///< of the top face, counter-clockwise from above
};

}  // namespace

model_ptr make_plate(const plate_spec& spec) { return plate_builder(spec).build(); }

}  // namespace asperity::test_support
