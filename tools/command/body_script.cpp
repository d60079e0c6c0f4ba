#include "body_script.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string_view>
#include <utility>

#include "asperity/core/math.hpp"
#include "asperity/core/printable.hpp"

namespace asperity::command {
namespace {

constexpr double two_pi = 6.283185307179586;
constexpr double begins_in_s = 0.2;  // from rest to the motion

std::optional<double> number(std::string_view text) {
  double out = 0.0;
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), out);
  if (failed != std::errc() || end != text.data() + text.size() || !std::isfinite(out)) return std::nullopt;
  return out;
}

/// Numbers with commas between them; nothing where a part is none.
std::optional<std::vector<double>> numbers(std::string_view text) {
  std::vector<double> out;
  for (;;) {
    const std::size_t comma = text.find(',');
    std::string_view part = text.substr(0, comma);
    while (!part.empty() && part.front() == ' ') part.remove_prefix(1);
    while (!part.empty() && (part.back() == ' ' || part.back() == '\r')) part.remove_suffix(1);
    const std::optional<double> x = number(part);
    if (!x) return std::nullopt;
    out.push_back(*x);
    if (comma == std::string_view::npos) return out;
    text.remove_prefix(comma + 1);
  }
}

/// `3:turntable=10` without `3:`, and the 3.
struct addressed {
  std::size_t body = 1;
  std::string motion;
};
std::optional<addressed> address(const std::string& text) {
  addressed out{1, text};
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos || text.substr(0, colon).find_first_not_of("0123456789") != std::string::npos) {
    return out;
  }
  const auto [end, failed] = std::from_chars(text.data(), text.data() + colon, out.body);
  if (failed != std::errc() || end != text.data() + colon || out.body == 0) return std::nullopt;
  out.motion = text.substr(colon + 1);
  return out;
}

using motion = std::variant<conveyor, pendulum, turntable, pose_table>;

/// A motion of numbers alone; nothing where the text is none.
std::optional<motion> motion_of(const std::string& text) {
  constexpr double fastest_m_per_s = 10.0, fastest_rad_per_s = 100.0;
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) return std::nullopt;
  const std::string kind = text.substr(0, equals);
  const auto given = numbers(std::string_view(text).substr(equals + 1));
  if (!given) return std::nullopt;
  const std::vector<double>& n = *given;
  if (kind == "conveyor" && n.size() <= 2) {
    const conveyor c{n[0], n.size() == 2 ? n[1] : conveyor{}.way_m};
    if (!(std::fabs(c.speed_m_per_s) <= fastest_m_per_s && c.way_m > 0.0 && c.way_m <= 1e3)) return std::nullopt;
    return c;
  }
  if (kind == "pendulum" && n.size() == 2) {
    const pendulum p{glm::radians(n[0]), n[1]};
    if (!(std::fabs(n[0]) <= 90.0 && p.period_s >= 0.1 && p.period_s <= 1e3)) return std::nullopt;
    return p;
  }
  if (kind == "turntable" && n.size() == 1) {
    const turntable t{n[0] * two_pi / 60.0};
    if (!(std::fabs(t.rate_rad_per_s) <= fastest_rad_per_s)) return std::nullopt;
    return t;
  }
  return std::nullopt;
}

result<pose_table> read_table(const std::string& file) {
  constexpr std::size_t most_rows = 1'000'000, longest_line = 1000;
  const auto bad = [&](std::size_t line, const std::string& what) {
    return error{error_code::bad_format, printable(file) + ", line " + std::to_string(line) + ": " + what};
  };
  std::error_code failed;
  if (!std::filesystem::is_regular_file(file, failed)) {
    return error{error_code::io_failed, "--move " + printable(file) + ": there is no such file"};
  }
  std::ifstream in(file);
  if (!in) return error{error_code::io_failed, "--move " + printable(file) + " cannot be opened"};
  pose_table out;
  std::string text;
  for (std::size_t line = 1; std::getline(in, text); ++line) {
    if (text.size() > longest_line) return bad(line, "a row is longer than 1000 characters");
    if (text.empty() || text == "\r") continue;
    const auto n = numbers(text);
    if (!n && line == 1) continue;  // names of columns
    if (!n || n->size() != 8) return bad(line, "a row must hold eight numbers: time,x,y,z,qx,qy,qz,qw (s, m)");
    if (!out.time_s.empty() && !((*n)[0] > out.time_s.back())) return bad(line, "its time is not after that before");
    pose T{quat_from_xyzw({(*n)[4], (*n)[5], (*n)[6], (*n)[7]}), {(*n)[1], (*n)[2], (*n)[3]}};
    if (!is_valid(T)) return bad(line, "its quaternion (qx, qy, qz, qw) must have length 1: divide it by its length");
    T.rotation = glm::normalize(T.rotation);
    if (out.time_s.size() == most_rows) return bad(line, "more than a million rows");
    out.time_s.push_back((*n)[0]);
    out.T_wb.push_back(T);
  }
  if (out.time_s.size() < 2) return bad(1, "a motion needs two rows of time,x,y,z,qx,qy,qz,qw at least");
  return out;
}

/// Place along a way that is gone to and fro at one speed, with turns that take begins_in_s; from rest at 0.
double to_and_fro(double t_s, double speed_m_per_s, double way_m) {
  if (!(speed_m_per_s > 0.0)) return 0.0;
  const double even_s = way_m / speed_m_per_s, turn_s = begins_in_s, lap_s = 2.0 * (even_s + turn_s);
  // Of one lap: the second half of the turn at the beginning, evenly on, a turn, evenly back, the first half.
  const auto lap = [&](double u) {
    const double rise = 0.5 * turn_s, ramp = speed_m_per_s / rise;  // m/s^2
    if (u < rise) return 0.5 * ramp * u * u;
    const double low = 0.5 * speed_m_per_s * rise;
    if (u < rise + even_s) return low + speed_m_per_s * (u - rise);
    const double past = std::min(u - rise - even_s, turn_s);
    const double turned = low + way_m + speed_m_per_s * past - 0.5 * ramp * past * past;
    if (u < rise + even_s + turn_s) return turned;
    const double back = std::min(u - rise - even_s - turn_s, even_s);
    if (u < rise + 2.0 * even_s + turn_s) return turned - speed_m_per_s * back;
    const double left = lap_s - u;
    return 0.5 * ramp * left * left;
  };
  return lap(std::fmod(t_s, lap_s));
}

}  // namespace

result<body_script> body_script::read(const std::string& text, std::size_t bodies) {
  const std::optional<addressed> to = address(text);
  if (!to || to->body > bodies) {
    const std::string count = std::to_string(bodies);
    return error{error_code::invalid_argument, "--move " + printable(text) + ": there are " + count +
                                                   " fixed bodies, counted from 1: N:MOTION with N up to " + count};
  }
  body_script out;
  out.body_ = static_cast<std::uint32_t>(to->body - 1);
  if (std::optional<motion> known = motion_of(to->motion)) {
    out.motion_ = std::move(*known);
    return out;
  }
  result<pose_table> table = read_table(to->motion);
  if (!table) return table.error();
  out.motion_ = std::move(table).value();
  return out;
}

body_motion body_script::at(double t_s, const pose& T_wb_still) const {
  constexpr double h_s = 1e-6;
  const pose before = pose_at(std::max(0.0, t_s - h_s), T_wb_still), after = pose_at(t_s + h_s, T_wb_still);
  const double over_s = t_s + h_s - std::max(0.0, t_s - h_s);
  return {body_,
          pose_at(t_s, T_wb_still),
          {(after.position - before.position) / over_s,
           log_rotation(after.rotation * glm::conjugate(before.rotation)) / over_s}};
}

pose body_script::pose_at(double t_s, const pose& T_wb_still) const {
  const auto turned = [&](const vec3& rotation_w) {
    return pose{glm::normalize(exp_rotation(rotation_w) * T_wb_still.rotation), T_wb_still.position};
  };
  if (const auto* c = std::get_if<conveyor>(&motion_)) {
    const double gone_m = to_and_fro(t_s, std::fabs(c->speed_m_per_s), c->way_m);
    return {T_wb_still.rotation, T_wb_still.position + vec3(std::copysign(gone_m, c->speed_m_per_s), 0.0, 0.0)};
  }
  if (const auto* p = std::get_if<pendulum>(&motion_)) {
    const double angle = p->amplitude_rad * smoothstep(t_s / begins_in_s) * std::sin(two_pi * t_s / p->period_s);
    return turned({0.0, angle, 0.0});
  }
  if (const auto* t = std::get_if<turntable>(&motion_)) {
    // The integral of a rate that grows evenly over begins_in_s.
    const double grown_s = t_s < begins_in_s ? 0.5 * t_s * t_s / begins_in_s : t_s - 0.5 * begins_in_s;
    return turned({0.0, 0.0, std::remainder(t->rate_rad_per_s * grown_s, two_pi)});
  }
  const auto& table = std::get<pose_table>(motion_);
  const auto next = std::upper_bound(table.time_s.begin(), table.time_s.end(), t_s);
  if (next == table.time_s.begin()) return table.T_wb.front();
  if (next == table.time_s.end()) return table.T_wb.back();
  const auto j = static_cast<std::size_t>(next - table.time_s.begin()), i = j - 1;
  const double part = (t_s - table.time_s[i]) / (table.time_s[j] - table.time_s[i]);
  const pose &a = table.T_wb[i], &b = table.T_wb[j];
  const vec3 way = log_rotation(b.rotation * glm::conjugate(a.rotation));
  return {glm::normalize(exp_rotation(part * way) * a.rotation), a.position + part * (b.position - a.position)};
}

std::string body_script_error(const std::string& text) {
  const std::optional<addressed> to = address(text);
  if (to && (motion_of(to->motion) || to->motion.ends_with(".csv"))) return {};
  std::string out = "'";
  out += printable(text);
  out +=
      "' is no motion: give conveyor=SPEED[,WAY], pendulum=DEGREES,SECONDS, turntable=RPM or FILE.csv, with N: in "
      "front for the N-th body";
  return out;
}

}  // namespace asperity::command
