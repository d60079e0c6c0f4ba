#include "contract/policy/renderer_contract.hpp"

#include "asperity/planes/plane_renderer.hpp"
#include "asperity/window/any_depth.hpp"
#include "asperity/window/window_renderer.hpp"
#include "exact/exact_renderer.hpp"
#include "support/kept_bodies.hpp"

namespace asperity {
namespace {

struct default_factory {
  static any_renderer make(const scene& bodies) { return any_renderer(test_support::build_renderer(bodies).value()); }
};
struct default_with_planes {
  static any_renderer make(const scene& bodies) {
    return any_renderer(test_support::build_renderer(bodies, {.reach_m = 1e-3}).value());
  }
};
struct planes_factory {
  static any_renderer make(const scene& bodies) {
    static const auto fields = std::make_shared<const field_scene>(make_field_scene(bodies).value());
    return any_renderer(make_plane_renderer(bodies, fields).value());
  }
};
template <gradient_scheme Scheme>
struct paper_factory {
  static any_renderer make(const scene& bodies) {
    return any_renderer(make_window_renderer(bodies, {.depth = {.gradient = Scheme}}).value());
  }
};
struct exact_factory {
  static any_renderer make(const scene& bodies) { return any_renderer(make_exact_renderer(bodies).value()); }
};
/// The paper's with a depth backend chosen at run time.
struct erased_depth_factory {
  static any_renderer make(const scene& bodies) {
    return any_renderer(basic_renderer<convex_piece_finder, any_depth, gradient_penalty>(
        bodies, convex_piece_finder(bodies), any_depth(cpu_depth(bodies)), gradient_penalty()));
  }
};

using factories =
    ::testing::Types<default_factory, default_with_planes, planes_factory, paper_factory<gradient_scheme::soft_max>,
                     paper_factory<gradient_scheme::central_difference>, exact_factory, erased_depth_factory>;
INSTANTIATE_TYPED_TEST_SUITE_P(Renderers, RendererContract, factories);

TEST(AnyRenderer, GivesTheBitsOfWhatIsInside) {
  using fixture = RendererContract<default_factory>;
  window_renderer alone = make_window_renderer(fixture::bodies()).value();
  any_renderer erased(make_window_renderer(fixture::bodies()).value());
  const std::vector<pose> fixed = fixture::where_fixed();
  const pose pressed{quat(1, 0, 0, 0), {0.001, 0.002, 0.0145}};
  tick a, b;
  ASSERT_EQ(alone.step({pressed, fixed}, a), status::ok);
  ASSERT_EQ(erased.step({pressed, fixed}, b), status::ok);
  EXPECT_EQ(a.force.on_probe_w.force, b.force.on_probe_w.force);
  EXPECT_EQ(a.force.stiffness.m, b.force.stiffness.m);
  EXPECT_EQ(&erased.scene(), &erased.target<window_renderer>()->scene());
}

TEST(AnyRenderer, KnowsWhatIsInside) {
  any_renderer erased(make_window_renderer(RendererContract<default_factory>::bodies()).value());
  EXPECT_NE(erased.target<window_renderer>(), nullptr);
  EXPECT_EQ(erased.target<least_motion_renderer>(), nullptr);
  any_renderer moved(std::move(erased));
  EXPECT_NE(moved.target<window_renderer>(), nullptr);
}

}  // namespace
}  // namespace asperity
