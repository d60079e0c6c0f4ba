#include "law/contact_study/report.hpp"

#include <array>
#include <cstdarg>
#include <cstdio>

namespace asperity::contact_study {
namespace {

[[gnu::format(printf, 1, 2)]] std::string formatted(const char* format, ...) {
  std::array<char, 256> line{};
  std::va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(line.data(), line.size(), format, arguments);
  va_end(arguments);
  return line.data();
}

using row = std::vector<std::string>;

const row header{"pair",
                 "motion",
                 "formulation",
                 "r 1 kHz median",
                 "r 1 kHz worst",
                 "r 10 kHz median",
                 "r 10 kHz worst",
                 "ratio worst",
                 "torque ratio worst",
                 "with steps",
                 "largest step mN",
                 "over limit",
                 "pose"};

row motion_row(const std::string& pair, motion m, const char* formulation, const std::vector<pose_result>& poses) {
  const motion_summary s = summarise(poses, m);
  return {pair,
          std::string(to_string(m)),
          formulation,
          formatted("%.2f", s.force_1khz.median),
          formatted("%.2f", s.force_1khz.worst),
          formatted("%.2f", s.force_10khz.median),
          formatted("%.2f", s.force_10khz.worst),
          formatted("%.2f", s.force_ratio.worst),
          formatted("%.2f", s.torque_ratio.worst),
          s.resolved ? formatted("%zu", s.with_steps) : "-",
          s.resolved ? formatted("%.2f", 1e3 * s.largest_step_n) : "-",
          formatted("%zu of %zu%s", s.over_limit, poses.size(), s.ok ? "" : " (a tick failed)"),
          formatted("%llu", static_cast<unsigned long long>(s.worst_pose))};
}

std::vector<row> motion_rows(const std::vector<pair_result>& pairs) {
  std::vector<row> out{header};
  for (const pair_result& p : pairs) {
    for (const motion m : all_motions) {
      out.push_back(motion_row(p.pair, m, "least_motion", p.least_motion));
      if (!p.window.empty()) out.push_back(motion_row(p.pair, m, "window", p.window));
    }
  }
  return out;
}

std::vector<row> loop_rows(const std::vector<pair_result>& pairs) {
  std::vector<row> out{{"pair", "loop", "formulation", "work median", "work worst", "over limit", "pose"}};
  const auto add = [&](const std::string& pair, const char* formulation, const std::vector<pose_result>& poses) {
    const loop_summary s = summarise_loops(poses);
    out.push_back({pair, "6 DoF", formulation, formatted("%.1e", s.work.median), formatted("%.1e", s.work.worst),
                   formatted("%zu of %zu", s.over_limit, poses.size()),
                   formatted("%llu", static_cast<unsigned long long>(s.worst_pose))});
  };
  for (const pair_result& p : pairs) {
    add(p.pair, "least_motion", p.least_motion);
    if (!p.window.empty()) add(p.pair, "window", p.window);
  }
  return out;
}

std::string aligned(const std::vector<row>& rows) {
  std::vector<std::size_t> width(rows.front().size());
  for (const row& r : rows) {
    for (std::size_t i = 0; i < r.size(); ++i) width[i] = std::max(width[i], r[i].size());
  }
  std::string out;
  for (const row& r : rows) {
    for (std::size_t i = 0; i < r.size(); ++i) {
      const std::string pad(width[i] - r[i].size(), ' ');
      out += (i > 0 ? "  " : "") + (i < 3 ? r[i] + pad : pad + r[i]);  // words left, figures right
    }
    out += '\n';
  }
  return out;
}

std::string markdown(const std::vector<row>& rows) {
  std::string out;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    for (const std::string& cell : rows[k]) out += "| " + cell + " ";
    out += "|\n";
    for (std::size_t i = 0; k == 0 && i < rows[k].size(); ++i) out += i < 3 ? "|---" : "|---:";
    if (k == 0) out += "|\n";
  }
  return out;
}

}  // namespace

std::string text_table(const std::vector<pair_result>& pairs) {
  return aligned(motion_rows(pairs)) + "\n" + aligned(loop_rows(pairs));
}

std::string markdown_table(const std::vector<pair_result>& pairs) {
  return markdown(motion_rows(pairs)) + "\n" + markdown(loop_rows(pairs));
}

std::string broken_limits(const std::vector<pair_result>& pairs) {
  std::string out;
  for (const pair_result& p : pairs) {
    for (const pose_result& r : p.least_motion) {
      const auto index = static_cast<unsigned long long>(r.index);
      for (const motion m : all_motions) {
        const jumps& j = r.moved[static_cast<std::size_t>(m)];
        const bool has_step = j.left && j.left->count > 0;
        if (!j.over_limit() && !has_step && j.at_1khz.ok && j.at_10khz.ok) continue;
        out += formatted("%s, pose %llu, %s: force %.2f, %.2f, torque %.2f, %.2f", p.pair.c_str(), index,
                         to_string(m).data(), j.at_1khz.force, j.at_10khz.force, j.at_1khz.torque, j.at_10khz.torque);
        out += formatted(", at %.3f mm", 1e3 * j.at_10khz.at_m);
        if (has_step) {
          out += formatted("; %zu step(s), of %.2f mN at %.6f mm", j.left->count, 1e3 * j.left->largest_n,
                           1e3 * j.left->at_m);
        }
        out += formatted("%s\n", j.at_1khz.ok && j.at_10khz.ok ? "" : ", a tick failed");
      }
      if (r.loop > loop_limit) out += formatted("%s, pose %llu, loop: %.2e\n", p.pair.c_str(), index, r.loop);
    }
  }
  return out;
}

}  // namespace asperity::contact_study
