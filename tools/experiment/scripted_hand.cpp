#include "scripted_hand.hpp"

#include <utility>

#include "asperity/device/simulated/simulated_settings.hpp"

namespace asperity::experiment {
namespace {

// Far above what any experiment needs: what limits the force shall be the force model.
device_capabilities strong_hand(const hand_grip& grip) {
  device_capabilities out = simulated_capabilities();
  out.name = "scripted hand";
  out.continuous_force_n = out.peak_force_n = 1e3;
  out.continuous_torque_n_m = out.peak_torque_n_m = 1e2;
  out.force_slew_n_per_s = 1e7;
  out.torque_slew_n_m_per_s = 1e6;
  out.position_resolution_m = out.rotation_resolution_rad = 0.0;
  out.worst_latency_ns = 0;
  out.moving_mass_kg = grip.mass_kg;
  out.moving_inertia_kg_m2 = grip.inertia_kg_m2;
  return out;
}

// Semi-implicit Euler along each axis, dampers and springs at the end of the step: no grip can blow up.
vec3 next_velocity(const vec3& v, const vec3& pull, double mass, const vec3& k, const vec3& b, double h) {
  vec3 out;
  for (int i = 0; i < 3; ++i) out[i] = (mass * v[i] + h * pull[i]) / (mass + h * b[i] + h * h * k[i]);
  return out;
}

}  // namespace

scripted_hand::scripted_hand(std::function<hand_wish(double)> script, const hand_grip& grip)
    : script_(std::move(script)), grip_(grip), capabilities_(strong_hand(grip)) {
  T_dh_ = script_(0.0).T_dh;
}

result<void> scripted_hand::open() {
  if (machine_.state() == device_state::absent || machine_.state() == device_state::closed) {
    machine_.apply(device_event::arrived);
  }
  if (!machine_.apply(device_event::opened)) {
    return error{error_code::invalid_argument, "the scripted hand is open already: close() it first"};
  }
  machine_.apply(device_event::prepared);
  return {};
}

result<void> scripted_hand::arm() {
  if (machine_.apply(device_event::armed)) return {};
  return error{error_code::invalid_argument, "the scripted hand is not ready: open() it first"};
}

result<void> scripted_hand::clear_fault() {
  if (machine_.apply(device_event::cleared)) return {};
  return error{error_code::invalid_argument, "the scripted hand has no fault to clear"};
}

status scripted_hand::disarm() noexcept {
  command_ = {};
  return machine_.apply(device_event::disarmed) ? status::ok : status::not_ready;
}

void scripted_hand::close() noexcept {
  command_ = {};
  machine_.apply(device_event::closed);
}

status scripted_hand::read(std::int64_t now_ns, device_sample& in) noexcept {
  if (!measures(machine_.state())) return status::not_ready;
  advance(now_ns);
  if (sequence_ == 0 || sampled_ns_ != now_ns) ++sequence_;
  sampled_ns_ = now_ns;
  in.host_time_ns = in.device_time_ns = now_ns;
  in.sequence = sequence_;
  in.lost = 0;
  in.T_dh = T_dh_;
  in.velocity_d = velocity_d_;
  in.valid =
      sample_field::position | sample_field::rotation | sample_field::linear_velocity | sample_field::angular_velocity;
  return status::ok;
}

status scripted_hand::write(std::int64_t now_ns, const device_command& out) noexcept {
  if (!measures(machine_.state())) return status::not_ready;
  advance(now_ns);
  if (out.frame != wrench_frame::device_base || !is_finite(out.on_hand)) {
    command_ = {};
    machine_.apply(device_event::failed);
    return status::not_finite;
  }
  const bool zero = is_zero(out.on_hand);
  if (may_put_out(machine_.state())) machine_.apply(zero ? device_event::released : device_event::engaged);
  command_ = may_put_out(machine_.state()) ? out : device_command{};
  return status::ok;
}

void scripted_hand::advance(std::int64_t now_ns) noexcept {
  if (!started_) {
    started_ = true;
    origin_ns_ = at_ns_ = now_ns;
  }
  if (grip_.rigid) {
    const hand_wish wish = script_(seconds(now_ns));
    T_dh_ = wish.T_dh;
    velocity_d_ = wish.velocity_d;
    at_ns_ = now_ns;
    return;
  }
  for (; at_ns_ + step_ns <= now_ns; at_ns_ += step_ns) step(script_(seconds(at_ns_)));
}

void scripted_hand::step(const hand_wish& wish) noexcept {
  constexpr double h = 1e-9 * static_cast<double>(step_ns);
  const wrench felt = at_ns_ <= command_.valid_until_ns ? command_.on_hand : wrench{};
  const vec3 turn_wanted = log_rotation(wish.T_dh.rotation * glm::conjugate(T_dh_.rotation));
  const vec3 pull = grip_.stiffness_n_per_m * (wish.T_dh.position - T_dh_.position) +
                    grip_.damping_n_s_per_m * wish.velocity_d.linear + wish.push_d.force + felt.force;
  const vec3 turn = grip_.stiffness_n_m_per_rad * turn_wanted + grip_.damping_n_m_s_per_rad * wish.velocity_d.angular +
                    wish.push_d.torque + felt.torque;
  velocity_d_.linear =
      next_velocity(velocity_d_.linear, pull, grip_.mass_kg, grip_.stiffness_n_per_m, grip_.damping_n_s_per_m, h);
  velocity_d_.angular = next_velocity(velocity_d_.angular, turn, grip_.inertia_kg_m2, grip_.stiffness_n_m_per_rad,
                                      grip_.damping_n_m_s_per_rad, h);
  T_dh_.position += h * velocity_d_.linear;
  T_dh_.rotation = glm::normalize(exp_rotation(h * velocity_d_.angular) * T_dh_.rotation);
}

}  // namespace asperity::experiment
