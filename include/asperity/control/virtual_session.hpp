// Both loops on a clock that is a number: the same session, the same bits, as fast as the machine can.
#pragma once

#include <cstdint>
#include <utility>

#include "asperity/control/contact_loop.hpp"
#include "asperity/control/device_loop.hpp"

namespace asperity {

/// Who runs when. Times are virtual; contact ticks cost none.
struct virtual_schedule {
  std::int64_t start_ns = 0;
  std::int64_t device_period_ns = 1'000'000;
  std::int64_t contact_period_ns = 1'000'000;
  /// When a contact is handed over: in the tick that computed it, or at the next contact tick, as if it had taken the
  /// whole period to compute.
  bool contact_one_period_late = false;

  [[nodiscard]] constexpr loop_periods periods() const noexcept { return {device_period_ns, contact_period_ns}; }
};

/// A contact loop and a device loop, interleaved by one fixed rule: in time order, and where both fall on one instant
/// the contact loop runs first, on the pose of the device tick before.
/// The device must not read a clock either: the simulated device does not.
template <contact_renderer Renderer, haptic_device Device, session_observer Observer = no_observer>
class virtual_session : public session_application {
 public:
  /// @param dev open and, to be felt, armed; outlives the session
  /// @pre both periods > 0
  virtual_session(Renderer feel, scene_placement placement, Device& dev, const control_settings& settings,
                  const virtual_schedule& schedule = {}, Observer observer = {})
      : schedule_(schedule),
        contact_(std::move(feel), placement, shared_,
                 selection_for(schedule.periods().renewal_ns(), settings.map.scale), laws_of(settings)),
        device_(dev, with_periods(settings, schedule.periods()), placement.centre_of_mass_a, shared_,
                std::move(observer)),
        next_contact_ns_(schedule.start_ns),
        next_device_ns_(schedule.start_ns) {}

  // The loops hold the address of the exchange.
  virtual_session(const virtual_session&) = delete;
  virtual_session& operator=(const virtual_session&) = delete;

  /// Runs up to the next device tick and through it. @return that tick's status
  /// @rt as safe as renderer and device
  status step() noexcept {
    while (step_contact()) continue;
    const status s = device_.tick(next_device_ns_);
    next_device_ns_ += schedule_.device_period_ns;
    ++device_ticks_;
    return s;
  }

  /// Runs the next contact tick, where one comes before the next device tick. For whoever times the two loops apart:
  /// step() runs those that are left. @return whether there was one
  /// @rt as safe as the renderer
  bool step_contact() noexcept {
    if (next_contact_ns_ > next_device_ns_) return false;
    if (schedule_.contact_one_period_late) contact_.publish();
    contact_status_ = contact_.compute(next_contact_ns_);
    if (!schedule_.contact_one_period_late) contact_.publish();
    next_contact_ns_ += schedule_.contact_period_ns;
    ++contact_ticks_;
    return true;
  }

  /// Runs every device tick before until_ns. @return the last status
  status run_until(std::int64_t until_ns) noexcept {
    status s = status::ok;
    while (next_device_ns_ < until_ns) s = step();
    return s;
  }

  /// Puts the next device tick at another time than one period after the last, as for ticks that once came unevenly.
  /// @pre not before the last one
  void next_device_at(std::int64_t at_ns) noexcept { next_device_ns_ = at_ns; }

  /// The way by which versions of a scene that changes come into the session; see scene_editor::commit(). From one
  /// thread, while the session runs.
  [[nodiscard]] auto& scenes() noexcept requires scene_taker<Renderer> { return contact_.scenes(); }
  /// Time of the next device tick.
  [[nodiscard]] std::int64_t now_ns() const noexcept { return next_device_ns_; }
  [[nodiscard]] std::uint64_t device_ticks() const noexcept { return device_ticks_; }
  [[nodiscard]] std::uint64_t contact_ticks() const noexcept { return contact_ticks_; }
  /// The renderer's answer in the last contact tick.
  [[nodiscard]] status contact_status() const noexcept { return contact_status_; }
  [[nodiscard]] contact_loop<Renderer>& contact() noexcept { return contact_; }
  [[nodiscard]] device_loop<Device, Observer>& device() noexcept { return device_; }

 private:
  virtual_schedule schedule_;
  contact_loop<Renderer> contact_;
  device_loop<Device, Observer> device_;
  std::int64_t next_contact_ns_;
  std::int64_t next_device_ns_;
  std::uint64_t device_ticks_ = 0;
  std::uint64_t contact_ticks_ = 0;
  status contact_status_ = status::not_ready;
};

}  // namespace asperity
