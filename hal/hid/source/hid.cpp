#include "asperity/hid/hid.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <hidapi.h>
#include <linux/hidraw.h>
#include <sys/ioctl.h>
#include <unistd.h>
#include <utility>

#include "asperity/hid/enumerate.hpp"
#include "asperity/hid/hidraw_link.hpp"

namespace asperity::hid {
namespace {

std::string numbers(std::uint16_t vendor_id, std::uint16_t product_id, const char* format = "%04x:%04x") {
  char text[16];
  std::snprintf(text, sizeof text, format, vendor_id, product_id);
  return text;
}

// Closes unless it is handed on.
class open_file {
 public:
  explicit open_file(int fd) noexcept : fd_(fd) {}
  open_file(const open_file&) = delete;
  open_file& operator=(const open_file&) = delete;
  ~open_file() {
    if (fd_ >= 0) ::close(fd_);
  }
  [[nodiscard]] int get() const noexcept { return fd_; }
  [[nodiscard]] int hand_on() noexcept { return std::exchange(fd_, -1); }

 private:
  int fd_;
};

std::string words_for(int error_number) { return std::strerror(error_number); }

// What the open node says of itself, or the error number that it answered with.
int ask(int fd, std::vector<std::uint8_t>& descriptor, hidraw_devinfo& info) {
  int size = 0;
  if (::ioctl(fd, HIDIOCGRDESCSIZE, &size) < 0) return errno;
  hidraw_report_descriptor whole{};
  if (size < 0 || size > HID_MAX_DESCRIPTOR_SIZE) return EPROTO;
  whole.size = static_cast<std::uint32_t>(size);
  if (::ioctl(fd, HIDIOCGRDESC, &whole) < 0) return errno;
  if (::ioctl(fd, HIDIOCGRAWINFO, &info) < 0) return errno;
  descriptor.assign(whole.value, whole.value + size);
  return 0;
}

// Linux 5.6 and later; empty before.
std::string serial_of(int fd) {
  char text[64] = {};
  if (::ioctl(fd, HIDIOCGRAWUNIQ(sizeof text - 1), text) < 0) return {};
  return text;
}

result<std::unique_ptr<hid_link>> open_node(const std::string& path, const hid_listing* expected) {
  const std::string rule = expected != nullptr ? udev_rule(expected->vendor_id, expected->product_id) : std::string();
  open_file file(::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC | O_NOCTTY));
  if (file.get() < 0) return error{error_code::io_failed, explain_open_error(path, errno, rule)};
  std::vector<std::uint8_t> descriptor;
  hidraw_devinfo info{};
  if (const int fault = ask(file.get(), descriptor, info); fault != 0) {
    if (fault == ENODEV || fault == EIO) {
      return error{error_code::io_failed, path + ": the device left while it was being opened; plug it in again"};
    }
    return error{error_code::unsupported, path + " is not a HID device's node (" + words_for(fault) +
                                              "): take a path that list_hid() gives, as /dev/hidraw0"};
  }
  if (expected != nullptr) {
    const auto vendor = static_cast<std::uint16_t>(info.vendor);
    const auto product = static_cast<std::uint16_t>(info.product);
    const std::string serial = serial_of(file.get());
    if (vendor != expected->vendor_id || product != expected->product_id ||
        (!serial.empty() && serial != expected->serial)) {
      return error{error_code::io_failed, path + " is " + numbers(vendor, product) + " now and not " +
                                              identity_of(*expected) +
                                              ", which was there before: list the devices again"};
    }
  }
  return std::unique_ptr<hid_link>(std::make_unique<hidraw_link>(file.hand_on(), std::move(descriptor)));
}

}  // namespace

std::string udev_rule(std::uint16_t vendor_id, std::uint16_t product_id) {
  return "SUBSYSTEM==\"hidraw\", KERNELS==\"*:" + numbers(vendor_id, product_id, "%04X:%04X") +
         ".*\", TAG+=\"uaccess\"";
}

std::string explain_open_error(const std::string& path, int error_number, const std::string& rule) {
  if (error_number == EACCES || error_number == EPERM) {
    std::string text = path + " cannot be opened: this user has no permission; ";
    if (rule.empty())
      return text + "install asperity's 70-asperity.rules in /etc/udev/rules.d and plug the device in again";
    return text + "put this line into /etc/udev/rules.d/70-asperity.rules and plug the device in again: " + rule;
  }
  if (error_number == ENOENT || error_number == ENODEV || error_number == ENXIO) {
    return path + " cannot be opened: no device is there; list the devices again";
  }
  if (error_number == EBUSY) return path + " cannot be opened: another program holds it; close that one";
  return path + " cannot be opened: " + words_for(error_number);
}

std::optional<std::string> why_not_openable(const hid_listing& which) {
  if (::faccessat(AT_FDCWD, which.path.c_str(), R_OK | W_OK, AT_EACCESS) == 0) return std::nullopt;
  return explain_open_error(which.path, errno, udev_rule(which.vendor_id, which.product_id));
}

result<std::vector<hid_listing>> list_hid() {
  const hid_api_version* const version = hid_version();
  std::vector<hid_listing> found =
      version != nullptr && may_list(version->major, version->minor) ? list_from_hidapi() : list_from_sysfs();
  std::sort(found.begin(), found.end(), [](const hid_listing& a, const hid_listing& b) {
    return a.path.size() != b.path.size() ? a.path.size() < b.path.size() : a.path < b.path;  // hidraw9, hidraw10
  });
  for (hid_listing& one : found) one.not_openable = why_not_openable(one);
  return found;
}

result<std::unique_ptr<hid_link>> open_hid(const std::string& path) { return open_node(path, nullptr); }

result<std::unique_ptr<hid_link>> open_hid(const hid_listing& which) { return open_node(which.path, &which); }

}  // namespace asperity::hid
