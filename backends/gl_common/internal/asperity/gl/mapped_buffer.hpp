// Buffers for the data of every tick between host and device, and the fence that signals when the device is done.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "asperity/gl/functions.hpp"
#include "asperity/gl/names.hpp"

namespace asperity::gl {

enum class direction : std::uint8_t { to_device, from_device };

/// A buffer at a fixed address of the host: mapped for good where the driver can, otherwise a copy that send() and
/// receive() carry over.
class mapped_buffer {
 public:
  mapped_buffer() = default;
  /// @pre the context is current in this thread   @return limit_exceeded
  [[nodiscard]] static result<mapped_buffer> make(const context_ptr& context, std::size_t bytes, direction way,
                                                  const std::string& what);

  /// The memory as an array of T. @rt safe
  template <class T>
  [[nodiscard]] std::span<T> as() const noexcept {
    return {static_cast<T*>(memory_), size() / sizeof(T)};
  }
  [[nodiscard]] std::size_t size() const noexcept { return name_.bytes(); }
  [[nodiscard]] GLuint name() const noexcept { return name_.get(); }

  /// To be called before the commands that read the buffer; the first `bytes` arrive. @rt safe
  void send(std::size_t bytes) noexcept;
  /// To be called after the fence; the first `bytes` are what the device wrote. @rt safe
  /// @return backend_failed where the driver does not give them
  [[nodiscard]] status receive(std::size_t bytes) noexcept;

 private:
  owned_name name_;
  void* memory_ = nullptr;
  std::unique_ptr<std::byte[]> copy_;  ///< where the buffer is not mapped for good
};

/// Waits until the device has done everything so far and what it wrote can be read: the one blocking round trip.
/// @pre current in this thread   @param timeout_ns  how long to wait
/// @return ok | backend_failed (time is up, or the context is lost)   @rt safe, apart from what the driver does
[[nodiscard]] status wait_for_device(const functions& gl, std::uint64_t timeout_ns) noexcept;

}  // namespace asperity::gl
