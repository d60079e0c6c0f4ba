#include "asperity/drivers/canopen/setup_dialogue.hpp"

#include <cmath>
#include <cstdint>
#include <optional>

namespace asperity::canopen {

setup_dialogue::setup_dialogue(const cia402_settings& settings)
    : steps_(setup_of(settings)),
      rated_m_n_m_(settings.rated_torque_n_m * 1000.0),
      answer_limit_ns_(settings.answer_limit_ns),
      most_tries_(settings.answer_tries),
      node_(settings.node) {}

void setup_dialogue::restart() noexcept {
  next_ = 0;
  tries_ = 0;
  asked_ = sent_pre_operational_ = false;
}

std::optional<drive_fault> setup_dialogue::unanswered() const noexcept {
  if (!sent_pre_operational_ || tries_ < most_tries_) return std::nullopt;
  return drive_fault{"the drive does not answer a request (index of the object)", object().index};
}

can_frame setup_dialogue::frame() const noexcept {
  using enum setup_step::kind;
  // A drive that starts by itself takes no mapping before.
  if (!sent_pre_operational_) return encode_nmt(nmt_command::pre_operational, node_);
  const setup_step& s = steps_[next_];
  return s.what == write || s.what == write_if_there ? encode_download_request(node_, s.at, s.value, s.size)
                                                     : encode_upload_request(node_, s.at);
}

void setup_dialogue::was_sent(std::int64_t now_ns) noexcept {
  if (!sent_pre_operational_) {
    sent_pre_operational_ = true;
    return;
  }
  asked_ = true;
  ++tries_;
  repeat_ns_ = now_ns + answer_limit_ns_;
}

std::optional<drive_fault> setup_dialogue::take(const sdo_response& answer) noexcept {
  using kind = sdo_response::kind;
  using enum setup_step::kind;
  if (!asked_ || done()) return std::nullopt;
  const setup_step& s = steps_[next_];
  if (answer.at != s.at) return std::nullopt;  // late, of a request that was repeated
  if (answer.what == kind::aborted) {
    const bool missing = answer.value == abort_code::no_object || answer.value == abort_code::no_sub;
    if (s.what != write_if_there || !missing) {
      return drive_fault{"the drive refused an object of its configuration (SDO abort)", answer.value};
    }
  } else if (s.what == write || s.what == write_if_there) {
    if (answer.what != kind::written) return std::nullopt;
  } else {
    if (answer.what != kind::value) return std::nullopt;
    if (s.what == expect && answer.value != s.value) {
      return drive_fault{"the drive did not keep a value of its configuration (index of the object)", s.at.index};
    }
    if (s.what == torque_modes && (answer.value & torque_mode_supported) == 0) {
      return drive_fault{"the drive has no cyclic synchronous torque mode (object 6502)", answer.value};
    }
    if (s.what == rated_torque && !(std::fabs(answer.value - rated_m_n_m_) <= 1.0 + 1e-3 * rated_m_n_m_)) {
      return drive_fault{"the drive's rated torque (object 6076, mN m) is not the configured one", answer.value};
    }
  }
  ++next_;
  tries_ = 0;
  asked_ = false;
  return std::nullopt;
}

}  // namespace asperity::canopen
