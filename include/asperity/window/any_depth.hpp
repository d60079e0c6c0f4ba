// A depth backend chosen at run time.
#pragma once

#include <concepts>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>

#include "asperity/core/memory.hpp"
#include "asperity/render/contact.hpp"
#include "asperity/render/depth_backend.hpp"

namespace asperity {

/// Owns any depth backend that measures contacts, and is a depth backend itself: a program chooses between CPU and GPU
/// when it starts. One allocation when it is made, none afterwards; one call through a function pointer per tick, for
/// all contacts together.
/// A moved-from any_depth may only be destroyed or assigned to.
class any_depth {
 public:
  using policy_tag = depth_tag;

  template <class D>
  requires(!std::same_as<std::remove_cvref_t<D>, any_depth> && depth_backend<std::remove_cvref_t<D>> &&
           std::same_as<found_by<std::remove_cvref_t<D>>, contact_set> &&
           std::same_as<reading_of<std::remove_cvref_t<D>>, penetration>) explicit any_depth(D&& backend)
      : self_(new std::remove_cvref_t<D>(std::forward<D>(backend)), table_for<std::remove_cvref_t<D>>.destroy),
        table_(&table_for<std::remove_cvref_t<D>>) {}

  /// What the backend inside answers.
  /// @rt as the backend inside
  [[nodiscard]] status measure(const scene_pose& at, const contact_set& contacts, std::span<penetration> out) noexcept {
    return table_->measure(self_.get(), at, contacts, out);
  }
  /// Size of the backend and of the memory that it reports.
  [[nodiscard]] std::size_t heap_bytes() const noexcept { return table_->heap_bytes(self_.get()); }

 private:
  struct table {
    status (*measure)(void*, const scene_pose&, const contact_set&, std::span<penetration>) noexcept;
    std::size_t (*heap_bytes)(const void*) noexcept;
    void (*destroy)(void*) noexcept;
  };

  template <class D>
  static constexpr table table_for{
      [](void* self, const scene_pose& at, const contact_set& contacts, std::span<penetration> out) noexcept {
        return static_cast<D*>(self)->measure(at, contacts, out);
      },
      [](const void* self) noexcept {
        if constexpr (reports_heap<D>) return sizeof(D) + static_cast<const D*>(self)->heap_bytes();
        return sizeof(D);
      },
      [](void* self) noexcept { delete static_cast<D*>(self); }};

  std::unique_ptr<void, void (*)(void*) noexcept> self_;
  const table* table_;
};

static_assert(depth_backend<any_depth>);

}  // namespace asperity
