#include "window_on_gpu.hpp"

#include <utility>

#include "asperity/gl/compute_depth.hpp"
#include "asperity/gl/occlusion_depth.hpp"
#include "asperity/window/fallback_depth.hpp"

namespace asperity::command {
namespace {

/// A depth backend whose ticks are counted for the report.
template <class Depth>
class counted_depth {
 public:
  using policy_tag = depth_tag;

  counted_depth(Depth depth, std::shared_ptr<gpu_use> use) : depth_(std::move(depth)), use_(std::move(use)) {}

  [[nodiscard]] status measure(const scene_pose& at, const contact_set& contacts, std::span<penetration> out) noexcept {
    const status s = depth_.measure(at, contacts, out);
    ++use_->ticks;
    if (s == status::backend_failed) ++use_->failed;
    if constexpr (requires { depth_.counted(); }) use_->fallbacks = depth_.counted().fallbacks;
    return s;
  }
  [[nodiscard]] const std::shared_ptr<gpu_use>& use() const noexcept { return use_; }
  [[nodiscard]] std::size_t heap_bytes() const noexcept { return depth_.heap_bytes(); }

 private:
  Depth depth_;
  std::shared_ptr<gpu_use> use_;
};

template <class Depth>
using counted_renderer = basic_renderer<convex_piece_finder, counted_depth<Depth>, gradient_penalty>;
using gpu_alone = counted_renderer<any_depth>;
using gpu_then_cpu = counted_renderer<fallback_depth<any_depth, any_depth>>;

/// Stands for a GPU that could not be opened.
struct absent_depth {
  using policy_tag = depth_tag;
  [[nodiscard]] status measure(const scene_pose&, const contact_set&, std::span<penetration>) noexcept {
    return status::backend_failed;
  }
};

result<any_depth> open(const scene& bodies, const gpu_wish& wish, const window_renderer_settings& settings,
                       gpu_use& use) {
  const result<gl::context_ptr> context = gl::open_context({.device = wish.device});
  if (!context) return context.error();
  result<any_depth> made = wish.make_depth(*context, bodies, settings.depth, settings.limits);
  if (!made) return made.error();
  const gl::context_facts& facts = (*context)->facts();
  use.device = facts.renderer;
  use.version = facts.version;
  use.software = facts.software;
  use.device_bytes = (*context)->device_bytes();
  use.leave_thread = [c = *context] { c->release(); };
  return made;
}

bool is_the_gpu_s(error_code code) { return code == error_code::unsupported || code == error_code::limit_exceeded; }

}  // namespace

result<any_renderer> make_window_on_gpu(scene bodies, const gpu_wish& wish, const window_renderer_settings& settings) {
  if (const result<void> ok = check_has_fixed_body(bodies); !ok) return ok.error();
  result<cpu_depth> cpu = make_cpu_depth(bodies, settings.depth);  // refuses what no backend can use
  if (!cpu) return cpu.error();
  const auto use = std::make_shared<gpu_use>();
  use->fallback = wish.fallback;
  result<any_depth> gpu = open(bodies, wish, settings, *use);
  if (!gpu && !(wish.fallback && is_the_gpu_s(gpu.error().code))) {
    error why = gpu.error();
    if (is_the_gpu_s(why.code)) why.message += wish.instead;
    return why;
  }
  if (!gpu) use->problem = gpu.error().message;
  any_depth first = gpu ? std::move(gpu).value() : any_depth(absent_depth{});
  convex_piece_finder finder(bodies, settings.finder);
  const gradient_penalty force(settings.force);
  if (!wish.fallback) {
    return any_renderer(
        gpu_alone(std::move(bodies), std::move(finder), {std::move(first), use}, force, settings.limits));
  }
  fallback_depth<any_depth, any_depth> both(std::move(first), any_depth(std::move(cpu).value()));
  return any_renderer(
      gpu_then_cpu(std::move(bodies), std::move(finder), {std::move(both), use}, force, settings.limits));
}

std::shared_ptr<gpu_use> gpu_use_of(any_renderer& feel) {
  if (gpu_alone* const r = feel.target<gpu_alone>()) return r->depth().use();
  if (gpu_then_cpu* const r = feel.target<gpu_then_cpu>()) return r->depth().use();
  return nullptr;
}

result<any_depth> make_gl_compute_depth(const gl::context_ptr& context, const scene& bodies,
                                        const window_depth_settings& settings, const contact_limits& limits) {
  result<gl::compute_depth> made =
      gl::compute_depth::make(context, bodies, settings, {.contacts = limits.contacts, .triangles = limits.triangles});
  if (!made) return made.error();
  return any_depth(std::move(made).value());
}

result<any_depth> make_gl_occlusion_depth(const gl::context_ptr& context, const scene& bodies,
                                          const window_depth_settings& settings, const contact_limits& limits) {
  result<gl::occlusion_depth> made = gl::occlusion_depth::make(
      context, bodies, settings, {.contacts = limits.contacts, .triangles = limits.triangles});
  if (!made) return made.error();
  return any_depth(std::move(made).value());
}

}  // namespace asperity::command
