#include "baselines_renderers.hpp"

#include <utility>

#include "baselines/ho.hpp"
#include "baselines/minsky.hpp"
#include "baselines/point_depth.hpp"
#include "baselines/siira_pai.hpp"

namespace asperity::experiment {
namespace {

template <class Model>
any_renderer make(const scene& bodies, const std::optional<vec3>& point_a, Model model) {
  using namespace baselines;
  return any_renderer(basic_renderer<point_finder, point_depth, Model>(bodies, point_finder(bodies),
                                                                       point_depth(bodies, point_a), std::move(model)));
}

}  // namespace

any_renderer make_point_renderer(const scene& bodies, point_force model, const std::optional<vec3>& point_a) {
  switch (model) {
    case point_force::minsky:
      return make(bodies, point_a, baselines::minsky());
    case point_force::minsky_by_pressure:
      return make(bodies, point_a, baselines::minsky({.grows_with_pressure = true}));
    case point_force::ho:
      return make(bodies, point_a, baselines::ho());
    case point_force::siira_pai:
      break;
  }
  return make(bodies, point_a, baselines::siira_pai());
}

}  // namespace asperity::experiment
