// The HID transport: reports out, reports in.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "asperity/transport/io_status.hpp"

namespace asperity {

/// A report that has arrived.
struct hid_report {
  std::size_t size = 0;           ///< bytes in the caller's buffer, the report's number first where it has one
  std::int64_t host_time_ns = 0;  ///< when it was received, on the session's clock
};

/// One open HID device: hidapi or an in-process twin of it.
/// One thread at a time. read() and write() do not block, allocate or throw.
class hid_link {
 public:
  hid_link() = default;
  hid_link(const hid_link&) = delete;
  hid_link& operator=(const hid_link&) = delete;
  virtual ~hid_link() = default;

  /// The device's own description of its reports; empty where the system does not give it. Does not change.
  [[nodiscard]] virtual std::span<const std::uint8_t> report_descriptor() const noexcept = 0;

  /// The oldest input report that has arrived by now_ns, into `bytes`. A kernel keeps some 60 and drops others without
  /// an error: read until `nothing` in every tick.
  /// @return ok | nothing | gone | failed
  [[nodiscard]] virtual io_status read(std::int64_t now_ns, std::span<std::uint8_t> bytes,
                                       hid_report& report) noexcept = 0;

  /// Sends an output report, its number first (0 where the device numbers none).
  /// @return ok | busy | gone | too_short | refused | failed
  [[nodiscard]] virtual io_status write(std::int64_t now_ns, std::span<const std::uint8_t> bytes) noexcept = 0;
};

}  // namespace asperity
