// Makes the table of driver_abi.h from a C++ driver. See docs/tutorial/write-a-driver.md.
//
//   struct my_driver {
//     static constexpr asperity::driver_description description{.name = "mine", .version = "1.0", ...};
//     static asperity::result<std::vector<asperity::device_listing>> list();
//     static asperity::result<std::unique_ptr<my_device>> make(const asperity::device_listing& which);
//   };
//   ASPERITY_EXPORT_DRIVER(my_driver)
#pragma once

#include <atomic>
#include <concepts>
#include <cstdint>
#include <exception>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "asperity/core/export.hpp"
#include "asperity/core/status.hpp"
#include "asperity/device/device.hpp"
#include "asperity/device/driver.hpp"
#include "asperity/device/driver_abi.h"
#include "asperity/device/driver_conversion.hpp"

namespace asperity {

/// What a driver says about itself. String literals.
struct driver_description {
  const char* name = "";     ///< a short word without spaces
  const char* version = "";  ///< of the driver
  const char* licence = "";  ///< an SPDX expression, or "proprietary"
  const char* vendor = "";   ///< who answers for it
  driver_maturity maturity = driver_maturity::protocol_tested;
};

/// Something that a test has a device do; see ASPERITY_PROVOKE_... in driver_abi.h.
enum class provocation : std::uint32_t {
  departure = ASPERITY_PROVOKE_DEPARTURE,
  comeback = ASPERITY_PROVOKE_RETURN,
  write_failure = ASPERITY_PROVOKE_WRITE_FAILURE,
};

namespace detail {

template <class T>
struct pointee_of_result;
template <class D>
struct pointee_of_result<result<std::unique_ptr<D>>> {
  using type = D;
};

}  // namespace detail

/// A driver that can be exported: a description, what is plugged in, and a device that models haptic_device.
///
/// Three members of the device are optional; the conformance kit asks for them:
///   status applied(std::int64_t now_ns, wrench& out) const noexcept   what it puts out, after its own limits; @rt safe
///   std::string fault_text() const                                    why it is in its fault
///   bool provoke(provocation what)                                    false where it cannot
template <class T>
concept exportable_driver = requires(const device_listing& which) {
  { T::description } -> std::convertible_to<const driver_description&>;
  { T::list() } -> std::same_as<result<std::vector<device_listing>>>;
  T::make(which);
  requires haptic_device<typename detail::pointee_of_result<decltype(T::make(which))>::type>;
};

/// Tells the host's log something, where there is one. Outside a tick; from any thread.
class driver_log {
 public:
  static void say(std::uint32_t level, const char* text) noexcept {
    const asperity_host* host = host_.load(std::memory_order_acquire);
    if (host != nullptr) host->log(host->context, level, text);
  }
  static void attach(const asperity_host* host) noexcept {
    const bool usable =
        host != nullptr && host->struct_size >= offsetof(asperity_host, reserved) && host->log != nullptr;
    host_.store(usable ? host : nullptr, std::memory_order_release);
  }

 private:
  static inline std::atomic<const asperity_host*> host_{nullptr};
};

namespace detail {

ASPERITY_API void put_error(char* error, std::uint32_t error_size, std::string_view text) noexcept;

[[nodiscard]] ASPERITY_API std::int32_t failure(const error& e, char* text, std::uint32_t text_size) noexcept;

/// Runs what a vendor wrote, outside a tick. Nothing is thrown across the border.
template <class Work>
[[nodiscard]] std::int32_t guarded(char* error, std::uint32_t error_size, Work&& work) noexcept {
#if defined(__cpp_exceptions)
  try {
    return work();
  } catch (const std::exception& e) {
    put_error(error, error_size, e.what());
  } catch (...) {
    put_error(error, error_size, "the driver threw something that is not a std::exception");
  }
  return ASPERITY_FAILED;
#else
  static_cast<void>(error);
  static_cast<void>(error_size);
  return work();
#endif
}

[[nodiscard]] ASPERITY_API asperity_listing to_abi(const device_listing& d, const asperity_capabilities* c) noexcept;

/// The functions of the table for one driver.
template <exportable_driver Driver>
struct exported {
  using device = typename pointee_of_result<decltype(Driver::make(std::declval<const device_listing&>()))>::type;

  [[nodiscard]] static device& self(asperity_device* d) noexcept { return *reinterpret_cast<device*>(d); }
  [[nodiscard]] static const device& self(const asperity_device* d) noexcept {
    return *reinterpret_cast<const device*>(d);
  }

  static std::int32_t list(void* context, std::int32_t (*found)(void*, const asperity_listing*), char* error,
                           std::uint32_t error_size) noexcept {
    return guarded(error, error_size, [&]() -> std::int32_t {
      const result<std::vector<device_listing>> all = Driver::list();
      if (!all) return failure(all.error(), error, error_size);
      for (const device_listing& each : *all) {
        const asperity_capabilities capabilities = abi::to_abi(each.capabilities);
        const asperity_listing listing = to_abi(each, &capabilities);
        if (found(context, &listing) != 0) break;
      }
      return ASPERITY_OK;
    });
  }

  static std::int32_t make(const asperity_listing* which, asperity_device** made, char* error,
                           std::uint32_t error_size) noexcept {
    return guarded(error, error_size, [&]() -> std::int32_t {
      if (which == nullptr || made == nullptr || which->struct_size < offsetof(asperity_listing, capabilities)) {
        put_error(error, error_size, "make() was called without a listing");
        return ASPERITY_INVALID;
      }
      const asperity_listing l = abi::copy_in(*which);
      device_listing wanted{.driver = Driver::description.name,
                            .identity = std::string(abi::get_text(l.identity).value_or("")),
                            .path = std::string(abi::get_text(l.path).value_or("")),
                            .name = std::string(abi::get_text(l.name).value_or(""))};
      result<std::unique_ptr<device>> d = Driver::make(wanted);
      if (!d) return failure(d.error(), error, error_size);
      if (*d == nullptr) {
        put_error(error, error_size, "the driver made no device and gave no reason");
        return ASPERITY_FAILED;
      }
      *made = reinterpret_cast<asperity_device*>(std::move(d).value().release());
      return ASPERITY_OK;
    });
  }

  static void destroy(asperity_device* d) noexcept { delete reinterpret_cast<device*>(d); }

  static std::int32_t capabilities(const asperity_device* d, asperity_capabilities* out) noexcept {
    abi::copy_out(abi::to_abi(self(d).capabilities()), *out);
    return ASPERITY_OK;
  }

  static std::int32_t state(const asperity_device* d) noexcept { return static_cast<std::int32_t>(self(d).state()); }

  // The answer of open(), arm() and clear_fault().
  template <class Work>
  static std::int32_t answer(char* error, std::uint32_t error_size, Work&& work) noexcept {
    return guarded(error, error_size, [&]() -> std::int32_t {
      const result<void> done = work();
      return done ? ASPERITY_OK : failure(done.error(), error, error_size);
    });
  }
  static std::int32_t open(asperity_device* d, char* error, std::uint32_t error_size) noexcept {
    return answer(error, error_size, [d] { return self(d).open(); });
  }
  static std::int32_t arm(asperity_device* d, char* error, std::uint32_t error_size) noexcept {
    return answer(error, error_size, [d] { return self(d).arm(); });
  }
  static std::int32_t clear_fault(asperity_device* d, char* error, std::uint32_t error_size) noexcept {
    return answer(error, error_size, [d] { return self(d).clear_fault(); });
  }

  static std::int32_t disarm(asperity_device* d) noexcept { return abi::to_code(self(d).disarm()); }
  static void close(asperity_device* d) noexcept { self(d).close(); }

  static std::int32_t read(asperity_device* d, std::int64_t now_ns, asperity_sample* out) noexcept {
    device_sample sample;
    const status s = self(d).read(now_ns, sample);
    if (s == status::ok) abi::copy_out(abi::to_abi(sample), *out);
    return abi::to_code(s);
  }

  static std::int32_t write(asperity_device* d, std::int64_t now_ns, const asperity_command* command) noexcept {
    return abi::to_code(self(d).write(now_ns, abi::from_abi(abi::copy_in(*command))));
  }

  static std::int32_t attach(const asperity_host* host, char* /*error*/, std::uint32_t /*error_size*/) noexcept {
    driver_log::attach(host);
    return ASPERITY_OK;
  }
  static void detach(const asperity_host* /*host*/) noexcept { driver_log::attach(nullptr); }

  // Written so that they are instantiated for a device that has the member, and NULL for one that has not.
  template <class D>
  static constexpr auto applied_of() noexcept -> decltype(asperity_driver::applied) {
    if constexpr (requires(const D& x, std::int64_t now_ns, wrench& w) {
                    { x.applied(now_ns, w) }
                    noexcept->std::same_as<status>;
                  }) {
      return [](const asperity_device* d, std::int64_t now_ns, asperity_applied* out) noexcept -> std::int32_t {
        wrench w{};
        const status s = self(d).applied(now_ns, w);
        if (s == status::ok) abi::copy_out(abi::to_abi(w), *out);
        return abi::to_code(s);
      };
    } else {
      return nullptr;
    }
  }
  template <class D>
  static constexpr auto fault_text_of() noexcept -> decltype(asperity_driver::fault_text) {
    if constexpr (requires(const D& x) { std::string(x.fault_text()); }) {
      return [](const asperity_device* d, char* text, std::uint32_t text_size) noexcept -> std::int32_t {
        return guarded(text, text_size, [&]() -> std::int32_t {
          put_error(text, text_size, std::string(self(d).fault_text()));
          return ASPERITY_OK;
        });
      };
    } else {
      return nullptr;
    }
  }
  template <class D>
  static constexpr auto provoke_of() noexcept -> decltype(asperity_driver::provoke) {
    if constexpr (requires(D & x) {
                    { x.provoke(provocation::departure) } -> std::same_as<bool>;
                  }) {
      return [](asperity_device* d, std::uint32_t what) noexcept -> std::int32_t {
        if (what < ASPERITY_PROVOKE_DEPARTURE || what > ASPERITY_PROVOKE_WRITE_FAILURE) return ASPERITY_UNSUPPORTED;
        return guarded(nullptr, 0, [&]() -> std::int32_t {
          return self(d).provoke(static_cast<provocation>(what)) ? ASPERITY_OK : ASPERITY_UNSUPPORTED;
        });
      };
    } else {
      return nullptr;
    }
  }

  [[nodiscard]] static constexpr asperity_driver make_table() noexcept {
    asperity_driver t{};
    t.struct_size = sizeof(asperity_driver);
    t.abi_major = ASPERITY_ABI_MAJOR;
    t.abi_minor = ASPERITY_ABI_MINOR;
    t.maturity = static_cast<std::uint32_t>(Driver::description.maturity);
    t.name = Driver::description.name;
    t.version = Driver::description.version;
    t.licence = Driver::description.licence;
    t.vendor = Driver::description.vendor;
    t.list = list;
    t.make = make;
    t.destroy = destroy;
    t.capabilities = capabilities;
    t.state = state;
    t.open = open;
    t.arm = arm;
    t.clear_fault = clear_fault;
    t.disarm = disarm;
    t.close = close;
    t.read = read;
    t.write = write;
    t.attach = attach;
    t.detach = detach;
    t.applied = applied_of<device>();
    t.fault_text = fault_text_of<device>();
    t.provoke = provoke_of<device>();
    return t;
  }
};

}  // namespace detail

/// The table of a driver, static. Nothing in it throws: what the driver throws outside a tick comes back as an error
/// text, and what it throws in a tick, against its own noexcept, ends the program.
template <exportable_driver Driver>
inline constexpr asperity_driver driver_table = detail::exported<Driver>::make_table();

}  // namespace asperity

/// Defines the one exported function of a driver. Once per shared object, outside any namespace.
#define ASPERITY_EXPORT_DRIVER(Driver)                                                            \
  extern "C" __attribute__((visibility("default"))) const asperity_driver* asperity_driver_entry( \
      std::uint32_t host_abi) {                                                                   \
    return (host_abi >> 16) == ASPERITY_ABI_MAJOR ? &asperity::driver_table<Driver> : nullptr;    \
  }                                                                                               \
  static_assert(asperity::exportable_driver<Driver>,                                              \
                "ASPERITY_EXPORT_DRIVER takes a type that models "                                \
                "asperity::exportable_driver")
