// The suite that every depth backend passes, for the paper's: as it is, packed, with 24 bits, and in ES.
#include "asperity/gl/occlusion_depth.hpp"
#include "contract/policy/depth_backend_contract.hpp"

namespace asperity {
namespace {

template <gl::dialect Dialect, std::uint32_t Bits, bool Packed>
struct occlusion_factory {
  using backend = gl::occlusion_depth;
  /// The same context for every test: opening one takes longer than measuring.
  static const result<gl::context_ptr>& context() {
    static const auto opened = gl::open_context({.dialect = Dialect});
    return opened;
  }
  static std::string unavailable() { return context() ? "" : context().error().message; }
  static backend make(const scene& s, gradient_scheme /*scheme*/) {
    auto made = gl::occlusion_depth::make(*context(), s, gl::paper_depth_settings(),
                                          {.contacts = 4, .depth_bits = Bits, .packed = Packed});
    EXPECT_TRUE(made) << made.error().message;
    return *std::move(made);
  }
  static window_depth_settings reference(gradient_scheme /*scheme*/) { return gl::paper_depth_settings(); }
  static constexpr bool soft_maximum = false;
  static constexpr bool repeatable = true;
  // The suite's windows of 5 mm see ranges of some 2 mm: a quantum of 3e-8 m, and steps of 80 um and more.
  static constexpr double depth_tolerance_m = Bits == 16 ? 5e-8 : 6e-9;
  static constexpr double gradient_tolerance = Bits == 16 ? 1e-2 : 2e-3;
};

using as_it_is = occlusion_factory<gl::dialect::core, 16, false>;
using packed = occlusion_factory<gl::dialect::core, 16, true>;
using bits_24 = occlusion_factory<gl::dialect::core, 24, false>;
using in_es = occlusion_factory<gl::dialect::es, 16, false>;
INSTANTIATE_TYPED_TEST_SUITE_P(GlOcclusion, DepthBackendContract, as_it_is);
INSTANTIATE_TYPED_TEST_SUITE_P(GlOcclusionPacked, DepthBackendContract, packed);
INSTANTIATE_TYPED_TEST_SUITE_P(GlOcclusion24, DepthBackendContract, bits_24);
INSTANTIATE_TYPED_TEST_SUITE_P(GlOcclusionEs, DepthBackendContract, in_es);

}  // namespace
}  // namespace asperity
