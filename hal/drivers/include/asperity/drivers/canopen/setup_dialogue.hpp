// Sends a configuration to a drive: one object after another, each repeated until it is answered.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "asperity/core/export.hpp"
#include "asperity/drivers/canopen/cia402_setup.hpp"
#include "asperity/drivers/canopen/frames.hpp"
#include "asperity/drivers/joint/joint_drive.hpp"

namespace asperity::canopen {

/// The requests of setup_of(), over SDO, behind the NMT command that makes the drive take them.
/// @rt safe after construction
class ASPERITY_API setup_dialogue {
 public:
  explicit setup_dialogue(const cia402_settings& settings);
  void restart() noexcept;
  [[nodiscard]] bool done() const noexcept { return next_ >= steps_.size(); }
  /// Object that is being read or written; index 0 once all are.
  [[nodiscard]] object_address object() const noexcept { return done() ? object_address{} : steps_[next_].at; }

  /// Whether a frame has to go out: nothing was asked yet, or its answer is overdue. @pre !done()
  [[nodiscard]] bool is_due(std::int64_t now_ns) const noexcept { return !asked_ || now_ns >= repeat_ns_; }
  /// What is wrong where a frame is due and was sent often enough. @pre is_due()
  [[nodiscard]] std::optional<drive_fault> unanswered() const noexcept;
  /// The frame. @pre is_due(), not unanswered()
  [[nodiscard]] can_frame frame() const noexcept;
  /// The bus took the frame.
  void was_sent(std::int64_t now_ns) noexcept;

  /// Goes on to the next object where the answer is the awaited one. @return what is wrong with it
  [[nodiscard]] std::optional<drive_fault> take(const sdo_response& answer) noexcept;

 private:
  setup_steps steps_;
  double rated_m_n_m_;
  std::int64_t answer_limit_ns_;
  std::int64_t repeat_ns_ = 0;
  std::size_t next_ = 0;
  int most_tries_;
  int tries_ = 0;
  std::uint8_t node_;
  bool asked_ = false;
  bool sent_pre_operational_ = false;
};

}  // namespace asperity::canopen
