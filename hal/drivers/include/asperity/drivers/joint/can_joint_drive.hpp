// What all joint drives that answer every period have in common: the way to torque and back, and its limits in time.
#pragma once

#include <cmath>
#include <cstdint>

#include "asperity/drivers/joint/joint_drive.hpp"
#include "asperity/drivers/joint/joint_scale.hpp"

namespace asperity {

/// Options that do not depend on the protocol. All times are counted on the session's clock.
struct joint_drive_settings {
  joint_scale scale{};
  double peak_torque_n_m = 1.0;              ///< at the joint; what is over it never reaches the wire
  double fastest_rad_per_s = 100.0;          ///< of the joint: a position that jumps further than that is a fault
  std::int64_t step_limit_ns = 500'000'000;  ///< for each way: to idle, to enabled, back to idle
  std::int64_t quiet_ns = 10'000'000;        ///< nothing heard for that long: zero torque until it is heard again
  std::int64_t silence_ns = 50'000'000;      ///< nothing heard for that long: a fault where it was enabled
  std::int64_t hold_ns = 20'000'000;         ///< a torque that set_torque() does not renew for that long: a fault

  [[nodiscard]] bool usable() const noexcept {
    return scale.usable() && std::isfinite(peak_torque_n_m) && peak_torque_n_m > 0.0 && peak_torque_n_m <= 1e6 &&
           std::isfinite(fastest_rad_per_s) && fastest_rad_per_s > 0.0 && step_limit_ns > 0 && quiet_ns > 0 &&
           silence_ns >= quiet_ns && hold_ns > 0;
  }
};

/// The part of a joint_drive that is the same for every protocol. A protocol says which frames a phase needs, and tells
/// what it heard.
///
///     off -> leading -> idle -> arming -> enabled -> leaving -> idle
///                        \-> seeking -> leading           (an idle drive that fell silent, and was heard again)
///     anything but off -> faulted -> leading              (clear_fault() only)
///
/// - leading, arming and leaving end within step_limit_ns, or in a fault.
/// - enabled ends in a fault when the drive is not heard, or when the application renews its torque no more: the
///   drive's own watchdog is fed by the application's commands and by nothing else. A torque that was never set is zero
///   and needs no renewing.
/// - A bus that does not take a frame is a fault at once; one whose queue is full, after busy_limit steps.
/// @rt safe
class can_joint_drive : public joint_drive {
 public:
  static constexpr int busy_limit = 5;

  [[nodiscard]] const drive_facts& facts() const noexcept final { return facts_; }
  [[nodiscard]] drive_fault fault() const noexcept final { return fault_; }
  [[nodiscard]] const joint_reading& reading() const noexcept final { return reading_; }
  [[nodiscard]] drive_state state() const noexcept final {
    switch (phase_) {
      case phase::off:
      case phase::seeking:
        return drive_state::silent;
      case phase::idle:
        return drive_state::idle;
      case phase::enabled:
        return drive_state::enabled;
      case phase::faulted:
        return drive_state::fault;
      case phase::leading:
      case phase::arming:
      case phase::leaving:
        break;
    }
    return drive_state::starting;
  }
  /// Frames with this drive's id that do not have the form of its protocol, so far.
  [[nodiscard]] std::uint64_t malformed() const noexcept { return malformed_; }

  void start(std::int64_t now_ns) noexcept final {
    if (phase_ != phase::off) return;
    lead(now_ns, false);
  }

  [[nodiscard]] bool enable(std::int64_t now_ns) noexcept final {
    if (phase_ != phase::idle) return false;
    enter(phase::arming, now_ns);
    return true;
  }

  void disable(std::int64_t now_ns) noexcept final {
    torque_n_m_ = 0.0;
    if (phase_ == phase::arming || phase_ == phase::enabled) enter(phase::leaving, now_ns);
  }

  [[nodiscard]] bool clear_fault(std::int64_t now_ns) noexcept final {
    if (phase_ != phase::faulted) return false;
    fault_ = {};
    lead(now_ns, true);
    return true;
  }

  void set_torque(double torque_n_m) noexcept final {
    torque_n_m_ = saturated(torque_n_m, facts_.peak_torque_n_m);
    renewed_ = true;
  }

  [[nodiscard]] io_status step(std::int64_t now_ns, can_bus& bus) noexcept final {
    if (phase_ == phase::off || !usable_) return io_status::ok;
    watch(now_ns);
    worst_ = io_status::ok;
    if (facts_.needs_fd && !bus.takes_fd()) {
      fail("the bus carries no CAN FD, which this drive needs", 0);
      return io_status::refused;
    }
    send_due(now_ns, bus);
    judge();
    return worst_;
  }

 protected:
  enum class phase : std::uint8_t { off, seeking, leading, idle, arming, enabled, leaving, faulted };

  explicit can_joint_drive(const joint_drive_settings& settings) noexcept
      : options_(settings), usable_(settings.usable()) {
    if (!usable_) options_ = joint_drive_settings{};
    facts_.peak_torque_n_m = options_.peak_torque_n_m;
  }
  void refuse_settings() noexcept { usable_ = false; }

  // The frames of this period, by phase. What is not `enabled` sends no torque but zero.
  virtual void send_due(std::int64_t now_ns, can_bus& bus) noexcept = 0;
  // A way to idle begins; `clearing`: the drive's own fault is to be cleared on it.
  virtual void begin_lead(bool clearing) noexcept = 0;

  [[nodiscard]] phase at() const noexcept { return phase_; }
  [[nodiscard]] std::int64_t since_ns() const noexcept { return since_ns_; }
  [[nodiscard]] const joint_drive_settings& settings() const noexcept { return options_; }
  [[nodiscard]] const joint_scale& scale() const noexcept { return options_.scale; }
  [[nodiscard]] drive_facts& facts_to_fill() noexcept { return facts_; }

  // Torque of the joint that may go out now, N m.
  [[nodiscard]] double torque_due(std::int64_t now_ns) const noexcept {
    if (phase_ != phase::enabled || is_quiet(now_ns)) return 0.0;
    return torque_n_m_;
  }
  [[nodiscard]] bool is_quiet(std::int64_t now_ns) const noexcept { return now_ns - heard_ns_ > options_.quiet_ns; }
  // Whether this step may feed the drive's watchdog: a torque was set since the last one, or none since enable().
  [[nodiscard]] bool is_fed() const noexcept { return fed_; }

  // True until the zero torque that ends a phase was taken by the bus.
  [[nodiscard]] bool owes_zero() const noexcept { return owes_zero_; }
  void zero_was_sent() noexcept { owes_zero_ = false; }

  // Sends one frame. @return whether the bus took it
  bool put(std::int64_t now_ns, can_bus& bus, const can_frame& frame) noexcept {
    const io_status s = bus.send(now_ns, frame);
    if (s == io_status::ok) return true;
    if (worst_ == io_status::ok || worst_ == io_status::busy) worst_ = s;
    return false;
  }

  void fail(const char* what, std::uint32_t code, std::int64_t now_ns) noexcept {
    if (phase_ == phase::off || phase_ == phase::faulted) return;
    fault_ = {what, code};
    enter(phase::faulted, now_ns);
  }
  void fail(const char* what, std::uint32_t code) noexcept { fail(what, code, seen_ns_); }

  void reached(phase next, std::int64_t now_ns) noexcept { enter(next, now_ns); }
  void heard(std::int64_t now_ns) noexcept {
    heard_ns_ = now_ns;
    seen_ns_ = now_ns;
    if (phase_ == phase::seeking) lead(now_ns, false);
  }
  void count_malformed() noexcept { ++malformed_; }

  // A position of the joint. A jump says that the drive lost its count, as a reset does.
  void heard_position(std::int64_t now_ns, const can_frame& frame, double position_rad) noexcept {
    if (!std::isfinite(position_rad) || std::fabs(position_rad) > 1e6) {
      fail("the drive reports a position that cannot be", 0, now_ns);
      return;
    }
    if (has_position_) {
      constexpr double jitter_s = 5e-3;
      const double reach = options_.fastest_rad_per_s * (static_cast<double>(now_ns - position_ns_) * 1e-9 + jitter_s);
      if (std::fabs(position_rad - reading_.position_rad) > reach) {
        fail("the position jumped: the drive was reset or lost its count", 0, now_ns);
      }
    }
    has_position_ = true;
    position_ns_ = now_ns;
    reading_.host_time_ns = frame.host_time_ns;
    reading_.position_rad = position_rad;
    ++reading_.sequence;
  }
  void heard_velocity(double velocity_rad_per_s) noexcept {
    reading_.has_velocity = std::isfinite(velocity_rad_per_s);
    reading_.velocity_rad_per_s = reading_.has_velocity ? velocity_rad_per_s : 0.0;
  }
  void heard_torque(double torque_n_m) noexcept {
    reading_.has_torque = std::isfinite(torque_n_m);
    reading_.torque_n_m = reading_.has_torque ? torque_n_m : 0.0;
  }

 private:
  void enter(phase next, std::int64_t now_ns) noexcept {
    phase_ = next;
    since_ns_ = now_ns;
    seen_ns_ = now_ns;
    owes_zero_ = next == phase::leaving || next == phase::faulted;
    torque_n_m_ = 0.0;
    ever_set_ = false;
    renewed_ = false;
    renewed_ns_ = now_ns;
  }

  void lead(std::int64_t now_ns, bool clearing) noexcept {
    has_position_ = false;
    busy_ = 0;
    heard_ns_ = now_ns;
    enter(phase::leading, now_ns);
    begin_lead(clearing);
    if (!usable_) fail("settings of this drive are outside their ranges: gear ratio, torque, id or times", 0, now_ns);
  }

  void watch(std::int64_t now_ns) noexcept {
    seen_ns_ = now_ns;
    const bool late = now_ns - since_ns_ > options_.step_limit_ns;
    const bool silent = now_ns - heard_ns_ > options_.silence_ns;
    fed_ = true;
    switch (phase_) {
      case phase::leading:
        if (late) fail(late_lead(), 0, now_ns);
        break;
      case phase::arming:
        if (late) fail("the drive did not enable in time", 0, now_ns);
        break;
      case phase::leaving:
        if (late) fail("the drive did not confirm in time that its torque is off", 0, now_ns);
        break;
      case phase::idle:
        if (silent) enter(phase::seeking, now_ns);
        break;
      case phase::enabled: {
        // Also where the application is back by now: what was held for too long does not go on by itself.
        const bool late_torque = ever_set_ && now_ns - renewed_ns_ > options_.hold_ns;
        ever_set_ = ever_set_ || renewed_;
        fed_ = renewed_ || !ever_set_;
        if (fed_) renewed_ns_ = now_ns;
        if (silent) {
          fail("the drive fell silent", 0, now_ns);
        } else if (late_torque) {
          fail("the application did not renew its torque in time", 0, now_ns);
        }
        break;
      }
      case phase::off:
      case phase::seeking:
      case phase::faulted:
        break;
    }
    renewed_ = false;
  }

  [[nodiscard]] const char* late_lead() const noexcept {
    if (!has_position_ && malformed_ > 0) return "something answers with this drive's id, but not in its protocol";
    return has_position_ ? "the drive did not become idle in time" : "the drive does not answer";
  }

  void judge() noexcept {
    if (worst_ == io_status::ok || worst_ == io_status::nothing) {
      busy_ = 0;
      return;
    }
    if (worst_ == io_status::busy) {
      if (++busy_ > busy_limit) fail("the bus took no frame: its queue stays full", 0);
      return;
    }
    switch (worst_) {
      case io_status::down:
        fail("the bus took no frame: it is down or bus-off", 0);
        break;
      case io_status::gone:
        fail("the bus took no frame: its interface is gone", 0);
        break;
      case io_status::too_short:
        fail("the bus took a part of a frame only", 0);
        break;
      case io_status::refused:
        fail("the bus cannot carry this drive's frames", 0);
        break;
      default:
        fail("the bus took no frame: sending failed", 0);
        break;
    }
  }

  joint_drive_settings options_;
  drive_facts facts_{};
  drive_fault fault_{};
  joint_reading reading_{};
  double torque_n_m_ = 0.0;  // of the joint, within the peak
  std::int64_t since_ns_ = 0;
  std::int64_t seen_ns_ = 0;
  std::int64_t heard_ns_ = 0;
  std::int64_t renewed_ns_ = 0;
  std::int64_t position_ns_ = 0;
  std::uint64_t malformed_ = 0;
  int busy_ = 0;
  io_status worst_ = io_status::ok;
  phase phase_ = phase::off;
  bool usable_;
  bool owes_zero_ = false;
  bool renewed_ = false;
  bool ever_set_ = false;
  bool fed_ = true;
  bool has_position_ = false;
};

}  // namespace asperity
