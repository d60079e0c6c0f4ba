// A USB device that a real kernel sees and that lives in this program: the kernel's USB/IP host controller (vhci-hcd)
// is handed one end of a socket pair, and this answers at the other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "asperity/transport/usb_link.hpp"

namespace asperity::test_support {

/// What a device does. All calls come with the port's lock held.
class usb_function {
 public:
  usb_function() = default;
  usb_function(const usb_function&) = delete;
  usb_function& operator=(const usb_function&) = delete;
  virtual ~usb_function() = default;

  /// A vendor's control request. @return ok | refused (stalled)
  [[nodiscard]] virtual io_status control(const usb_setup& setup, std::span<std::uint8_t> data, std::size_t& done) = 0;
  /// Bytes on the bulk endpoint to the device. @return false: not taken now; asked again later
  [[nodiscard]] virtual bool take(std::span<const std::uint8_t> bytes) = 0;

  enum class answer { data, nothing, stall, broken };
  /// The next transfer to the host, at most `room.size()` bytes.
  [[nodiscard]] virtual answer give(std::span<std::uint8_t> room, std::size_t& size) = 0;
  /// Once in a millisecond.
  virtual void tick() {}
  /// The host has cleared a halt.
  virtual void halt_cleared() {}
};

struct usb_identity {
  std::uint16_t vendor = 0x1209;
  std::uint16_t product = 0x0a5f;
  std::string maker = "asperity";
  std::string name = "Virtual USB";
  std::string serial = "V1";
};

/// One full-speed device with bulk endpoints 0x81 and 0x02, 64 bytes a packet.
class usbip_device {
 public:
  /// Why no such device can be made here; empty where it can.
  [[nodiscard]] static std::string missing();

  usbip_device(usb_function& function, usb_identity identity) : function_(function), identity_(std::move(identity)) {}
  ~usbip_device() { unplug(); }
  usbip_device(const usbip_device&) = delete;
  usbip_device& operator=(const usbip_device&) = delete;

  /// Into that port of the kernel's controller, 0 to 7. @return what went wrong; empty where nothing did
  [[nodiscard]] std::string plug_in(int port);
  void unplug();

  /// Calls it while nothing comes from or goes to the host.
  void with_lock(const std::function<void()>& look) {
    const std::lock_guard<std::mutex> lock(mutex_);
    look();
  }
  /// Transfers that the host has taken back so far.
  [[nodiscard]] unsigned taken_back() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return taken_back_;
  }

 private:
  struct request {
    std::uint32_t number = 0;
    std::uint32_t room = 0;
    std::vector<std::uint8_t> bytes{};  // to the device
  };

  void serve();
  void count_milliseconds();
  void submitted(std::span<const std::uint8_t> header, std::vector<std::uint8_t> bytes);
  void taken_back(std::uint32_t number, std::uint32_t which);
  void answer_control(std::uint32_t number, std::span<const std::uint8_t> setup, std::vector<std::uint8_t> bytes,
                      std::size_t room, bool to_host);
  [[nodiscard]] bool descriptor(std::uint8_t kind, std::uint8_t index, std::vector<std::uint8_t>& out) const;
  void move_waiting();
  void reply(std::uint32_t number, std::int32_t status, std::span<const std::uint8_t> bytes, std::size_t done);
  void send_all(std::span<const std::uint8_t> bytes);
  [[nodiscard]] bool receive_all(std::span<std::uint8_t> bytes);

  usb_function& function_;
  usb_identity identity_;
  int socket_ = -1;
  bool plugged_ = false;
  std::thread server_{};
  std::thread ticker_{};
  std::mutex mutex_{};
  std::deque<request> waiting_in_{};
  std::deque<request> waiting_out_{};
  unsigned taken_back_ = 0;
};

}  // namespace asperity::test_support
