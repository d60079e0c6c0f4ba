#include "recorded_row.hpp"

#include <initializer_list>

namespace asperity::command {
namespace {

std::vector<std::string> make_columns() {
  std::vector<std::string> out{"time_s"};
  for (const std::string who : {"device", "probe"}) {
    for (const char* axis : {"_x_m", "_y_m", "_z_m", "_qx", "_qy", "_qz", "_qw"}) out.push_back(who + axis);
  }
  for (const std::string who : {"contact", "hand"}) {
    for (const char* axis : {"_fx_n", "_fy_n", "_fz_n", "_tx_n_m", "_ty_n_m", "_tz_n_m"}) out.push_back(who + axis);
  }
  for (const char* name : {"depth_m", "contacts", "contact_age_s", "delivered_j", "surplus_j", "guard_alpha_per_s",
                           "guard_scale", "sample", "device", "fault"}) {
    out.emplace_back(name);
  }
  return out;
}

}  // namespace

const std::vector<std::string>& recording_columns() {
  static const std::vector<std::string> columns = make_columns();
  return columns;
}

std::array<double, recorded_numbers> numbers_of(const session_record& tick) noexcept {
  std::array<double, recorded_numbers> out;
  std::size_t i = 0;
  const auto put = [&](std::initializer_list<double> list) {
    for (const double x : list) out[i++] = x;
  };
  put({static_cast<double>(tick.time_ns) / 1e9});
  for (const pose& T : {tick.T_dh, tick.T_wa}) {
    const auto q = to_xyzw(T.rotation);
    put({T.position.x, T.position.y, T.position.z, q[0], q[1], q[2], q[3]});
  }
  for (const wrench& w : {tick.on_probe_w, tick.on_hand_d})
    put({w.force.x, w.force.y, w.force.z, w.torque.x, w.torque.y, w.torque.z});
  put({tick.max_depth_m, static_cast<double>(tick.contacts), static_cast<double>(tick.contact_age_ns) / 1e9,
       tick.delivered_j, tick.surplus_j, tick.guard_alpha_per_s, tick.guard_scale});
  return out;
}

std::array<const char*, recorded_words> words_of(const session_record& tick) noexcept {
  return {to_string(tick.sample), to_string(tick.device), to_string(tick.fault)};
}

}  // namespace asperity::command
