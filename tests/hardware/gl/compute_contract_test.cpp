// The suite that every depth backend passes, for the one in compute shaders: in double and in single precision, and in
// ES.
#include "asperity/gl/compute_depth.hpp"
#include "contract/policy/depth_backend_contract.hpp"

namespace asperity {
namespace {

template <gl::dialect Dialect, gl::arithmetic Arithmetic>
struct compute_factory {
  using backend = gl::compute_depth;
  /// The same context for every test: opening one takes longer than measuring.
  static const result<gl::context_ptr>& context() {
    static const auto opened = gl::open_context({.dialect = Dialect});
    return opened;
  }
  static std::string unavailable() { return context() ? "" : context().error().message; }
  static backend make(const scene& s, gradient_scheme scheme) {
    window_depth_settings settings;
    settings.gradient = scheme;
    auto made = gl::compute_depth::make(*context(), s, settings, {.arithmetic = Arithmetic});
    EXPECT_TRUE(made) << made.error().message;
    return *std::move(made);
  }
  static constexpr bool repeatable = true;
};

struct in_double : compute_factory<gl::dialect::core, gl::arithmetic::double_precision> {
  static constexpr double depth_tolerance_m = 1e-11;
  static constexpr double gradient_tolerance = 1e-5;
};
struct in_single : compute_factory<gl::dialect::core, gl::arithmetic::single_precision> {
  static constexpr double depth_tolerance_m = 6e-9;  // 1e-6 of the window's half size
  static constexpr double gradient_tolerance = 1e-2;
};
struct in_es : compute_factory<gl::dialect::es, gl::arithmetic::automatic> {
  static constexpr double depth_tolerance_m = 6e-9;
  static constexpr double gradient_tolerance = 1e-2;
};

INSTANTIATE_TYPED_TEST_SUITE_P(GlComputeDouble, DepthBackendContract, in_double);
INSTANTIATE_TYPED_TEST_SUITE_P(GlComputeSingle, DepthBackendContract, in_single);
INSTANTIATE_TYPED_TEST_SUITE_P(GlComputeEs, DepthBackendContract, in_es);

}  // namespace
}  // namespace asperity
