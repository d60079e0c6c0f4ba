#include "session_summary.hpp"

#include <algorithm>
#include <utility>

#include "model_report.hpp"
#include "text.hpp"

namespace asperity::command {
namespace {

json range_json(const vector_range& range) {
  return {{"max", range.largest()}, {"low", to_json(range.low())}, {"high", to_json(range.high())}};
}

std::string range_text(const vector_range& range, const std::string& unit, double scale) {
  std::string out = "up to " + brief(scale * range.largest()) + ' ' + unit + "  (";
  const char* const names[] = {"x ", ", y ", ", z "};
  for (int i = 0; i < 3; ++i) {
    out += names[i] + brief(scale * range.low()[i]) + " to " + brief(scale * range.high()[i]);
  }
  return out + ")";
}

json level_json(const vibration_level& level, bool measured) {
  if (!measured) return nullptr;
  return {{"rms", level.rms},
          {"mean", level.mean},
          {"worst_rms", level.worst_rms},
          {"worst_mean", level.worst_mean},
          {"worst_time", 1e-9 * static_cast<double>(level.worst_time_ns)},
          {"excessive", level.excessive}};
}

json vibration_json(const vibration_report& seen, std::int64_t device_period_ns) {
  const bool measured = seen.measurements > 0;
  return {{"band", {vibration_monitor::corner_hz, 0.5e9 / static_cast<double>(device_period_ns)}},
          {"rest", 1e-9 * static_cast<double>(seen.rest_ns)},
          {"force", level_json(seen.force, measured)},
          {"torque", level_json(seen.torque, measured)}};
}

std::string vibration_text(const vibration_monitor& monitor) {
  if (!monitor.valid()) return "not measured: that needs a device loop of 200 Hz to 10 kHz";
  const vibration_report& seen = monitor.report();
  if (seen.measurements == 0) return "not measured: the hand never rested for 0.7 s";
  return "at most " + brief(1e3 * seen.force.worst_rms) + " mN and " + brief(1e3 * seen.torque.worst_rms) +
         " mN m rms above 60 Hz, in " + brief(1e-9 * static_cast<double>(seen.rest_ns)) + " s at rest";
}

std::string excess_text(const vibration_level& level, const std::string& what, const std::string& unit) {
  return brief(1e3 * level.worst_rms) + ' ' + unit + " rms of " + what + " (mean " + brief(1e3 * level.worst_mean) +
         ' ' + unit + ") at " + brief(1e-9 * static_cast<double>(level.worst_time_ns)) + " s";
}

std::vector<plot_line> components(const std::vector<vec3>& values) {
  std::vector<plot_line> lines;
  for (int i = 0; i < 3; ++i) {
    plot_line line{std::string(1, "xyz"[i]), {}};
    line.y.reserve(values.size());
    for (const vec3& v : values) line.y.push_back(v[i]);
    lines.push_back(std::move(line));
  }
  return lines;
}

}  // namespace

void vector_range::add(const vec3& v) noexcept {
  low_ = empty_ ? v : glm::min(low_, v);
  high_ = empty_ ? v : glm::max(high_, v);
  largest_ = std::max(largest_, std::sqrt(glm::dot(v, v)));
  empty_ = false;
}

void session_summary::add(const session_record& tick) noexcept {
  ++ticks_;
  if (tick.contacts > 0) ++touching_;
  contact_sum_ += tick.contacts;
  contacts_max_ = std::max(contacts_max_, tick.contacts);
  depth_max_m_ = std::max(depth_max_m_, tick.max_depth_m);
  probe_force_.add(tick.on_probe_w.force);
  probe_torque_.add(tick.on_probe_w.torque);
  hand_force_.add(tick.on_hand_d.force);
  hand_torque_.add(tick.on_hand_d.torque);
  delivered_j_ = tick.delivered_j;
  raised_j_ = tick.raised_j;
  if (tick.gripper_told) {
    if (!gripper_m_) gripper_m_ = {tick.gripper_m, tick.gripper_m};
    gripper_m_->first = std::min(gripper_m_->first, tick.gripper_m);
    gripper_m_->second = std::max(gripper_m_->second, tick.gripper_m);
  }
  transient_j_ = tick.transient_j;
  first_touches_ = tick.first_touches;
  from_bodies_j_ = tick.from_bodies_j;
  surplus_max_j_ = std::max(surplus_max_j_, tick.surplus_j);
  if (tick.clutch_ratio == 0.0) ++let_go_ticks_;
  buttons_told_ = buttons_told_ || tick.buttons_told;
  ++velocity_ticks_[static_cast<std::size_t>(tick.velocity)];
  velocity_refused_ = velocity_refused_ || tick.velocity_refused;
  wall_.add(tick);
  vibration_.observe(tick.time_ns, tick.T_dh, tick.on_hand_d);
  if (tick.guard_alpha_per_s > 0.0 || tick.guard_scale < 1.0) ++guarded_;
}

double session_summary::mean_contacts() const noexcept {
  return touching_ == 0 ? 0.0 : static_cast<double>(contact_sum_) / static_cast<double>(touching_);
}

json session_summary::to_json() const {
  const double share = ticks_ == 0 ? 0.0 : static_cast<double>(touching_) / static_cast<double>(ticks_);
  return {{"contacts", {{"share_of_ticks", share}, {"mean", mean_contacts()}, {"max", contacts_max_}}},
          {"max_depth", depth_max_m_},
          {"probe_force", range_json(probe_force_)},
          {"probe_torque", range_json(probe_torque_)},
          {"hand_force", range_json(hand_force_)},
          {"hand_torque", range_json(hand_torque_)},
          {"energy",
           {{"delivered_to_hand", delivered_j_},
            {"from_bodies", from_bodies_j_},
            {"of_weight", raised_j_},
            {"of_transients", transient_j_},
            {"of_weight", raised_j_},
            {"largest_surplus", surplus_max_j_},
            {"guarded_ticks", guarded_}}},
          {"gripper", gripper_m_ ? json{{"low", gripper_m_->first}, {"high", gripper_m_->second}} : json()},
          {"wall", wall_.to_json()},
          {"vibration", vibration_json(vibration_.report(), device_period_ns_)}};
}

std::string session_summary::to_text() const {
  const double share = ticks_ == 0 ? 0.0 : static_cast<double>(touching_) / static_cast<double>(ticks_);
  std::string out;
  out += row("contacts", brief(mean_contacts()) + " on average while touching (" + brief(100.0 * share) +
                             " % of the time), at most " + std::to_string(contacts_max_));
  out += row("deepest overlap", length_text(depth_max_m_));
  out += wall_.to_text();
  out += row("force on the probe", range_text(probe_force_, "N", 1.0));
  out += row("torque on the probe", range_text(probe_torque_, "mN m", 1e3));
  out += row("force on the hand", range_text(hand_force_, "N", 1.0));
  out += row("torque on the hand", range_text(hand_torque_, "mN m", 1e3));
  out += row("energy", brief(1e3 * delivered_j_) + " mJ to the hand, surplus at most " + brief(1e3 * surplus_max_j_) +
                           " mJ; the guard acted in " + std::to_string(guarded_) + " ticks");
  if (from_bodies_j_ != 0.0) out += row("moving bodies", "gave " + brief(1e3 * from_bodies_j_) + " mJ to the probe");
  out += row("vibration at rest", vibration_text(vibration_));
  return out;
}

std::string session_summary::vibration_warning() const {
  const vibration_report& seen = vibration_.report();
  std::string out;
  if (seen.force.excessive) out = excess_text(seen.force, "force", "mN");
  if (seen.torque.excessive) out += (out.empty() ? "" : ", ") + excess_text(seen.torque, "torque", "mN m");
  if (out.empty()) return out;
  return "  warning: the wrench vibrates above 60 Hz while the hand rests: " + out +
         "; lower the coupling's stiffness, raise the contact rate, add damping, or take a softer tau\n";
}

session_curves::session_curves(std::size_t expected_ticks) : stride_(1 + expected_ticks / 20000) {}

void session_curves::add(const session_record& tick) {
  if (seen_ == 0) start_w_ = tick.T_wa.position;
  if (seen_++ % stride_ != 0) return;
  time_s_.push_back(static_cast<double>(tick.time_ns) / 1e9);
  position_mm_.push_back(1e3 * (tick.T_wa.position - start_w_));
  force_n_.push_back(tick.on_hand_d.force);
  torque_mn_m_.push_back(1e3 * tick.on_hand_d.torque);
}

plot_page session_curves::page(std::string title, std::string caption) const {
  if (stride_ > 1) caption += " Every " + std::to_string(stride_) + "th tick is drawn.";
  return {std::move(title),
          std::move(caption),
          "time (s)",
          time_s_,
          {{"probe position (mm)", components(position_mm_)},
           {"force on the hand (N)", components(force_n_)},
           {"torque on the hand (mN m)", components(torque_mn_m_)}}};
}

}  // namespace asperity::command
