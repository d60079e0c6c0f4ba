#include "law/oracle/originals_agree.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "asperity/window/cpu_depth.hpp"
#include "asperity/window/window_renderer.hpp"
#include "support/height_models.hpp"
#include "support/kept_bodies.hpp"

namespace asperity::oracle {
namespace {

constexpr std::uint32_t grid = 64;
constexpr std::array press_from_m{0.0, 1e-6, 1e-4, 1e-3, 4e-3};
constexpr double mean_errors = 4.0;  // times the bakes' RMS errors: what a depth is expected to be off at most

template <class Made>
Made made_or_thrown(result<Made> made) {
  if (!made) throw std::runtime_error(made.error().message);
  return std::move(made).value();
}

}  // namespace

double window_depth::excess_m() const noexcept {
  if (nothing) return way_m;
  const double low = on_grid_m - bracket.later_m, high = way_m + bracket.earlier_m;
  return std::max({0.0, low - depth_m, depth_m - high});
}

struct judged_pair::renderers {
  explicit renderers(const scene& bodies)
      : least_motion_feel(made_or_thrown(test_support::build_renderer(bodies))),
        window_feel(made_or_thrown(make_window_renderer(bodies))),
        backend(bodies, {.grid = grid}),
        contacts({.contacts = 1, .triangles = 1U << 16}),
        patch_a(test_support::all_triangles(*bodies.probe)),
        patch_b(test_support::all_triangles(*bodies.fixed.front())) {}

  felt_depth feel(formulation f, const pose& T_wa) {
    const std::array<pose, 1> fixed{};
    tick t;
    // The paper's finder remembers its last contacts. Far away it forgets them, so that a pose can be repeated alone.
    if (f == formulation::window &&
        window_feel.step({{T_wa.rotation, T_wa.position + vec3(10.0, 0.0, 0.0)}, fixed}, t) != status::ok) {
      throw std::runtime_error("a tick failed");
    }
    const status s =
        f == formulation::least_motion ? least_motion_feel.step({T_wa, fixed}, t) : window_feel.step({T_wa, fixed}, t);
    if (s != status::ok && s != status::capacity_reached) throw std::runtime_error("a tick failed");
    felt_depth out{0.0, t.contacts.size()};
    if (t.force.on_probe_w.force == vec3(0.0)) return out;
    out.towards_w = glm::normalize(t.force.on_probe_w.force);
    out.depth_m = f == formulation::least_motion ? std::sqrt(2.0 * least_motion_feel.force().energy_j() /
                                                             least_motion_feel.force().settings().stiffness_n_per_m)
                                                 : std::max(0.0, deepest(t));
    return out;
  }
  std::optional<double> depth(const contact_window& window, const pose& T_wa) {
    const std::array<pose, 1> fixed{};
    contacts.clear();
    contact c;
    c.window = window;
    penetration p;
    if (!contacts.add(c, patch_a, patch_b) ||
        backend.measure({T_wa, fixed}, contacts, std::span(&p, 1)) != status::ok) {
      throw std::runtime_error("the depth backend failed");
    }
    if (has(p.flags, depth_flag::no_overlap)) return std::nullopt;
    return p.depth_m;
  }

  least_motion_renderer least_motion_feel;
  window_renderer window_feel;
  cpu_depth backend;
  contact_set contacts;
  std::vector<std::uint32_t> patch_a, patch_b;
};

judged_pair::judged_pair(original_and_bake probe, original_and_bake fixed)
    : probe_(std::move(probe)),
      fixed_(std::move(fixed)),
      name_(probe_.name + " on " + fixed_.name),
      error_m_(probe_.model->report.max_error_m + fixed_.model->report.max_error_m),
      smaller_m_(std::min(probe_.model->box.diagonal(), fixed_.model->box.diagonal())),
      sampler_(name_, probe_.full, fixed_.full),
      made_(std::make_unique<renderers>(scene{probe_.model, {fixed_.model}})) {
  feel = [this](formulation f, const pose& T_wa) { return made_->feel(f, T_wa); };
  depth = [this](const contact_window& w, const pose& T_wa) { return made_->depth(w, T_wa); };
}
judged_pair::~judged_pair() = default;

double judged_pair::rms_error_m() const noexcept {
  return probe_.model->report.rms_error_m + fixed_.model->report.rms_error_m;
}

judged judged_pair::judge(formulation f, const approach& on, press by, double way_m) {
  judged out;
  out.way_m = way_m;
  out.felt = feel(f, on.pressed(way_m));
  const double felt_m = out.felt.depth_m, mean_m = mean_errors * rms_error_m();
  const auto is = [&](verdict worse, double excess_m) {
    if (excess_m <= mean_m - error_m_) return;
    out.is = excess_m > 0.0 ? worse : verdict::doubtful;
    out.excess_m = std::max(0.0, excess_m);
  };
  if (by == press::drawn_back) {
    out.bound_m = error_m_;
    if (felt_m <= whisper_m) return out;
    out.overlap_m = -surface_distance(sampler_.probe(), sampler_.fixed(), way_m, -way_m);
    is(verdict::false_touch, -out.overlap_m - out.bound_m);
    return out;
  }
  out.bound_m = error_m_ + missing_m(f);
  // No law of depth owes more than the way back out; walls that meet at right angles share it, more of them than three
  // can come to sqrt(2) of it.
  is(verdict::deep, felt_m - (out.felt.contacts > 1 ? std::sqrt(2.0) : 1.0) * way_m - out.bound_m);
  if (out.is == verdict::agrees && felt_m < way_m - mean_m - missing_m(f)) {  // the overlap is no more than the way
    out.overlap_m = overlap_m(way_m);
    is(felt_m > 0.0 ? verdict::shallow : verdict::missed, out.overlap_m - out.bound_m - felt_m);
  }
  const bool drawn_in = by != press::deep && felt_m > whisper_m && glm::dot(out.felt.towards_w, on.window.n_ab_w) > 0.1;
  if (drawn_in && (out.is == verdict::agrees || out.is == verdict::doubtful)) {
    out.is = verdict::pulls;
    out.excess_m = felt_m;
  }
  return out;
}

double judged_pair::missing_m(formulation f) const noexcept {
  return f == formulation::least_motion ? 2.0 * made_->least_motion_feel.force().settings().softness_m
                                        : 0.01 * smaller_m_ / grid;
}

double judged_pair::overlap_m(double way_m) {
  if (way_m != overlap_of_m_) {
    overlap_of_m_ = way_m;
    overlap_m_ = overlap_at_least(sampler_.probe(), sampler_.fixed(), way_m);
  }
  return overlap_m_;
}

approach judged_pair::draw(std::uint64_t seed, std::uint64_t index) {
  overlap_of_m_ = 0.0;
  approach drawn = sampler_.draw(seed, index);
  if (bend) bend(drawn);
  return drawn;
}

double judged_pair::way_m(press by) {
  const auto k = static_cast<std::size_t>(by);
  if (by == press::drawn_back) return -sampler_.log_between(1e-6, 2e-3);
  return sampler_.log_between(press_from_m[k],
                              by == press::deep ? std::max(8e-3, 0.1 * smaller_m_) : press_from_m[k + 1]);
}

judged_approach judged_pair::judge_approach(std::uint64_t seed, std::uint64_t index) {
  const approach on = draw(seed, index);
  judged_approach out;
  out.index = index;
  for (std::size_t k = 0; k < presses; ++k) {
    const press by{static_cast<std::uint8_t>(k)};
    const double way = way_m(by);
    for (const formulation f : {formulation::least_motion, formulation::window}) {
      out.poses[static_cast<std::size_t>(f)][k] = judge(f, on, by, way);
    }
  }
  out.window = judge_window(on);
  return out;
}

judged judged_pair::judge_pose(std::uint64_t seed, std::uint64_t index, formulation f, press by) {
  const approach on = draw(seed, index);
  double way = 0.0;
  for (std::size_t k = 0; k <= static_cast<std::size_t>(by); ++k) way = way_m(press{static_cast<std::uint8_t>(k)});
  return judge(f, on, by, way);
}

window_depth judged_pair::judge_window(const approach& on) {
  window_depth out;
  out.way_m = sampler_.log_between(1e-4, 8e-3);
  contact_window w = on.window;
  w.half_size_m = sampler_.log_between(0.01 * smaller_m_, 0.04 * smaller_m_);
  const double u = 0.5 * w.half_size_m * sampler_.between(-1.0, 1.0),
               v = 0.5 * w.half_size_m * sampler_.between(-1.0, 1.0);
  w.centre_w += u * w.u_w + v * w.v_w;
  const std::optional<double> depth_m = depth(w, on.pressed(out.way_m));
  out.nothing = !depth_m.has_value();
  out.depth_m = depth_m.value_or(0.0);

  // The same samples of the originals, in the sampler's axes.
  const vec3 centre = glm::transpose(mat3(w.u_w, w.v_w, w.n_ab_w)) * w.centre_w;
  out.on_grid_m = -std::numeric_limits<double>::infinity();
  const double pitch = 2.0 * w.half_size_m / grid;
  for (std::uint32_t j = 0; j < grid; ++j) {
    for (std::uint32_t i = 0; i < grid; ++i) {
      const double x = centre.x + (i + 0.5) * pitch - w.half_size_m, y = centre.y + (j + 0.5) * pitch - w.half_size_m;
      const double a = sampler_.probe().highest(x, y);
      if (!std::isfinite(a)) continue;
      const double b = sampler_.fixed().lowest(x, y);
      if (std::isfinite(b)) out.on_grid_m = std::max(out.on_grid_m, a - b + out.way_m);
    }
  }
  // Neither way is ever shorter than the errors themselves. Most depths lie within that.
  out.bracket = {error_m_, error_m_};
  if (!out.nothing && out.excess_m() > 0.0) {
    out.bracket = bracket_of(sampler_.probe(), sampler_.fixed(), error_m_, 0.05 * smaller_m_);
  }
  return out;
}

}  // namespace asperity::oracle
