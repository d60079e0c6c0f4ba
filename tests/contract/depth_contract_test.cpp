#include "contract/depth_backend_contract.hpp"

namespace asperity {
namespace {

struct cpu_factory {
  using backend = cpu_depth;
  static backend make(const scene& s, gradient_scheme scheme) {
    depth_settings settings;
    settings.gradient = scheme;
    return cpu_depth(s, settings);
  }
  // It is the reference itself: the suite then checks that it does not depend on what it did before.
  static constexpr double depth_tolerance_m = 1e-13;
  static constexpr double gradient_tolerance = 1e-9;
  static constexpr bool repeatable = true;
};

INSTANTIATE_TYPED_TEST_SUITE_P(Cpu, DepthBackendContract, cpu_factory);

}  // namespace
}  // namespace asperity
