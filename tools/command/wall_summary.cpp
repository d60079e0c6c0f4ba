#include "wall_summary.hpp"

#include <algorithm>
#include <cstddef>

#include "text.hpp"

namespace asperity::command {
namespace {

struct flag_words {
  tick_flag flag;
  const char* key;
  const char* what;
  const char* change;
};

constexpr std::array<flag_words, wall_summary::flags> words{{
    {tick_flag::beyond_field, "beyond_field", "the probe was deeper than the depth fields can answer",
     "press less, or raise the contact rate"},
    {tick_flag::passed, "passed", "the probe went half way through a body or out on its far side",
     "press less, raise the contact rate, or make the body thicker"},
    {tick_flag::not_held, "not_held", "the probe was over 1 mm deep: the planes did not hold it",
     "press less, or raise the contact rate"},
    {tick_flag::planes_left_out, "planes_left_out", "near samples or support planes did not fit",
     "touch fewer bodies at once, or raise the contact rate, which shortens the reach"},
    {tick_flag::unbalanced, "unbalanced", "the contact solver left over 1 mN, or found no solution",
     "lower the coupling's stiffness"},
    {tick_flag::friction_left_out, "friction_left_out", "more bodies were pressed than can have friction at once",
     "touch fewer bodies at once"},
    {tick_flag::body_lost, "body_lost", "a moving body was told of too late, or not as a motion, and stood still",
     "tell of it ten times a second or more often, with poses of unit quaternions"},
    {tick_flag::stands_back, "stands_back", "a body came where the probe was, and is felt further in until it leaves",
     "put bodies where the probe is not"},
}};

std::string first_text(std::int64_t first_ns) { return brief(1e-9 * static_cast<double>(first_ns)) + " s"; }

}  // namespace

void wall_summary::add(const session_record& tick) noexcept {
  has_planes_ = has_planes_ || tick.planes > 0;
  overlap_max_m_ = std::max(overlap_max_m_, tick.overlap_m);
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (!has(tick.flags, words[i].flag)) continue;
    if (counts_[i].ticks++ == 0) counts_[i].first_ns = tick.time_ns;
  }
}

json wall_summary::to_json() const {
  if (!has_planes_) return nullptr;
  json out = {{"largest_overlap", overlap_max_m_}};
  for (std::size_t i = 0; i < words.size(); ++i) {
    const count& c = counts_[i];
    out[words[i].key] = {{"ticks", c.ticks},
                         {"first", c.ticks > 0 ? json(1e-9 * static_cast<double>(c.first_ns)) : json()}};
  }
  return out;
}

std::string wall_summary::to_text() const {
  if (!has_planes_) return "";
  std::string reported;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (counts_[i].ticks == 0) continue;
    reported += std::string(reported.empty() ? "" : ", ") + words[i].key + " in " + std::to_string(counts_[i].ticks) +
                " ticks from " + first_text(counts_[i].first_ns) + " on";
  }
  return row("wall", (reported.empty() ? "held in every tick" : reported) + "; at most " + length_text(overlap_max_m_) +
                         " of overlap in the solver");
}

std::string wall_summary::warnings() const {
  std::string out;
  for (std::size_t i = 0; has_planes_ && i < words.size(); ++i) {
    if (counts_[i].ticks == 0) continue;
    out += std::string("  warning: ") + words[i].what + ", first at " + first_text(counts_[i].first_ns) + ": " +
           words[i].change + "\n";
  }
  return out;
}

}  // namespace asperity::command
