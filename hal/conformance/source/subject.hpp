// The device under test: every call goes through here, and what must hold after every call is looked at after every
// call.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "asperity/core/spatial.hpp"
#include "asperity/device/device_state.hpp"
#include "asperity/device/driver_abi.h"
#include "asperity/device/driver_conversion.hpp"
#include "call_watch.hpp"
#include "kit_clock.hpp"
#include "ledger.hpp"
#include "progress.hpp"

namespace asperity::conformance {

class subject {
 public:
  subject(const asperity_driver& table, const asperity_listing& which, kit_clock& clock, ledger& found,
          progress& shared);
  subject(const subject&) = delete;
  subject& operator=(const subject&) = delete;
  ~subject();

  /// A handle that was never opened; an older one is destroyed first. @return false where make() fails
  bool make_anew();
  void destroy();

  std::int32_t open();
  std::int32_t arm();
  std::int32_t clear_fault();
  std::int32_t disarm();
  void close();
  std::int32_t read();
  std::int32_t write(const asperity_command& c);
  std::int32_t provoke(std::uint32_t what);

  /// A command in base frame that is valid for the next 20 ms.
  [[nodiscard]] asperity_command command(const wrench& on_hand);
  std::int32_t write(const wrench& on_hand) { return write(command(on_hand)); }
  /// One period later: read(), then write(). @return what write() answers
  std::int32_t tick(const wrench& on_hand);

  /// Brings the device into a state, whatever it is in. @return false where it does not go there
  bool reach(device_state wanted);

  [[nodiscard]] device_state state() const noexcept { return state_; }
  /// What is put out now, where the driver can tell.
  [[nodiscard]] std::optional<wrench> applied();
  [[nodiscard]] bool reports_applied() const noexcept { return t_.applied != nullptr; }
  [[nodiscard]] bool can_provoke() const noexcept { return t_.provoke != nullptr; }
  /// Compares what the driver says now with what it said after open().
  void look_at_capabilities();
  [[nodiscard]] const asperity_capabilities& capabilities() const noexcept { return capabilities_; }
  [[nodiscard]] std::int64_t period_ns() const noexcept;
  [[nodiscard]] kit_clock& clock() noexcept { return clock_; }
  /// A small wrench along an actuated axis, zero where there is none.
  [[nodiscard]] wrench small_wrench() const noexcept;
  /// Text that open(), arm() or clear_fault() gave last.
  [[nodiscard]] const std::string& last_error() const noexcept { return last_error_; }

  /// Newest sample, and how long calls took; for the report.
  [[nodiscard]] const asperity_sample& newest() const noexcept { return newest_; }
  [[nodiscard]] const std::vector<std::int64_t>& pair_times_ns() const noexcept { return pair_times_ns_; }
  [[nodiscard]] int times_opened() const noexcept { return times_opened_; }
  void measure_pairs(bool on) noexcept { measure_pairs_ = on; }
  /// Whether a non-zero wrench may be commanded: the device is simulated, or a person holds it.
  bool may_push = false;

 private:
  template <class Call>
  std::int32_t set_up_call(const char* name, Call&& call);
  template <class Call>
  std::int32_t tick_call(const char* name, Call&& call);
  void look_at_watch(const char* name, const watched& w);
  void observe(const char* name);
  void look_at_output(const char* name);
  void look_at_sample(std::int64_t now_ns, const asperity_sample& s);
  [[nodiscard]] bool provoke_a_fault();

  const asperity_driver& t_;
  asperity_listing which_;
  kit_clock& clock_;
  ledger& found_;
  progress& shared_;
  asperity_device* handle_ = nullptr;
  device_state state_ = device_state::absent;
  asperity_capabilities capabilities_{};
  bool opened_once_ = false;
  int times_opened_ = 0;
  asperity_sample newest_{};
  bool has_sample_ = false;
  std::uint64_t command_sequence_ = 0;
  std::string last_error_;
  std::vector<std::int64_t> pair_times_ns_;
  bool measure_pairs_ = false;
};

}  // namespace asperity::conformance
