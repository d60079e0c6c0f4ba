#include "support/built_renderers.hpp"

#include <cstddef>
#include <mutex>
#include <utility>
#include <vector>

#include "asperity/least_motion/default_renderer.hpp"
#include "asperity/window/paper_renderer.hpp"

namespace asperity::test_support {

struct default_formulation {
  renderer feel;
};
struct papers_formulation {
  paper_renderer feel;
};

template <class Formulation>
built<Formulation>::built(std::unique_ptr<Formulation> made) noexcept : made_(std::move(made)) {}
template <class Formulation>
built<Formulation>::built(built&&) noexcept = default;
template <class Formulation>
built<Formulation>& built<Formulation>::operator=(built&&) noexcept = default;
template <class Formulation>
built<Formulation>::~built() = default;

template <class Formulation>
status built<Formulation>::step(const scene_pose& at, tick& out) noexcept {
  return made_->feel.step(at, out);
}

template <class Formulation>
const asperity::scene& built<Formulation>::scene() const noexcept {
  return made_->feel.scene();
}

template <class Formulation>
const contact_set& built<Formulation>::contacts() const noexcept {
  return made_->feel.contacts();
}

template class built<default_formulation>;
template class built<papers_formulation>;

const least_motion_settings& built_renderer::settings() const noexcept { return made_->feel.force().settings(); }
double built_renderer::energy_j() const noexcept { return made_->feel.force().energy_j(); }

namespace {

// What was made of the last few scenes: tests feel the same bodies again and again, with one setting changed.
struct kept_bodies {
  asperity::scene bodies;
  field_body_settings settings;
  std::shared_ptr<const field_scene> fields;
  std::shared_ptr<const exits::exit_scene> ways_of;
};
constexpr std::size_t scenes_kept = 4;

result<kept_bodies> bodies_of(const asperity::scene& bodies, const field_body_settings& settings) {
  static std::mutex guard;
  static std::vector<kept_bodies> kept;
  const std::lock_guard lock(guard);
  for (const kept_bodies& k : kept) {
    if (k.bodies.probe == bodies.probe && k.bodies.fixed == bodies.fixed && k.settings == settings) return k;
  }
  result<field_scene> made = make_field_scene(bodies, settings);
  if (!made) return made.error();
  auto fields = std::make_shared<const field_scene>(std::move(made).value());
  auto ways_of = std::make_shared<const exits::exit_scene>(*fields);
  if (kept.size() == scenes_kept) kept.erase(kept.begin());
  kept.push_back({bodies, settings, std::move(fields), std::move(ways_of)});
  return kept.back();
}

}  // namespace

result<built_renderer> build_renderer(scene bodies, const renderer_settings& settings) {
  if (const result<void> ok = check_has_fixed_body(bodies); !ok) return ok.error();
  const result<kept_bodies> kept = bodies_of(bodies, settings.bodies);
  if (!kept) return kept.error();
  result<renderer> made = make_renderer(std::move(bodies), kept->fields, kept->ways_of, settings);
  if (!made) return made.error();
  return built_renderer(std::unique_ptr<default_formulation>(new default_formulation{std::move(made).value()}));
}

result<built_paper_renderer> build_paper_renderer(scene bodies, const paper_settings& settings) {
  result<paper_renderer> made = make_paper_renderer(std::move(bodies), settings);
  if (!made) return made.error();
  return built_paper_renderer(std::unique_ptr<papers_formulation>(new papers_formulation{std::move(made).value()}));
}

}  // namespace asperity::test_support
