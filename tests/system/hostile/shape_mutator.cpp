#include "shape_mutator.hpp"

#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>

namespace asperity::hostile {
namespace {

using mesh = triangle_mesh;

std::size_t any_triangle(const mesh& m, random_source& random) { return random.below(m.triangles.size()); }
vec3& any_position(mesh& m, random_source& random) { return m.positions[random.below(m.positions.size())]; }

void append(mesh& to, const mesh& other, double scale, const vec3& shift, bool inside_out) {
  const auto base = static_cast<std::uint32_t>(to.positions.size());
  for (const vec3& p : other.positions) to.positions.push_back(scale * p + shift);
  for (const auto& t : other.triangles) {
    to.triangles.push_back(inside_out ? std::array{t[0] + base, t[2] + base, t[1] + base}
                                      : std::array{t[0] + base, t[1] + base, t[2] + base});
  }
}

void turn(mesh& m, std::size_t triangle) { std::swap(m.triangles[triangle][1], m.triangles[triangle][2]); }

void put_number(mesh& m, random_source& random, double number) {
  vec3& p = m.positions[m.triangles[any_triangle(m, random)][random.below(3)]];
  p[static_cast<glm::length_t>(random.below(3))] = number;
}

// Joins two balls in one vertex.
void touch_in_a_point(mesh& m) {
  const mesh other = m;
  const std::size_t top = 0;
  append(m, other, -1.0, 2.0 * m.positions[top], true);
  const auto twin = static_cast<std::uint32_t>(other.positions.size() + top);
  for (auto& t : m.triangles)
    for (auto& v : t) v = v == twin ? static_cast<std::uint32_t>(top) : v;
}

constexpr double infinity = std::numeric_limits<double>::infinity();

std::vector<planted_fault> make_faults() {
  const std::vector<std::string> not_finite{"not a number", "not finite", "NaN", "infinite", "number"};
  return {
      {"nothing at all", [](mesh&, random_source&) {}, {}, true},
      {"one triangle", [](mesh& m, random_source&) { m.triangles.resize(1); }, {"1 triangle", "not closed"}},
      {"no triangle", [](mesh& m, random_source&) { m.triangles.clear(); }, {"no ", "empty", "without", "0"}},
      {"NaN", [](mesh& m, random_source& r) { put_number(m, r, std::nan("")); }, not_finite},
      {"infinity", [](mesh& m, random_source& r) { put_number(m, r, infinity); }, not_finite},
      {"minus infinity", [](mesh& m, random_source& r) { put_number(m, r, -infinity); }, not_finite},
      {"1e30 m", [](mesh& m, random_source& r) { put_number(m, r, 1e30); }, {"mix-up of units", "too large", "single"}},
      {"1e300 m", [](mesh& m, random_source& r) { put_number(m, r, 1e300); }, {"units", "not finite", "number"}},
      {"a micrometre across",
       [](mesh& m, random_source&) {
         for (vec3& p : m.positions) p *= 1e-5;
       },
       {"too small to be felt"}},
      {"millimetres",
       [](mesh& m, random_source&) {
         for (vec3& p : m.positions) p *= 1e5;
       },
       {"mix-up of units"}},
      {"far from the origin",
       [](mesh& m, random_source&) {
         for (vec3& p : m.positions) p += vec3(100.0);
       },
       {"move it to the origin", "without area", "more than two triangles"}},
      {"two vertices in one place",
       [](mesh& m, random_source& r) {
         const auto t = m.triangles[any_triangle(m, r)];
         m.positions[t[0]] = m.positions[t[1]];
       },
       {"without area", "not closed", "more than two triangles", "surfaces touch"}},
      {"three vertices on a line",
       [](mesh& m, random_source& r) {
         const auto t = m.triangles[any_triangle(m, r)];
         m.positions[t[2]] = m.positions[t[0]];
       },
       {"without area", "not closed", "more than two triangles", "surfaces touch"}},
      {"flattened",
       [](mesh& m, random_source&) {
         for (vec3& p : m.positions) p.z = 0.0;
       },
       {"encloses no volume", "without area", "more than two triangles"}},
      {"the same face twice",
       [](mesh& m, random_source& r) { m.triangles.push_back(m.triangles[any_triangle(m, r)]); },
       {"more than two triangles"}},
      {"every face twice",
       [](mesh& m, random_source&) {
         const auto once = m.triangles;
         m.triangles.insert(m.triangles.end(), once.begin(), once.end());
       },
       {"more than two triangles"}},
      {"a fin on an edge",
       [](mesh& m, random_source& r) {
         const auto t = m.triangles[any_triangle(m, r)];
         m.positions.emplace_back(0.1, 0.2, 0.3);
         m.triangles.push_back({t[0], t[1], static_cast<std::uint32_t>(m.positions.size() - 1)});
       },
       {"more than two triangles"}},
      {"balls that touch in a point", [](mesh& m, random_source&) { touch_in_a_point(m); }, {"touch in a point"}},
      {"a missing face",
       [](mesh& m, random_source& r) {
         m.triangles.erase(m.triangles.begin() + static_cast<std::ptrdiff_t>(any_triangle(m, r)));
       },
       {"3 open edges"}},
      {"inside-out",
       [](mesh& m, random_source&) {
         for (std::size_t t = 0; t < m.triangles.size(); ++t) turn(m, t);
       },
       {"was inside-out and has been turned"},
       true},
      {"one triangle turned",
       [](mesh& m, random_source& r) { turn(m, any_triangle(m, r)); },
       {"1 triangle was wound against its neighbours"},
       true},
      {"every third turned",
       [](mesh& m, random_source&) {
         for (std::size_t t = 0; t < m.triangles.size(); t += 3) turn(m, t);
       },
       {"were wound against their neighbours and have been turned"},
       true},
      {"two balls",
       [](mesh& m, random_source&) {
         append(m, mesh(m), 0.5, {0.2, 0.0, 0.0}, false);
       },
       {},
       true},
      {"a cavity", [](mesh& m, random_source&) { append(m, mesh(m), 0.5, vec3(0.0), true); }, {}, true},
      {"two balls through each other",
       [](mesh& m, random_source&) {
         append(m, mesh(m), 0.8, {0.04, 0.001, 0.002}, false);
       },
       {"pairs of triangles cross"},
       true},
      {"two balls, one inside-out",
       [](mesh& m, random_source&) {
         append(m, mesh(m), 0.5, {0.2, 0.0, 0.0}, true);
       },
       {"component that is inside-out"}},
      {"an index past the end",
       [](mesh& m, random_source& r) { m.triangles[any_triangle(m, r)][r.below(3)] = 0x7fffffff; },
       {"vertex", "index", "indices"},
       false,
       true},
  };
}

}  // namespace

triangle_mesh good_ball() {
  // Rings between two poles.
  constexpr std::uint32_t rings = 8, around = 14;
  mesh out;
  const auto at = [](double theta, double phi) {
    const double r = 0.05 * (1.0 + 0.02 * std::sin(5 * phi) * std::sin(4 * theta));
    return r * vec3(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
  };
  out.positions.push_back(at(0.0, 0.0));
  for (std::uint32_t i = 1; i < rings; ++i)
    for (std::uint32_t j = 0; j < around; ++j)
      out.positions.push_back(at(std::numbers::pi * i / rings, 2 * std::numbers::pi * j / around));
  out.positions.push_back(at(std::numbers::pi, 0.0));
  const auto last = static_cast<std::uint32_t>(out.positions.size() - 1);
  const auto ring = [&](std::uint32_t i, std::uint32_t j) { return 1 + (i - 1) * around + j % around; };
  for (std::uint32_t j = 0; j < around; ++j) {
    out.triangles.push_back({0, ring(1, j), ring(1, j + 1)});
    for (std::uint32_t i = 1; i + 1 < rings; ++i) {
      out.triangles.push_back({ring(i, j), ring(i + 1, j), ring(i + 1, j + 1)});
      out.triangles.push_back({ring(i, j), ring(i + 1, j + 1), ring(i, j + 1)});
    }
    out.triangles.push_back({last, ring(rings - 1, j + 1), ring(rings - 1, j)});
  }
  return out;
}

const std::vector<planted_fault>& planted_faults() {
  static const std::vector<planted_fault> all = make_faults();
  return all;
}

triangle_mesh mutated_shape(const triangle_mesh& good, random_source& random) {
  mesh out = good;
  for (std::size_t changes = 1 + random.below(3); changes > 0; --changes) {
    if (out.triangles.empty() || out.positions.empty()) break;
    const auto amount = [&] { return (static_cast<double>(random.below(2001)) - 1000.0) * 1e-4; };
    switch (random.below(8)) {
      case 0:
        out.triangles[any_triangle(out, random)][random.below(3)] =
            static_cast<std::uint32_t>(random.below(out.positions.size()));
        break;
      case 1:  // a spike, often right through the other side
        any_position(out, random) *= 30.0 * amount();
        break;
      case 2:
        any_position(out, random) += vec3(amount(), amount(), amount());
        break;
      case 3:  // a copy that cuts through
        append(out, mesh(out), 0.5 + 5.0 * std::abs(amount()), vec3(amount(), amount(), amount()), random.once_in(2));
        break;
      case 4: {
        const vec3 squeeze{1.0, 1.0, amount() * std::pow(10.0, -static_cast<double>(random.below(8)))};
        for (vec3& p : out.positions) p *= squeeze;
        break;
      }
      case 5:
        std::swap(out.positions[random.below(out.positions.size())], any_position(out, random));
        break;
      default: {
        const planted_fault& fault = random.one_of(planted_faults());
        fault.plant(out, random);
        if (fault.needs_indices) return out;  // the changes above follow indices
      }
    }
    if (out.triangles.size() > 2000) break;
  }
  return out;
}

}  // namespace asperity::hostile
