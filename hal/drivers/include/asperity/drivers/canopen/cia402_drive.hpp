// A CiA 402 drive in cyclic synchronous torque mode, from its reset to its torque.
#pragma once

#include <cstdint>

#include "asperity/core/export.hpp"
#include "asperity/drivers/canopen/setup_dialogue.hpp"
#include "asperity/drivers/joint/joint_drive.hpp"

namespace asperity {

/// Leads one drive through boot-up, configuration, NMT start and the power states, and supervises it:
///
///     reset communication -> boot-up -> pre-operational -> objects (setup_dialogue.hpp) -> NMT start
///       -> [fault reset] -> ready to switch on = idle -> switched on -> operation enabled = enabled
///
/// - The bus needs a canopen_master as well, which sends SYNC after every drive's step(): without it no drive answers.
/// - start() and clear_fault() reset a fault that the drive holds, once, by a rising edge. Nothing else does.
/// - In session these are faults: a heartbeat or process data that stop, an emergency or boot-up message, a state of
///   NMT or power that nobody asked for, another mode than torque, a frame that the bus does not take. In fault,
///   torque 0 and "disable voltage" (or quick stop, see the configuration) go out in every period; a drive that is not
///   operational and so would not hear them is reset.
/// @source CiA 301; CiA 402-2 through descriptions of drives that implement it
/// @rt safe after construction
class ASPERITY_API cia402_drive final : public joint_drive {
 public:
  explicit cia402_drive(const cia402_settings& settings);
  [[nodiscard]] const drive_facts& facts() const noexcept override { return facts_; }
  [[nodiscard]] drive_state state() const noexcept override;
  [[nodiscard]] drive_fault fault() const noexcept override { return fault_; }
  [[nodiscard]] const joint_reading& reading() const noexcept override { return reading_; }
  /// The object that was being read or written when the configuration stopped.
  [[nodiscard]] canopen::object_address object() const noexcept { return setup_.object(); }
  /// What the drive last said of its power section.
  [[nodiscard]] canopen::power_state power() const noexcept { return canopen::decode_status(status_.status_word); }

  /// Also ends what went on before, but not a fault and not an enabled drive's work.
  void start(std::int64_t now_ns) noexcept override;
  [[nodiscard]] bool enable(std::int64_t now_ns) noexcept override;
  void disable(std::int64_t now_ns) noexcept override;
  /// Leads the drive to idle anew, as start() does.
  [[nodiscard]] bool clear_fault(std::int64_t now_ns) noexcept override;

  void set_torque(double torque_n_m) noexcept override { torque_n_m_ = torque_n_m; }

  [[nodiscard]] bool take(std::int64_t now_ns, const can_frame& frame) noexcept override;
  [[nodiscard]] io_status step(std::int64_t now_ns, can_bus& bus) noexcept override;

 private:
  enum class phase : std::uint8_t {
    off,
    boot,        ///< reset sent, boot-up message awaited
    configure,   ///< objects are read and written
    start_node,  ///< NMT start sent, heartbeat and process data awaited
    lead,        ///< from whatever the power section is in to ready to switch on
    idle,
    switch_on,
    enabled,
    wind_down,
    fault,
  };
  static constexpr std::int64_t repeat_reset_ns = 1'000'000'000;
  static constexpr std::int64_t repeat_start_ns = 100'000'000;
  static constexpr int most_busy_in_a_row = 5;
  static constexpr int most_resets = 3;  // against loss on the bus

  [[nodiscard]] bool exchanges_data() const noexcept;
  void begin(std::int64_t now_ns) noexcept;
  void enter(phase p, std::int64_t now_ns, std::int64_t limit_ns) noexcept;
  void fail(const char* what, std::uint32_t code) noexcept;
  void take_heartbeat(std::int64_t now_ns, canopen::nmt_state state) noexcept;
  void take_status(std::int64_t now_ns, const canopen::torque_status& status) noexcept;
  void take_motion(const can_frame& frame, const canopen::motion_counts& counts) noexcept;
  void take_answer(std::int64_t now_ns, const canopen::sdo_response& answer) noexcept;
  void judge_power() noexcept;
  void check_limits(std::int64_t now_ns) noexcept;
  void move_on(std::int64_t now_ns) noexcept;
  [[nodiscard]] io_status send_configuration(std::int64_t now_ns, can_bus& bus) noexcept;
  [[nodiscard]] std::uint16_t lead_word() noexcept;
  [[nodiscard]] canopen::torque_command command() noexcept;
  [[nodiscard]] bool send(std::int64_t now_ns, can_bus& bus, const can_frame& frame, io_status& answer) noexcept;

  cia402_settings settings_;
  canopen::setup_dialogue setup_;
  std::int16_t limit_permille_;
  double rad_per_count_;
  drive_facts facts_{};
  joint_reading reading_{};
  drive_fault fault_{};

  phase phase_ = phase::off;
  std::int64_t due_ns_ = 0;     // end of the present phase
  std::int64_t repeat_ns_ = 0;  // when the present request is sent, or sent again
  double torque_n_m_ = 0.0;

  bool operational_ = false;
  bool was_started_ = false;  // so that the drive listens to process data
  bool has_status_ = false;
  bool has_motion_ = false;
  std::int64_t heartbeat_ns_ = 0;
  std::int64_t data_ns_ = 0;
  canopen::torque_status status_{};
  std::uint32_t last_emergency_ = 0;
  int reset_step_ = 0;  // of the fault reset: 0 not tried, 1 bit 7 is low, 2 it has risen
  bool zero_sent_ = false;
  int busy_in_a_row_ = 0;
  int resets_sent_ = 0;  // in fault
};

}  // namespace asperity
