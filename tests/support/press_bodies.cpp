#include "support/press_bodies.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

#include "asperity/bake/bake.hpp"
#include "asperity/io/textured_model_file.hpp"

namespace asperity::test_support {
namespace {

constexpr double mm = 1e-3;
constexpr double pi = std::numbers::pi;
constexpr double whole = std::numeric_limits<double>::infinity();  // edges may be as long as the shape allows

std::uint32_t index(std::size_t i) { return static_cast<std::uint32_t>(i); }

std::size_t parts(double length, double longest) {
  return length > longest ? static_cast<std::size_t>(std::ceil(length / longest - 1e-9)) : 1;
}

/// Points that coincide become one vertex.
class welder {
 public:
  std::uint32_t operator()(const vec3& p) {
    const std::array<long, 3> key{std::lround(p.x / nearest_m), std::lround(p.y / nearest_m),
                                  std::lround(p.z / nearest_m)};
    const auto [at, is_new] = known_.try_emplace(key, index(mesh.positions.size()));
    if (is_new) mesh.positions.push_back(p);
    return at->second;
  }
  void triangle(const vec3& a, const vec3& b, const vec3& c) {
    const std::array<std::uint32_t, 3> t{(*this)(a), (*this)(b), (*this)(c)};
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) mesh.triangles.push_back(t);
  }
  /// Of four corners, counter-clockwise seen from outside, in a grid of m by n.
  void quad(const vec3& a, const vec3& b, const vec3& c, const vec3& d, std::size_t m, std::size_t n) {
    const auto at = [&](std::size_t i, std::size_t j) {
      const double u = static_cast<double>(i) / static_cast<double>(m),
                   v = static_cast<double>(j) / static_cast<double>(n);
      return (1.0 - v) * ((1.0 - u) * a + u * b) + v * ((1.0 - u) * d + u * c);
    };
    for (std::size_t i = 0; i < m; ++i) {
      for (std::size_t j = 0; j < n; ++j) {
        triangle(at(i, j), at(i + 1, j), at(i + 1, j + 1));
        triangle(at(i, j), at(i + 1, j + 1), at(i, j + 1));
      }
    }
  }

  triangle_mesh mesh;

 private:
  static constexpr double nearest_m = 1e-8;
  std::map<std::array<long, 3>, std::uint32_t> known_;
};

/// What lies between `low` and `high` where `keep` says so of the cells of a lattice of planes, one list per axis.
triangle_mesh lattice(const std::array<std::vector<double>, 3>& planes, double longest,
                      const std::function<bool(std::array<std::size_t, 3>)>& keep) {
  welder out;
  std::array<std::size_t, 3> cell{};
  const auto kept = [&](std::array<std::size_t, 3> c) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (c[k] >= planes[k].size() - 1) return false;  // wraps round below zero
    }
    return keep(c);
  };
  for (cell[0] = 0; cell[0] + 1 < planes[0].size(); ++cell[0]) {
    for (cell[1] = 0; cell[1] + 1 < planes[1].size(); ++cell[1]) {
      for (cell[2] = 0; cell[2] + 1 < planes[2].size(); ++cell[2]) {
        if (!kept(cell)) continue;
        for (std::size_t k = 0; k < 3; ++k) {
          const std::size_t u = (k + 1) % 3, v = (k + 2) % 3;
          for (const bool upper : {false, true}) {
            std::array<std::size_t, 3> beside = cell;
            upper ? ++beside[k] : --beside[k];
            if (kept(beside)) continue;
            const auto corner = [&](std::size_t i, std::size_t j) {
              vec3 p;
              p[static_cast<int>(k)] = planes[k][cell[k] + (upper ? 1 : 0)];
              p[static_cast<int>(u)] = planes[u][cell[u] + i];
              p[static_cast<int>(v)] = planes[v][cell[v] + j];
              return p;
            };
            const std::size_t m = parts(planes[u][cell[u] + 1] - planes[u][cell[u]], longest),
                              n = parts(planes[v][cell[v] + 1] - planes[v][cell[v]], longest);
            if (upper) {
              out.quad(corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1), m, n);
            } else {
              out.quad(corner(0, 0), corner(0, 1), corner(1, 1), corner(1, 0), n, m);
            }
          }
        }
      }
    }
  }
  return std::move(out.mesh);
}

triangle_mesh box(const vec3& size, double longest) {
  const auto planes = [](double s) { return std::vector<double>{-0.5 * s, 0.5 * s}; };
  return lattice({planes(size.x), planes(size.y), planes(size.z)}, longest, [](auto) { return true; });
}

triangle_mesh corner(double longest) {
  const std::vector<double> planes{-25.0 * mm, 0.0, 25.0 * mm};
  return lattice({planes, planes, planes}, longest,
                 [](const std::array<std::size_t, 3>& c) { return c[0] + c[1] + c[2] < 3; });
}

triangle_mesh groove(double longest) {
  constexpr std::array<double, 5> x{-30.0 * mm, -15.0 * mm, 0.0, 15.0 * mm, 30.0 * mm};
  constexpr std::array<double, 5> top{10.0 * mm, 10.0 * mm, -5.0 * mm, 10.0 * mm, 10.0 * mm};
  constexpr double bottom = -20.0 * mm, side = 30.0 * mm;
  const std::size_t along = parts(2.0 * side, longest), across = parts(15.0 * mm * std::numbers::sqrt2, longest),
                    up = parts(30.0 * mm, longest);
  welder out;
  const auto at = [&](std::size_t i, double y, bool upper) { return vec3(x[i], y, upper ? top[i] : bottom); };
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t j = i + 1;
    out.quad(at(i, -side, true), at(j, -side, true), at(j, side, true), at(i, side, true), across, along);
    out.quad(at(i, -side, false), at(i, side, false), at(j, side, false), at(j, -side, false), along, across);
    out.quad(at(i, -side, false), at(j, -side, false), at(j, -side, true), at(i, -side, true), across, up);
    out.quad(at(i, side, false), at(i, side, true), at(j, side, true), at(j, side, false), up, across);
  }
  out.quad(at(0, -side, false), at(0, -side, true), at(0, side, true), at(0, side, false), up, along);
  out.quad(at(4, -side, false), at(4, side, false), at(4, side, true), at(4, -side, true), along, up);
  return std::move(out.mesh);
}

/// A profile of (radius, height) that begins and ends on the axis and runs round the solid with its outside to the
/// right, turned about z. `around` points of a ring for a radius and a height: the corners of an N-gon, with points on
/// its sides in between.
using ring_of = std::function<std::vector<vec3>(double radius, double height)>;

triangle_mesh lathe(const std::vector<vec2>& profile, double longest, const ring_of& ring) {
  std::vector<vec2> finer{profile.front()};
  for (std::size_t i = 1; i < profile.size(); ++i) {
    const std::size_t n = parts(glm::length(profile[i] - profile[i - 1]), longest);
    for (std::size_t k = 1; k <= n; ++k) {
      const double t = static_cast<double>(k) / static_cast<double>(n);
      finer.push_back((1.0 - t) * profile[i - 1] + t * profile[i]);
    }
  }
  welder out;
  for (std::size_t i = 1; i < finer.size(); ++i) {
    const std::vector<vec3> low = ring(finer[i - 1].x, finer[i - 1].y), high = ring(finer[i].x, finer[i].y);
    for (std::size_t k = 0; k < low.size(); ++k) {
      const std::size_t next = (k + 1) % low.size();
      out.triangle(low[k], low[next], high[next]);  // what lies on the axis is one point
      out.triangle(low[k], high[next], high[k]);
    }
  }
  return std::move(out.mesh);
}

/// Rings that are regular N-gons.
ring_of polygon(int sides, double largest_radius, double longest) {
  const std::size_t per_side = parts(2.0 * largest_radius * std::sin(pi / sides), longest);
  return [sides, per_side](double radius, double height) {
    std::vector<vec3> out;
    for (int i = 0; i < sides; ++i) {
      const double a = 2.0 * pi * i / sides, b = 2.0 * pi * (i + 1) / sides;
      for (std::size_t k = 0; k < per_side; ++k) {
        const double t = static_cast<double>(k) / static_cast<double>(per_side);
        out.emplace_back(radius * ((1.0 - t) * std::cos(a) + t * std::cos(b)),
                         radius * ((1.0 - t) * std::sin(a) + t * std::sin(b)), height);
      }
    }
    return out;
  };
}

triangle_mesh rod(int sides, double longest) {
  constexpr double r = 2.0 * mm, half = 30.0 * mm;
  return lathe({{0.0, -half}, {r, -half}, {r, half}, {0.0, half}}, longest, polygon(sides, r, longest));
}

triangle_mesh cone(double half_angle_deg, int sides, double longest) {
  const double slope = std::tan(half_angle_deg * pi / 180.0), height = std::min(20.0 * mm, 20.0 * mm / slope);
  const double r = slope * height;
  return lathe({{0.0, 0.0}, {r, height}, {0.0, height}}, longest, polygon(sides, r, longest));
}

triangle_mesh cup(double longest) {
  constexpr double outer = 20.0 * mm, inner = 18.0 * mm, floor = 2.0 * mm, height = 40.0 * mm;
  return lathe({{0.0, 0.0}, {outer, 0.0}, {outer, height}, {inner, height}, {inner, floor}, {0.0, floor}}, longest,
               polygon(96, outer, longest));
}

/// The cone and the prism cut each other in scallops: along every meridian the smaller radius of the two counts.
triangle_mesh pencil(bool fine) {
  constexpr double corner_radius = 4.0 * mm, length = 70.0 * mm;
  const double slope = std::tan(20.0 * pi / 180.0), scallops = corner_radius / slope;
  const int around = fine ? 96 : 48;
  const auto ring = [&](double share, double height) {
    std::vector<vec3> out;
    for (int i = 0; i < around; ++i) {
      const double a = 2.0 * pi * i / around, in_side = std::fmod(a, pi / 3.0) - pi / 6.0;
      const double prism = corner_radius * std::cos(pi / 6.0) / std::cos(in_side);
      const double r = share * std::min(height * slope, prism);
      out.emplace_back(r * std::cos(a), r * std::sin(a), height);
    }
    return out;
  };
  std::vector<vec2> profile{{0.0, 0.0}};  // (share of the radius, height)
  const int cone_rings = fine ? 16 : 4, scallop_rings = fine ? 12 : 6, prism_rings = fine ? 59 : 1;
  const double prism_from = scallops * std::cos(pi / 6.0);  // the middles of the sides meet the cone first
  for (int i = 1; i <= cone_rings; ++i) profile.emplace_back(1.0, prism_from * i / cone_rings);
  for (int i = 1; i <= scallop_rings; ++i) {
    profile.emplace_back(1.0, prism_from + (scallops - prism_from) * i / scallop_rings);
  }
  for (int i = 1; i <= prism_rings; ++i) profile.emplace_back(1.0, scallops + (length - scallops) * i / prism_rings);
  profile.emplace_back(0.0, length);
  return lathe(profile, whole, ring);
}

triangle_mesh ball(double radius, int level) {
  const double g = 0.5 * (1.0 + std::sqrt(5.0));
  triangle_mesh out;
  out.positions = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                   {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  out.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                   {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                   {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (; level > 0; --level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [at, is_new] = middles.try_emplace(std::minmax(a, b), index(out.positions.size()));
      if (is_new) out.positions.push_back(glm::normalize(out.positions[a]) + glm::normalize(out.positions[b]));
      return at->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& [a, b, c] : out.triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    out.triangles = std::move(finer);
  }
  for (vec3& p : out.positions) p = radius * glm::normalize(p);
  return out;
}

/// A name and the numbers behind its underscores.
struct parsed_name {
  std::string_view kind;
  std::vector<int> numbers;
};

std::optional<parsed_name> parse(std::string_view name) {
  parsed_name out;
  const std::size_t end = name.find('_');
  out.kind = name.substr(0, end);
  while (!name.empty()) {
    const std::size_t at = name.find('_');
    if (at == std::string_view::npos) break;
    name.remove_prefix(at + 1);
    int value = 0;
    const auto [stop, fault] = std::from_chars(name.data(), name.data() + name.size(), value);
    if (fault != std::errc{} || value <= 0 || (stop != name.data() + name.size() && *stop != '_')) return std::nullopt;
    out.numbers.push_back(value);
  }
  return out;
}

std::optional<triangle_mesh> make(std::string_view name, bool fine) {
  const std::optional<parsed_name> known = parse(name);
  if (!known) return std::nullopt;
  const auto& [kind, numbers] = *known;
  const double longest = fine ? 1.0 * mm : whole;
  if (kind == "ball" && numbers.size() == 1) {
    return ball(numbers[0] * mm, fine ? (numbers[0] > 20 ? 6 : 5) : 3);
  }
  if (kind == "plate" && numbers.size() == 1) return box({60.0 * mm, 60.0 * mm, numbers[0] * mm}, longest);
  if (kind == "rod" && numbers.size() == 1 && numbers[0] >= 3) return rod(numbers[0], longest);
  if (kind == "cone" && numbers.size() == 2 && numbers[0] < 90 && numbers[1] >= 3) {
    return cone(numbers[0], numbers[1], longest);
  }
  if (kind == "pyramid" && numbers.size() == 1 && numbers[0] < 90) return cone(numbers[0], 4, longest);
  if (!numbers.empty()) return std::nullopt;
  if (kind == "slab") return box({60.0 * mm, 60.0 * mm, 20.0 * mm}, longest);
  if (kind == "pencil") return pencil(fine);
  if (kind == "cup") return cup(longest);
  if (kind == "groove") return groove(longest);
  if (kind == "corner") return corner(longest);
  return std::nullopt;
}

bool is_newer_than_this_program(const std::filesystem::path& file) {
  std::error_code fault;
  const auto program = std::filesystem::last_write_time(std::filesystem::read_symlink("/proc/self/exe", fault), fault);
  if (fault) return false;
  const auto made = std::filesystem::last_write_time(file, fault);
  return !fault && made > program;
}

}  // namespace

bool is_press_solid(std::string_view name) { return make(name, false).has_value(); }

result<triangle_mesh> make_press_solid(std::string_view name, fineness how) {
  if (auto made = make(name, how == fineness::fine)) return std::move(*made);
  return error{error_code::invalid_argument, "no solid for presses is called " + std::string(name)};
}

result<press_solid> bake_press_solid(std::string_view name, press_bake how, const std::filesystem::path& kept) {
  const bool own = how == press_bake::own_coarse;
  result<triangle_mesh> full = make_press_solid(name, own ? fineness::plain : fineness::fine);
  if (!full) return full.error();
  const std::filesystem::path file = kept / (std::string(name) + (own ? ".own.glb" : ".glb"));
  if (!kept.empty() && is_newer_than_this_program(file)) {
    if (result<textured_model> read = io::load_textured_model(file)) {
      return press_solid{std::move(*full), std::make_shared<const textured_model>(std::move(read).value())};
    }
  }
  bake::bake_settings options;
  options.name = name;
  options.texture_size = own ? 256 : 512;  // a simplified body's edges are as round as its texels are large
  if (own) options.triangles = full->triangles.size();
  result<textured_model> made = bake::bake(*full, options);
  if (!made) return made.error();
  if (!kept.empty()) {
    std::error_code ignored;
    std::filesystem::create_directories(kept, ignored);
    if (const result<void> saved = io::save_textured_model(*made, file); !saved) return saved.error();
  }
  return press_solid{std::move(*full), std::make_shared<const textured_model>(std::move(made).value())};
}

double volume_m3(const triangle_mesh& mesh) {
  double out = 0.0;
  for (const auto& t : mesh.triangles) {
    out += glm::dot(mesh.positions[t[0]], glm::cross(mesh.positions[t[1]], mesh.positions[t[2]])) / 6.0;
  }
  return out;
}

std::size_t open_edges(const triangle_mesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> ways;
  for (const auto& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) ++ways[{t[k], t[(k + 1) % 3]}];
  }
  std::size_t out = 0;
  for (const auto& [edge, times] : ways) {
    const auto back = ways.find({edge.second, edge.first});
    if (times != 1 || back == ways.end() || back->second != 1) ++out;
  }
  return out;
}

}  // namespace asperity::test_support
