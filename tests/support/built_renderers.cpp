#include "support/built_renderers.hpp"

#include <cstddef>
#include <mutex>
#include <utility>
#include <vector>

#include "asperity/render/default_renderer.hpp"

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

const shared_settings& built_renderer::settings() const noexcept { return made_->feel.force().settings(); }
double built_renderer::energy_j() const noexcept { return made_->feel.force().energy_j(); }

namespace {

// The cells of the last few scenes: tests feel the same bodies again and again, with one setting changed.
struct kept_cells {
  asperity::scene bodies;
  cell_settings settings;
  std::shared_ptr<const cell_scene> cells;
};
constexpr std::size_t scenes_kept = 4;

bool same_bodies(const asperity::scene& a, const asperity::scene& b) {
  return a.probe == b.probe && a.fixed == b.fixed;
}

result<std::shared_ptr<const cell_scene>> cells_of(const asperity::scene& bodies, const cell_settings& settings) {
  static std::mutex guard;
  static std::vector<kept_cells> kept;
  const std::lock_guard lock(guard);
  for (const kept_cells& k : kept) {
    if (same_bodies(k.bodies, bodies) && k.settings == settings) return k.cells;
  }
  result<cell_scene> cut = make_cell_scene(bodies, settings);
  if (!cut) return cut.error();
  if (kept.size() == scenes_kept) kept.erase(kept.begin());
  kept.push_back({bodies, settings, std::make_shared<const cell_scene>(std::move(cut).value())});
  return kept.back().cells;
}

}  // namespace

result<built_renderer> build_renderer(scene bodies, const renderer_settings& settings) {
  const auto cells = cells_of(bodies, settings.cells);
  if (!cells) return cells.error();
  result<renderer> made = make_renderer(std::move(bodies), *cells, settings);
  if (!made) return made.error();
  return built_renderer(std::unique_ptr<default_formulation>(new default_formulation{std::move(made).value()}));
}

result<built_paper_renderer> build_paper_renderer(scene bodies, const paper_settings& settings) {
  result<paper_renderer> made = make_paper_renderer(std::move(bodies), settings);
  if (!made) return made.error();
  return built_paper_renderer(std::unique_ptr<papers_formulation>(new papers_formulation{std::move(made).value()}));
}

}  // namespace asperity::test_support
