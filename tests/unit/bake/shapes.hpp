// Meshes by formula for the tests of the bake.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <numbers>
#include <random>
#include <vector>

#include "asperity/model/triangle_mesh.hpp"

namespace asperity::bake::shapes {

inline triangle_mesh tetrahedron(const vec3& at = vec3(0.0), double size = 0.1) {
  return {{at, at + vec3(size, 0, 0), at + vec3(0, size, 0), at + vec3(0, 0, size)},
          {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}},
          {}};
}

/// Box about the origin, every face a grid of cells[axis] cells, welded; moved(p) places the vertex at lattice point p.
inline triangle_mesh box(const vec3& size, const std::array<int, 3>& cells,
                         const std::function<vec3(vec3)>& moved = nullptr) {
  triangle_mesh mesh;
  std::map<std::array<int, 3>, std::uint32_t> number;
  const auto vertex = [&](const std::array<int, 3>& at) {
    const auto [entry, added] = number.try_emplace(at, static_cast<std::uint32_t>(mesh.positions.size()));
    if (added) {
      const vec3 unit{static_cast<double>(at[0]) / cells[0], static_cast<double>(at[1]) / cells[1],
                      static_cast<double>(at[2]) / cells[2]};
      const vec3 p = size * (unit - 0.5);
      mesh.positions.push_back(moved ? moved(p) : p);
    }
    return entry->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t u = (axis + 1) % 3;
    const std::size_t v = (axis + 2) % 3;
    for (const bool upper : {false, true})
      for (int i = 0; i < cells[u]; ++i)
        for (int j = 0; j < cells[v]; ++j) {
          const auto corner = [&](int di, int dj) {
            std::array<int, 3> at{};
            at[axis] = upper ? cells[axis] : 0;
            at[u] = i + di;
            at[v] = j + dj;
            return vertex(at);
          };
          const std::uint32_t a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
          if (upper) {
            mesh.triangles.push_back({a, b, c});
            mesh.triangles.push_back({a, c, d});
          } else {
            mesh.triangles.push_back({a, c, b});
            mesh.triangles.push_back({a, d, c});
          }
        }
  }
  return mesh;
}

/// Surface of the cells of a grid that are solid; grid[axis] are the planes between the cells. Welded.
/// @pre no two solid cells touch in an edge or a corner only
inline triangle_mesh cells(const std::array<std::vector<double>, 3>& grid,
                           const std::function<bool(const std::array<int, 3>&)>& solid) {
  triangle_mesh mesh;
  std::map<std::array<int, 3>, std::uint32_t> number;
  const auto count = [&](std::size_t axis) { return static_cast<int>(grid[axis].size()) - 1; };
  const auto is_solid = [&](const std::array<int, 3>& c) {
    for (std::size_t k = 0; k < 3; ++k)
      if (c[k] < 0 || c[k] >= count(k)) return false;
    return solid(c);
  };
  const auto vertex = [&](const std::array<int, 3>& at) {
    const auto [entry, added] = number.try_emplace(at, static_cast<std::uint32_t>(mesh.positions.size()));
    const auto plane = [&](std::size_t k) { return grid[k][static_cast<std::size_t>(at[k])]; };
    if (added) mesh.positions.emplace_back(plane(0), plane(1), plane(2));
    return entry->second;
  };
  const auto wall = [&](const std::array<int, 3>& cell, std::size_t axis, bool upper) {
    std::array<std::uint32_t, 4> ring{};
    for (std::size_t i = 0; i < 4; ++i) {
      std::array<int, 3> at = cell;
      at[axis] += upper ? 1 : 0;
      at[(axis + 1) % 3] += i == 1 || i == 2 ? 1 : 0;
      at[(axis + 2) % 3] += i >= 2 ? 1 : 0;
      ring[upper ? i : 3 - i] = vertex(at);
    }
    mesh.triangles.push_back({ring[0], ring[1], ring[2]});
    mesh.triangles.push_back({ring[0], ring[2], ring[3]});
  };
  std::array<int, 3> c{};
  for (c[0] = 0; c[0] < count(0); ++c[0])
    for (c[1] = 0; c[1] < count(1); ++c[1])
      for (c[2] = 0; c[2] < count(2); ++c[2])
        for (std::size_t axis = 0; axis < 3 && is_solid(c); ++axis)
          for (const bool upper : {false, true}) {
            std::array<int, 3> beside = c;
            beside[axis] += upper ? 1 : -1;
            if (!is_solid(beside)) wall(c, axis, upper);
          }
  return mesh;
}

/// Torus about z whose tube radius varies by a product of two sines.
struct wavy_torus {
  double major_m = 0.05;
  double minor_m = 0.02;
  double amplitude_m = 0.0005;
  int waves_around = 20;
  int waves_across = 8;

  [[nodiscard]] double tube(double u, double v) const {
    return minor_m + amplitude_m * std::sin(waves_around * u) * std::sin(waves_across * v);
  }

  /// Distance of p from the surface along the radius of the tube: no less than its distance.
  [[nodiscard]] double radial_offset(const vec3& p) const {
    const double from_axis = std::hypot(p.x, p.y) - major_m;
    return std::hypot(from_axis, p.z) - tube(std::atan2(p.y, p.x), std::atan2(p.z, from_axis));
  }

  [[nodiscard]] triangle_mesh mesh(std::uint32_t around, std::uint32_t across) const {
    triangle_mesh out;
    for (std::uint32_t i = 0; i < around; ++i)
      for (std::uint32_t j = 0; j < across; ++j) {
        const double u = 2.0 * std::numbers::pi * i / around;
        const double v = 2.0 * std::numbers::pi * j / across;
        const double d = tube(u, v);
        out.positions.emplace_back((major_m + d * std::cos(v)) * std::cos(u), (major_m + d * std::cos(v)) * std::sin(u),
                                   d * std::sin(v));
        const std::uint32_t i1 = (i + 1) % around, j1 = (j + 1) % across;
        out.triangles.push_back({i * across + j, i1 * across + j, i1 * across + j1});
        out.triangles.push_back({i * across + j, i1 * across + j1, i * across + j1});
      }
    return out;
  }
};

/// The two meshes as one, without a common vertex.
inline triangle_mesh both(const triangle_mesh& a, const triangle_mesh& b) {
  triangle_mesh out = a;
  const auto base = static_cast<std::uint32_t>(a.positions.size());
  out.positions.insert(out.positions.end(), b.positions.begin(), b.positions.end());
  for (const auto& t : b.triangles) out.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
  return out;
}

inline triangle_mesh reversed(triangle_mesh mesh) {
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

inline triangle_mesh scaled(triangle_mesh mesh, double factor, const vec3& shift = vec3(0.0)) {
  for (vec3& p : mesh.positions) p = factor * p + shift;
  return mesh;
}

/// Uniform numbers that are the same everywhere.
class dice {
 public:
  explicit dice(std::uint64_t seed) : bits_(seed) {}
  double operator()(double low = 0.0, double high = 1.0) {
    return low + (high - low) * static_cast<double>(bits_() >> 11) * 0x1p-53;
  }
  std::array<double, 3> barycentric() {
    const double a = (*this)();
    const double b = (*this)();
    return a + b <= 1.0 ? std::array{1.0 - a - b, a, b} : std::array{a + b - 1.0, 1.0 - a, 1.0 - b};
  }
  std::size_t below(std::size_t n) { return static_cast<std::size_t>((*this)() * static_cast<double>(n)); }

 private:
  std::mt19937_64 bits_;
};

}  // namespace asperity::bake::shapes
