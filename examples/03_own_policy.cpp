// A force model of your own in the renderer: a spring that softens, so that no contact pushes harder along its normal
// than a limit.
#include <cmath>
#include <cstdio>

#include <asperity/asperity.hpp>
#include <asperity/io/textured_model_file.hpp>

// force_tag says "I keep the contract of render/force_model.hpp"; the compiler checks the signature, noexcept included.
class gentle_spring {
 public:
  using policy_tag = asperity::force_tag;

  gentle_spring(double stiffness_n_per_m, double limit_n) : stiffness_n_per_m_(stiffness_n_per_m), limit_n_(limit_n) {}

  // Force f(d) = limit tanh(k d / limit) along the gradient of the depth d: stiffness k at first touch, never more than
  // the limit along the normal. Its derivative f' is positive, so J = -f' g g^T pulls nothing and an implicit step may
  // use it. What it reports as contacts is what was found.
  [[nodiscard]] asperity::status accumulate(const asperity::scene_pose&, const asperity::contact_set& contacts,
                                            std::span<const asperity::penetration> depths,
                                            asperity::force_report& out) const noexcept {
    out = {{}, contacts.contacts(), depths.first(contacts.size())};
    for (const asperity::penetration& p : out.depths) {
      if (!(p.soft_depth_m > 0.0) || has(p.flags, asperity::depth_flag::no_overlap)) continue;
      const double t = std::tanh(stiffness_n_per_m_ * p.soft_depth_m / limit_n_);
      out.force.on_probe_w += to_wrench(-limit_n_ * t * p.gradient);
      add_outer(out.force.stiffness, -stiffness_n_per_m_ * (1.0 - t * t), p.gradient);
    }
    return asperity::status::ok;
  }

 private:
  double stiffness_n_per_m_;
  double limit_n_;
};
static_assert(asperity::force_model<gentle_spring>);

using gentle_renderer = asperity::basic_renderer<asperity::convex_piece_finder, asperity::cpu_depth, gentle_spring>;

int main(int argc, char** argv) {
  if (argc != 3) return std::puts("usage: 03_own_policy PROBE.glb FIXED.glb"), 2;
  auto probe = asperity::io::load_textured_model(argv[1]);
  auto fixed = asperity::io::load_textured_model(argv[2]);
  if (!probe || !fixed) return std::puts((probe ? fixed : probe).error().message.c_str()), 1;
  const auto a = std::make_shared<const asperity::textured_model>(std::move(*probe));
  const auto b = std::make_shared<const asperity::textured_model>(std::move(*fixed));

  const asperity::scene bodies{a, {b}};
  auto depth = asperity::make_cpu_depth(bodies);
  auto usual = asperity::make_window_renderer(bodies);
  if (!depth || !usual) return std::puts((depth ? usual.error() : depth.error()).message.c_str()), 1;
  gentle_renderer gentle(bodies, asperity::convex_piece_finder(bodies), std::move(*depth), gentle_spring(2000.0, 1.0));

  const std::vector<asperity::pose> T_wb(1);
  asperity::pose T_wa;
  std::puts("pressed by   usual force   gentle force");
  for (const double pressed_m : {0.0, 0.0002, 0.0005, 0.001}) {
    T_wa.position.z = b->box.high.z - a->box.low.z - pressed_m;
    asperity::tick hard;
    asperity::tick soft;
    if (usual->step({T_wa, T_wb}, hard) != asperity::status::ok) return 1;
    if (gentle.step({T_wa, T_wb}, soft) != asperity::status::ok) return 1;
    std::printf("%7.1f mm %11.3f N %12.3f N\n", 1e3 * pressed_m, glm::length(hard.force.on_probe_w.force),
                glm::length(soft.force.on_probe_w.force));
  }
  return 0;
}
