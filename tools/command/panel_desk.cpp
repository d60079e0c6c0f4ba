#include "panel_desk.hpp"

#include <charconv>
#include <chrono>
#include <cmath>
#include <optional>

#include "asperity/core/printable.hpp"
#include "cli.hpp"
#include "text.hpp"
#include "view/page_server.hpp"

namespace asperity::command {
namespace {

constexpr std::uint64_t most_periods_told = 4096;

std::int64_t steady_now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

template <class Number>
std::optional<Number> whole_number_of(std::string_view text) {
  Number value{};
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (failed != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

json numbers(const vec3& v) { return json::array({v.x, v.y, v.z}); }

}  // namespace

std::string panel_desk::state(std::uint64_t after) {
  json out;
  {
    const std::lock_guard lock(reading_);
    static_cast<void>(shared_->seen.refresh());
    const panel_snapshot& s = shared_->seen.front();
    const pose& T = s.sample.T_dh;
    out = {{"time", 1e-9 * static_cast<double>(s.time_ns)},
           {"position", numbers(T.position)},
           {"rotation", {T.rotation.x, T.rotation.y, T.rotation.z, T.rotation.w}},
           {"measured", static_cast<unsigned>(s.sample.valid)},
           {"buttons", s.sample.buttons},
           {"gripper", s.sample.gripper_m},
           {"sample", to_string(s.verdict)},
           {"device", to_string(s.device)},
           {"fault", to_string(s.fault)},
           {"force", numbers(s.put_out.force)},
           {"ticks", s.rates.ticks},
           {"lost_periods", s.rates.lost_periods},
           {"lapses", s.rates.lapses},
           {"longest_gap", 1e-9 * static_cast<double>(s.rates.longest_gap_ns)},
           {"scale", s.rate_scale},
           {"rejected", s.rejected},
           {"repeated", s.repeated},
           {"lost", s.sample.lost},
           {"press", s.last.press},
           {"press_end", to_string(s.last.end)}};
  }
  const std::uint64_t written = shared_->periods_written.load(std::memory_order_acquire);
  std::uint64_t from = std::min(after, written);
  if (written - from > most_periods_told) from = written - most_periods_told;
  json periods = json::array();
  for (std::uint64_t i = from; i < written; ++i) {
    periods.push_back(shared_->period_ns[i % panel_exchange::periods].load(std::memory_order_relaxed));
  }
  out["periods"] = std::move(periods);
  out["periods_end"] = written;
  return out.dump(-1, ' ', false, json::error_handler_t::replace);
}

view::panel_link::told panel_desk::ask(std::string_view query) {
  const auto is = [&query](std::string_view name) {
    const bool found = query.starts_with(name);
    if (found) query.remove_prefix(name.size());
    return found;
  };
  if (is("press=")) return press(query);
  if (is("beat=")) return beat(query);
  if (is("release=")) return release(query);
  return {400, "press=AXIS,NEWTONS, beat=PRESS,NUMBER or release=PRESS"};
}

void panel_desk::end() {
  const std::lock_guard lock(telling_);
  ended_ = true;
  wish_.released = true;
  publish();
}

view::panel_link::told panel_desk::press(std::string_view text) {
  if (!(most_n_ > 0.0)) return {403, why_not_};
  const std::string form =
      "press=AXIS,NEWTONS: x, y or z of the device's base frame that it can push along, and no more "
      "than " +
      brief(most_n_) + " N either way";
  const std::size_t axis = text.empty() ? std::string_view::npos : std::string_view("xyz").find(text.front());
  if (axis == std::string_view::npos || (axes_ >> axis & 1) == 0 || text.substr(1, 1) != ",") return {400, form};
  const std::optional<double> newtons = whole_number_of<double>(text.substr(2));
  if (!newtons || !(std::fabs(*newtons) <= most_n_) || *newtons == 0.0) return {400, form};  // NaN too
  result<std::string> name = view::make_token();
  if (!name) return {503, name.error().message};

  const std::lock_guard lock(telling_);
  if (ended_) return {410, "the panel is over"};
  const std::int64_t now_ns = steady_now_ns();
  if (is_held(now_ns)) return {409, "another page holds the force test: let go there first"};
  name_ = std::move(name).value();
  number_ = 0;
  wish_ = {.press = wish_.press + 1, .beat_ns = now_ns};
  wish_.force_d[static_cast<vec3::length_type>(axis)] = *newtons;
  publish();
  return {200, json({{"press", name_}}).dump()};
}

view::panel_link::told panel_desk::beat(std::string_view text) {
  const std::size_t comma = text.find(',');
  const auto number =
      comma == std::string_view::npos ? std::nullopt : whole_number_of<std::uint64_t>(text.substr(comma + 1));
  if (!number) return {400, "beat=PRESS,NUMBER"};
  const std::lock_guard lock(telling_);
  const std::int64_t now_ns = steady_now_ns();
  if (wish_.press == 0 || !view::same_token(text.substr(0, comma), name_) || !is_held(now_ns)) {
    return {410, "this press is over: press anew"};
  }
  if (*number <= number_) return {400, "beats count up"};
  number_ = *number;
  ++wish_.beats;
  wish_.beat_ns = now_ns;
  publish();
  return {204, {}};
}

view::panel_link::told panel_desk::release(std::string_view text) {
  const std::lock_guard lock(telling_);
  if (wish_.press == 0 || !view::same_token(text, name_)) return {410, "this press is over"};
  wish_.released = true;
  publish();
  return {204, {}};
}

// The loop has the last word; this one keeps a page from holding the place of another where the loop is slow.
bool panel_desk::is_held(std::int64_t now_ns) const {
  const std::int64_t limit_ns = wish_.beats == 0 ? button_.first_beat_ns : button_.longest_silence_ns;
  return wish_.press != 0 && !wish_.released && !ended_ && now_ns - wish_.beat_ns <= limit_ns &&
         shared_->over.load(std::memory_order_acquire) < wish_.press;
}

void panel_desk::publish() {
  shared_->wish.back() = wish_;
  shared_->wish.publish();
}

}  // namespace asperity::command
