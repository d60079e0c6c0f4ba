// A device chosen at run time.
#pragma once

#include <concepts>
#include <cstdint>
#include <memory>
#include <utility>

#include "asperity/device/device.hpp"

namespace asperity {

/// Owns any haptic_device and is one itself: the choice of a device at the edge of a program, static code behind it.
/// One allocation when it is made, none afterwards; calls go through a table of function pointers.
/// A moved-from any_device may only be destroyed or assigned to.
class any_device {
 public:
  using policy_tag = device_tag;

  template <class D>
  requires(!std::same_as<std::remove_cvref_t<D>, any_device> &&
           haptic_device<std::remove_cvref_t<D>>) explicit any_device(D&& dev)
      : self_(new std::remove_cvref_t<D>(std::forward<D>(dev)), table_for<std::remove_cvref_t<D>>.destroy),
        table_(&table_for<std::remove_cvref_t<D>>) {}

  [[nodiscard]] const device_capabilities& capabilities() const noexcept { return table_->capabilities(self_.get()); }
  [[nodiscard]] device_state state() const noexcept { return table_->state(self_.get()); }
  [[nodiscard]] result<void> open() { return table_->open(self_.get()); }
  [[nodiscard]] result<void> arm() { return table_->arm(self_.get()); }
  [[nodiscard]] result<void> clear_fault() { return table_->clear_fault(self_.get()); }
  status disarm() noexcept { return table_->disarm(self_.get()); }
  void close() noexcept { table_->close(self_.get()); }
  [[nodiscard]] status read(std::int64_t now_ns, device_sample& in) noexcept {
    return table_->read(self_.get(), now_ns, in);
  }
  [[nodiscard]] status write(std::int64_t now_ns, const device_command& out) noexcept {
    return table_->write(self_.get(), now_ns, out);
  }

 private:
  struct table {
    const device_capabilities& (*capabilities)(const void*) noexcept;
    device_state (*state)(const void*) noexcept;
    result<void> (*open)(void*);
    result<void> (*arm)(void*);
    result<void> (*clear_fault)(void*);
    status (*disarm)(void*) noexcept;
    void (*close)(void*) noexcept;
    status (*read)(void*, std::int64_t, device_sample&) noexcept;
    status (*write)(void*, std::int64_t, const device_command&) noexcept;
    void (*destroy)(void*) noexcept;
  };

  template <class D>
  static constexpr table table_for{[](const void* self) noexcept -> const device_capabilities& {
                                     return static_cast<const D*>(self)->capabilities();
                                   },
                                   [](const void* self) noexcept { return static_cast<const D*>(self)->state(); },
                                   [](void* self) { return static_cast<D*>(self)->open(); },
                                   [](void* self) { return static_cast<D*>(self)->arm(); },
                                   [](void* self) { return static_cast<D*>(self)->clear_fault(); },
                                   [](void* self) noexcept { return static_cast<D*>(self)->disarm(); },
                                   [](void* self) noexcept { static_cast<D*>(self)->close(); },
                                   [](void* self, std::int64_t now_ns, device_sample& in) noexcept {
                                     return static_cast<D*>(self)->read(now_ns, in);
                                   },
                                   [](void* self, std::int64_t now_ns, const device_command& out) noexcept {
                                     return static_cast<D*>(self)->write(now_ns, out);
                                   },
                                   [](void* self) noexcept { delete static_cast<D*>(self); }};

  std::unique_ptr<void, void (*)(void*) noexcept> self_;
  const table* table_;
};

static_assert(haptic_device<any_device>);

}  // namespace asperity
