// A HID device that exists in this process only: the twin of asperity::hid.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "asperity/core/export.hpp"
#include "asperity/transport/hid_link.hpp"
#include "asperity/transport/link_script.hpp"

namespace asperity {

/// A device on a cable. Its far end is this object, which a fake peer reads and writes; its host's end is a hid_link.
///
/// As the kernel's: the device side queues up to 63 input reports, drops the newest beyond that without a word, and an
/// open link answers `gone` from the moment of unplugging on. Plugging it in again makes a new link possible and
/// does not revive an old one. Neither end allocates after construction, except that host_end() makes the link.
class ASPERITY_API virtual_hid {
 public:
  static constexpr std::size_t max_report_bytes = 64;
  static constexpr std::size_t kernel_queue = 63;

  /// @param report_descriptor what the device says of itself
  /// @param script faults; calls are counted on the host's end, over all links that were ever open
  explicit virtual_hid(std::vector<std::uint8_t> report_descriptor, link_script script = {});

  /// The host's end of the cable as it is plugged in now. It outlives this object where it has to.
  [[nodiscard]] std::unique_ptr<hid_link> host_end() const;

  /// An input report: from the device to the host. @return false where it is too long or nothing is plugged in
  bool send(std::int64_t now_ns, std::span<const std::uint8_t> report) noexcept;

  /// The oldest output report that has arrived at the device. @param size its bytes, where there is one
  [[nodiscard]] bool receive(std::int64_t now_ns, std::span<std::uint8_t> report, std::size_t& size) noexcept;

  void unplug() noexcept;
  /// Back on the bus, with empty queues.
  void plug_in() noexcept;
  [[nodiscard]] bool plugged() const noexcept;

  /// Calls on the host's end so far.
  [[nodiscard]] std::uint64_t calls() const noexcept;
  /// Input reports that were dropped because nobody read.
  [[nodiscard]] std::uint64_t dropped() const noexcept;

 private:
  struct wire;
  class end;

  std::shared_ptr<wire> wire_;
};

}  // namespace asperity
