#include "asperity/bake/procedural.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "bake/surface_points.hpp"

namespace asperity::bake {
namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;
constexpr std::size_t most_dots = 1'000'000;
constexpr std::size_t tries_per_dot = 30;
constexpr std::size_t waves_of_noise = 192;

bool positive(double x) noexcept { return std::isfinite(x) && x > 0.0; }

error wrong(std::string what) { return {error_code::invalid_argument, std::move(what)}; }

// SplitMix64: the same numbers on every machine. @source Steele, Lea and Flood 2014
class number_source {
 public:
  explicit number_source(std::uint64_t seed) noexcept : state_(seed) {}
  // In [0, 1).
  double operator()() noexcept {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15U;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
  }

 private:
  std::uint64_t state_;
};

// Points in space by the cell of a grid that they are in.
class point_grid {
 public:
  explicit point_grid(double cell_m) : cell_m_(cell_m) {}

  void add(const vec3& p, const vec3& normal) {
    const auto number = static_cast<std::uint32_t>(points_.size());
    points_.push_back({p, normal, no_point});
    const auto [cell, added] = first_.try_emplace(key(cell_of(p)), number);
    if (!added) points_.back().next = std::exchange(cell->second, number);
  }

  // Calls visit(point, normal) for all points within a cell's width of p, in an order that is always the same.
  template <class Visit>
  void near(const vec3& p, const Visit& visit) const {
    const vec3 at = cell_of(p);
    for (int dx = -1; dx <= 1; ++dx)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dz = -1; dz <= 1; ++dz) {
          const auto found = first_.find(key(at + vec3(dx, dy, dz)));
          if (found == first_.end()) continue;
          for (std::uint32_t i = found->second; i != no_point; i = points_[i].next)
            visit(points_[i].place, points_[i].normal);
        }
  }

  [[nodiscard]] std::size_t size() const noexcept { return points_.size(); }

 private:
  static constexpr std::uint32_t no_point = 0xffffffffU;
  struct node {
    vec3 place;
    vec3 normal;
    std::uint32_t next;  // in the same cell
  };

  [[nodiscard]] vec3 cell_of(const vec3& p) const noexcept { return glm::floor(p / cell_m_); }
  // Two cells may share a key: whoever visits looks at distances.
  static std::uint64_t key(const vec3& cell) noexcept {
    std::uint64_t h = 0;
    for (int axis = 0; axis < 3; ++axis) {
      h ^= static_cast<std::uint64_t>(static_cast<std::int64_t>(cell[axis]));
      h *= 0x9e3779b97f4a7c15U;
      h ^= h >> 29;
    }
    return h;
  }

  double cell_m_;
  std::vector<node> points_;
  std::unordered_map<std::uint64_t, std::uint32_t> first_;
};

struct wave {
  vec3 k_rad_per_m;
  double phase_rad;
  double amplitude;
};

double sum_of(const std::vector<wave>& waves, const vec3& p) noexcept {
  double sum = 0.0;
  for (const wave& w : waves) sum += w.amplitude * std::cos(glm::dot(w.k_rad_per_m, p) + w.phase_rad);
  return sum;
}

// Integral of k^-slope from a to b.
double band_power(double a, double b, double slope) noexcept {
  if (std::abs(slope - 1.0) < 1e-9) return std::log(b / a);
  return (std::pow(b, 1.0 - slope) - std::pow(a, 1.0 - slope)) / (1.0 - slope);
}

// A profile along a line sees a plane wave k at k times the cosine of the angle between them, which is uniform in
// [-1, 1]. So a shell of waves with power S(k) dk gives the profile a flat spectrum up to k, and S(k) proportional to
// k^-slope gives one that falls as k^-slope.
std::vector<wave> roughness_waves(const roughness& s) {
  number_source random(s.seed);
  std::vector<wave> out;
  const double k_low = two_pi / s.long_m;
  const double ratio = s.long_m / s.short_m;
  for (std::size_t i = 0; i < waves_of_noise; ++i) {
    const auto edge = [&](double at) { return k_low * std::pow(ratio, at / static_cast<double>(waves_of_noise)); };
    const double from = edge(static_cast<double>(i));
    const double to = edge(static_cast<double>(i + 1));
    const double k = from * std::pow(to / from, random());
    const double z = 2.0 * random() - 1.0;
    const double turn = two_pi * random();
    const double across = std::sqrt(1.0 - z * z);
    const double power = band_power(from / k_low, to / k_low, s.spectral_slope);
    out.push_back(
        {k * vec3(across * std::cos(turn), across * std::sin(turn), z), two_pi * random(), std::sqrt(2.0 * power)});
  }
  return out;
}

}  // namespace

result<relief> make_stripes(const stripes& s) {
  const double length = glm::length(s.direction);
  if (!positive(s.pitch_m) || !positive(s.height_m)) return wrong("pitch and height of stripes have to be positive");
  if (!is_finite(s.direction) || !(length > 0.0)) return wrong("the direction across the stripes has no length");
  const vec3 k = s.direction * (two_pi / (length * s.pitch_m));
  relief out;
  out.finest_m = 0.25 * s.pitch_m;
  out.height_m = [k, half = 0.5 * s.height_m](const relief_point& p) {
    return half * std::cos(glm::dot(k, p.position));
  };
  return out;
}

result<relief> make_dots(const dots& s, const triangle_mesh& mesh) {
  if (!positive(s.pitch_m) || !positive(s.height_m) || !positive(s.diameter_m))
    return wrong("pitch, height and diameter of dots have to be positive");
  if (s.diameter_m > s.pitch_m) return wrong("dots wider than their pitch would run into one another");
  const std::vector<double> areas = cumulative_areas(mesh);
  if (areas.empty() || !(areas.back() > 0.0)) return error{error_code::bad_mesh, "the mesh has no area for dots"};
  // Discs of the radius pitch / 2 do not overlap; thrown until there is no room, they cover about 0.55 of the surface.
  const double expected = 0.7 * areas.back() / (s.pitch_m * s.pitch_m);
  if (expected > static_cast<double>(most_dots))
    return error{error_code::limit_exceeded, "a pitch of " + std::to_string(1e3 * s.pitch_m) +
                                                 " mm would put more than a million dots on this surface; ask for a "
                                                 "larger one"};
  auto grid = std::make_shared<point_grid>(s.pitch_m);
  number_source random(s.seed);
  const auto throws = static_cast<std::size_t>(std::ceil(expected)) * tries_per_dot;
  for (std::size_t i = 0; i < throws; ++i) {
    const double at = random();
    const double r = random();
    const relief_point p = point_on(mesh, triangle_at(areas, at), triangle_share(r, random()));
    bool free = true;
    grid->near(p.position, [&](const vec3& q, const vec3& n) {
      free = free && (glm::length(q - p.position) >= s.pitch_m || glm::dot(n, p.normal) < 0.0);
    });
    if (free) grid->add(p.position, p.normal);
  }
  relief out;
  out.finest_m = 0.25 * s.diameter_m;
  out.height_m = [dots_near = std::shared_ptr<const point_grid>(std::move(grid)), height = s.height_m,
                  radius = 0.5 * s.diameter_m](const relief_point& p) {
    double h = 0.0;
    dots_near->near(p.position, [&](const vec3& q, const vec3& n) {
      const double r = glm::length(q - p.position) / radius;
      if (r < 1.0 && glm::dot(n, p.normal) > 0.0)  // not through a thin wall
        h = std::max(h, height * 0.5 * (1.0 + std::cos(std::numbers::pi * r)));
    });
    return h;
  };
  return out;
}

result<relief> make_roughness(const roughness& s, const triangle_mesh& mesh) {
  if (!positive(s.rms_m)) return wrong("the RMS of a roughness has to be positive");
  if (!positive(s.short_m) || !positive(s.long_m) || !(s.short_m < s.long_m))
    return wrong("the wavelengths of a roughness have to be positive, the shorter one first");
  if (!(s.spectral_slope >= 0.0 && s.spectral_slope <= 6.0)) return wrong("a spectral slope is from 0 to 6");
  relief out;
  out.finest_m = 0.25 * s.short_m;
  auto waves = std::make_shared<std::vector<wave>>(roughness_waves(s));
  out.height_m = [waves](const relief_point& p) { return sum_of(*waves, p.position); };
  const relief_extent raw = measure_relief(mesh, out);
  if (!positive(raw.rms_m)) return error{error_code::bad_mesh, "the mesh has no area for a roughness"};
  out.height_m = [waves, mean = raw.mean_m, gain = s.rms_m / raw.rms_m](const relief_point& p) {
    return gain * (sum_of(*waves, p.position) - mean);
  };
  return out;
}

}  // namespace asperity::bake
