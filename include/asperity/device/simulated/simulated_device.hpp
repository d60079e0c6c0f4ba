// A device made of numbers: a plant, a hand and a script of faults on a virtual clock.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "asperity/device/device.hpp"
#include "asperity/device/simulated/actuator.hpp"
#include "asperity/device/simulated/motion_script.hpp"
#include "asperity/device/simulated/simulated_settings.hpp"

namespace asperity {

/// Where the energy of the plant went since the first read(), J. Works are of the wrench at the end of a plant step, as
/// the step uses it, so that by_device_j + by_hand_j - damped_j - numerical_j is the kinetic energy gained, to
/// rounding.
struct plant_energy {
  double by_device_j = 0.0;  ///< work of the device's wrench
  double by_hand_j = 0.0;    ///< work of the hand's spring and damper
  double damped_j = 0.0;     ///< lost in the plant's own dampers
  double numerical_j = 0.0;  ///< taken out by the implicit step
};

/// Driver of a device that does not exist, under the contract of a real one.
///
/// read(now) integrates plant and hand up to now in steps of 50 us with the last command (zero after its
/// valid_until_ns, which is the device's own watchdog), so that the session's clock is the only clock. The motion
/// script begins with the first read(). The same configuration and the same calls give the same bits.
class simulated_device {
 public:
  using policy_tag = device_tag;

  explicit simulated_device(simulated_settings settings = {})
      : settings_(std::move(settings)),
        motion_(settings_.motion, settings_.seed),
        bits_(settings_.seed ^ 0x9e3779b97f4a7c15ULL),
        luck_(settings_.seed ^ 0x6c6f7373ULL),
        actuator_(settings_.actuator) {
    for (tremor_wave& w : tremor_) {
      w.rate_rad_per_s = 2.0 * 3.141592653589793 * (8.0 + 4.0 * unit());
      w.phase_rad = 2.0 * 3.141592653589793 * unit();
    }
    const hand_target start = motion_.at(0.0);
    plant_ = {start.T_dh, {}};
    past_.fill({plant_, 0});
  }

  [[nodiscard]] const device_capabilities& capabilities() const noexcept { return settings_.capabilities; }
  [[nodiscard]] device_state state() const noexcept { return machine_.state(); }

  [[nodiscard]] result<void> open() {
    if (departed_) {
      return error{error_code::io_failed, "the simulated device has left its bus; call plug_in() before open()"};
    }
    if (machine_.state() == device_state::absent || machine_.state() == device_state::closed) {
      machine_.apply(device_event::arrived);
    }
    if (!machine_.apply(device_event::opened)) return refused("open");
    machine_.apply(device_event::prepared);
    return {};
  }

  [[nodiscard]] result<void> arm() {
    if (!machine_.apply(device_event::armed)) return refused("arm");
    return {};
  }

  [[nodiscard]] result<void> clear_fault() {
    if (!machine_.apply(device_event::cleared)) return refused("clear_fault");
    return {};
  }

  status disarm() noexcept {
    command_ = {};
    return machine_.apply(device_event::disarmed) ? status::ok : status::not_ready;
  }

  void close() noexcept {
    command_ = {};
    machine_.apply(device_event::closed);
  }

  /// @return ok | backend_failed (a scripted drop, or in a fault) | not_ready (not open, or departed)
  [[nodiscard]] status read(std::int64_t now_ns, device_sample& in) noexcept {
    advance(now_ns);
    if (fault_at(device_fault::depart, now_ns)) depart();
    if (fault_at(device_fault::overheat, now_ns) || actuator_.burnt()) overheat();
    if (!measures()) return unanswered();
    if (fault_at(device_fault::drop, now_ns)) return status::backend_failed;
    if (has_news(now_ns)) measure(now_ns);
    in = newest_;
    spoil(now_ns, in);
    return status::ok;
  }

  /// @return ok | backend_failed (a scripted refusal, or in a fault) | not_ready (not open, or departed)
  [[nodiscard]] status write(std::int64_t now_ns, const device_command& out) noexcept {
    advance(now_ns);
    if (!measures()) return unanswered();
    if (fault_at(device_fault::refuse_write, now_ns)) return status::backend_failed;
    if (!may_put_out(machine_.state())) {
      command_ = {};
      return status::ok;
    }
    if (out.frame != wrench_frame::device_base || !is_finite(out.on_hand)) {
      command_ = {};
      machine_.apply(device_event::failed);
      return status::not_finite;
    }
    const bool zero = is_zero(out.on_hand);
    machine_.apply(zero ? device_event::released : device_event::engaged);
    command_ = out;
    command_.on_hand = {saturated(out.on_hand.force, settings_.capabilities.peak_force_n),
                        saturated(out.on_hand.torque, settings_.capabilities.peak_torque_n_m)};
    return status::ok;
  }

  /// Wrench that is commanded to the motors at now_ns. @rt safe
  [[nodiscard]] status applied(std::int64_t now_ns, wrench& out) const noexcept {
    out = now_ns <= command_.valid_until_ns ? command_.on_hand : wrench{};
    return status::ok;
  }

  /// Takes the device off its bus, as device_fault::depart does.
  void unplug() noexcept { depart(); }

  /// Puts a departed device back on its bus: present, or still in its fault until clear_fault(). Every return is under
  /// another path.
  void plug_in() noexcept {
    returns_ += departed_ ? 1U : 0U;
    departed_ = false;
    machine_.apply(device_event::arrived);
  }
  /// Where the device is plugged in: "simulated:0", after its first return "simulated:1". Not in a tick.
  [[nodiscard]] std::string path() const { return "simulated:" + std::to_string(returns_); }
  /// What the motors put out in the last step of the plant.
  [[nodiscard]] const wrench& put_out() const noexcept { return put_out_; }
  /// The device's own motors, as hot and as limited as they are.
  [[nodiscard]] const simulated_actuator& actuator() const noexcept { return actuator_; }

  /// What the hand feels and does now, for tests and recordings: the truth behind the measurements.
  [[nodiscard]] const pose& true_T_dh() const noexcept { return plant_.T_dh; }
  [[nodiscard]] const twist& true_velocity_d() const noexcept { return plant_.velocity_d; }
  /// Work of the device's wrench on the hand's side of the port since the first read(), J.
  [[nodiscard]] double delivered_j() const noexcept { return energy_.by_device_j; }
  /// The whole book of the plant.
  [[nodiscard]] const plant_energy& energy() const noexcept { return energy_; }
  /// Kinetic energy of the plant, J.
  [[nodiscard]] double kinetic_j() const noexcept {
    const twist& v = plant_.velocity_d;
    return 0.5 * (settings_.plant.mass_kg * glm::dot(v.linear, v.linear) +
                  settings_.plant.inertia_kg_m2 * glm::dot(v.angular, v.angular));
  }
  [[nodiscard]] const simulated_settings& settings() const noexcept { return settings_; }

 private:
  static constexpr std::int64_t plant_step_ns = 50'000;
  static constexpr std::int64_t slow_reply_ns = 8'000'000;
  static constexpr std::size_t past_size = 512;  // 25.6 ms of plant states for the delay

  struct plant_state {
    pose T_dh{};
    twist velocity_d{};
  };
  struct past_state {
    plant_state plant{};
    std::int64_t time_ns = 0;
  };
  struct tremor_wave {
    double rate_rad_per_s = 0.0;
    double phase_rad = 0.0;
  };

  [[nodiscard]] double unit() noexcept { return static_cast<double>(bits_() >> 11) * 0x1.0p-53; }

  [[nodiscard]] bool measures() const noexcept { return asperity::measures(machine_.state()); }

  [[nodiscard]] bool fault_at(device_fault kind, std::int64_t now_ns) const noexcept {
    for (const scripted_fault& f : settings_.faults) {
      if (f.kind == kind && now_ns >= f.from_ns && now_ns < f.until_ns) return true;
    }
    return false;
  }

  // A device that is there and in a fault says so; one that is not there says nothing.
  [[nodiscard]] status unanswered() const noexcept {
    return machine_.state() == device_state::fault && !departed_ ? status::backend_failed : status::not_ready;
  }

  void depart() noexcept {
    departed_ = true;
    command_ = {};
    machine_.apply(device_event::departed);
  }

  void overheat() noexcept {
    command_ = {};
    machine_.apply(device_event::failed);
  }

  // Whether a measurement reaches the host now. The first one always does.
  [[nodiscard]] bool has_news(std::int64_t now_ns) noexcept {
    if (sequence_ == 0) return true;
    if (newest_.host_time_ns == now_ns) return false;  // asked again: one instant has one measurement
    if (fault_at(device_fault::stale, now_ns)) return false;
    if (fault_at(device_fault::slow_reply, now_ns) && now_ns < newest_.host_time_ns + slow_reply_ns) return false;
    const double loss = fault_at(device_fault::loss, now_ns) ? 0.9 : settings_.measurement.loss;
    if (!(loss > 0.0) || static_cast<double>(luck_() >> 11) * 0x1.0p-53 >= loss) return true;
    ++sequence_;
    ++lost_;
    return false;
  }

  [[nodiscard]] error refused(const char* what) const {
    return {error_code::invalid_argument,
            std::string(what) + "() is not possible while the simulated device is " + to_string(machine_.state())};
  }

  // What the output gate let through stays as it is, to the bit; its certificate leaves room for rounding.
  [[nodiscard]] static vec3 saturated(const vec3& v, double limit) noexcept {
    const double largest = std::max(std::fabs(v.x), std::max(std::fabs(v.y), std::fabs(v.z)));
    if (!(largest > 0.0)) return v;
    const vec3 direction = v / largest;  // first, so that no square of an ordinary number is infinite
    const double length = std::sqrt(glm::dot(direction, direction));
    return largest * length > limit * 1.00000001 ? (limit / length) * direction : v;
  }

  void advance(std::int64_t now_ns) noexcept {
    if (!started_) {
      started_ = true;
      origin_ns_ = now_ns;
      plant_ns_ = now_ns;
      past_.fill({plant_, now_ns});
    }
    while (plant_ns_ + plant_step_ns <= now_ns) step();
  }

  // Semi-implicit Euler: the dampers are taken at the end of the step, so that a firm grip cannot blow up.
  void step() noexcept {
    const double h = static_cast<double>(plant_step_ns) * 1e-9;
    const double t = static_cast<double>(plant_ns_ - origin_ns_) * 1e-9;
    const hand_target hand = motion_.at(t);
    const hand_settings& g = settings_.hand;
    const plant_settings& p = settings_.plant;
    const wrench put_out = put_out_ =
        actuator_.follow(plant_ns_ <= command_.valid_until_ns ? command_.on_hand : wrench{}, h);

    const vec3 pull = g.stiffness_n_per_m * (hand.T_dh.position + tremor(t) - plant_.T_dh.position) +
                      g.damping_n_s_per_m * hand.velocity_d.linear + put_out.force;
    const vec3 turn =
        g.stiffness_n_m_per_rad * log_rotation(hand.T_dh.rotation * glm::conjugate(plant_.T_dh.rotation)) +
        g.damping_n_m_s_per_rad * hand.velocity_d.angular + put_out.torque;
    const double b = g.damping_n_s_per_m + p.damping_n_s_per_m;
    const double br = g.damping_n_m_s_per_rad + p.damping_n_m_s_per_rad;
    const twist before = plant_.velocity_d;
    twist& v = plant_.velocity_d;
    v.linear = (p.mass_kg * v.linear + h * pull) / (p.mass_kg + h * b);
    v.angular = (p.inertia_kg_m2 * v.angular + h * turn) / (p.inertia_kg_m2 + h * br);
    plant_.T_dh.position += h * v.linear;
    plant_.T_dh.rotation = glm::normalize(exp_rotation(h * v.angular) * plant_.T_dh.rotation);
    book(h, before, put_out, {pull - put_out.force, turn - put_out.torque});

    plant_ns_ += plant_step_ns;
    past_next_ = (past_next_ + 1) % past_size;
    past_[past_next_] = {plant_, plant_ns_};
  }

  // `pull` is the hand's wrench before its damper took part in the step.
  void book(double h, const twist& before, const wrench& put_out, const wrench& pull) noexcept {
    const hand_settings& g = settings_.hand;
    const plant_settings& p = settings_.plant;
    const twist& v = plant_.velocity_d;
    const double v2 = glm::dot(v.linear, v.linear);
    const double w2 = glm::dot(v.angular, v.angular);
    const vec3 dv = v.linear - before.linear;
    const vec3 dw = v.angular - before.angular;
    energy_.by_device_j += h * (glm::dot(put_out.force, v.linear) + glm::dot(put_out.torque, v.angular));
    energy_.by_hand_j += h * (glm::dot(pull.force, v.linear) - g.damping_n_s_per_m * v2 +
                              glm::dot(pull.torque, v.angular) - g.damping_n_m_s_per_rad * w2);
    energy_.damped_j += h * (p.damping_n_s_per_m * v2 + p.damping_n_m_s_per_rad * w2);
    energy_.numerical_j += 0.5 * (p.mass_kg * glm::dot(dv, dv) + p.inertia_kg_m2 * glm::dot(dw, dw));
  }

  [[nodiscard]] vec3 tremor(double t_s) const noexcept {
    vec3 out{0.0};
    for (std::size_t i = 0; i < tremor_.size(); ++i) {
      out[static_cast<int>(i % 3)] += std::sin(tremor_[i].rate_rad_per_s * t_s + tremor_[i].phase_rad);
    }
    return settings_.hand.tremor_m * out;
  }

  void measure(std::int64_t now_ns) noexcept {
    const measurement_settings& m = settings_.measurement;
    const std::int64_t delay = m.delay_ns + static_cast<std::int64_t>(unit() * static_cast<double>(m.jitter_ns));
    const std::size_t back = std::min<std::size_t>(
        static_cast<std::size_t>(std::max<std::int64_t>(0, delay) / plant_step_ns), past_size - 1);
    const past_state& then = past_[(past_next_ + past_size - back) % past_size];
    newest_.host_time_ns = now_ns;
    newest_.device_time_ns = then.time_ns;
    newest_.sequence = ++sequence_;
    newest_.lost = lost_;
    newest_.T_dh = quantised(then.plant.T_dh);
    newest_.velocity_d = then.plant.velocity_d;
    newest_.valid = sample_field::position | sample_field::rotation | sample_field::linear_velocity |
                    sample_field::angular_velocity;
  }

  [[nodiscard]] pose quantised(const pose& T) const noexcept {
    const auto grid = [](vec3 v, double q) {
      return q > 0.0 ? vec3(q * std::round(v.x / q), q * std::round(v.y / q), q * std::round(v.z / q)) : v;
    };
    const measurement_settings& m = settings_.measurement;
    pose out{T.rotation, grid(T.position, m.position_resolution_m)};
    if (m.rotation_resolution_rad > 0.0) {
      out.rotation = exp_rotation(grid(log_rotation(T.rotation), m.rotation_resolution_rad));
    }
    return out;
  }

  void spoil(std::int64_t now_ns, device_sample& s) noexcept {
    if (!fault_at(device_fault::stuck_encoder, now_ns)) stuck_x_m_ = s.T_dh.position.x;
    s.T_dh.position.x = stuck_x_m_;
    if (fault_at(device_fault::nan_pose, now_ns)) s.T_dh.position.x = std::numeric_limits<double>::quiet_NaN();
    if (fault_at(device_fault::infinite_pose, now_ns)) s.T_dh.position.y = std::numeric_limits<double>::infinity();
    if (fault_at(device_fault::bad_rotation, now_ns)) s.T_dh.rotation = 2.0 * s.T_dh.rotation;
    if (fault_at(device_fault::jump, now_ns)) s.T_dh.position.z += 0.5;
  }

  simulated_settings settings_;
  motion_script motion_;
  std::mt19937_64 bits_;
  std::mt19937_64 luck_;  // of its own, so that a loss leaves delays and tremor as they are
  simulated_actuator actuator_;
  std::array<tremor_wave, 9> tremor_{};
  device_state_machine machine_{};
  bool departed_ = false;
  unsigned returns_ = 0;

  bool started_ = false;
  std::int64_t origin_ns_ = 0;
  std::int64_t plant_ns_ = 0;
  plant_state plant_{};
  std::array<past_state, past_size> past_{};
  std::size_t past_next_ = 0;
  device_command command_{};
  wrench put_out_{};
  device_sample newest_{};
  std::uint64_t sequence_ = 0;
  std::uint64_t lost_ = 0;
  double stuck_x_m_ = 0.0;
  plant_energy energy_{};
};

static_assert(haptic_device<simulated_device>);

}  // namespace asperity
