#include "asperity/bodies/free_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "asperity/control/exchange.hpp"
#include "asperity/control/linearise.hpp"
#include "asperity/core/memory.hpp"
#include "asperity/field/field_body.hpp"
#include "asperity/planes/plane_renderer.hpp"
#include "bodies/body_step.hpp"
#include "bodies/mover.hpp"
#include "bodies/plane_choice.hpp"
#include "bodies/touch_graph.hpp"

namespace asperity {

namespace {

error bad(std::string what) { return error{error_code::invalid_argument, "free bodies: " + std::move(what)}; }

bool is_above_0(double x) noexcept { return std::isfinite(x) && x > 0.0; }
bool is_at_least_0(double x) noexcept { return std::isfinite(x) && x >= 0.0; }

/// Of a body about its centre of mass, m.
double radius_of(const textured_model& m) noexcept {
  const vec3 c = m.mass.centre_of_mass;
  return glm::length(glm::max(glm::abs(m.box.high - c), glm::abs(m.box.low - c)));
}

/// The renderer of one mover and the bodies after it.
struct rendered {
  std::optional<plane_renderer> renderer;
  tick found;
};

result<detail::mover> mover_of(const free_body& b, std::size_t number) {
  const std::string name = "free body " + std::to_string(number);
  if (!b.model) return bad(name + " has no model");
  if (!is_valid(b.T_wb)) return bad("the pose of " + name + " is not finite, or its quaternion is not of length 1");
  if (!is_at_least_0(b.mass_kg))
    return bad("the mass of " + name + " must be finite and above 0, or 0 for its density");
  const mass_properties& shape = b.model->mass;
  const double mass_kg = b.mass_kg > 0.0 ? b.mass_kg : b.density_kg_per_m3 * shape.volume_m3;
  if (!(is_above_0(mass_kg) && mass_kg >= 1e-6 && mass_kg <= 1e4)) {
    return bad("the mass of " + name + " is " + std::to_string(mass_kg) +
               " kg; it must be from 1e-6 to 1e4: give a mass, or another density");
  }
  return detail::mover{.mass_kg = mass_kg,
                       .inertia_kg_m2 = mass_kg * shape.inertia_per_mass,
                       .centre_b = shape.centre_of_mass,
                       .radius_m = radius_of(*b.model),
                       .T_wc = b.T_wb * pose{quat(1.0, 0.0, 0.0, 0.0), shape.centre_of_mass}};
}

}  // namespace

result<void> check(const free_bodies_settings& s) {
  if (!is_finite(s.gravity_m_per_s2)) return bad("gravity_m_per_s2 must be finite");
  if (!(s.period_s >= 1e-5 && s.period_s <= 0.02)) return bad("period_s must be from 1e-5 to 0.02");
  if (s.render_every < 1 || s.render_every > 100) return bad("render_every must be from 1 to 100");
  if (s.substeps < 1 || s.substeps > 100) return bad("substeps must be from 1 to 100");
  if (!is_at_least_0(s.linear_damping_per_s)) return bad("linear_damping_per_s must be finite, 0 or more");
  if (!is_at_least_0(s.angular_damping_per_s)) return bad("angular_damping_per_s must be finite, 0 or more");
  if (!is_at_least_0(s.sleep_below_m_per_s)) return bad("sleep_below_m_per_s must be finite, 0 or more");
  if (!is_at_least_0(s.sleep_after_s)) return bad("sleep_after_s must be finite, 0 or more");
  if (!(s.fastest_m_per_s >= 0.1 && s.fastest_m_per_s <= 100.0)) return bad("fastest_m_per_s must be from 0.1 to 100");
  if (!is_above_0(s.probe.mass_kg)) return bad("probe.mass_kg must be finite and above 0");
  if (!is_valid(s.T_ha)) return bad("T_ha is not finite, or its quaternion is not of length 1");
  if (s.most_leaves < 16 || s.most_leaves > 1'000'000) return bad("most_leaves must be from 16 to 1e6");
  if (s.most_planes < most_support_planes || s.most_planes > 100'000) {
    return bad("most_planes must be from " + std::to_string(most_support_planes) + " to 1e5");
  }
  if (const result<void> ok = check(s.contact); !ok) return ok;
  return check(s.friction);
}

struct free_bodies::parts {
  free_bodies_settings settings;
  bool has_probe;
  virtual_coupling coupling;
  pose T_hc{}, T_ca{};
  std::vector<detail::mover> movers;  // the probe first
  std::vector<detail::mover_contacts> contacts{};
  std::vector<rendered> renderers{};
  std::vector<pose> standing_T_wb{};
  std::vector<vec3> standing_centres_w{};
  detail::body_step step;
  detail::touch_graph touches;
  detail::plane_choice choice;
  pose target_T_wc{};
  twist target_velocity_w{};
  int calls_until_render = 0;
  double spent_s = 0.0;  // by the last call
  status answer = status::ok;
  tick_flag flags = tick_flag::none;
  bool left_out = false;
  std::vector<pose> now_T_wb{};

  [[nodiscard]] std::size_t first() const noexcept { return has_probe ? 1 : 0; }
  [[nodiscard]] detail::mover* free(std::size_t body) noexcept {
    return body < movers.size() - first() ? &movers[first() + body] : nullptr;
  }
  [[nodiscard]] double render_period_s() const noexcept { return settings.period_s * settings.render_every; }

  void wake_all() noexcept {
    for (detail::mover& m : movers) m.sleeps = false, m.quiet_s = 0.0;
    calls_until_render = 0;
  }

  // Which movers touch, or will within the time until contacts are told anew, at their speeds.
  void find_touches() noexcept {
    touches.clear();
    const double soon_s = 1.5 * render_period_s();
    for (std::uint32_t a = 0; a < movers.size(); ++a) {
      for (const support_plane& p : contacts[a].contact.planes) {
        const std::uint32_t b = contacts[a].others[p.body].number;
        if (b >= movers.size()) continue;
        const vec6 slide = movers[a].velocity -
                           detail::seen_from(movers[b].velocity, movers[a].T_wc.position - movers[b].T_wc.position);
        if (p.depth_m + soon_s * std::max(0.0, dot(p.gradient, slide)) > 0.0) touches.meet(a, b);
      }
    }
  }

  void wake_touched() noexcept {
    find_touches();
    const detail::touch_graph::group awake = touches.reached_from([&](std::size_t m) { return !movers[m].sleeps; });
    for (std::size_t m = 0; m < movers.size(); ++m) {
      if (awake[m] && movers[m].sleeps) movers[m].sleeps = false, movers[m].quiet_s = 0.0;
    }
  }

  // Bodies that are slow, and all whom they touch are.
  void put_to_sleep(double dt_s) noexcept {
    if (!(settings.sleep_after_s > 0.0)) return;
    for (std::size_t m = first(); m < movers.size(); ++m) {
      const bool slow = movers[m].speed() < settings.sleep_below_m_per_s && is_zero(movers[m].push_w);
      movers[m].quiet_s = slow ? movers[m].quiet_s + dt_s : 0.0;
    }
    const detail::touch_graph::group kept_awake = touches.reached_from(
        [&](std::size_t m) { return (has_probe && m == 0) || movers[m].quiet_s < settings.sleep_after_s; });
    for (std::size_t m = first(); m < movers.size(); ++m) {
      detail::mover& body = movers[m];
      if (kept_awake[m] || body.sleeps) continue;
      const vec3 w = glm::conjugate(body.T_wc.rotation) * body.velocity.angular;
      step.lose(0.5 * body.mass_kg * glm::dot(body.velocity.linear, body.velocity.linear) +
                0.5 * glm::dot(w, body.inertia_kg_m2 * w));
      body.velocity = {};
      body.sleeps = true;
    }
  }

  [[nodiscard]] pose T_wb_of(std::uint32_t body) const noexcept {
    return body < movers.size() ? movers[body].T_wb() : standing_T_wb[body - movers.size()];
  }

  // So far may points of two bodies come to each other before contacts are told anew.
  [[nodiscard]] double gaps_m() const noexcept {
    constexpr double begins_m_per_s = 0.3;
    double fastest = 0.0, next = 0.0;
    for (const detail::mover& m : movers) {
      const double speed = m.speed();
      next = std::max(next, std::min(speed, fastest));
      fastest = std::max(fastest, speed);
    }
    return 1.5 * render_period_s() * (fastest + next + 2.0 * begins_m_per_s);
  }

  void render() noexcept {
    flags = tick_flag::none;
    left_out = false;
    const double gaps = gaps_m();
    const plane_selection selection = selection_for(static_cast<std::int64_t>(1e9 * render_period_s()));
    for (detail::mover& m : movers) {
      m.known_m = std::numeric_limits<double>::infinity();
      m.known_from_T_wc = m.T_wc;
    }
    for (std::uint32_t a = 0; a < movers.size(); ++a) {
      rendered& r = renderers[a];
      detail::mover_contacts& of = contacts[a];
      if (!r.renderer) continue;
      const bool all_sleep =
          movers[a].sleeps && std::all_of(of.others.begin(), of.others.end(), [&](const detail::other_body& b) {
            return b.number >= movers.size() || movers[b.number].sleeps;
          });
      if (all_sleep) continue;
      for (std::size_t i = 0; i < of.others.size(); ++i) now_T_wb[i] = T_wb_of(of.others[i].number);
      const std::span<const pose> at(now_T_wb.data(), of.others.size());
      const status s = r.renderer->step({movers[a].T_wb(), at, gaps}, r.found);
      const bool usable = s == status::ok || s == status::capacity_reached;
      const status told = usable ? choice.choose(r.found.planes, selection, of) : s;
      if (told != status::ok && told != status::capacity_reached) {
        answer = told;
        continue;
      }
      of.contact.T_wc = movers[a].T_wc;
      std::copy(at.begin(), at.end(), of.T_wb.begin());
      of.contact.known = r.found.known;
      of.contact.flags = r.found.flags;
      left_out = left_out || s == status::capacity_reached ||
                 (told == status::capacity_reached &&
                  lacks_a_wall(r.found.planes, of.contact.planes, selection.same_direction));
      flags |= of.contact.flags;
      if (!of.contact.known.is_limited()) continue;
      // Half of the way for each of two.
      const double half_m = 0.5 * of.contact.known.way_m;
      movers[a].known_m = std::min(movers[a].known_m, half_m);
      for (const detail::other_body& b : of.others) {
        if (b.number < movers.size()) movers[b.number].known_m = std::min(movers[b.number].known_m, half_m);
      }
    }
    wake_touched();
  }

  void move(double dt_s, const pose& wanted_T_wc) noexcept {
    answer = status::ok;
    if (calls_until_render <= 0) {
      render();
      calls_until_render = settings.render_every;
    }
    --calls_until_render;
    if (answer != status::ok) return;
    step.begin();
    const pose from = target_T_wc;
    const vec6 way = has_probe ? pose_difference(wanted_T_wc, from) : vec6{};
    if (has_probe) {
      target_T_wc = wanted_T_wc;
      target_velocity_w = to_twist((1.0 / dt_s) * way);
    }
    for (int i = 1; i <= settings.substeps; ++i) {
      const double passed = static_cast<double>(i) / settings.substeps;
      const pose target{exp_rotation(passed * way.angular) * from.rotation, from.position + passed * way.linear};
      const status s =
          step.step(dt_s / settings.substeps, movers, contacts, standing_centres_w, {target, target_velocity_w});
      left_out = left_out || s == status::capacity_reached;
      if (s == status::not_finite) {
        answer = s;
        return;
      }
    }
    step.add_sleepers(dt_s, movers, contacts, standing_centres_w);
    spent_s = dt_s;
    find_touches();
    step.for_each_touch([&](std::uint32_t a, std::uint32_t b) noexcept { touches.meet(a, b); });
    put_to_sleep(dt_s);
    for (detail::mover& m : movers) m.push_w = {};
    if (left_out) answer = status::capacity_reached;
  }

  [[nodiscard]] wrench mean_on(std::size_t body) const noexcept {
    return spent_s > 0.0 ? (1.0 / spent_s) * step.impulses()[body] : wrench{};
  }
};

result<free_bodies> free_bodies::make(const free_scene& scene, const free_bodies_settings& settings) {
  if (const result<void> ok = check(settings); !ok) return ok.error();
  if (scene.free.empty()) return bad("there is no free body; virtual_tool is for a probe among bodies that stand");
  if (scene.free.size() > most_free_bodies) {
    return bad("there are " + std::to_string(scene.free.size()) + " of them, and room for " +
               std::to_string(most_free_bodies));
  }
  std::vector<detail::mover> movers;
  std::vector<model_ptr> models;
  const bool has_probe = scene.probe != nullptr;
  if (has_probe) {
    const vec3 centre = scene.probe->mass.centre_of_mass;
    movers.push_back({.mass_kg = settings.probe.mass_kg,
                      .inertia_kg_m2 = settings.probe.inertia_kg_m2,
                      .centre_b = centre,
                      .radius_m = radius_of(*scene.probe)});
    models.push_back(scene.probe);
  }
  for (std::size_t i = 0; i < scene.free.size(); ++i) {
    result<detail::mover> m = mover_of(scene.free[i], i);
    if (!m) return m.error();
    movers.push_back(*m);
    models.push_back(scene.free[i].model);
  }
  for (std::size_t i = 0; i < scene.standing.size(); ++i) {
    const standing_body& b = scene.standing[i];
    if (!b.model) return bad("standing body " + std::to_string(i) + " has no model");
    if (!is_valid(b.T_wb)) return bad("the pose of standing body " + std::to_string(i) + " is not valid");
    models.push_back(b.model);
  }
  // One field for each model, whoever meets it.
  asperity::scene all{models.front(), {models.begin() + (models.size() > 1 ? 1 : 0), models.end()}};
  result<field_scene> fields = make_field_scene(all, settings.fields);
  if (!fields) return fields.error();
  const auto field_of = [&](std::size_t i) {
    if (models.size() == 1) return fields->probe;
    return i == 0 ? fields->probe : fields->fixed[i - 1];
  };
  const virtual_coupling coupling(
      settings.coupling, settings.probe.mass_kg,
      (settings.probe.inertia_kg_m2[0][0] + settings.probe.inertia_kg_m2[1][1] + settings.probe.inertia_kg_m2[2][2]) /
          3.0);
  const vec3 centre = has_probe ? scene.probe->mass.centre_of_mass : vec3(0.0);
  auto made = std::make_unique<parts>(
      parts{.settings = settings,
            .has_probe = has_probe,
            .coupling = coupling,
            .T_hc = settings.T_ha * pose{quat(1.0, 0.0, 0.0, 0.0), centre},
            .T_ca = pose{quat(1.0, 0.0, 0.0, 0.0), -centre},
            .movers = movers,
            .step = detail::body_step(settings, coupling, movers.size(), scene.standing.size(), has_probe),
            .touches = detail::touch_graph(movers.size()),
            .choice = detail::plane_choice(settings.most_leaves)});
  for (const standing_body& b : scene.standing) {
    made->standing_T_wb.push_back(b.T_wb);
    made->standing_centres_w.push_back(b.T_wb * b.model->mass.centre_of_mass);
  }
  made->now_T_wb.resize(models.size());
  made->contacts.resize(movers.size());
  made->renderers.resize(movers.size());
  for (std::size_t a = 0; a < movers.size(); ++a) {
    asperity::scene bodies{models[a], {models.begin() + static_cast<std::ptrdiff_t>(a) + 1, models.end()}};
    if (bodies.fixed.empty()) continue;
    auto of_these = std::make_shared<field_scene>();
    of_these->probe = field_of(a);
    double smallest_m = models[a]->box.diagonal();
    for (std::size_t b = a + 1; b < models.size(); ++b) {
      of_these->fixed.push_back(field_of(b));
      smallest_m = std::min(smallest_m, models[b]->box.diagonal());
      const bool is_smaller = models[a]->box.diagonal() <= models[b]->box.diagonal();
      const std::uint32_t larger = is_smaller ? detail::of_other : detail::of_mover;
      const bool feels_all = has_probe && a == 0;  // a hand feels the texture of both
      made->contacts[a].others.push_back({static_cast<std::uint32_t>(b), feels_all ? 0 : larger});
    }
    made->contacts[a].springs.resize(made->contacts[a].others.size());
    made->contacts[a].T_wb.resize(bodies.fixed.size());
    made->contacts[a].laws = {settings.contact, surfaces_of(bodies)};
    plane_renderer_settings of_renderer;
    of_renderer.reach_m = std::min(0.25 * smallest_m, 3.0 * made->render_period_s() * settings.fastest_m_per_s);
    of_renderer.limits.leaves = settings.most_leaves;
    result<plane_renderer> renderer = make_plane_renderer(std::move(bodies), std::move(of_these), of_renderer);
    if (!renderer) return renderer.error();
    made->renderers[a].renderer = std::move(renderer).value();
  }
  return free_bodies(std::move(made));
}

free_bodies::free_bodies(std::unique_ptr<parts> made) noexcept : parts_(std::move(made)) {}
free_bodies::free_bodies(free_bodies&&) noexcept = default;
free_bodies& free_bodies::operator=(free_bodies&&) noexcept = default;
free_bodies::~free_bodies() = default;

void free_bodies::place(const pose& T_wh) noexcept {
  parts& p = *parts_;
  if (!p.has_probe) return;
  p.step.forget(0);
  p.target_T_wc = T_wh * p.T_hc;
  p.target_velocity_w = {};
  p.movers[0].T_wc = p.target_T_wc;
  p.movers[0].velocity = {};
  p.calls_until_render = 0;
}

bool free_bodies::put(std::size_t body, const pose& T_wb, const twist& velocity_w) noexcept {
  parts& p = *parts_;
  detail::mover* const m = p.free(body);
  if (m == nullptr || !is_valid(T_wb) || !is_finite(to_vec6(velocity_w))) return false;
  m->T_wc = T_wb * pose{quat(1.0, 0.0, 0.0, 0.0), m->centre_b};
  m->velocity = to_vec6(velocity_w);
  p.step.forget(static_cast<std::uint32_t>(p.first() + body));
  p.wake_all();
  return true;
}

bool free_bodies::push(std::size_t body, const wrench& on_body_w) noexcept {
  detail::mover* const m = parts_->free(body);
  if (m == nullptr || !is_finite(on_body_w)) return false;
  m->push_w += on_body_w;
  m->sleeps = false;
  m->quiet_s = 0.0;
  return true;
}

wrench free_bodies::follow(const pose& T_wh, double dt_s) noexcept {
  parts& p = *parts_;
  if (!p.has_probe || !is_valid(T_wh) || !(std::isfinite(dt_s) && dt_s > 0.0)) {
    p.answer = status::invalid_pose;
    return {};
  }
  p.move(std::min(dt_s, 2.0 * p.settings.period_s), T_wh * p.T_hc);
  if (p.answer != status::ok && p.answer != status::capacity_reached) return {};
  const detail::mover& m = p.movers[0];
  const wrench on_probe = p.coupling.on_probe(p.target_T_wc, p.target_velocity_w, m.T_wc, to_twist(m.velocity));
  const wrench felt = transport(-1.0 * on_probe, p.target_T_wc.position, T_wh.position);
  if (!is_finite(felt)) p.answer = status::not_finite;
  return is_finite(felt) ? felt : wrench{};
}

void free_bodies::advance(double dt_s) noexcept {
  parts& p = *parts_;
  if (!(std::isfinite(dt_s) && dt_s > 0.0)) {
    p.answer = status::invalid_pose;
    return;
  }
  p.move(std::min(dt_s, 2.0 * p.settings.period_s), p.target_T_wc);
}

status free_bodies::last() const noexcept { return parts_->answer; }
tick_flag free_bodies::flags() const noexcept { return parts_->flags; }
std::size_t free_bodies::size() const noexcept { return parts_->movers.size() - parts_->first(); }
pose free_bodies::T_wb(std::size_t body) const noexcept {
  const detail::mover* const m = parts_->free(body);
  return m != nullptr ? m->T_wb() : pose{};
}
twist free_bodies::velocity_w(std::size_t body) const noexcept {
  const detail::mover* const m = parts_->free(body);
  return m != nullptr ? to_twist(m->velocity) : twist{};
}
double free_bodies::mass_kg(std::size_t body) const noexcept {
  const detail::mover* const m = parts_->free(body);
  return m != nullptr ? m->mass_kg : 0.0;
}
bool free_bodies::sleeps(std::size_t body) const noexcept {
  const detail::mover* const m = parts_->free(body);
  return m != nullptr && m->sleeps;
}
wrench free_bodies::on_free(std::size_t body) const noexcept {
  return body < size() ? parts_->mean_on(parts_->first() + body) : wrench{};
}
wrench free_bodies::on_standing(std::size_t body) const noexcept {
  return body < parts_->standing_T_wb.size() ? parts_->mean_on(parts_->movers.size() + body) : wrench{};
}
pose free_bodies::T_wa() const noexcept { return parts_->has_probe ? parts_->movers[0].T_wc * parts_->T_ca : pose{}; }
bool free_bodies::has_braked() const noexcept { return parts_->step.has_braked(); }
const bodies_energy& free_bodies::energy() const noexcept { return parts_->step.energy(); }

std::size_t free_bodies::memory_bytes() const noexcept {
  const parts& p = *parts_;
  std::size_t bytes = sizeof *this + sizeof p + p.step.heap_bytes() + p.choice.heap_bytes() +
                      heap_bytes(p.movers, p.standing_T_wb, p.standing_centres_w, p.now_T_wb);
  for (const detail::mover_contacts& c : p.contacts) {
    bytes += sizeof c + heap_bytes(c.others, c.springs, c.T_wb) +
             c.laws.pairs.capacity() * sizeof(std::optional<surface_pair>);
  }
  for (const rendered& r : p.renderers) bytes += sizeof r + (r.renderer ? r.renderer->memory_bytes() : 0);
  return bytes;
}

}  // namespace asperity
