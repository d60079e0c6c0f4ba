// The process of one driver: started, watched and ended by the program. Everything but is_gone() is outside a tick.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <sys/types.h>

#include "asperity/core/status.hpp"
#include "asperity/plugin/child_driver.hpp"
#include "asperity/plugin/child_exchange.hpp"
#include "asperity/plugin/driver_file.hpp"

namespace asperity::plugin {

class child_process {
 public:
  /// Starts the helper with the judged file and a page of its own. The driver is not loaded yet.
  [[nodiscard]] static result<std::unique_ptr<child_process>> start(const driver_file& file,
                                                                    const child_settings& settings);
  child_process(const child_process&) = delete;
  child_process& operator=(const child_process&) = delete;
  /// Ends the process, if need be by force, and takes the memory back.
  ~child_process();

  [[nodiscard]] child_page& page() noexcept { return *page_; }
  /// Whether it has ended. Enters the kernel and does not wait. @rt safe
  [[nodiscard]] bool is_gone() noexcept;
  /// SIGKILL, and waits for it to be gone.
  void kill() noexcept;
  /// Gives it this long to end by itself, then kill().
  void wait_or_kill(std::int64_t patience_ns) noexcept;
  /// How it ended, and in which call. @pre is_gone()
  [[nodiscard]] std::string end_text() const;
  [[nodiscard]] child_phase phase() const noexcept;

 private:
  child_process(child_page* page, pid_t pid) noexcept : page_(page), pid_(pid) {}

  child_page* page_;
  pid_t pid_;
  std::optional<int> ended_{};  // status of waitpid(); INT_MIN where another part of the program took it
};

/// Where the helper is: beside this program, below its prefix, or where it was installed.
[[nodiscard]] std::string find_host_program();

}  // namespace asperity::plugin
