// The program's end of the exchange with one driver process.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "asperity/core/status.hpp"
#include "asperity/plugin/child_driver.hpp"
#include "asperity/plugin/child_exchange.hpp"
#include "child_process.hpp"

namespace asperity::plugin {

/// Asks, waits no longer than it may, and keeps what came. read(), write(), disarm() and state() allocate nothing, lock
/// nothing, throw nothing and read no clock. They enter the kernel to wake the driver's process, to ask whether it has
/// ended, and in read() to wait for its answer for a stated time.
class child_link {
 public:
  child_link(std::shared_ptr<const driver_file> file, child_settings settings)
      : file_(std::move(file)), options_(std::move(settings)) {}
  child_link(const child_link&) = delete;
  child_link& operator=(const child_link&) = delete;
  /// Asks the process to put out zero and to end, and ends it.
  ~child_link();

  /// Starts a process, or another one, and loads the driver in it.
  [[nodiscard]] result<void> start();
  /// What the driver says of itself. @pre start() succeeded
  [[nodiscard]] const call_answer& hello() const noexcept { return hello_; }
  /// What is plugged in, judged. The first list() of a process has what loading left of its time.
  [[nodiscard]] result<std::vector<listed_item>> list();

  /// One call outside a tick. The answer's text is ended by a zero byte. @return ASPERITY_FAILED, with the reason in
  /// the answer's text, where none came
  std::int32_t call(child_call what, call_answer& answer, const call_request& with = {});
  /// The process of a device that is in fault is replaced by a new one where it has ended or does not answer.
  std::int32_t clear_fault(call_answer& answer);
  std::int32_t make(const asperity_listing& which, call_answer& answer);

  std::int32_t read(std::int64_t now_ns, asperity_sample& out) noexcept;
  std::int32_t write(std::int64_t now_ns, const asperity_command& command) noexcept;
  std::int32_t disarm() noexcept;
  [[nodiscard]] std::int32_t state() const noexcept;

  /// What happened to the process; empty where it lives and answers.
  [[nodiscard]] std::string what_happened() const;
  /// The same, for when this object is gone: filled in at its end.
  [[nodiscard]] std::shared_ptr<const std::string> last_words() const noexcept { return last_words_; }

 private:
  enum class trouble : std::uint8_t { none, gone, silent, program_silent };

  [[nodiscard]] child_page& page() noexcept { return process_->page(); }
  [[nodiscard]] bool lockstep() const noexcept { return options_.pace == child_pace::lockstep; }
  void post() noexcept;
  bool look() noexcept;
  template <class Done>
  bool wait(Done&& done) noexcept;
  void take_state(std::uint64_t stamp, std::int32_t state) noexcept;
  [[nodiscard]] std::int64_t patience_ns(child_call what) const noexcept;
  void give_up(trouble t) noexcept;
  void fail(call_answer& answer, const std::string& why) const;

  std::shared_ptr<const driver_file> file_;
  child_settings options_;
  std::unique_ptr<child_process> process_{};
  trouble trouble_ = trouble::none;
  child_phase silent_in_ = child_phase::idle;
  std::uint64_t calls_ = 0;
  std::int64_t list_left_ns_ = 0;  // of the time for loading and the first list() together
  call_answer hello_{};
  asperity_listing which_{};
  std::shared_ptr<std::string> last_words_ = std::make_shared<std::string>();

  tick_request request_{};
  tick_answer answer_{};
  asperity_sample last_{};
  bool has_last_ = false;
  std::uint64_t stamp_ = 0;
  std::int32_t state_ = ASPERITY_STATE_ABSENT;
  std::uint64_t silences_ = 0;      // of the program, as the driver's process counts them
  int unanswered_ = 0;              // reads in a row ...
  std::int64_t unanswered_ns_ = 0;  // ... and the session time of the first of them
};

}  // namespace asperity::plugin
