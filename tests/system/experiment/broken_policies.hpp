// Policies that are broken on purpose, each in the way that is made most easily. Statements of the experiments have to
// notice.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "asperity/window/window_renderer.hpp"
#include "broken_mutation.hpp"
#include "model/surface_index.hpp"
#include "model/texture_scale.hpp"
#include "window/central_difference.hpp"
#include "window/deepest.hpp"
#include "window/height_lookup.hpp"
#include "window/pair_scale.hpp"
#include "window/patch_projection.hpp"

namespace broken {

using namespace asperity;

/// What a mutation makes of one derivative by the probe's motion. @param arm_w  from c_A to the contact
[[nodiscard]] inline vec6 spoilt(mutation how, vec6 g, const vec3& arm_w, const vec3& n_w) noexcept {
  if (how == mutation::no_transport) g.angular -= glm::cross(arm_w, g.linear);
  if (how == mutation::flipped_normal) {
    const vec3 twice = -2.0 * glm::dot(g.linear, n_w) * n_w;
    g.linear += twice;
    g.angular += glm::cross(arm_w, twice);
  }
  return g;
}

/// The paper's depth by central differences, put together once more of the library's parts so that its lookup and its
/// difference can be exchanged. Unbroken it gives the bits of cpu_depth.
class difference_depth {
 public:
  using policy_tag = depth_tag;

  difference_depth(asperity::scene scene, const window_depth_settings& settings, mutation how)
      : scene_(std::move(scene)), settings_(settings), how_(how), a_(scene_, 0, settings), b_(scene_, 1, settings) {
    bodies_.emplace_back(*scene_.probe);
    const detail::texture_scale probe = detail::measure_texture(*scene_.probe, bodies_.front());
    for (const model_ptr& m : scene_.fixed) {
      bodies_.emplace_back(*m);
      pairs_.push_back(detail::scale_of(settings_, probe, detail::measure_texture(*m, bodies_.back()),
                                        std::min(scene_.probe->box.diagonal(), m->box.diagonal())));
    }
  }

  [[nodiscard]] status measure(const scene_pose& at, const contact_set& contacts, std::span<penetration> out) noexcept {
    for (std::size_t i = 0; i < contacts.size(); ++i) out[i] = measure_one(at, contacts, contacts.contacts()[i]);
    return status::ok;
  }

 private:
  struct side {
    detail::patch_projection patch;
    detail::height_field field;
    side(const asperity::scene& s, std::size_t first, const window_depth_settings& settings)
        : patch(most_triangles(s, first)), field(std::size_t{settings.grid} * settings.grid) {}
  };
  static std::size_t most_triangles(const asperity::scene& s, std::size_t first) {
    std::size_t most = first == 0 ? s.probe->mesh.triangles.size() : 0;
    for (const model_ptr& m : s.fixed) most = std::max(most, first == 0 ? most : m->mesh.triangles.size());
    return most;
  }
  [[nodiscard]] const textured_model& body(std::size_t i) const noexcept {
    return i == 0 ? *scene_.probe : *scene_.fixed[i - 1];
  }

  // Heights of one body over the samples where `other` has a surface.
  void fill(side& s, std::size_t i, std::span<const std::uint32_t> patch, const detail::window_map& map,
            detail::layer which, const detail::sample_grid& grid, const side* other) noexcept {
    s.patch.project(body(i).mesh, bodies_[i], patch, map, which, settings_.facing_cosine);
    detail::rasterise(s.patch, grid, which, s.field);
    const haptic_texture& texture = body(i).texture;
    static_cast<void>(
        detail::look_up({texture, bodies_[i], s.patch, map}, grid, settings_.parallax, s.field,
                        [&](std::size_t k) { return other == nullptr || other->field.kind[k] != detail::hit::none; }));
    if (how_ != mutation::nearest_texel) return;
    const auto nearest = [](double z, std::uint32_t size) {
      return static_cast<std::size_t>(std::clamp(std::round(z), 0.0, static_cast<double>(size - 1)));
    };
    for (std::size_t k = 0; k < grid.size(); ++k) {
      if (s.field.kind[k] != detail::hit::above && s.field.kind[k] != detail::hit::beside) continue;
      const vec2& z = s.field.texel[k];
      const vec3 point(texture.texels[nearest(z.y, texture.height) * texture.width + nearest(z.x, texture.width)]);
      if (is_finite(point)) s.field.height[k] = map.origin.z + glm::dot(map.n_b, point);
    }
  }

  [[nodiscard]] penetration measure_one(const scene_pose& at, const contact_set& contacts, const contact& c) noexcept {
    const penetration apart{.flags = depth_flag::no_overlap};
    if (!(c.window.half_size_m > 0.0)) return apart;
    const detail::sample_grid grid(settings_.grid, c.window.half_size_m);
    fill(b_, std::size_t{c.body} + 1, contacts.patch_b(c), detail::window_map(c.window, at.T_wb[c.body]),
         detail::layer::lowest, grid, nullptr);
    const auto depth_at = [&](const pose& T_wa) noexcept {
      fill(a_, 0, contacts.patch_a(c), detail::window_map(c.window, T_wa), detail::layer::highest, grid, &b_);
      return detail::find_deepest(a_.field, b_.field, grid);
    };
    const detail::deepest_sample here = depth_at(at.T_wa);
    if (here.samples == 0) return apart;
    penetration out;
    out.depth_m = out.soft_depth_m = here.depth_m;
    out.samples = here.samples;
    out.area_m2 = here.samples * grid.cell_m2();
    out.witness_w = detail::fine_point_w({body(0).texture, bodies_[0], a_.patch, detail::window_map(c.window, at.T_wa)},
                                         c.window, a_.field.texel[here.index]);
    const double step = detail::difference_step(settings_, pairs_[c.body], grid.pitch_m);
    const double turn = step / here.half_width_m;
    const vec3 centre_w = centre_of_mass_w(scene_, at.T_wa);
    detail::moved_depths moved;
    for (std::size_t i = 0; i < detail::probe_motions; ++i) {
      if (how_ == mutation::one_sided && i % 2 == 1) continue;
      const detail::deepest_sample there =
          depth_at(detail::moved_probe(i, c.window, at.T_wa, c.window.centre_w, step, turn));
      if (there.samples > 0) moved[i] = there.depth_m;
    }
    out.gradient = detail::gradient_of(moved, c.window, centre_w, c.window.centre_w, here.depth_m, step, turn);
    return out;
  }

  asperity::scene scene_;
  window_depth_settings settings_;
  mutation how_;
  side a_, b_;
  std::vector<detail::surface_index> bodies_;
  std::vector<detail::pair_scale> pairs_;
};

static_assert(depth_backend<difference_depth>);

/// The paper's depth with either gradient, broken. A lookup and a difference can be broken with central differences
/// alone, a curvature with the soft maximum alone: elsewhere the mutation changes nothing.
class paper_depth {
 public:
  using policy_tag = depth_tag;

  paper_depth(const asperity::scene& s, const window_depth_settings& settings, mutation how) : scene_(s), how_(how) {
    if (settings.gradient == gradient_scheme::central_difference) {
      differences_.emplace(s, settings, how);
    } else {
      soft_.emplace(s, settings);
    }
  }

  [[nodiscard]] status measure(const scene_pose& at, const contact_set& contacts, std::span<penetration> out) noexcept {
    const status s = differences_ ? differences_->measure(at, contacts, out) : soft_->measure(at, contacts, out);
    const vec3 centre_w = centre_of_mass_w(scene_, at.T_wa);
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const contact_window& window = contacts.contacts()[i].window;
      out[i].gradient = spoilt(how_, out[i].gradient, window.centre_w - centre_w, window.n_ab_w);
      if (how_ == mutation::no_curvature) out[i].curvature = {};
    }
    return s;
  }

 private:
  asperity::scene scene_;
  mutation how_;
  std::optional<difference_depth> differences_;
  std::optional<cpu_depth> soft_;
};

static_assert(depth_backend<paper_depth>);

using broken_paper_renderer = basic_renderer<convex_piece_finder, paper_depth, gradient_penalty>;

[[nodiscard]] inline result<broken_paper_renderer> make_paper(scene bodies, const window_depth_settings& settings,
                                                              mutation how) {
  window_renderer_settings s;
  s.depth = settings;
  if (result<cpu_depth> checked = make_cpu_depth(bodies, settings); !checked) return checked.error();
  convex_piece_finder finder(bodies, s.finder);
  paper_depth depth(bodies, settings, how);
  return broken_paper_renderer(std::move(bodies), std::move(finder), std::move(depth), gradient_penalty(s.force),
                               s.limits);
}

}  // namespace broken
