// What a page is told of every device tick: one row of numbers.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <vector>

#include "asperity/control/session_record.hpp"

namespace asperity::view {

/// Columns of a row, in their order, SI. A page finds a column by its name; see scene_document().
inline constexpr std::array trace_columns{"probe_x",    "probe_y",    "probe_z",        "probe_qx",     "probe_qy",
                                          "probe_qz",   "probe_qw",  // T_wa
                                          "target_x",   "target_y",   "target_z",       "target_qx",    "target_qy",
                                          "target_qz",  "target_qw",  // T_wa_target
                                          "contact_fx", "contact_fy", "contact_fz",     "contact_tx",   "contact_ty",
                                          "contact_tz",  // on_probe_w
                                          "hand_fx",    "hand_fy",    "hand_fz",        "hand_tx",      "hand_ty",
                                          "hand_tz",  // on_hand_d
                                          "depth",      "contacts",   "planes",         "overlap",      "contact_age",
                                          "delivered",  "surplus",    "guard_alpha",    "guard_scale",  "rate_scale",
                                          "clutch",     "took",  // took: seconds of the tick, or below 0
                                          "sample",     "flags",      "contact_status", "probe_status", "device",
                                          "fault"};  // numbers of the enumerations
inline constexpr std::size_t trace_width = trace_columns.size();
static_assert(trace_width % 2 == 0, "a row is a whole number of 64-bit words");

/// One device tick. Times are double, because a session may last a day; values are float, because a page draws them.
struct trace_row {
  double time_s = 0.0;
  std::array<float, trace_width> values{};
};

/// @param took_s how long the tick took; negative where nobody measured it
/// @rt safe
[[nodiscard]] inline trace_row to_row(const session_record& r, double took_s) noexcept {
  trace_row row;
  row.time_s = 1e-9 * static_cast<double>(r.time_ns);
  std::size_t at = 0;
  const auto put = [&](double x) { row.values[at++] = static_cast<float>(x); };
  const auto put_vector = [&](const vec3& v) {
    put(v.x);
    put(v.y);
    put(v.z);
  };
  const auto put_pose = [&](const pose& T) {
    put_vector(T.position);
    for (const double q : to_xyzw(T.rotation)) put(q);
  };
  const auto put_wrench = [&](const wrench& w) {
    put_vector(w.force);
    put_vector(w.torque);
  };
  const auto put_number = [&](auto e) { put(static_cast<double>(static_cast<std::uint32_t>(e))); };
  put_pose(r.T_wa);
  put_pose(r.T_wa_target);
  put_wrench(r.on_probe_w);
  put_wrench(r.on_hand_d);
  put(r.max_depth_m);
  put(r.contacts);
  put(r.planes);
  put(r.overlap_m);
  put(1e-9 * static_cast<double>(r.contact_age_ns));
  put(r.delivered_j);
  put(r.surplus_j);
  put(r.guard_alpha_per_s);
  put(r.guard_scale);
  put(r.rate_scale);
  put(r.clutch_ratio);
  put(took_s);
  put_number(r.sample);
  put_number(r.flags);
  put_number(r.contact_status);
  put_number(r.probe_status);
  put_number(r.device);
  put_number(r.fault);
  return row;
}

/// The newest rows, from one writer to any number of readers. The writer never waits: it overwrites the oldest row,
/// and a reader that was too slow finds out and is told how many it missed.
/// @rt add() is safe: no allocation, lock or clock
class trace_ring {
 public:
  static constexpr std::size_t capacity = 16384;  ///< rows: 16 s at 1 kHz, 1.6 s at 10 kHz

  trace_ring() : words_(capacity * row_words) {}

  void add(const trace_row& row) noexcept {
    const std::uint64_t at = written_.load(std::memory_order_relaxed);
    std::array<std::uint64_t, row_words> words;
    std::memcpy(words.data(), &row.time_s, sizeof row.time_s);
    std::memcpy(words.data() + 1, row.values.data(), sizeof row.values);
    begun_.store(at + 1, std::memory_order_relaxed);
    std::atomic<std::uint64_t>* const to = words_.data() + (at % capacity) * row_words;
    // Each is a release, and no fence stands for them all, because ThreadSanitizer does not know fences: a reader that sees
    // a new word of the row that goes also sees begun_.
    for (std::size_t i = 0; i < row_words; ++i) to[i].store(words[i], std::memory_order_release);
    written_.store(at + 1, std::memory_order_release);
  }

  /// How many rows were ever added.
  [[nodiscard]] std::uint64_t written() const noexcept { return written_.load(std::memory_order_acquire); }

  /// Appends the rows from number `from` on, at most `most`, of several more the newest.
  /// @return number of the first row that was appended; it equals written() where there is none
  std::uint64_t read(std::uint64_t from, std::size_t most, std::vector<trace_row>& to) const {
    const std::uint64_t end = written();
    const std::uint64_t room = most < capacity ? most : capacity;
    std::uint64_t first = from < end ? from : end;
    if (end - first > room) first = end - room;
    const std::size_t before = to.size();
    for (std::uint64_t at = first; at < end; ++at) {
      std::array<std::uint64_t, row_words> words;
      const std::atomic<std::uint64_t>* const source = words_.data() + (at % capacity) * row_words;
      for (std::size_t i = 0; i < row_words; ++i) words[i] = source[i].load(std::memory_order_acquire);
      trace_row& row = to.emplace_back();
      std::memcpy(&row.time_s, words.data(), sizeof row.time_s);
      std::memcpy(row.values.data(), words.data() + 1, sizeof row.values);
    }
    const std::uint64_t begun = begun_.load(std::memory_order_relaxed);
    // Rows that were being overwritten meanwhile.
    const std::uint64_t kept = begun > capacity ? begun - capacity : 0;
    if (kept > first) {
      const std::uint64_t lost = kept < end ? kept - first : end - first;
      to.erase(to.begin() + static_cast<std::ptrdiff_t>(before),
               to.begin() + static_cast<std::ptrdiff_t>(before + lost));
      first += lost;
    }
    return first;
  }

 private:
  static constexpr std::size_t row_words = 1 + trace_width / 2;

  std::vector<std::atomic<std::uint64_t>> words_;
  alignas(64) std::atomic<std::uint64_t> begun_{0};
  std::atomic<std::uint64_t> written_{0};
};

}  // namespace asperity::view
