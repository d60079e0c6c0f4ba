// Polyhedra with flat faces, and textured models of them: bodies whose contacts can be told by hand.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "asperity/core/math.hpp"
#include "asperity/model/textured_model.hpp"

namespace asperity::contacts_test {

/// A closed surface of plane polygons, in metres.
struct polyhedron {
  using loop = std::vector<std::uint32_t>;  ///< corners, counter-clockwise from outside; need not be convex
  std::vector<vec3> positions;
  std::vector<loop> faces;

  /// Adds a face; corners nearer than a nanometre to one that is there already are that one.
  void add(const std::vector<vec3>& corners) {
    loop face;
    for (const vec3& p : corners) {
      std::uint32_t v = 0;
      while (v < positions.size() && glm::length(positions[v] - p) > 1e-9) ++v;
      if (v == positions.size()) positions.push_back(p);
      face.push_back(v);
    }
    faces.push_back(std::move(face));
  }
};

/// Prism along y over a simple polygon in x and z, given in either sense. @pre y0 < y1
[[nodiscard]] inline polyhedron prism(std::vector<vec2> outline_xz, double y0, double y1) {
  double twice_area = 0.0;
  for (std::size_t i = 0; i < outline_xz.size(); ++i) {
    const vec2 &p = outline_xz[i], &q = outline_xz[(i + 1) % outline_xz.size()];
    twice_area += p.x * q.y - q.x * p.y;
  }
  if (twice_area < 0.0) std::reverse(outline_xz.begin(), outline_xz.end());
  const auto at = [](const vec2& p, double y) { return vec3(p.x, y, p.y); };
  polyhedron out;
  std::vector<vec3> near_cap, far_cap;
  for (std::size_t i = 0; i < outline_xz.size(); ++i) {
    const vec2 &p = outline_xz[i], &q = outline_xz[(i + 1) % outline_xz.size()];
    out.add({at(p, y0), at(p, y1), at(q, y1), at(q, y0)});
    near_cap.push_back(at(p, y0));
    far_cap.push_back(at(p, y1));
  }
  std::reverse(far_cap.begin(), far_cap.end());
  out.add(near_cap);
  out.add(far_cap);
  return out;
}

[[nodiscard]] inline polyhedron box(const vec3& low, const vec3& high) {
  return prism({{low.x, low.z}, {high.x, low.z}, {high.x, high.z}, {low.x, high.z}}, low.y, high.y);
}

/// Corners of a regular polygon whose first side is halved by the x axis.
[[nodiscard]] inline std::vector<vec2> regular_polygon(std::size_t corners, double radius) {
  std::vector<vec2> out;
  for (std::size_t i = 0; i < corners; ++i) {
    const double a = 2.0 * std::numbers::pi * (static_cast<double>(i) + 0.5) / static_cast<double>(corners);
    out.push_back(radius * vec2(std::cos(a), std::sin(a)));
  }
  return out;
}

/// Prism along y over a ring: a hole that is open at both ends. @pre inner.size() == outer.size(), both
/// counter-clockwise in x and z
[[nodiscard]] inline polyhedron tube(const std::vector<vec2>& inner, const std::vector<vec2>& outer, double y0,
                                     double y1) {
  const auto at = [](const vec2& p, double y) { return vec3(p.x, y, p.y); };
  polyhedron out;
  for (std::size_t i = 0; i < inner.size(); ++i) {
    const std::size_t j = (i + 1) % inner.size();
    out.add({at(outer[i], y0), at(outer[i], y1), at(outer[j], y1), at(outer[j], y0)});
    out.add({at(inner[j], y0), at(inner[j], y1), at(inner[i], y1), at(inner[i], y0)});
    out.add({at(inner[i], y1), at(inner[j], y1), at(outer[j], y1), at(outer[i], y1)});
    out.add({at(inner[j], y0), at(inner[i], y0), at(outer[i], y0), at(outer[j], y0)});
  }
  return out;
}

/// A cube without one octant: three square faces of side `inner` that look into the corner at the origin, `wall` thick.
[[nodiscard]] inline polyhedron hollow_corner(double inner, double wall) {
  polyhedron out;
  for (int axis = 0; axis < 3; ++axis) {
    const auto at = [&](double along, double u, double v) {
      vec3 p;
      p[axis] = along;
      p[(axis + 1) % 3] = u;
      p[(axis + 2) % 3] = v;
      return p;
    };
    const double a = inner, w = -wall;
    out.add({at(0, 0, 0), at(0, a, 0), at(0, a, a), at(0, 0, a)});
    out.add({at(w, w, w), at(w, w, a), at(w, a, a), at(w, a, w)});
    out.add({at(a, w, w), at(a, a, w), at(a, a, 0), at(a, 0, 0), at(a, 0, a), at(a, w, a)});
  }
  return out;
}

/// Height of the fine surface over the coarse point, along the face's normal, metres; body frame.
using relief = std::function<double(const vec3& point, const vec3& normal)>;

/// How the coarse surface is cut into convex pieces. Only the paper's formulation looks at it.
enum class cut_into {
  whole,      ///< one piece. @pre the polyhedron is convex
  triangles,  ///< each coarse triangle is a flat piece
};

/// How a polyhedron becomes a textured model.
struct model_plan {
  double texel_m = 0.3e-3;     ///< distance between texels
  std::uint32_t halvings = 0;  ///< how often every triangle is cut in four
  cut_into pieces = cut_into::triangles;
  relief height;  ///< none: the texture repeats the faces
};

namespace detail {

/// Chart of one face: a rectangle of the texture, laid on the face's plane.
struct face_chart {
  static constexpr double gutter = 4.0;  ///< texels around the face that carry its plane and relief on

  vec3 origin, u, v, n;
  vec2 low{std::numeric_limits<double>::max()}, high{std::numeric_limits<double>::lowest()};  ///< on the plane, metres
  std::uint32_t width = 0, height = 0;
  std::uint32_t left = 0, bottom = 0;  ///< in the texture

  face_chart(const polyhedron& body, const polyhedron::loop& face, double texel_m) {
    vec3 sum(0.0);
    for (std::size_t i = 0; i < face.size(); ++i) {
      sum += glm::cross(body.positions[face[i]], body.positions[face[(i + 1) % face.size()]]);
    }
    n = glm::normalize(sum);
    origin = body.positions[face[0]];
    u = glm::normalize(body.positions[face[1]] - origin);
    v = glm::cross(n, u);
    for (const std::uint32_t c : face) {
      low = glm::min(low, on_plane(body.positions[c]));
      high = glm::max(high, on_plane(body.positions[c]));
    }
    const auto texels = [&](double length) {
      return static_cast<std::uint32_t>(std::ceil(length / texel_m - 1e-9) + 2.0 * gutter);
    };
    width = texels(high.x - low.x);
    height = texels(high.y - low.y);
  }

  [[nodiscard]] vec2 on_plane(const vec3& p) const { return {glm::dot(u, p - origin), glm::dot(v, p - origin)}; }
};

/// Corners of the triangles of a polygon: the best-shaped ear is cut off until one triangle is left.
inline std::vector<std::array<std::uint32_t, 3>> triangulate(const polyhedron& body, polyhedron::loop rest,
                                                             const face_chart& plane) {
  const auto at = [&](std::uint32_t c) { return plane.on_plane(body.positions[c]); };
  const auto turn = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const vec2 p = at(b) - at(a), q = at(c) - at(a);
    return p.x * q.y - p.y * q.x;
  };
  const auto shape = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    return turn(a, b, c) /
           std::max({glm::length(at(a) - at(b)), glm::length(at(b) - at(c)), glm::length(at(c) - at(a))});
  };
  constexpr double flat = 1e-9;  // metres of height: three corners on a line make no triangle
  std::vector<std::array<std::uint32_t, 3>> out;
  while (rest.size() > 3) {
    const std::size_t n = rest.size();
    std::size_t best = 0;
    double best_shape = -1.0;
    const auto is_line_without = [&](std::size_t ear) {
      double all = 0.0;
      for (std::size_t i = 1; i + 1 < n; ++i) all += turn(rest[0], rest[i], rest[i + 1]);
      const double left = all - turn(rest[ear], rest[(ear + 1) % n], rest[(ear + 2) % n]);
      return left < 1e-6 * all;
    };
    for (std::size_t i = 0; i < n; ++i) {
      const std::uint32_t a = rest[i], b = rest[(i + 1) % n], c = rest[(i + 2) % n];
      const double own = shape(a, b, c);
      const bool holds_another = std::any_of(rest.begin(), rest.end(), [&](std::uint32_t d) {
        return d != a && d != b && d != c && turn(a, b, d) >= 0.0 && turn(b, c, d) >= 0.0 && turn(c, a, d) >= 0.0;
      });
      if (own > best_shape && own > flat && !holds_another && !is_line_without(i)) {
        best_shape = own;
        best = i;
      }
    }
    out.push_back({rest[best], rest[(best + 1) % n], rest[(best + 2) % n]});
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>((best + 1) % n));
  }
  out.push_back({rest[0], rest[1], rest[2]});
  return out;
}

}  // namespace detail

/// A model with one chart per face and several texels of gutter; texels of no face are NaN.
[[nodiscard]] inline model_ptr make_model(const polyhedron& body, const model_plan& plan) {
  auto model = std::make_shared<textured_model>();
  model->mesh.positions = body.positions;

  // Charts side by side on shelves, the tallest first.
  std::vector<detail::face_chart> charts;
  double texels = 0.0;
  std::uint32_t width = 0;
  for (const polyhedron::loop& face : body.faces) {
    charts.emplace_back(body, face, plan.texel_m);
    texels += static_cast<double>(charts.back().width) * charts.back().height;
    width = std::max(width, charts.back().width);
  }
  width = std::max(width, static_cast<std::uint32_t>(1.1 * std::sqrt(texels)));
  std::vector<std::size_t> order(charts.size());
  for (std::size_t f = 0; f < order.size(); ++f) order[f] = f;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return charts[a].height > charts[b].height; });
  std::uint32_t left = 0, bottom = 0, top = 0;
  for (const std::size_t f : order) {
    detail::face_chart& c = charts[f];
    if (left + c.width > width) {
      left = 0;
      bottom = top;
    }
    c.left = left;
    c.bottom = bottom;
    left += c.width;
    top = std::max(top, bottom + c.height);
  }
  model->texture.width = width;
  model->texture.height = top;
  model->texture.texels.assign(std::size_t{width} * top, glm::vec3(std::numeric_limits<float>::quiet_NaN()));

  for (std::size_t f = 0; f < charts.size(); ++f) {
    const detail::face_chart& c = charts[f];
    const auto uv = [&](const vec3& p) {
      const vec2 t = (c.on_plane(p) - c.low) / plan.texel_m + c.gutter;
      return vec2((c.left + t.x) / width, (c.bottom + t.y) / top);
    };
    for (const auto& t : detail::triangulate(body, body.faces[f], c)) {
      coarse_triangle triangle;
      triangle.vertex = t;
      for (std::size_t k = 0; k < 3; ++k) triangle.uv[k] = uv(body.positions[t[k]]);
      model->mesh.triangles.push_back(triangle);
    }
    for (std::uint32_t j = 0; j < c.height; ++j) {
      for (std::uint32_t i = 0; i < c.width; ++i) {
        const vec2 t = c.low + plan.texel_m * (vec2(i, j) + 0.5 - c.gutter);
        const vec3 p = c.origin + t.x * c.u + t.y * c.v;
        const double h = plan.height ? plan.height(p, c.n) : 0.0;
        model->texture.texels[std::size_t{c.bottom + j} * width + c.left + i] = glm::vec3(p + h * c.n);
      }
    }
  }

  for (std::uint32_t n = 0; n < plan.halvings; ++n) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    std::vector<coarse_triangle> cut;
    for (const coarse_triangle& t : model->mesh.triangles) {
      coarse_triangle inner;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = t.vertex[k], b = t.vertex[(k + 1) % 3];
        const auto [it, fresh] = middles.try_emplace({std::min(a, b), std::max(a, b)},
                                                     static_cast<std::uint32_t>(model->mesh.positions.size()));
        if (fresh) model->mesh.positions.push_back(0.5 * (model->mesh.positions[a] + model->mesh.positions[b]));
        inner.vertex[k] = it->second;
        inner.uv[k] = 0.5 * (t.uv[k] + t.uv[(k + 1) % 3]);
      }
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t before = (k + 2) % 3;
        cut.push_back({{t.vertex[k], inner.vertex[k], inner.vertex[before]}, {t.uv[k], inner.uv[k], inner.uv[before]}});
      }
      cut.push_back(inner);
    }
    model->mesh.triangles = std::move(cut);
  }

  const auto count = static_cast<std::uint32_t>(model->mesh.triangles.size());
  if (plan.pieces == cut_into::whole) {
    convex_piece whole;
    whole.vertices = model->mesh.positions;
    for (std::uint32_t t = 0; t < count; ++t) {
      whole.hull.push_back(model->mesh.triangles[t].vertex);
      whole.triangles.push_back(t);
    }
    model->pieces.push_back(std::move(whole));
  } else {
    for (std::uint32_t t = 0; t < count; ++t) {
      const auto c = corners(model->mesh, t);
      model->pieces.push_back({{c.begin(), c.end()}, {{0, 1, 2}}, {t}, true});
    }
  }
  model->mass = compute_mass_properties(model->mesh);
  model->box = {body.positions.front(), body.positions.front()};
  for (const vec3& p : body.positions) model->box = {glm::min(model->box.low, p), glm::max(model->box.high, p)};
  model->report.full_triangles = count;
  model->report.texels = model->texture.texels.size();
  return model;
}

}  // namespace asperity::contacts_test
