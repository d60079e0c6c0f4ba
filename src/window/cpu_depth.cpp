#include "asperity/window/cpu_depth.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "asperity/core/memory.hpp"
#include "model/surface_index.hpp"
#include "window/central_difference.hpp"
#include "window/deepest.hpp"
#include "window/edge_taper.hpp"
#include "window/height_lookup.hpp"
#include "window/pair_scale.hpp"
#include "window/soft_max.hpp"

namespace asperity {
namespace {

result<void> check_model(const textured_model& m, const std::string& who) {
  if (m.mesh.triangles.empty()) return error{error_code::bad_mesh, who + ": the coarse mesh has no triangle"};
  for (const coarse_triangle& t : m.mesh.triangles) {
    for (const std::uint32_t v : t.vertex) {
      if (v >= m.mesh.positions.size()) {
        return error{error_code::bad_mesh, who + ": a coarse triangle names vertex " + std::to_string(v) + " of " +
                                               std::to_string(m.mesh.positions.size()) + "; bake the model again"};
      }
    }
  }
  if (m.texture.width == 0 || m.texture.texels.size() != std::size_t{m.texture.width} * m.texture.height) {
    return error{error_code::bad_texture, who + ": no haptic texture, or one whose size is not width times height"};
  }
  return {};
}

}  // namespace

class cpu_depth::grid_search {
 public:
  grid_search(asperity::scene scene, const window_depth_settings& settings)
      : scene_(std::move(scene)),
        settings_(settings),
        ready_(check(settings).has_value() && check_scene(scene_).has_value()),
        a_(samples(), triangles(0, 1)),
        b_(samples(), triangles(1, scene_.fixed.size())),
        weight_(samples()) {
    if (!ready_) return;
    surfaces_.emplace_back(*scene_.probe);
    surface_of_.push_back(0);
    const detail::texture_scale probe = measure_texture(*scene_.probe, surfaces_.front());
    for (std::size_t b = 0; b < scene_.fixed.size(); ++b) add_fixed(b, probe);
    surfaces_.shrink_to_fit();
    surface_of_.shrink_to_fit();
    pairs_.shrink_to_fit();
  }

  [[nodiscard]] status measure(const scene_pose& at, const contact_set& contacts, std::span<penetration> out) noexcept {
    std::fill(out.begin(), out.end(), penetration{.flags = depth_flag::no_overlap});
    if (!ready_ || out.size() < contacts.size() || at.T_wb.size() != scene_.fixed.size()) return status::not_ready;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const contact& c = contacts.contacts()[i];
      if (c.body >= scene_.fixed.size()) return status::not_ready;
      out[i] = measure_one(at, contacts, c);
      if (std::isfinite(out[i].depth_m) && std::isfinite(out[i].soft_depth_m) && is_finite(out[i].gradient)) continue;
      std::fill(out.begin(), out.end(), penetration{.flags = depth_flag::no_overlap});
      return status::not_finite;
    }
    return status::ok;
  }

  [[nodiscard]] const window_depth_settings& settings() const noexcept { return settings_; }
  [[nodiscard]] const detail::pair_scale& pair(std::size_t body) const noexcept { return pairs_[body]; }
  [[nodiscard]] std::size_t heap_bytes() const noexcept {
    return asperity::heap_bytes(scene_.fixed, a_, b_, weight_, surfaces_, surface_of_, pairs_);
  }

 private:
  /// Scratch of one body: its projected patch, heights and taper.
  struct side {
    detail::patch_projection patch;
    detail::height_field field;
    detail::edge_taper taper;
    side(std::size_t samples, std::size_t triangles) : patch(triangles), field(samples), taper(triangles) {}
    [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(patch, field, taper); }
  };

  /// What stays the same over all evaluations of one contact.
  struct evaluation {
    const contact& at;
    const detail::sample_grid& grid;
    std::span<const std::uint32_t> patch_a;
    const pose& T_wa;
    const vec3& centre_of_mass_w;
    const detail::pair_scale& pair;
  };

  [[nodiscard]] std::size_t samples() const noexcept {
    return ready_ ? std::size_t{settings_.grid} * settings_.grid : 0;
  }
  /// Most coarse triangles of bodies first .. first + count - 1, the probe being body 0.
  [[nodiscard]] std::size_t triangles(std::size_t first, std::size_t count) const noexcept {
    if (!ready_) return 0;
    std::size_t most = 0;
    for (std::size_t i = first; i < first + count; ++i) most = std::max(most, body(i).mesh.triangles.size());
    return most;
  }
  [[nodiscard]] const textured_model& body(std::size_t i) const noexcept {
    return i == 0 ? *scene_.probe : *scene_.fixed[i - 1];
  }
  [[nodiscard]] const detail::surface_index& surface(std::size_t i) const noexcept { return surfaces_[surface_of_[i]]; }

  // Bodies of one model share what is known of its surface, and of its scale against the probe.
  void add_fixed(std::size_t b, const detail::texture_scale& probe) {
    const model_ptr& model = scene_.fixed[b];
    const auto begin = scene_.fixed.begin();
    const auto same = std::find(begin, begin + static_cast<std::ptrdiff_t>(b), model);
    if (const auto first = static_cast<std::size_t>(same - begin); first < b) {
      surface_of_.push_back(surface_of_[first + 1]);
      pairs_.push_back(pairs_[first]);
      return;
    }
    if (model == scene_.probe) {
      surface_of_.push_back(0);
    } else {
      surface_of_.push_back(static_cast<std::uint32_t>(surfaces_.size()));
      surfaces_.emplace_back(*model);
    }
    pairs_.push_back(scale_of(settings_, probe, measure_texture(*model, surface(b + 1)),
                              std::min(scene_.probe->box.diagonal(), model->box.diagonal())));
  }

  [[nodiscard]] penetration measure_one(const scene_pose& at, const contact_set& contacts, const contact& c) noexcept {
    using namespace detail;
    penetration out{.flags = depth_flag::no_overlap};
    const contact_window& window = c.window;
    if (!(window.half_size_m > 0.0) || !std::isfinite(window.half_size_m)) return out;
    const sample_grid grid(settings_.grid, window.half_size_m);
    const std::size_t fixed = std::size_t{c.body} + 1;
    const pair_scale& pair = pairs_[c.body];
    const vec3 centre_w = centre_of_mass_w(scene_, at.T_wa);
    const evaluation e{c, grid, contacts.patch_a(c), at.T_wa, centre_w, pair};

    // B does not move: its heights serve every pose of A. Where A only stands still, only shared samples are read.
    const bool differences = settings_.gradient == gradient_scheme::central_difference;
    const window_map map_a(window, at.T_wa), map_b(window, at.T_wb[c.body]);
    project(a_, 0, e.patch_a, map_a, layer::highest, grid);
    project(b_, fixed, contacts.patch_b(c), map_b, layer::lowest, grid);
    bool finite = look_up(view(b_, fixed, map_b), grid, settings_.parallax, b_.field,
                          [&](std::size_t i) { return differences || a_.field.kind[i] != hit::none; });
    const body_view probe = view(a_, 0, map_a);
    finite = look_up(probe, grid, settings_.parallax, a_.field,
                     [&](std::size_t i) { return b_.field.kind[i] != hit::none; }) &&
             finite;
    const depth_flag texels = finite ? depth_flag::none : depth_flag::bad_texel;

    const deepest_sample deepest = find_deepest(a_.field, b_.field, grid);
    out.flags = depth_flag::no_overlap | texels;
    if (deepest.samples == 0) return out;
    penetration found{.flags = texels};
    found.depth_m = depth_of(deepest, grid);
    found.witness_w = fine_point_w(probe, window, a_.field.texel[deepest.index]);
    found.samples = deepest.samples;
    found.area_m2 = deepest.samples * grid.cell_m2();
    // A level face is as deep at the border as elsewhere: only a border that is clearly deeper hides something.
    if (deepest.inner_samples == 0 || deepest.depth_m > deepest.inner_depth_m + 0.1 * pair.tau_m) {
      found.flags |= depth_flag::window_too_small;
    }
    if (differences) {
      found.soft_depth_m = found.depth_m;
      found.gradient = difference_gradient(e, deepest, found.depth_m);
      return found;
    }
    const soft_maximum soft = soft_maximum_of(e, view(b_, fixed, map_b), probe);
    if (!soft.found) return out;
    found.soft_depth_m = soft.depth_m;
    found.gradient = soft.gradient;
    found.curvature = soft.curvature;
    return found;
  }

  void project(side& s, std::size_t body_index, std::span<const std::uint32_t> patch, const detail::window_map& map,
               detail::layer which, const detail::sample_grid& grid) noexcept {
    s.patch.project(body(body_index).mesh, surface(body_index), patch, map, which, settings_.facing_cosine);
    rasterise(s.patch, grid, which, s.field);
  }

  [[nodiscard]] detail::body_view view(const side& s, std::size_t body_index,
                                       const detail::window_map& map) const noexcept {
    return {body(body_index).texture, surface(body_index), s.patch, map};
  }

  [[nodiscard]] double depth_of(const detail::deepest_sample& d, const detail::sample_grid& grid) const noexcept {
    return settings_.refine_maximum ? refined_depth(a_.field, b_.field, grid, d) : d.depth_m;
  }

  /// Gradient by the paper's eleven poses. Overwrites A's heights.
  [[nodiscard]] vec6 difference_gradient(const evaluation& e, const detail::deepest_sample& deepest,
                                         double here_m) noexcept {
    using namespace detail;
    const double step = difference_step(settings_, e.pair, e.grid.pitch_m);
    const vec3& origin = settings_.origin == rotation_origin::contact ? e.at.window.centre_w : e.centre_of_mass_w;
    const auto depth_at = [&](const pose& T_wa) noexcept -> std::optional<double> {
      const window_map map(e.at.window, T_wa);
      project(a_, 0, e.patch_a, map, layer::highest, e.grid);
      // Samples without a finite texel are masked here as they are at the pose itself, where they were reported.
      static_cast<void>(look_up(view(a_, 0, map), e.grid, settings_.parallax, a_.field,
                                [&](std::size_t i) { return b_.field.kind[i] != hit::none; }));
      const deepest_sample moved = find_deepest(a_.field, b_.field, e.grid);
      return moved.samples == 0 ? std::nullopt : std::optional(depth_of(moved, e.grid));
    };
    return central_difference(e.at.window, e.T_wa, e.centre_of_mass_w, origin, here_m, step,
                              step / deepest.half_width_m, depth_at);
  }

  /// Soft maximum over the heights at hand, with the tapers of both bodies and of the window's border.
  [[nodiscard]] detail::soft_maximum soft_maximum_of(const evaluation& e, const detail::body_view& fixed,
                                                     const detail::body_view& probe) noexcept {
    using namespace detail;
    const double width = settings_.taper_m > 0.0 ? settings_.taper_m : 0.1 * e.grid.half_m;
    for (std::size_t row = 0, i = 0; row < e.grid.side; ++row) {
      for (std::size_t column = 0; column < e.grid.side; ++column, ++i) {
        const bool shared = a_.field.kind[i] != hit::none && b_.field.kind[i] != hit::none;
        weight_[i] = shared ? border(e.grid, column, width) * border(e.grid, row, width) : 0.0;
      }
    }
    if (settings_.taper_silhouettes) {
      a_.taper.prepare(a_.patch, probe.index, probe.map, layer::highest, e.grid, width, settings_.facing_cosine);
      b_.taper.prepare(b_.patch, fixed.index, fixed.map, layer::lowest, e.grid, width, settings_.facing_cosine);
      a_.taper.apply(a_.patch, e.grid, a_.field, weight_);
      b_.taper.apply(b_.patch, e.grid, b_.field, weight_);
    }
    const bool taper_moves = settings_.taper_silhouettes && settings_.taper_gradient;
    const contact_window& window = e.at.window;
    const vec3 arm = e.centre_of_mass_w - window.centre_w;
    const vec3 centre(glm::dot(window.u_w, arm), glm::dot(window.v_w, arm), glm::dot(window.n_ab_w, arm));
    const auto gradient = [&](std::size_t i) {
      const vec2 uv = e.grid.position(i);
      vec6 g = height_gradient(probe, window, a_.field, i, uv, e.centre_of_mass_w);
      if (taper_moves) {
        const vec6 t = a_.taper.log_gradient(a_.patch.triangles()[a_.field.owner[i]], probe.index, probe.map,
                                             layer::highest, uv, centre);
        g += e.pair.tau_m * vec6{direction_to_world(window, t.linear), direction_to_world(window, t.angular)};
      }
      return g;
    };
    for (std::size_t i = 0; i < e.grid.size(); ++i) {
      const double mu = weight_[i];
      weight_[i] = !(mu > 0.0)
                       ? -std::numeric_limits<double>::infinity()
                       : a_.field.height[i] - b_.field.height[i] + (mu < 1.0 ? e.pair.tau_m * std::log(mu) : 0.0);
    }
    return soft_max(std::span(weight_).first(e.grid.size()), e.pair.tau_m, e.grid.cell_m2() / e.pair.reference_area_m2,
                    gradient);
  }

  [[nodiscard]] double border(const detail::sample_grid& grid, std::size_t i, double width_m) const noexcept {
    return settings_.taper_window ? smoothstep((grid.half_m - std::fabs(grid.coordinate(i))) / width_m) : 1.0;
  }

  asperity::scene scene_;
  window_depth_settings settings_;
  bool ready_;
  side a_, b_;
  std::vector<double> weight_;
  std::vector<detail::surface_index> surfaces_;  ///< of every model, the probe's first
  std::vector<std::uint32_t> surface_of_;        ///< of the probe, then of each fixed body: in surfaces_
  std::vector<detail::pair_scale> pairs_;        ///< probe against each fixed body
};

cpu_depth::cpu_depth(asperity::scene scene, const window_depth_settings& settings)
    : search_(std::make_unique<grid_search>(std::move(scene), settings)) {}
cpu_depth::cpu_depth(cpu_depth&&) noexcept = default;
cpu_depth& cpu_depth::operator=(cpu_depth&&) noexcept = default;
cpu_depth::~cpu_depth() = default;

status cpu_depth::measure(const scene_pose& at, const contact_set& contacts, std::span<penetration> out) noexcept {
  return search_->measure(at, contacts, out);
}

const window_depth_settings& cpu_depth::settings() const noexcept { return search_->settings(); }
double cpu_depth::tau_m(std::size_t body) const noexcept { return search_->pair(body).tau_m; }
double cpu_depth::reference_area_m2(std::size_t body) const noexcept { return search_->pair(body).reference_area_m2; }
double cpu_depth::difference_step_m(std::size_t body, double half_size_m) const noexcept {
  return detail::difference_step(settings(), search_->pair(body), 2.0 * half_size_m / settings().grid);
}
std::size_t cpu_depth::heap_bytes() const noexcept { return sizeof(grid_search) + search_->heap_bytes(); }

result<void> cpu_depth::check_scene(const asperity::scene& scene) {
  if (!scene.probe) return error{error_code::invalid_argument, "scene has no probe; load a textured model for it"};
  if (result<void> r = check_model(*scene.probe, "probe"); !r) return r;
  for (std::size_t i = 0; i < scene.fixed.size(); ++i) {
    const std::string name = "fixed body " + std::to_string(i);
    if (!scene.fixed[i]) return error{error_code::invalid_argument, name + " is missing; load a textured model for it"};
    if (result<void> r = check_model(*scene.fixed[i], name); !r) return r;
  }
  return {};
}

result<cpu_depth> make_cpu_depth(const scene& s, const window_depth_settings& settings) {
  if (result<void> r = check(settings); !r) return r.error();
  if (result<void> r = cpu_depth::check_scene(s); !r) return r.error();
  return cpu_depth(s, settings);
}

}  // namespace asperity
