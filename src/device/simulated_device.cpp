#include "asperity/device/simulated/simulated_device.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>

namespace asperity {

simulated_device::simulated_device(simulated_settings settings)
    : settings_(std::move(settings)),
      motion_(settings_.motion, settings_.seed),
      led_(motion_.at(0.0).T_dh),
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

result<void> simulated_device::open() {
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

result<void> simulated_device::arm() {
  if (!machine_.apply(device_event::armed)) return refused("arm");
  return {};
}

result<void> simulated_device::clear_fault() {
  if (!machine_.apply(device_event::cleared)) return refused("clear_fault");
  return {};
}

status simulated_device::disarm() noexcept {
  command_ = {};
  return machine_.apply(device_event::disarmed) ? status::ok : status::not_ready;
}

void simulated_device::close() noexcept {
  command_ = {};
  machine_.apply(device_event::closed);
}

status simulated_device::read(std::int64_t now_ns, device_sample& in) noexcept {
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

status simulated_device::write(std::int64_t now_ns, const device_command& out) noexcept {
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

status simulated_device::applied(std::int64_t now_ns, wrench& out) const noexcept {
  out = now_ns <= command_.valid_until_ns ? command_.on_hand : wrench{};
  return status::ok;
}

void simulated_device::plug_in() noexcept {
  returns_ += departed_ ? 1U : 0U;
  departed_ = false;
  machine_.apply(device_event::arrived);
}

double simulated_device::kinetic_j() const noexcept {
  const twist& v = plant_.velocity_d;
  return 0.5 * (settings_.plant.mass_kg * glm::dot(v.linear, v.linear) +
                settings_.plant.inertia_kg_m2 * glm::dot(v.angular, v.angular));
}

bool simulated_device::fault_at(device_fault kind, std::int64_t now_ns) const noexcept {
  for (const scripted_fault& f : settings_.faults) {
    if (f.kind == kind && now_ns >= f.from_ns && now_ns < f.until_ns) return true;
  }
  return false;
}

status simulated_device::unanswered() const noexcept {
  return machine_.state() == device_state::fault && !departed_ ? status::backend_failed : status::not_ready;
}

void simulated_device::depart() noexcept {
  departed_ = true;
  command_ = {};
  machine_.apply(device_event::departed);
}

void simulated_device::overheat() noexcept {
  command_ = {};
  machine_.apply(device_event::failed);
}

bool simulated_device::has_news(std::int64_t now_ns) noexcept {
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

error simulated_device::refused(const char* what) const {
  return {error_code::invalid_argument,
          std::string(what) + "() is not possible while the simulated device is " + to_string(machine_.state())};
}

vec3 simulated_device::saturated(const vec3& v, double limit) noexcept {
  const double largest = std::max(std::fabs(v.x), std::max(std::fabs(v.y), std::fabs(v.z)));
  if (!(largest > 0.0)) return v;
  const vec3 direction = v / largest;  // first, so that no square of an ordinary number is infinite
  const double length = std::sqrt(glm::dot(direction, direction));
  return largest * length > limit * 1.00000001 ? (limit / length) * direction : v;
}

void simulated_device::advance(std::int64_t now_ns) noexcept {
  if (!started_) {
    started_ = true;
    origin_ns_ = now_ns;
    plant_ns_ = now_ns;
    past_.fill({plant_, now_ns});
  }
  while (plant_ns_ + plant_step_ns <= now_ns) step();
}

const hand_target& simulated_device::led(double h_s) noexcept {
  const pose* const goal = settings_.lead->newest();
  return led_.follow(goal != nullptr ? *goal : motion_.at(0.0).T_dh, h_s);
}

void simulated_device::step() noexcept {
  const double h = static_cast<double>(plant_step_ns) * 1e-9;
  const double t = static_cast<double>(plant_ns_ - origin_ns_) * 1e-9;
  const hand_target hand = settings_.lead ? led(h) : motion_.at(t);
  const hand_settings& g = settings_.hand;
  const plant_settings& p = settings_.plant;
  const wrench put_out = put_out_ =
      actuator_.follow(plant_ns_ <= command_.valid_until_ns ? command_.on_hand : wrench{}, h);

  vec3 pull = g.stiffness_n_per_m * (hand.T_dh.position + tremor(t) - plant_.T_dh.position) +
              g.damping_n_s_per_m * hand.velocity_d.linear + put_out.force;
  vec3 turn = g.stiffness_n_m_per_rad * log_rotation(hand.T_dh.rotation * glm::conjugate(plant_.T_dh.rotation)) +
              g.damping_n_m_s_per_rad * hand.velocity_d.angular + put_out.torque;
  const wrench held_by_hand{pull - put_out.force, turn - put_out.torque};
  wrench weight{};
  if (p.gravity_d != vec3(0.0)) {
    weight.force = p.mass_kg * p.gravity_d;
    weight.torque = glm::cross(plant_.T_dh.rotation * p.centre_h, weight.force);
    pull += weight.force;
    turn += weight.torque;
  }
  const double b = g.damping_n_s_per_m + p.damping_n_s_per_m;
  const double br = g.damping_n_m_s_per_rad + p.damping_n_m_s_per_rad;
  const twist before = plant_.velocity_d;
  twist& v = plant_.velocity_d;
  v.linear = (p.mass_kg * v.linear + h * pull) / (p.mass_kg + h * b);
  v.angular = (p.inertia_kg_m2 * v.angular + h * turn) / (p.inertia_kg_m2 + h * br);
  plant_.T_dh.position += h * v.linear;
  plant_.T_dh.rotation = glm::normalize(exp_rotation(h * v.angular) * plant_.T_dh.rotation);
  energy_.by_weight_j += h * (glm::dot(weight.force, v.linear) + glm::dot(weight.torque, v.angular));
  book(h, before, put_out, held_by_hand);

  plant_ns_ += plant_step_ns;
  past_next_ = (past_next_ + 1) % past_size;
  past_[past_next_] = {plant_, plant_ns_};
}

void simulated_device::book(double h, const twist& before, const wrench& put_out, const wrench& pull) noexcept {
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

vec3 simulated_device::tremor(double t_s) const noexcept {
  vec3 out{0.0};
  for (std::size_t i = 0; i < tremor_.size(); ++i) {
    out[static_cast<int>(i % 3)] += std::sin(tremor_[i].rate_rad_per_s * t_s + tremor_[i].phase_rad);
  }
  return settings_.hand.tremor_m * out;
}

void simulated_device::measure(std::int64_t now_ns) noexcept {
  const measurement_settings& m = settings_.measurement;
  const std::int64_t delay = m.delay_ns + static_cast<std::int64_t>(unit() * static_cast<double>(m.jitter_ns));
  const std::size_t back =
      std::min<std::size_t>(static_cast<std::size_t>(std::max<std::int64_t>(0, delay) / plant_step_ns), past_size - 1);
  const past_state& then = past_[(past_next_ + past_size - back) % past_size];
  newest_.host_time_ns = now_ns;
  newest_.device_time_ns = then.time_ns;
  newest_.sequence = ++sequence_;
  newest_.lost = lost_;
  newest_.T_dh = quantised(then.plant.T_dh);
  newest_.velocity_d = then.plant.velocity_d;
  newest_.valid =
      sample_field::position | sample_field::rotation | sample_field::linear_velocity | sample_field::angular_velocity;
  if (settings_.capabilities.has_gripper()) {
    newest_.valid = newest_.valid | sample_field::gripper;
    newest_.gripper_m = gripper_m(1e-9 * static_cast<double>(then.time_ns - origin_ns_));
  }
  if (settings_.presses.empty()) return;
  newest_.valid = newest_.valid | sample_field::buttons;
  newest_.buttons = 0;
  for (const scripted_press& p : settings_.presses) {
    if (now_ns >= p.from_ns && now_ns < p.until_ns) newest_.buttons |= p.buttons;
  }
}

double simulated_device::gripper_m(double t_s) const noexcept {
  const device_capabilities& c = settings_.capabilities;
  const double share = 0.5 - 0.5 * std::cos(6.283185307179586 * 0.5 * t_s);
  return c.gripper_low_m + share * (c.gripper_high_m - c.gripper_low_m);
}

pose simulated_device::quantised(const pose& T) const noexcept {
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

void simulated_device::spoil(std::int64_t now_ns, device_sample& s) noexcept {
  if (!fault_at(device_fault::stuck_encoder, now_ns)) stuck_x_m_ = s.T_dh.position.x;
  s.T_dh.position.x = stuck_x_m_;
  if (fault_at(device_fault::nan_pose, now_ns)) s.T_dh.position.x = std::numeric_limits<double>::quiet_NaN();
  if (fault_at(device_fault::infinite_pose, now_ns)) s.T_dh.position.y = std::numeric_limits<double>::infinity();
  if (fault_at(device_fault::bad_rotation, now_ns)) s.T_dh.rotation = 2.0 * s.T_dh.rotation;
  if (fault_at(device_fault::jump, now_ns)) s.T_dh.position.z += 0.5;
}

}  // namespace asperity
