// Both loops of the library on a virtual clock, of which a scenario takes time away.
#pragma once

#include <algorithm>
#include <cstdint>

#include "asperity/control/contact_loop.hpp"
#include "asperity/control/device_loop.hpp"
#include "session/simulation/stall/stall_scenario.hpp"

namespace asperity::simulation {

/// Runs a scenario, with its stalls or without. The device thread is an ideal one otherwise; the contact thread takes a
/// pose, computes for contact_takes_ns, hands over, and sleeps until its next due time. A stall stops a thread where it
/// is: a contact may be handed over long after its pose.
class stall_session {
 public:
  stall_session(const stall_scenario& s, bool with_stalls)
      : scenario_(s),
        with_stalls_(with_stalls),
        device_(opened(s)),
        contact_(s.ground, {{pose{}}, vec3(0.0)}, shared_),
        loop_(device_, with_periods(s.control, {s.device_period_ns, s.contact_period_ns}), vec3(0.0), shared_) {
    static_cast<void>(device_.open());
    static_cast<void>(device_.arm());
  }

  stall_session(const stall_session&) = delete;
  stall_session& operator=(const stall_session&) = delete;

  void run() {
    std::int64_t device_ns = 0;
    std::int64_t contact_ns = 0;
    std::int64_t pose_ns = 0;  // that the contact being computed belongs to
    bool computing = false;
    while (std::min(device_ns, contact_ns) < scenario_.length_ns) {
      if (contact_ns > device_ns) {
        static_cast<void>(loop_.tick(device_ns));
        device_ns = awake(stalled_thread::device, device_ns + scenario_.device_period_ns);
      } else if (computing) {
        contact_.publish();
        computing = false;
        contact_ns = awake(stalled_thread::contact, std::max(contact_ns, pose_ns + scenario_.contact_period_ns));
      } else {
        static_cast<void>(contact_.compute(contact_ns));
        computing = true;
        pose_ns = contact_ns;
        contact_ns = awake(stalled_thread::contact, contact_ns + scenario_.contact_takes_ns);
      }
    }
  }

  [[nodiscard]] const scripted_device& device() const noexcept { return device_; }
  [[nodiscard]] const device_loop<scripted_device>& loop() const noexcept { return loop_; }

 private:
  [[nodiscard]] static scripted_device opened(const stall_scenario& s) { return {s.hand, s.capabilities}; }

  // When a thread that wants to do something at `at_ns` does it.
  [[nodiscard]] std::int64_t awake(stalled_thread who, std::int64_t at_ns) const noexcept {
    if (!with_stalls_ || (scenario_.who != stalled_thread::both && scenario_.who != who)) return at_ns;
    for (const stall& s : scenario_.stalls) {
      if (at_ns >= s.from_ns && at_ns < s.until_ns) return s.until_ns;
    }
    return at_ns;
  }

  stall_scenario scenario_;
  bool with_stalls_;
  exchange shared_{};
  scripted_device device_;
  contact_loop<terrain> contact_;
  device_loop<scripted_device> loop_;
};

}  // namespace asperity::simulation
