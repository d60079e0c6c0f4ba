#include "law/presses/press_law.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "asperity/planes/plane_renderer.hpp"
#include "asperity/window/window_renderer.hpp"
#include "support/fresh_seed.hpp"
#include "support/kept_bodies.hpp"

namespace asperity::presses {
namespace {

wrench no_answer() {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  return {vec3(nan), vec3(nan)};
}

double seconds(std::chrono::steady_clock::duration d) { return std::chrono::duration<double>(d).count(); }

template <class Renderer>
result<render_function> render_of(result<Renderer> made) {
  if (!made) return made.error();
  const auto feel = std::make_shared<Renderer>(std::move(made).value());
  return render_function([feel](const scene_pose& at, tick& out) { return feel->step(at, out); });
}

result<render_function> render_by_least_motion(const press_body& probe, const press_body& fixed,
                                               double stiffness_n_per_m) {
  least_motion_renderer_settings settings;
  settings.force.stiffness_n_per_m = stiffness_n_per_m;
  return render_of(test_support::build_renderer({probe.model, {fixed.model}}, settings));
}

result<render_function> render_by_windows(const press_body& probe, const press_body& fixed, double stiffness_n_per_m) {
  window_renderer_settings settings;
  settings.force.stiffness_n_per_m = stiffness_n_per_m;
  return render_of(make_window_renderer({probe.model, {fixed.model}}, settings));
}

// Support planes bring the stiffness of the control loop's contact_law; the reported force has the one asked for.
result<render_function> render_by_planes(const press_body& probe, const press_body& fixed, double stiffness_n_per_m,
                                         double contact_period_s) {
  plane_renderer_settings settings;
  constexpr double of_the_diagonal = 0.1;
  const double smaller_m = std::min(probe.model->box.diagonal(), fixed.model->box.diagonal());
  settings.reach_m = std::min(reach_for(contact_period_s), of_the_diagonal * smaller_m);
  settings.springs.stiffness_n_per_m = stiffness_n_per_m;
  return render_of(make_plane_renderer({probe.model, {fixed.model}}, settings));
}

press_law law_of(std::string name, decltype(press_law::render) render) {
  press_law out{std::move(name), {}, render};
  out.make = [render = std::move(render)](const press_body& probe, const press_body& fixed,
                                          double stiffness_n_per_m) -> result<step_function> {
    const result<render_function> made = render(probe, fixed, stiffness_n_per_m);
    if (!made) return made.error();
    return step_function([feel = *made](const pose& T_wa) {
      const std::array<pose, 1> T_wb{};
      tick t;
      const status s = feel({T_wa, T_wb}, t);
      return s == status::ok || s == status::capacity_reached ? t.force.on_probe_w : no_answer();
    });
  };
  return out;
}

}  // namespace

press_law least_motion_renderer_law() { return law_of("least-motion", render_by_least_motion); }
press_law window_renderer_law() { return law_of("window", render_by_windows); }

press_law plane_renderer_law(double contact_period_s) {
  return {"planes", {}, [=](const press_body& probe, const press_body& fixed, double stiffness_n_per_m) {
            return render_by_planes(probe, fixed, stiffness_n_per_m, contact_period_s);
          }};
}

press_law true_exit_law() {
  return {"exit",
          [](const press_body& probe, const press_body& fixed, double k) -> result<step_function> {
            const auto search = std::make_shared<exit_search>(probe.full, fixed.full);
            return step_function([search, k](const pose& T_wa) {
              const way_out exit = search->true_exit(T_wa, vec3(0.0, 0.0, 1.0));
              return wrench{k * exit.way_m * exit.direction_w, vec3(0.0)};
            });
          },
          {}};
}

std::vector<press_law> known_laws(double contact_period_s) {
  return {least_motion_renderer_law(), window_renderer_law(), plane_renderer_law(contact_period_s), true_exit_law()};
}

press_row press_one_pair(const press_pair& pair, const press_body& probe, const press_body& fixed,
                         const step_function& step, const press_choice& which) {
  using clock = std::chrono::steady_clock;
  press_row row;
  row.probe = pair.probe;
  row.fixed = pair.fixed;
  press_rules rules;
  rules.allowance_m = probe.error_m() + fixed.error_m();
  exit_search originals(probe.full, fixed.full);
  touch_finder finder(pair.name(), probe.full, fixed.full, pair.region);
  clock::duration stepping{};
  const step_function timed = [&](const pose& T_wa) {
    const auto start = clock::now();
    const wrench w = step(T_wa);
    stepping += clock::now() - start;
    ++row.step_count;
    return w;
  };
  for (int i = 0; i < which.first + which.touches; ++i) {
    const auto start = clock::now();
    const std::optional<press_touch> touch = finder.next(which.seed);
    row.touch_s += seconds(clock::now() - start);
    if (!touch) break;
    if (i < which.first) continue;
    rules.step_m = std::min(which.step_m, 0.25 * touch->press_m);
    row.longest_m = std::max(row.longest_m, touch->press_m);
    row.presses.push_back(run_press(timed, *touch, rules, originals));
  }
  row.step_s = seconds(stepping);
  return row;
}

session_row press_sessions(const press_pair& pair, const press_body& probe, const press_body& fixed,
                           const render_function& render, const press_choice& which, const session_rules& rules) {
  const auto start = std::chrono::steady_clock::now();
  session_row row{pair.probe, pair.fixed, {}, 0.0};
  exit_search originals(probe.full, fixed.full);
  touch_finder finder(pair.name(), probe.full, fixed.full, pair.region);
  for (int i = 0; i < which.first + which.touches; ++i) {
    const std::optional<press_touch> touch = finder.next(which.seed);
    if (!touch) break;
    if (i < which.first) continue;
    row.sessions.push_back(press_session(render, *touch, probe.model->mass.centre_of_mass, rules,
                                         test_support::seed_of(which.seed, pair.name(), touch->index), originals));
  }
  row.seconds = seconds(std::chrono::steady_clock::now() - start);
  return row;
}

rest_row rest_sessions(const press_pair& pair, const press_body& probe, const press_body& fixed,
                       const render_function& render, const press_choice& which, double plane_stiffness_n_per_m) {
  const auto start = std::chrono::steady_clock::now();
  rest_row row{pair.probe, pair.fixed, {}, 0.0};
  touch_finder finder(pair.name(), probe.full, fixed.full, pair.region);
  for (int i = 0; i < which.first + which.touches; ++i) {
    const std::optional<press_touch> touch = finder.next(which.seed);
    if (!touch) break;
    if (i < which.first) continue;
    rest_rules rules = drawn_rest(which.seed, pair.name(), touch->index);
    rules.plane_stiffness_n_per_m = plane_stiffness_n_per_m;
    row.rests.push_back(rest_session(render, *touch, probe.model->mass.centre_of_mass, rules,
                                     test_support::seed_of(which.seed, pair.name(), touch->index)));
  }
  row.seconds = seconds(std::chrono::steady_clock::now() - start);
  return row;
}

}  // namespace asperity::presses
