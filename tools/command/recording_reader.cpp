#include "recording_reader.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>

#include "recording.hpp"

namespace asperity::command {
namespace {

constexpr std::size_t number_columns = 34;  // the last three are words

std::string_view next_field(std::string_view& line) {
  const std::size_t comma = line.find(',');
  const std::string_view field = line.substr(0, comma);
  line.remove_prefix(comma == std::string_view::npos ? line.size() : comma + 1);
  return field;
}

template <class Enum>
std::optional<Enum> named(std::string_view word, int count) {
  for (int i = 0; i < count; ++i) {
    if (word == to_string(static_cast<Enum>(i))) return static_cast<Enum>(i);
  }
  return std::nullopt;
}

pose pose_of(const double* n) { return {quat_from_xyzw({n[3], n[4], n[5], n[6]}), {n[0], n[1], n[2]}}; }
wrench wrench_of(const double* n) { return {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}}; }

std::optional<session_record> record_of(std::string_view line) {
  static const std::size_t columns = [] {
    std::size_t n = 1;
    for (const char c : recording_header()) n += c == ',' ? 1U : 0U;
    return n;
  }();
  if (columns != number_columns + 3) return std::nullopt;
  std::array<double, number_columns> n{};
  for (double& x : n) {
    const std::string_view field = next_field(line);
    const auto [end, failed] = std::from_chars(field.data(), field.data() + field.size(), x);
    if (failed != std::errc() || end != field.data() + field.size()) return std::nullopt;
  }
  const auto sample = named<sample_verdict>(next_field(line), 7);
  const auto device = named<device_state>(next_field(line), device_state_count);
  const auto fault = named<gate_fault>(next_field(line), gate_fault_count);
  if (!sample || !device || !fault || !line.empty() || !std::isfinite(n[0]) || std::fabs(n[0]) > 1e8)
    return std::nullopt;
  session_record r;
  r.time_ns = std::llround(1e9 * n[0]);
  r.T_dh = pose_of(&n[1]);
  r.T_wa = pose_of(&n[8]);
  r.on_probe_w = wrench_of(&n[15]);
  r.on_hand_d = wrench_of(&n[21]);
  r.max_depth_m = n[27];
  r.contacts = n[28] >= 0.0 && n[28] < 1e6 ? static_cast<std::uint32_t>(n[28]) : 0;
  r.contact_age_ns = std::fabs(n[29]) < 1e6 ? std::llround(1e9 * n[29]) : 0;
  r.delivered_j = n[30];
  r.surplus_j = n[31];
  r.guard_alpha_per_s = n[32];
  r.guard_scale = n[33];
  r.sample = *sample;
  r.device = *device;
  r.fault = *fault;
  r.contact_status = status::ok;
  return r;
}

}  // namespace

result<std::vector<view::trace_row>> read_recording(const std::filesystem::path& file, double scale) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return error{error_code::io_failed, "cannot read " + file.string() + ": name a recording of `run --record`"};
  std::string line;
  if (!std::getline(in, line) || line + '\n' != recording_header()) {
    return error{error_code::bad_format,
                 file.string() + ": its first line is not that of a recording: write one with `run --record`"};
  }
  std::vector<view::trace_row> rows;
  std::optional<session_record> first;
  for (std::size_t number = 2; std::getline(in, line); ++number) {
    std::optional<session_record> r = record_of(line);
    if (!r) {
      return error{error_code::bad_format, file.string() + ": line " + std::to_string(number) +
                                               " is not a row of a recording: record it again, or cut it there"};
    }
    if (rows.size() == most_shown_rows) {
      return error{error_code::limit_exceeded, file.string() + " has more than " + std::to_string(most_shown_rows) +
                                                   " rows: cut it to the part that matters"};
    }
    if (!first) first = r;
    r->T_wa_target.rotation = r->T_dh.rotation * glm::conjugate(first->T_dh.rotation) * first->T_wa.rotation;
    r->T_wa_target.position = first->T_wa.position + scale * (r->T_dh.position - first->T_dh.position);
    rows.push_back(view::to_row(*r, -1.0));
  }
  if (rows.empty()) return error{error_code::bad_format, file.string() + " has no rows: record a session first"};
  return rows;
}

}  // namespace asperity::command
