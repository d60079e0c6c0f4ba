// Models without texture for tests of the collision room: a coarse mesh cut into convex pieces in a stated way.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "asperity/model/textured_model.hpp"

namespace asperity::test {

/// How a mesh is cut into pieces.
enum class cut_into {
  one_piece,   ///< the whole mesh is one convex piece
  triangles,   ///< every triangle is a flat piece of its own
  flat_faces,  ///< connected coplanar triangles are one flat piece; right for convex faces only
};

namespace detail {

/// For every triangle, the lowest index among the triangles of its flat face.
inline std::vector<std::uint32_t> flat_faces_of(const coarse_mesh& mesh) {
  const std::size_t count = mesh.triangles.size();
  std::vector<std::uint32_t> face(count);
  for (std::uint32_t t = 0; t < count; ++t) face[t] = t;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> edges;
  for (bool changed = true; changed;) {
    changed = false;
    edges.clear();
    for (std::uint32_t t = 0; t < count; ++t) {
      const vec3 n = glm::normalize(area_normal(corners(mesh, t)));
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = mesh.triangles[t].vertex[k];
        const std::uint32_t b = mesh.triangles[t].vertex[(k + 1) % 3];
        const auto [it, fresh] = edges.try_emplace({std::min(a, b), std::max(a, b)}, t);
        if (fresh) continue;
        const std::uint32_t other = it->second;
        if (glm::dot(n, glm::normalize(area_normal(corners(mesh, other)))) < 1.0 - 1e-9) continue;
        if (face[t] != face[other]) {
          face[t] = face[other] = std::min(face[t], face[other]);
          changed = true;
        }
      }
    }
  }
  return face;
}

inline convex_piece piece_of(const coarse_mesh& mesh, std::vector<std::uint32_t> triangles, bool flat) {
  convex_piece p;
  p.flat = flat;
  std::map<std::uint32_t, std::uint32_t> index;
  for (const std::uint32_t t : triangles) {
    std::array<std::uint32_t, 3> face{};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.triangles[t].vertex[k];
      const auto [it, fresh] = index.try_emplace(v, static_cast<std::uint32_t>(p.vertices.size()));
      if (fresh) p.vertices.push_back(mesh.positions[v]);
      face[k] = it->second;
    }
    p.hull.push_back(face);
  }
  p.triangles = std::move(triangles);
  return p;
}

}  // namespace detail

/// A model of this mesh, with pieces, mass and box, and an empty texture.
/// @pre one_piece needs a convex mesh
[[nodiscard]] inline model_ptr make_piece_model(coarse_mesh mesh, cut_into how) {
  auto m = std::make_shared<textured_model>();
  m->mesh = std::move(mesh);
  const auto count = static_cast<std::uint32_t>(m->mesh.triangles.size());
  if (how == cut_into::one_piece) {
    std::vector<std::uint32_t> all(count);
    for (std::uint32_t t = 0; t < count; ++t) all[t] = t;
    m->pieces.push_back(detail::piece_of(m->mesh, all, false));
  } else if (how == cut_into::triangles) {
    for (std::uint32_t t = 0; t < count; ++t) m->pieces.push_back(detail::piece_of(m->mesh, {t}, true));
  } else {
    const auto face = detail::flat_faces_of(m->mesh);
    for (std::uint32_t t = 0; t < count; ++t) {
      if (face[t] != t) continue;
      std::vector<std::uint32_t> members;
      for (std::uint32_t k = 0; k < count; ++k) {
        if (face[k] == t) members.push_back(k);
      }
      m->pieces.push_back(detail::piece_of(m->mesh, members, true));
    }
  }
  m->mass = compute_mass_properties(m->mesh);
  m->box = {m->mesh.positions.front(), m->mesh.positions.front()};
  for (const vec3& p : m->mesh.positions) m->box = {glm::min(m->box.low, p), glm::max(m->box.high, p)};
  return m;
}

/// Box about the origin, every face a grid of `cells` x `cells` squares of two triangles.
[[nodiscard]] inline coarse_mesh box_mesh(const vec3& half, std::uint32_t cells = 1) {
  coarse_mesh mesh;
  std::map<std::array<std::uint32_t, 3>, std::uint32_t> index;
  const auto vertex = [&](const std::array<std::uint32_t, 3>& at) {
    const auto [it, fresh] = index.try_emplace(at, static_cast<std::uint32_t>(mesh.positions.size()));
    if (fresh) {
      const vec3 share = vec3(at[0], at[1], at[2]) / static_cast<double>(cells);
      mesh.positions.push_back((2.0 * share - 1.0) * half);
    }
    return it->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const bool top : {false, true}) {
      for (std::uint32_t i = 0; i < cells; ++i) {
        for (std::uint32_t j = 0; j < cells; ++j) {
          const auto corner = [&](std::uint32_t di, std::uint32_t dj) {
            std::array<std::uint32_t, 3> at{};
            at[axis] = top ? cells : 0;
            at[(axis + 1) % 3] = i + di;
            at[(axis + 2) % 3] = j + dj;
            return vertex(at);
          };
          const std::uint32_t a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
          coarse_triangle first, second;
          first.vertex = top ? std::array{a, b, c} : std::array{a, c, b};
          second.vertex = top ? std::array{a, c, d} : std::array{a, d, c};
          mesh.triangles.push_back(first);
          mesh.triangles.push_back(second);
        }
      }
    }
  }
  return mesh;
}

/// Right prism over a star-shaped polygon about (0, 0), counter-clockwise in x and y, from z = -half_z to half_z.
[[nodiscard]] inline coarse_mesh prism_mesh(const std::vector<vec2>& outline, double half_z) {
  coarse_mesh mesh;
  const auto n = static_cast<std::uint32_t>(outline.size());
  for (const double z : {-half_z, half_z}) {
    for (const vec2& p : outline) mesh.positions.emplace_back(p.x, p.y, z);
  }
  mesh.positions.emplace_back(0.0, 0.0, -half_z);
  mesh.positions.emplace_back(0.0, 0.0, half_z);
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    coarse_triangle t;
    t.vertex = {a, b, c};
    mesh.triangles.push_back(t);
  };
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    add(i, j, n + j);
    add(i, n + j, n + i);
    add(2 * n, j, i);
    add(2 * n + 1, n + i, n + j);
  }
  return mesh;
}

/// Regular polygon for prism_mesh; a corner lies at `phase` radians from +x.
[[nodiscard]] inline std::vector<vec2> regular_polygon(std::uint32_t corners, double radius, double phase = 0.0) {
  std::vector<vec2> out;
  for (std::uint32_t i = 0; i < corners; ++i) {
    const double a = phase + 2.0 * std::numbers::pi * i / corners;
    out.push_back(radius * vec2(std::cos(a), std::sin(a)));
  }
  return out;
}

/// Torus about z, `around` x `across` quadrilaterals of two triangles.
[[nodiscard]] inline coarse_mesh torus_mesh(double major, double minor, std::uint32_t around, std::uint32_t across) {
  coarse_mesh mesh;
  for (std::uint32_t i = 0; i < around; ++i) {
    const double a = 2.0 * std::numbers::pi * i / around;
    for (std::uint32_t j = 0; j < across; ++j) {
      const double b = 2.0 * std::numbers::pi * j / across;
      const double r = major + minor * std::cos(b);
      mesh.positions.emplace_back(r * std::cos(a), r * std::sin(a), minor * std::sin(b));
    }
  }
  for (std::uint32_t i = 0; i < around; ++i) {
    for (std::uint32_t j = 0; j < across; ++j) {
      const auto at = [&](std::uint32_t di, std::uint32_t dj) {
        return (i + di) % around * across + (j + dj) % across;
      };
      coarse_triangle first, second;
      first.vertex = {at(0, 0), at(1, 0), at(1, 1)};
      second.vertex = {at(0, 0), at(1, 1), at(0, 1)};
      mesh.triangles.push_back(first);
      mesh.triangles.push_back(second);
    }
  }
  return mesh;
}

}  // namespace asperity::test
