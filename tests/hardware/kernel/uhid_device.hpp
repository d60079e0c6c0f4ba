// A HID device of the kernel's that this process makes through /dev/uhid: the tests are its firmware.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fcntl.h>
#include <linux/input.h>
#include <linux/uhid.h>
#include <memory>
#include <span>
#include <string>
#include <unistd.h>
#include <vector>

namespace asperity::test_support {

class uhid_device {
 public:
  /// Why there can be no such device here; empty where there can.
  [[nodiscard]] static std::string missing() {
    const int fd = ::open("/dev/uhid", O_RDWR | O_CLOEXEC);
    if (fd < 0) return std::string("/dev/uhid cannot be opened: ") + std::strerror(errno);
    ::close(fd);
    return {};
  }

  uhid_device() : fd_(::open("/dev/uhid", O_RDWR | O_CLOEXEC | O_NONBLOCK)) {}
  uhid_device(const uhid_device&) = delete;
  uhid_device& operator=(const uhid_device&) = delete;
  ~uhid_device() { ::close(fd_); }  // the same as unplugging it

  [[nodiscard]] bool plug_in(std::uint16_t vendor, std::uint16_t product, const std::string& name,
                             const std::string& serial, std::span<const std::uint8_t> descriptor) {
    const auto e = std::make_unique<uhid_event>();
    e->type = UHID_CREATE2;
    uhid_create2_req& c = e->u.create2;
    std::memcpy(c.name, name.data(), std::min(name.size(), sizeof c.name - 1));
    std::memcpy(c.uniq, serial.data(), std::min(serial.size(), sizeof c.uniq - 1));
    std::memcpy(c.rd_data, descriptor.data(), descriptor.size());
    c.rd_size = static_cast<std::uint16_t>(descriptor.size());
    c.bus = BUS_USB;
    c.vendor = vendor;
    c.product = product;
    return put(*e);
  }

  [[nodiscard]] bool unplug() {
    const auto e = std::make_unique<uhid_event>();
    e->type = UHID_DESTROY;
    return put(*e);
  }

  bool send(std::span<const std::uint8_t> report) {
    const auto e = std::make_unique<uhid_event>();
    e->type = UHID_INPUT2;
    e->u.input2.size = static_cast<std::uint16_t>(report.size());
    std::memcpy(e->u.input2.data, report.data(), report.size());
    return put(*e);
  }

  /// The output reports that came since the last call.
  [[nodiscard]] std::vector<std::vector<std::uint8_t>> take_outputs() {
    std::vector<std::vector<std::uint8_t>> out;
    const auto e = std::make_unique<uhid_event>();
    while (::read(fd_, e.get(), sizeof *e) > 0) {
      if (e->type == UHID_OUTPUT) {
        std::vector<std::uint8_t>& report = out.emplace_back(std::min<std::size_t>(e->u.output.size, UHID_DATA_MAX));
        std::memcpy(report.data(), e->u.output.data, report.size());
      }
    }
    return out;
  }

 private:
  [[nodiscard]] bool put(const uhid_event& e) { return ::write(fd_, &e, sizeof e) == sizeof e; }

  int fd_;
};

}  // namespace asperity::test_support
