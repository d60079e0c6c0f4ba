// A claimed interface whose transfers are always the same ones.
#pragma once

#include <cstddef>
#include <cstdint>
#include <libusb-1.0/libusb.h>
#include <memory>
#include <span>
#include <vector>

#include "asperity/transport/usb_finder.hpp"
#include "handles.hpp"

namespace asperity::usb {

class libusb_link final : public usb_link {
 public:
  /// @param interrupt whether the endpoints are of that kind and not bulk
  libusb_link(context session, handle device, const usb_pipes& pipes, bool interrupt_in, bool interrupt_out);
  ~libusb_link() override;
  libusb_link(const libusb_link&) = delete;
  libusb_link& operator=(const libusb_link&) = delete;

  /// Starts to read. @return ok, or why not; then the link is of no use
  [[nodiscard]] io_status start() noexcept;

  [[nodiscard]] io_status control(const usb_setup& setup, std::span<std::uint8_t> data, std::size_t& done,
                                  std::int64_t timeout_ns) noexcept override;
  [[nodiscard]] io_status write(std::int64_t now_ns, std::span<const std::uint8_t> bytes) noexcept override;
  [[nodiscard]] io_status read(std::int64_t now_ns, std::span<std::uint8_t> bytes,
                               usb_packet& packet) noexcept override;

 private:
  struct slot {
    libusb_link* owner = nullptr;
    libusb_transfer* transfer = nullptr;
    std::vector<unsigned char> buffer{};
    bool flying = false;
    std::int64_t ended_ns = 0;
  };

  static void LIBUSB_CALL in_ended(libusb_transfer* transfer) noexcept;
  static void LIBUSB_CALL out_ended(libusb_transfer* transfer) noexcept;

  [[nodiscard]] io_status submit(slot& s) noexcept;
  void collect(std::int64_t now_ns) noexcept;
  [[nodiscard]] io_status take(slot& s, std::span<std::uint8_t> bytes, usb_packet& packet) noexcept;
  [[nodiscard]] slot* free_out() noexcept;
  [[nodiscard]] bool any_flying(std::span<const slot> slots) const noexcept;
  void wait_while_flying(std::span<const slot> slots, int most_ms) noexcept;

  context session_;
  handle device_;
  int interface_;
  std::vector<slot> in_;
  std::vector<slot> out_;
  // Slots of in_ that have ended, oldest first: a ring with room for all.
  std::vector<std::size_t> ended_;
  std::size_t first_ended_ = 0;
  std::size_t ended_count_ = 0;
  std::int64_t now_ns_ = 0;
  io_status out_trouble_ = io_status::ok;  // of a transfer that was written earlier; told once
  bool gone_ = false;
};

}  // namespace asperity::usb
