// A USB device within this process, its cable and what goes wrong on it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "asperity/core/export.hpp"
#include "asperity/transport/link_script.hpp"
#include "asperity/transport/usb_finder.hpp"

namespace asperity {

/// The device's end: what a fake peer takes and gives. open() makes the host's end. One thread for both.
///
/// Faults of the script hit transfers, not control requests, but for `answer` and `unplug`, which hit any call. The
/// pipe to the device holds `out_transfers` that the peer has not taken; then the host is answered busy. bus_off means
/// nothing here. A fault holds for one transfer; a transfer that is lost was not seen by the host to be lost.
class ASPERITY_API virtual_usb {
 public:
  /// Answers a control request: fills or reads `data` and says how much of it. @return ok | refused (a stall)
  using control_handler = std::function<io_status(const usb_setup&, std::span<std::uint8_t> data, std::size_t& done)>;

  explicit virtual_usb(link_script script = {}, std::size_t out_transfers = 4);
  void on_control(control_handler handler);

  /// The oldest transfer from the host that has arrived. @return its size, or 0 where nothing has
  [[nodiscard]] std::size_t take(std::int64_t now_ns, std::span<std::uint8_t> bytes) noexcept;

  /// Sends a transfer to the host. @return false where the pipe is full or nobody has the device open
  bool give(std::int64_t now_ns, std::span<const std::uint8_t> bytes) noexcept;

  /// Pulls the cable: every open link answers `gone` for ever.
  void unplug() noexcept;
  void plug_in() noexcept;
  [[nodiscard]] bool plugged() const noexcept;
  /// Whether a host has it open.
  [[nodiscard]] bool is_open() const noexcept;
  /// Calls on the host's end so far, over all links.
  [[nodiscard]] const link_player& player() const noexcept;

  /// The host's end; null where it is not plugged in. A second one while the first is open is null as well.
  [[nodiscard]] std::unique_ptr<usb_link> open();

 private:
  struct shared;
  class host_end;

  std::shared_ptr<shared> shared_;
};

/// A bus of virtual devices, for drivers that look for theirs. The devices outlive it.
class ASPERITY_API virtual_usb_bus final : public usb_finder {
 public:
  /// Puts a device on the bus under the listing that a host sees while it is plugged in.
  void attach(virtual_usb& device, usb_listing as) { sockets_.push_back({&device, std::move(as)}); }
  /// The device is listed under another path from now on.
  void move(const virtual_usb& device, std::string path);

  [[nodiscard]] result<std::vector<usb_listing>> list(std::uint16_t vendor, std::uint16_t product) override;
  [[nodiscard]] result<std::unique_ptr<usb_link>> open(const usb_listing& which, const usb_pipes&) override;

 private:
  struct socket {
    virtual_usb* device;
    usb_listing listing;
  };
  std::vector<socket> sockets_;
};

}  // namespace asperity
