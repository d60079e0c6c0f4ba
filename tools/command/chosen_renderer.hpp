// A renderer whose policies were chosen at run time.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <utility>

#include "asperity/render/renderer.hpp"
#include "gpu_use.hpp"

namespace asperity::command {

/// A renderer of any kind. Its ticks are compiled where it is wrapped: one kind in a file, since each takes a compiler
/// half a minute.
class chosen_renderer {
 public:
  template <class Finder, class Depth, class Force>
  explicit chosen_renderer(basic_renderer<Finder, Depth, Force> r)
      : kind_(std::make_unique<held<basic_renderer<Finder, Depth, Force>>>(std::move(r))) {}
  template <class Finder, class Depth, class Force>
  chosen_renderer(basic_renderer<Finder, Depth, Force> r, std::shared_ptr<gpu_use> gpu)
      : chosen_renderer(std::move(r)) {
    gpu_ = std::move(gpu);
  }
  /// Anything else with step(), scene() and memory_bytes(): what changes the ticks of another renderer, for instance.
  template <class Renderer>
  chosen_renderer(std::in_place_type_t<Renderer>, Renderer r) : kind_(std::make_unique<held<Renderer>>(std::move(r))) {}

  [[nodiscard]] status step(const scene_pose& at, tick& out) noexcept { return kind_->step(at, out); }
  [[nodiscard]] const asperity::scene& scene() const noexcept { return kind_->scene(); }
  [[nodiscard]] std::size_t memory_bytes() const noexcept { return kind_->memory_bytes(); }
  /// What a contact of the last tick is deep at most, m; nothing where the depth backend does not know.
  [[nodiscard]] std::optional<double> depth_at_most_m(std::size_t contact) noexcept {
    return kind_->depth_at_most_m(contact);
  }
  /// What it does with a GPU; null where it uses none.
  [[nodiscard]] const std::shared_ptr<gpu_use>& gpu() const noexcept { return gpu_; }

 private:
  struct any_kind {
    virtual ~any_kind() = default;
    [[nodiscard]] virtual status step(const scene_pose& at, tick& out) noexcept = 0;
    [[nodiscard]] virtual const asperity::scene& scene() const noexcept = 0;
    [[nodiscard]] virtual std::size_t memory_bytes() const noexcept = 0;
    [[nodiscard]] virtual std::optional<double> depth_at_most_m(std::size_t contact) noexcept = 0;
  };
  template <class Renderer>
  struct held final : any_kind {
    explicit held(Renderer r) : renderer(std::move(r)) {}
    [[nodiscard]] status step(const scene_pose& at, tick& out) noexcept override { return renderer.step(at, out); }
    [[nodiscard]] const asperity::scene& scene() const noexcept override { return renderer.scene(); }
    [[nodiscard]] std::size_t memory_bytes() const noexcept override { return renderer.memory_bytes(); }
    [[nodiscard]] std::optional<double> depth_at_most_m(std::size_t contact) noexcept override {
      if constexpr (requires { renderer.depth().brackets()[contact].upper_m; }) {
        const auto brackets = renderer.depth().brackets();
        if (contact < brackets.size() && brackets[contact].bounded) return brackets[contact].upper_m;
      }
      return std::nullopt;
    }
    Renderer renderer;
  };

  std::unique_ptr<any_kind> kind_;
  std::shared_ptr<gpu_use> gpu_;
};

}  // namespace asperity::command
