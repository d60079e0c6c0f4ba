#include "asperity/window/gradient_penalty.hpp"
#include "contract/policy/force_model_contract.hpp"

namespace asperity {
namespace {

template <depth_value Value>
struct gradient_penalty_factory {
  using model = gradient_penalty;
  static model make(double stiffness_n_per_m) {
    return gradient_penalty({.stiffness_n_per_m = stiffness_n_per_m, .value = Value});
  }
};

using factories =
    ::testing::Types<gradient_penalty_factory<depth_value::soft>, gradient_penalty_factory<depth_value::hard>>;
INSTANTIATE_TYPED_TEST_SUITE_P(GradientPenalty, ForceModelContract, factories);

}  // namespace
}  // namespace asperity
