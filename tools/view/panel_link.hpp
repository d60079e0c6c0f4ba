// What the page of a device panel asks, and who answers.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace asperity::view {

/// Asked by the threads of a server, several at once.
class panel_link {
 public:
  struct told {
    int code = 204;    ///< of HTTP
    std::string body;  ///< a document for 200, one sentence for 400 and above
  };

  panel_link() = default;
  panel_link(const panel_link&) = delete;
  panel_link& operator=(const panel_link&) = delete;
  virtual ~panel_link() = default;

  /// What does not change: device, limits, whether a force is offered. JSON.
  [[nodiscard]] virtual std::string description() = 0;
  /// What is now, and the periods from number `after` on. JSON.
  [[nodiscard]] virtual std::string state(std::uint64_t after) = 0;
  /// `press=AXIS,NEWTONS`, `beat=PRESS,NUMBER` or `release=PRESS`.
  [[nodiscard]] virtual told ask(std::string_view query) = 0;
};

}  // namespace asperity::view
