// A HID link over a hidraw node of Linux.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "asperity/transport/hid_link.hpp"

namespace asperity::hid {

/// Owns the descriptor of a hidraw node that was opened with O_NONBLOCK.
///
/// read() is one system call and never waits. The kernel keeps 63 reports that nobody read, the oldest ones.
/// write() is one system call in which the kernel hands the report to the device: on USB it waits until the device has
/// it, some milliseconds with a slow one. Nothing here allocates, not even where a call fails.
class hidraw_link final : public hid_link {
 public:
  /// @param fd closed by the destructor
  hidraw_link(int fd, std::vector<std::uint8_t> report_descriptor) noexcept
      : fd_(fd), descriptor_(std::move(report_descriptor)) {}
  ~hidraw_link() override;

  [[nodiscard]] std::span<const std::uint8_t> report_descriptor() const noexcept override { return descriptor_; }
  [[nodiscard]] io_status read(std::int64_t now_ns, std::span<std::uint8_t> bytes,
                               hid_report& report) noexcept override;
  [[nodiscard]] io_status write(std::int64_t now_ns, std::span<const std::uint8_t> bytes) noexcept override;

  /// errno of the last call that answered gone or failed; 0 before.
  [[nodiscard]] int errno_value() const noexcept { return errno_; }

 private:
  [[nodiscard]] bool hung_up() const noexcept;

  int fd_;
  std::vector<std::uint8_t> descriptor_;
  int errno_ = 0;
};

}  // namespace asperity::hid
