// One open Falcon as frames out and positions in, without states.
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "asperity/core/export.hpp"
#include "asperity/drivers/falcon/falcon_frame.hpp"
#include "asperity/drivers/falcon/falcon_kinematics.hpp"
#include "asperity/drivers/falcon/ftdi_line.hpp"

namespace asperity {

/// Why a report was not believed.
enum class falcon_doubt : std::uint8_t {
  none,
  out_of_range,  ///< an encoder stands where no arm can
  jump,          ///< an encoder moved faster than any hand
  no_position,   ///< the three angles close no leg
  not_homed,     ///< a leg says that it has not passed its index mark
};

/// Sends commands, collects reports and judges them. Frames carry no checksum, so a report with a wrong bit can only
/// be recognised by impossible values.
/// @rt send() and receive() are safe where the link's write() and read() are
class ASPERITY_API falcon_wire {
 public:
  void attach(std::unique_ptr<usb_link> link) noexcept;
  void detach() noexcept { link_.reset(); }
  [[nodiscard]] usb_link* link() noexcept { return link_.get(); }

  /// One frame to the device, which answers each with one report.
  [[nodiscard]] io_status send(std::int64_t now_ns, const falcon_command& command) noexcept;

  /// Takes in everything that has arrived. Drops an answer to a frame of long ago, which says where the grip was then
  /// and not where it is now. @return ok | gone | too_short | failed ...
  [[nodiscard]] io_status receive(std::int64_t now_ns) noexcept;

  /// Steps of the encoders are judged from the next report on, as if it were the first: homing moves them.
  void forget_encoders() noexcept { judged_before_ = false; }
  /// Whether a report in which a leg is not homed is believed.
  void demand_homing(bool demanded) noexcept { homing_demanded_ = demanded; }

  /// Whether the last receive() brought a position that is believed.
  [[nodiscard]] bool fresh() const noexcept { return fresh_; }
  /// Whether there has been one at all.
  [[nodiscard]] bool placed() const noexcept { return positions_ != 0; }
  [[nodiscard]] const falcon_report& report() const noexcept { return report_; }
  [[nodiscard]] const falcon_angles& angles() const noexcept { return angles_; }
  [[nodiscard]] const vec3& grip_d() const noexcept { return position_.grip_d; }
  /// When the newest believed report arrived.
  [[nodiscard]] std::int64_t report_ns() const noexcept { return report_ns_; }
  /// Believed positions so far.
  [[nodiscard]] std::uint64_t positions() const noexcept { return positions_; }
  /// Well-formed reports so far, believed or not.
  [[nodiscard]] std::uint64_t reports() const noexcept { return reports_; }
  /// Reports that were spoilt or not believed so far.
  [[nodiscard]] std::uint64_t lost() const noexcept { return doubted_ + deframer_.broken() + line_errors_ + misread_; }
  /// The last report's flags, believed or not.
  [[nodiscard]] std::uint8_t homed() const noexcept { return homed_; }
  /// Reports in a row that were not believed, and why the last was not.
  [[nodiscard]] int doubted_in_a_row() const noexcept { return doubted_in_a_row_; }
  [[nodiscard]] falcon_doubt doubt() const noexcept { return doubt_; }
  /// How long frames have gone out without a report coming back, ns.
  [[nodiscard]] std::int64_t silence_ns(std::int64_t now_ns) const noexcept;

 private:
  static constexpr int most_transfers = 32;  // in one tick; a device that sends more is not one
  // The legs reach their workspace with some 2100 counts either way; the rest is for encoders that were homed a little
  // off.
  static constexpr int most_counts = 2600;
  static constexpr int most_counts_per_ms = 150;  // an arm's end at 6 m/s
  static constexpr std::int64_t outdated_after_ns = 10'000'000;

  void take(const falcon_frame& frame, std::int64_t host_time_ns) noexcept;
  [[nodiscard]] falcon_doubt judge(const falcon_report& report, std::int64_t host_time_ns) const noexcept;
  void reject(falcon_doubt doubt) noexcept;

  // Only the newest report of a tick is worth the iteration.
  void find_position() noexcept;

  // The legs can meet in more than one way; on the device they do in the one that falcon_angles_at() takes.
  [[nodiscard]] static bool is_reached(const vec3& grip_d, const falcon_angles& angles) noexcept;

  std::unique_ptr<usb_link> link_{};
  std::array<std::uint8_t, 512> buffer_{};
  falcon_deframer deframer_{};
  falcon_report candidate_{};
  std::int64_t candidate_ns_ = 0;
  std::array<std::int16_t, 3> last_encoders_{};
  std::int64_t last_encoders_ns_ = 0;
  bool judged_before_ = false;
  bool homing_demanded_ = false;
  falcon_report report_{};
  falcon_angles angles_{};
  falcon_position position_{};
  std::int64_t report_ns_ = 0;
  std::int64_t unanswered_since_ns_ = 0;
  std::int64_t sent_ns_ = 0;
  bool unanswered_ = false;
  bool outdated_ = false;
  bool fresh_ = false;
  std::uint8_t homed_ = 0;
  std::uint64_t positions_ = 0;
  std::uint64_t reports_ = 0;
  std::uint64_t misread_ = 0;
  std::uint64_t doubted_ = 0;
  std::uint64_t line_errors_ = 0;
  int doubted_in_a_row_ = 0;
  falcon_doubt doubt_ = falcon_doubt::none;
};

}  // namespace asperity
