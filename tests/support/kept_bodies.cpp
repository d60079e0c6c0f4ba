#include "support/kept_bodies.hpp"

#include <cstddef>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace asperity::test_support {
namespace {

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
  auto ways_of = exits::make_exit_scene(*fields);
  if (kept.size() == scenes_kept) kept.erase(kept.begin());
  kept.push_back({bodies, settings, std::move(fields), std::move(ways_of)});
  return kept.back();
}

}  // namespace

result<least_motion_renderer> build_renderer(scene bodies, const least_motion_renderer_settings& settings) {
  if (const result<void> ok = check_has_fixed_body(bodies); !ok) return ok.error();
  const result<kept_bodies> kept = bodies_of(bodies, settings.bodies);
  if (!kept) return kept.error();
  return make_least_motion_renderer(std::move(bodies), kept->fields, kept->ways_of, settings);
}

}  // namespace asperity::test_support
