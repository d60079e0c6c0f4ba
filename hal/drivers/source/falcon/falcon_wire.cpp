#include "asperity/drivers/falcon/falcon_wire.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <optional>
#include <span>
#include <utility>

namespace asperity {

void falcon_wire::attach(std::unique_ptr<usb_link> link) noexcept {
  *this = falcon_wire{};
  link_ = std::move(link);
}

io_status falcon_wire::send(std::int64_t now_ns, const falcon_command& command) noexcept {
  const io_status s = link_->write(now_ns, encode_falcon(command));
  if (s == io_status::ok) sent_ns_ = now_ns;
  if (s == io_status::ok && !unanswered_) {
    unanswered_ = true;
    unanswered_since_ns_ = now_ns;
  }
  return s;
}

io_status falcon_wire::receive(std::int64_t now_ns) noexcept {
  fresh_ = false;
  outdated_ = now_ns - sent_ns_ > outdated_after_ns;
  io_status s = io_status::ok;
  for (int i = 0; i < most_transfers && s == io_status::ok; ++i) {
    usb_packet packet;
    s = link_->read(now_ns, buffer_, packet);
    if (s != io_status::ok) break;
    const std::size_t size = std::min(packet.size, buffer_.size());
    line_errors_ += for_each_ftdi_byte(std::span<const std::uint8_t>(buffer_).first(size), [&](std::uint8_t byte) {
      const std::optional<falcon_frame> frame = deframer_.push(byte);
      if (frame) take(*frame, packet.host_time_ns);
    });
  }
  if (fresh_) find_position();
  return s == io_status::nothing ? io_status::ok : s;
}

std::int64_t falcon_wire::silence_ns(std::int64_t now_ns) const noexcept {
  return unanswered_ ? now_ns - unanswered_since_ns_ : 0;
}

void falcon_wire::take(const falcon_frame& frame, std::int64_t host_time_ns) noexcept {
  const std::optional<falcon_report> report = decode_falcon_report(frame);
  if (!report) {
    ++misread_;
    return;
  }
  ++reports_;
  unanswered_ = false;
  homed_ = report->homed;
  if (outdated_) return;
  const falcon_doubt doubt = judge(*report, host_time_ns);
  if (doubt != falcon_doubt::none) {
    reject(doubt);
    return;
  }
  judged_before_ = true;
  last_encoders_ = report->encoder_counts;
  last_encoders_ns_ = host_time_ns;
  candidate_ = *report;
  candidate_ns_ = host_time_ns;
  fresh_ = true;
}

falcon_doubt falcon_wire::judge(const falcon_report& report, std::int64_t host_time_ns) const noexcept {
  if (homing_demanded_ && report.homed != falcon_all_homed) return falcon_doubt::not_homed;
  // The longer nothing was heard, the farther the hand may have gone.
  const std::int64_t passed_ms = std::max<std::int64_t>((host_time_ns - last_encoders_ns_) / 1'000'000, 1);
  for (std::size_t i = 0; i < 3; ++i) {
    const int counts = report.encoder_counts[i];
    if (std::abs(counts) > most_counts) return falcon_doubt::out_of_range;
    if (judged_before_ && std::abs(counts - last_encoders_[i]) > most_counts_per_ms * passed_ms)
      return falcon_doubt::jump;
  }
  return falcon_doubt::none;
}

void falcon_wire::reject(falcon_doubt doubt) noexcept {
  doubt_ = doubt;
  ++doubted_;
  ++doubted_in_a_row_;
}

void falcon_wire::find_position() noexcept {
  falcon_angles angles{};
  for (std::size_t i = 0; i < 3; ++i) angles[i] = falcon_angle_rad(candidate_.encoder_counts[i]);
  falcon_position p = falcon_position_at(angles, position_.grip_d);
  if (!p.converged) p = falcon_position_at(angles);
  if (!p.converged || !is_reached(p.grip_d, angles)) {
    reject(falcon_doubt::no_position);
    fresh_ = false;
    return;
  }
  position_ = p;
  angles_ = angles;
  report_ = candidate_;
  report_ns_ = candidate_ns_;
  ++positions_;
  doubted_in_a_row_ = 0;
}

bool falcon_wire::is_reached(const vec3& grip_d, const falcon_angles& angles) noexcept {
  constexpr double wide_m = 0.1;  // twice what its maker says of it
  if (!(std::fabs(grip_d.x) < wide_m && std::fabs(grip_d.y) < wide_m && grip_d.z > 0.0)) return false;
  const std::optional<falcon_angles> back = falcon_angles_at(grip_d);
  if (!back) return false;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!(std::fabs((*back)[i] - angles[i]) < falcon_rad_per_count)) return false;
  }
  return true;
}

}  // namespace asperity
