// A renderer chosen at run time: formulation, depth backend and force model behind one virtual call a tick.
#pragma once

#include <concepts>
#include <cstddef>
#include <memory>
#include <type_traits>
#include <utility>

#include "asperity/core/status.hpp"
#include "asperity/model/scene.hpp"
#include "asperity/render/renderer.hpp"

namespace asperity {

/// What a control loop asks of a renderer: every basic_renderer, and what changes the ticks of another one.
template <class R>
concept ticks_contacts = requires(R& r, const R& fixed, const scene_pose& at, tick& out) {
  { r.step(at, out) }
  noexcept->std::same_as<status>;
  { fixed.scene() }
  noexcept->std::same_as<const scene&>;
  { fixed.memory_bytes() }
  noexcept->std::same_as<std::size_t>;
};

/// Owns a renderer of any kind and is one itself.
///
///     asperity::any_renderer feel(papers ? asperity::any_renderer(asperity::make_window_renderer(bodies).value())
///                                        : asperity::any_renderer(asperity::make_renderer(bodies).value()));
///
/// One allocation when it is made, none afterwards. A moved-from any_renderer may only be destroyed or assigned to.
class any_renderer {
 public:
  template <class R>
  requires(!std::same_as<std::remove_cvref_t<R>, any_renderer> &&
           ticks_contacts<std::remove_cvref_t<R>>) explicit any_renderer(R&& inside)
      : self_(std::make_unique<held<std::remove_cvref_t<R>>>(std::forward<R>(inside))) {}

  /// As the renderer inside answers; see basic_renderer::step().
  /// @rt as the renderer inside
  [[nodiscard]] status step(const scene_pose& at, tick& out) noexcept { return self_->step(at, out); }
  [[nodiscard]] const asperity::scene& scene() const noexcept { return self_->scene(); }
  /// Memory that the renderer inside takes, bytes.
  [[nodiscard]] std::size_t memory_bytes() const noexcept { return self_->memory_bytes(); }

  /// The renderer inside where it is an R; otherwise null.
  template <ticks_contacts R>
  [[nodiscard]] R* target() noexcept {
    return self_->kind() == &kind_of<R> ? &static_cast<held<R>&>(*self_).inside : nullptr;
  }

 private:
  // Without run-time type information: a kind is the address of its name.
  template <class R>
  static constexpr char kind_of = 0;

  struct any_kind {
    virtual ~any_kind() = default;
    [[nodiscard]] virtual status step(const scene_pose& at, tick& out) noexcept = 0;
    [[nodiscard]] virtual const asperity::scene& scene() const noexcept = 0;
    [[nodiscard]] virtual std::size_t memory_bytes() const noexcept = 0;
    [[nodiscard]] virtual const char* kind() const noexcept = 0;
  };
  template <class R>
  struct held final : any_kind {
    explicit held(R r) : inside(std::move(r)) {}
    [[nodiscard]] status step(const scene_pose& at, tick& out) noexcept override { return inside.step(at, out); }
    [[nodiscard]] const asperity::scene& scene() const noexcept override { return inside.scene(); }
    [[nodiscard]] std::size_t memory_bytes() const noexcept override { return inside.memory_bytes(); }
    [[nodiscard]] const char* kind() const noexcept override { return &kind_of<R>; }
    R inside;
  };

  std::unique_ptr<any_kind> self_;
};

static_assert(ticks_contacts<any_renderer>);

}  // namespace asperity
