// The closed forms of the depth over every backend that samples a grid. Each is held to two limits: what a grid can
// miss of the closed form, with the backend's own bound on top; and that bound alone against the CPU backend.
#include "asperity/gl/compute_depth.hpp"
#include "asperity/gl/occlusion_depth.hpp"
#include "law/oracle/depth_cases.hpp"

namespace asperity::oracle {
namespace {

window_depth_settings soft(parallax_mode lookup) {
  window_depth_settings s;
  s.grid = case_grid;
  s.parallax = lookup;
  return s;
}

template <parallax_mode Lookup>
struct on_the_cpu {
  static std::string unavailable() { return ""; }
  static window_depth_settings settings() { return soft(Lookup); }
  static cpu_depth make(const scene& s) { return cpu_depth(s, settings()); }
  static double bound_m(const cpu_depth& /*backend*/, const contact_window& /*window*/) { return 0.0; }
};

/// One context for all cases: opening one takes longer than measuring.
template <gl::dialect Dialect>
const result<gl::context_ptr>& shared_context() {
  static const auto opened = gl::open_context({.dialect = Dialect});
  return opened;
}

template <gl::arithmetic Arithmetic, parallax_mode Lookup>
struct in_compute_shaders {
  static std::string unavailable() {
    const auto& context = shared_context<gl::dialect::core>();
    return context ? "" : context.error().message;
  }
  static window_depth_settings settings() { return soft(Lookup); }
  static gl::compute_depth make(const scene& s) {
    auto made = gl::compute_depth::make(*shared_context<gl::dialect::core>(), s, settings(),
                                        {.contacts = 1, .arithmetic = Arithmetic});
    EXPECT_TRUE(made) << made.error().message;
    return *std::move(made);
  }
  static double bound_m(const gl::compute_depth& /*backend*/, const contact_window& window) {
    return (Arithmetic == gl::arithmetic::double_precision ? 1e-11 : 1e-6) * 2.0 * window.half_size_m;
  }
};

template <gl::dialect Dialect>
struct by_occlusion_queries {
  static std::string unavailable() {
    const auto& context = shared_context<Dialect>();
    return context ? "" : context.error().message;
  }
  static window_depth_settings settings() { return gl::paper_depth_settings(case_grid); }
  static gl::occlusion_depth make(const scene& s) {
    auto made = gl::occlusion_depth::make(*shared_context<Dialect>(), s, settings(), {.contacts = 1});
    EXPECT_TRUE(made) << made.error().message;
    return *std::move(made);
  }
  static double bound_m(const gl::occlusion_depth& backend, const contact_window& /*window*/) {
    return backend.quantum_m(0);
  }
};

/// What the CPU backend says about every case.
template <parallax_mode Lookup>
const std::vector<double>& depths_on_the_cpu(std::span<const depth_case> cases) {
  static const std::vector<double> found = [&] {
    std::vector<double> out;
    for (const depth_case& c : cases) {
      cpu_depth backend = on_the_cpu<Lookup>::make(c.bodies);
      out.push_back(test_support::measure_whole(backend, c.bodies, c.window, c.T_wa).depth_m);
    }
    return out;
  }();
  return found;
}

template <class Backend>
class ClosedFormDepths : public testing::Test {
 protected:
  void SetUp() override {
    if (const std::string why = Backend::unavailable(); !why.empty()) GTEST_SKIP() << why;
  }
};

using backends = testing::Types<on_the_cpu<parallax_mode::exact>, on_the_cpu<parallax_mode::paper_lookup>,
                                in_compute_shaders<gl::arithmetic::double_precision, parallax_mode::exact>,
                                in_compute_shaders<gl::arithmetic::double_precision, parallax_mode::paper_lookup>,
                                in_compute_shaders<gl::arithmetic::single_precision, parallax_mode::exact>,
                                by_occlusion_queries<gl::dialect::core>, by_occlusion_queries<gl::dialect::es>>;
struct names {
  template <class Backend>
  static std::string GetName(int i) {
    constexpr std::array all{"Cpu",         "CpuPapersLookup", "GlCompute", "GlComputePapersLookup", "GlComputeSingle",
                             "GlOcclusion", "GlOcclusionEs"};
    return all[static_cast<std::size_t>(i)];
  }
};
TYPED_TEST_SUITE(ClosedFormDepths, backends, names);

TYPED_TEST(ClosedFormDepths, AreWithinTheBackendsBound) {
  static const depth_cases all;
  error_table table("depths in mm, " + std::to_string(case_grid) + " samples per side");
  const bool paper = TypeParam::settings().parallax == parallax_mode::paper_lookup;
  const std::vector<double>& on_cpu = paper ? depths_on_the_cpu<parallax_mode::paper_lookup>(all.all())
                                            : depths_on_the_cpu<parallax_mode::exact>(all.all());
  // Made anew where the bodies change, the next one before the last one goes: they share their programs.
  std::optional<decltype(TypeParam::make(std::declval<const scene&>()))> backend;
  model_ptr probe;
  for (std::size_t i = 0; i < all.all().size(); ++i) {
    const depth_case& c = all.all()[i];
    const std::string form = c.form;
    if (probe != c.bodies.probe) {
      auto next = TypeParam::make(c.bodies);
      backend.emplace(std::move(next));
      probe = c.bodies.probe;
    }
    const penetration p = test_support::measure_whole(*backend, c.bodies, c.window, c.T_wa);
    EXPECT_FALSE(has(p.flags, depth_flag::no_overlap) || has(p.flags, depth_flag::saturated)) << form;
    const double bound_m = TypeParam::bound_m(*backend, c.window), expected_mm = paper ? c.paper_depth_mm : c.depth_mm;
    table.add(form + ", closed form", std::fabs(p.depth_m / mm - expected_mm), c.limit_mm + bound_m / mm);
    table.add(form + ", CPU backend", std::fabs(p.depth_m - on_cpu[i]) / mm, bound_m / mm);
  }
}

}  // namespace
}  // namespace asperity::oracle
