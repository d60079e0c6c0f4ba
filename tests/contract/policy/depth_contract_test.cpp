#include "contract/policy/depth_backend_contract.hpp"
#include "exact/exact_depth.hpp"

namespace asperity {
namespace {

struct cpu_factory {
  using backend = cpu_depth;
  static backend make(const scene& s, gradient_scheme scheme) {
    window_depth_settings settings;
    settings.gradient = scheme;
    return cpu_depth(s, settings);
  }
  // It is the reference itself: the suite then checks that it does not depend on what it did before.
  static constexpr double depth_tolerance_m = 1e-13;
  static constexpr double gradient_tolerance = 1e-9;
  static constexpr bool repeatable = true;
};

INSTANTIATE_TYPED_TEST_SUITE_P(Cpu, DepthBackendContract, cpu_factory);

struct exact_factory {
  using backend = exact_depth;
  static backend make(const scene& s, gradient_scheme /*scheme*/) { return exact_depth(s); }
  // 64 x 64 samples miss up to 7 um of the suite's textures, and the slopes of their maximum are up to 0.6 off; what
  // 256 x 256 leave is the reference's own error. ExactDepth.TheGradientIsThatOfTheMaximum measures this backend's.
  static window_depth_settings reference(gradient_scheme scheme) {
    return {.gradient = scheme, .grid = 256, .difference_step_m = 1e-5, .refine_maximum = true};
  }
  static constexpr double depth_tolerance_m = 1e-6;
  static constexpr double gradient_tolerance = 0.3;
  static constexpr bool repeatable = true;
  static constexpr bool soft_maximum = false;
};

INSTANTIATE_TYPED_TEST_SUITE_P(Exact, DepthBackendContract, exact_factory);

}  // namespace
}  // namespace asperity
