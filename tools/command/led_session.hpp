// A session that a person leads from a page, in a process of its own.
#pragma once

#include <string>
#include <sys/types.h>

#include "asperity/core/status.hpp"

namespace asperity::command {

/// `asperity run --view 0 --motion mouse` of two models. It ends when this does, and when this program does.
class led_session {
 public:
  /// From the thread that outlives the session: the system ends the process with that thread.
  /// @return io_failed where no process can be started
  [[nodiscard]] static result<led_session> start(const std::string& probe, const std::string& fixed);

  led_session(led_session&& other) noexcept;
  led_session& operator=(led_session&&) = delete;
  /// Asks the session to end as Ctrl-C does; after three seconds without an end the process is killed.
  ~led_session();

  /// Reads what the process said meanwhile. @return whether it still runs
  [[nodiscard]] bool look();
  /// Where the page is; empty until it is there.
  [[nodiscard]] const std::string& url() const noexcept { return url_; }
  /// Why it ended, where it ended with a fault.
  [[nodiscard]] const std::string& trouble() const noexcept { return trouble_; }

 private:
  led_session(pid_t process, int said) : process_(process), said_(said) {}
  [[nodiscard]] bool has_ended();

  pid_t process_ = -1;
  int said_ = -1;  // its standard error
  std::string line_;
  std::string last_;
  std::string url_;
  std::string trouble_;
};

}  // namespace asperity::command
