// The depth between the samples: a depth backend that finds the maximum itself and says how far it can be off.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "asperity/window/cpu_depth.hpp"
#include "exact/deepest_line.hpp"
#include "window/deepest.hpp"
#include "window/pair_scale.hpp"

namespace asperity {

/// Settings of exact_depth. SI units.
struct exact_depth_settings {
  /// Which surface is meant, as for the sampling backends.
  parallax_mode parallax = parallax_mode::exact;

  /// The search stops when the largest depth is known to this, m.
  double epsilon_m = 1e-8;

  /// The search stops when it has kept this many pairs of pieces; 56 bytes each.
  std::uint32_t max_nodes = 1U << 18;

  /// Samples per side of the grid that the search starts from. Odd: one of them is the window's middle.
  std::uint32_t grid = 65;

  /// As window_depth_settings::facing_cosine.
  double facing_cosine = 0.1;

  static constexpr std::uint32_t most_nodes = 1U << 26;
};

/// Says which setting is out of range and what would do.
[[nodiscard]] inline result<void> check(const exact_depth_settings& s) {
  const auto bad = [](std::string what) {
    return error{error_code::invalid_argument, "exact depth settings: " + std::move(what)};
  };
  if (!(std::isfinite(s.epsilon_m) && s.epsilon_m > 0.0)) return bad("epsilon_m must be a length above 0");
  if (s.max_nodes < 1 || s.max_nodes > exact_depth_settings::most_nodes) {
    return bad("max_nodes is " + std::to_string(s.max_nodes) + "; give 1 to " +
               std::to_string(exact_depth_settings::most_nodes));
  }
  return check(window_depth_settings{.grid = s.grid, .facing_cosine = s.facing_cosine});
}

/// What exact_depth knows about one contact: the largest depth lies between lower_m and upper_m.
struct depth_bracket {
  bool bounded = false;  ///< false: no line crosses both surfaces, and nothing else here means anything
  double lower_m =
      0.0;  ///< depth along a line that was read; minus infinity where the search met none before it stopped
  double upper_m = 0.0;   ///< no line is deeper
  std::size_t nodes = 0;  ///< pairs of pieces that were kept for a closer look
  bool capped = false;    ///< the search stopped at max_nodes
  std::size_t beside_samples =
      0;  ///< of the starting grid: where the exact parallax gives up and the paper's stands in
};

/// Directional penetration depth as the maximum over all lines of the window, not over a grid of them: for tests, for
/// work at a desk, and to say what a grid misses. **Not for a tick**: how long it takes depends on the surfaces, from a
/// millisecond to seconds, and only max_nodes ends it for certain. Its memory is taken when it is made (a set of more
/// than 16 contacts takes a little more).
///
/// What the maximum is of: the surface that the texture's bilinear interpolation defines over the coarse triangles of
/// the patches that face along n; the same that cpu_depth reads at its samples.
/// - parallax_mode::paper_lookup: h(u, v) is the height of the fine point that the texture holds for the coarse point
///   over (u, v). No sample of cpu_depth is deeper than upper_m.
/// - parallax_mode::exact: h is the height of the fine surface over (u, v), A's highest and B's lowest where there are
///   several. The fine surface of a triangle is that of the texels inside its chart; it ends at the lines of the edges
///   where the patch ends, and what turns its other side to the window is no part of it. A sample of cpu_depth is
///   deeper than upper_m only where its lookup runs into a chart's gutter, or gives up (the fine surface folds over or
///   ends) and takes the paper's point: that is not a point of the surface over its line.
///
/// depth_m and soft_depth_m are the depth along the deepest line that was read, witness_w A's fine point on it, the
/// gradient that of the depth along this line (the probe moves, the line stays). Curvature is zero. At a crest of the
/// bilinear surface the depth has a kink, and the gradient is that of one side. samples, area_m2 and bad_texel are the
/// starting grid's. `unresolved` says that the search stopped at max_nodes with more than epsilon left.
/// @source paper Eqs. 8, 9; branch and bound
class exact_depth {
 public:
  using policy_tag = depth_tag;

  /// Builds a pyramid for each model, some tenths of a second per million texels.
  /// @pre check(settings) and cpu_depth::check_scene(scene) succeed; otherwise measure() answers not_ready.
  /// make_exact_depth() says why.
  explicit exact_depth(asperity::scene scene, const exact_depth_settings& settings = {})
      : scene_(std::move(scene)),
        settings_(settings),
        ready_(check(settings).has_value() && cpu_depth::check_scene(scene_).has_value()),
        a_(samples(), triangles(0, 1)),
        b_(samples(), triangles(1, scene_.fixed.size())),
        witness_(1),
        search_(ready_ ? settings.max_nodes : 0, triangles(0, 1 + scene_.fixed.size())) {
    if (!ready_) return;
    add_body(*scene_.probe);
    for (const model_ptr& model : scene_.fixed) {
      add_body(*model);
      tau_m_.push_back(detail::scale_of({}, measure_texture(*scene_.probe, bodies_.front().index),
                                        measure_texture(*model, bodies_.back().index),
                                        std::min(scene_.probe->box.diagonal(), model->box.diagonal()))
                           .tau_m);
    }
    detail::reserve_resident(brackets_, contact_limits{}.contacts);
  }

  /// Depth of every contact. Where no line crosses both patches: no_overlap.
  /// @pre out.size() >= contacts.size(); contacts are of this scene at these poses
  /// @return ok | not_ready (set-up, sizes or indices do not fit) | not_finite; the last two leave zeros behind
  [[nodiscard]] status measure(const scene_pose& at, const contact_set& contacts, std::span<penetration> out) noexcept {
    std::fill(out.begin(), out.end(), penetration{.flags = depth_flag::no_overlap});
    brackets_.clear();
    if (!ready_ || out.size() < contacts.size() || at.T_wb.size() != scene_.fixed.size()) return status::not_ready;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const contact& c = contacts.contacts()[i];
      if (c.body >= scene_.fixed.size()) return status::not_ready;
      depth_bracket bracket;
      out[i] = measure_one(at, contacts, c, bracket);
      brackets_.push_back(bracket);
      if (std::isfinite(out[i].depth_m) && is_finite(out[i].gradient)) continue;
      std::fill(out.begin(), out.end(), penetration{.flags = depth_flag::no_overlap});
      return status::not_finite;
    }
    return status::ok;
  }

  /// Of the last call of measure(), one for each contact.
  [[nodiscard]] std::span<const depth_bracket> brackets() const noexcept { return brackets_; }
  [[nodiscard]] const exact_depth_settings& settings() const noexcept { return settings_; }

  /// Without the models, which others share.
  [[nodiscard]] std::size_t heap_bytes() const noexcept {
    return asperity::heap_bytes(scene_.fixed, a_, b_, witness_, search_, bodies_, tau_m_, brackets_);
  }

 private:
  struct side {
    detail::patch_projection patch;
    detail::height_field field;
    side(std::size_t samples, std::size_t triangles) : patch(triangles), field(samples) {}
    [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(patch, field); }
  };
  struct searched_model {
    const textured_model* model;
    detail::surface_index index;
    detail::texture_pyramid pyramid;
    detail::chart_blocks charts;
    explicit searched_model(const textured_model& m) : model(&m), index(m), pyramid(m.texture), charts(m, index) {}
    [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(index, pyramid, charts); }
  };

  void add_body(const textured_model& m) { bodies_.emplace_back(m); }
  [[nodiscard]] std::size_t samples() const noexcept {
    return ready_ ? std::size_t{settings_.grid} * settings_.grid : 0;
  }
  [[nodiscard]] std::size_t triangles(std::size_t first, std::size_t count) const noexcept {
    if (!ready_) return 0;
    std::size_t most = 0;
    for (std::size_t i = first; i < first + count; ++i) {
      most = std::max(most, (i == 0 ? scene_.probe : scene_.fixed[i - 1])->mesh.triangles.size());
    }
    return most;
  }

  void project(side& s, const searched_model& body, std::span<const std::uint32_t> patch, const detail::window_map& map,
               detail::layer which, const detail::sample_grid& grid) noexcept {
    s.patch.project(body.model->mesh, body.index, patch, map, which, settings_.facing_cosine);
    rasterise(s.patch, grid, which, s.field);
  }

  [[nodiscard]] penetration measure_one(const scene_pose& at, const contact_set& contacts, const contact& c,
                                        depth_bracket& bracket) noexcept {
    using namespace detail;
    penetration out{.flags = depth_flag::no_overlap};
    const contact_window& window = c.window;
    if (!(window.half_size_m > 0.0) || !std::isfinite(window.half_size_m)) return out;
    const sample_grid grid(settings_.grid, window.half_size_m);
    const searched_model &model_a = bodies_.front(), &model_b = bodies_[std::size_t{c.body} + 1];
    const window_map map_a(window, at.T_wa), map_b(window, at.T_wb[c.body]);
    project(a_, model_a, contacts.patch_a(c), map_a, layer::highest, grid);
    project(b_, model_b, contacts.patch_b(c), map_b, layer::lowest, grid);
    const body_view view_a{model_a.model->texture, model_a.index, a_.patch, map_a};
    const body_view view_b{model_b.model->texture, model_b.index, b_.patch, map_b};
    bool finite = look_up(view_b, grid, settings_.parallax, b_.field,
                          [&](std::size_t i) { return a_.field.kind[i] != hit::none; });
    finite = look_up(view_a, grid, settings_.parallax, a_.field,
                     [&](std::size_t i) { return b_.field.kind[i] != hit::none; }) &&
             finite;
    if (!finite) out.flags |= depth_flag::bad_texel;
    const deepest_sample sampled = find_deepest(a_.field, b_.field, grid);
    bracket.beside_samples = drop_substitutes(grid);

    const search_result found = search_.find({view_a, model_a.pyramid, model_a.charts, settings_.parallax},
                                             {view_b, model_b.pyramid, model_b.charts, settings_.parallax},
                                             window.half_size_m, settings_.epsilon_m, seed(grid));
    bracket.bounded = found.bounded;
    bracket.lower_m = found.deepest.found ? found.deepest.depth_m : -std::numeric_limits<double>::infinity();
    bracket.upper_m = found.upper_m;
    bracket.nodes = found.nodes;
    bracket.capped = found.capped;
    if (found.capped) out.flags |= depth_flag::unresolved;
    if (!found.deepest.found) return out;

    penetration p{.flags = finite ? depth_flag::none : depth_flag::bad_texel};
    if (found.capped) p.flags |= depth_flag::unresolved;
    p.depth_m = p.soft_depth_m = found.deepest.depth_m;
    p.samples = sampled.samples;
    p.area_m2 = sampled.samples * grid.cell_m2();
    // As for the grids, a border counts only where it is clearly deeper than the inside.
    const double border = window.half_size_m * (1.0 - 1e-3);
    const bool at_border = std::fabs(found.deepest.uv.x) > border || std::fabs(found.deepest.uv.y) > border;
    if (at_border && (sampled.inner_samples == 0 || p.depth_m > sampled.inner_depth_m + 0.1 * tau_m_[c.body])) {
      p.flags |= depth_flag::window_too_small;
    }
    witness_.kind[0] = settings_.parallax == parallax_mode::exact ? hit::above : hit::beside;
    witness_.owner[0] = found.deepest.slot_a;
    witness_.texel[0] = found.deepest.texel_a;
    p.witness_w = fine_point_w(view_a, window, found.deepest.texel_a);
    p.gradient = height_gradient(view_a, window, witness_, 0, found.deepest.uv, centre_of_mass_w(scene_, at.T_wa));
    return p;
  }

  /// Leaves only the samples that are points of the surface which is searched. @return how many were not
  [[nodiscard]] std::size_t drop_substitutes(const detail::sample_grid& grid) noexcept {
    using detail::hit;
    if (settings_.parallax != parallax_mode::exact) return 0;
    std::size_t dropped = 0;
    for (std::size_t i = 0; i < grid.size(); ++i) {
      hit &a = a_.field.kind[i], &b = b_.field.kind[i];
      if (a == hit::none || b == hit::none || (a == hit::above && b == hit::above)) continue;
      a = b = hit::none;
      ++dropped;
    }
    return dropped;
  }

  /// The deepest sample of the starting grid.
  [[nodiscard]] detail::crossing_line seed(const detail::sample_grid& grid) const noexcept {
    const detail::deepest_sample d = find_deepest(a_.field, b_.field, grid);
    if (d.samples == 0) return {};
    return {true,
            d.depth_m,
            grid.position(d.index),
            a_.field.owner[d.index],
            b_.field.owner[d.index],
            a_.field.texel[d.index],
            b_.field.texel[d.index]};
  }

  asperity::scene scene_;
  exact_depth_settings settings_;
  bool ready_;
  side a_, b_;
  detail::height_field witness_;  ///< of the one line that the gradient is asked at
  detail::deepest_line search_;
  std::vector<searched_model> bodies_;  ///< the probe, then the fixed bodies
  std::vector<double> tau_m_;           ///< softness that the sampling backends would choose, by fixed body
  std::vector<depth_bracket> brackets_;
};

static_assert(depth_backend<exact_depth>);

/// An exact_depth, or what is wrong with its settings or scene.
/// @return invalid_argument | bad_mesh | bad_texture
[[nodiscard]] inline result<exact_depth> make_exact_depth(const scene& s, const exact_depth_settings& settings = {}) {
  if (result<void> r = check(settings); !r) return r.error();
  if (result<void> r = cpu_depth::check_scene(s); !r) return r.error();
  return exact_depth(s, settings);
}

}  // namespace asperity
