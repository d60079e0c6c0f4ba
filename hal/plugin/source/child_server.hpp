// The driver's end of the exchange: what runs in the process of its own.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <sys/types.h>

#include "asperity/plugin/child_exchange.hpp"
#include "asperity/plugin/driver_module.hpp"
#include "asperity/plugin/plugin_device.hpp"
#include "asperity/plugin/plugin_driver.hpp"

namespace asperity::plugin {

/// Answers the program until it asks to end, or is gone. Nobody over there has to be alive for the device to go to
/// zero: where a paced program falls silent while the device may put out, zero is written once its last command has
/// expired, and the device is disarmed a stated time later; where the program is gone, at once.
class child_server {
 public:
  child_server(child_page& page, driver_file file, pid_t program) noexcept
      : page_(page), file_(std::move(file)), program_(program) {}
  child_server(const child_server&) = delete;
  child_server& operator=(const child_server&) = delete;
  ~child_server() = default;

  /// @return exit status of the process
  int serve();

 private:
  [[nodiscard]] bool answer_ticks();
  [[nodiscard]] bool answer_call();
  void answer(const call_request& r, call_answer& a);
  void load(call_answer& a);
  void list(call_answer& a);
  void make(const call_request& r, call_answer& a);
  void watch();
  void silence() noexcept;
  void publish() noexcept;
  void finish(call_answer& a, const result<void>& done) noexcept;
  [[nodiscard]] std::int32_t state() const noexcept;
  [[nodiscard]] bool is_program_gone() const noexcept;

  class in_phase;

  child_page& page_;
  std::optional<driver_file> file_;
  pid_t program_;
  std::unique_ptr<plugin_driver> driver_{};
  std::optional<plugin_device> device_{};
  asperity_sample sample_{};
  tick_answer ticks_{};
  std::uint64_t stamp_ = 0;
  std::uint64_t call_ = 0;
  bool quit_ = false;
  std::int64_t heard_ns_ = 0;    // CLOCK_MONOTONIC, when the program last asked for something in a tick
  std::int64_t session_ns_ = 0;  // its session clock then
  bool commanded_ = false;       // since it was armed: before that it puts out zero, and a session may take its time
  std::int64_t hold_ns_ = 0;     // how long its last command was good for
};

}  // namespace asperity::plugin
