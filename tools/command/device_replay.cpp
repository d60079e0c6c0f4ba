#include "device_replay.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "asperity/device/simulated/simulated_device.hpp"
#include "device/recording_bytes.hpp"
#include "interrupt.hpp"
#include "text.hpp"

namespace asperity::command {
namespace {

// The recorded device for a session that owns its device, while the replay looks on.
class shared_replay {
 public:
  using policy_tag = device_tag;

  explicit shared_replay(std::shared_ptr<replay_device> on_record) : on_record_(std::move(on_record)) {}

  [[nodiscard]] const device_capabilities& capabilities() const noexcept { return on_record_->capabilities(); }
  [[nodiscard]] device_state state() const noexcept { return on_record_->state(); }
  [[nodiscard]] result<void> open() { return on_record_->open(); }
  [[nodiscard]] result<void> arm() { return on_record_->arm(); }
  [[nodiscard]] result<void> clear_fault() { return on_record_->clear_fault(); }
  status disarm() noexcept { return on_record_->disarm(); }
  void close() noexcept { on_record_->close(); }
  [[nodiscard]] status read(std::int64_t now_ns, device_sample& in) noexcept { return on_record_->read(now_ns, in); }
  [[nodiscard]] status write(std::int64_t now_ns, const device_command& out) noexcept {
    return on_record_->write(now_ns, out);
  }

 private:
  std::shared_ptr<replay_device> on_record_;
};

struct named_number {
  const char* name;
  double device_capabilities::*value;
};
constexpr std::array limits{named_number{"continuous force", &device_capabilities::continuous_force_n},
                            named_number{"peak force", &device_capabilities::peak_force_n},
                            named_number{"continuous torque", &device_capabilities::continuous_torque_n_m},
                            named_number{"peak torque", &device_capabilities::peak_torque_n_m},
                            named_number{"slew of the force", &device_capabilities::force_slew_n_per_s},
                            named_number{"slew of the torque", &device_capabilities::torque_slew_n_m_per_s}};

// The simulated device is part of this program: a recording that describes another one is no session of it.
result<void> check_descriptor(const device_recording& r) {
  for (const auto member : recording_detail::capability_numbers) {
    if (!std::isfinite(r.capabilities.*member)) {
      return error{error_code::bad_format,
                   "its device has a limit that is no number: give a recording that is as it was written"};
    }
  }
  const device_capabilities here = simulated_capabilities();
  if (r.name != here.name) return {};
  device_capabilities there = r.capabilities;
  there.name = here.name;
  if (recording_encoder().begin(there, r.before) == recording_encoder().begin(here, r.before)) return {};
  std::string what;
  for (const named_number& n : limits) {
    if (there.*n.value != here.*n.value && what.empty()) {
      what = " (" + std::string(n.name) + ": " + brief(there.*n.value) + " there, " + brief(here.*n.value) + " here)";
    }
  }
  return error{error_code::unsupported,
               "it is of a simulated device with another descriptor" + what +
                   ": replay it with the version that recorded it, or record the session again"};
}

error not_a_session(const std::string& what) {
  return {error_code::unsupported,
          "it holds no session that can be replayed: " + what + "; give a file of `asperity run --record-device`"};
}

constexpr std::int64_t latest_ns = std::int64_t{1} << 62;  // room for what is added to a time
constexpr std::int64_t longest_ns = 86'400'000'000'000;

// Ticks from call `at` on: one read and one write at one time each. What ends them is another call than disarm. The
// first disarm() ends the session: its gate was shut, and no wrench came after it.
result<given_ticks> ticks_of(const std::vector<call_record>& calls, std::size_t at) {
  given_ticks out;
  std::vector<std::int64_t>& times = out.times_ns;
  std::optional<std::size_t> disarmed;
  for (; at < calls.size(); ++at) {
    if (calls[at].call == device_call::disarm) {
      if (!disarmed) disarmed = times.size();
      continue;
    }
    if (calls[at].call != device_call::read && calls[at].call != device_call::write) break;
    const bool last = at + 1 == calls.size();
    if (calls[at].call == device_call::read && last) break;
    if (calls[at].call != device_call::read || calls[at + 1].call != device_call::write ||
        calls[at].now_ns != calls[at + 1].now_ns) {
      return not_a_session("call " + std::to_string(at) + " is not one read and one write at one time");
    }
    const std::int64_t before_ns = times.empty() ? calls[at].now_ns : times.back();
    const std::int64_t now_ns = calls[at++].now_ns;
    if (now_ns < 0 || now_ns > latest_ns || now_ns < before_ns) {
      return not_a_session("tick " + std::to_string(times.size()) + " comes before the one before it");
    }
    times.push_back(now_ns);
  }
  if (times.empty()) return not_a_session("there is no tick after its arm()");
  if (times.back() - times.front() > longest_ns) return not_a_session("it lasts longer than a day");
  out.of_session = disarmed.value_or(times.size());
  return out;
}

void make(replay_device& device, const call_record& c) {
  device_sample unused;
  switch (c.call) {
    case device_call::open:
      static_cast<void>(device.open());
      break;
    case device_call::arm:
      static_cast<void>(device.arm());
      break;
    case device_call::clear_fault:
      static_cast<void>(device.clear_fault());
      break;
    case device_call::disarm:
      device.disarm();
      break;
    case device_call::close:
      device.close();
      break;
    case device_call::read:
      static_cast<void>(device.read(c.now_ns, unused));
      break;
    case device_call::write:
      static_cast<void>(device.write(c.now_ns, c.command));
      break;
  }
}

bool has_pose(const call_record& c) {
  return c.call == device_call::read && c.answered == status::ok && has_all(c.sample.valid, sample_field::position);
}

// Where the command took the probe up: at the last pose before arm(). A program that read none took the first one.
std::optional<pose> start_of(const device_recording& r, std::size_t arm) {
  for (std::size_t i = arm; i-- > 0;) {
    if (has_pose(r.calls[i])) return r.calls[i].sample.T_dh;
  }
  if (r.name == simulated_capabilities().name) return std::nullopt;
  const auto first = std::find_if(r.calls.begin(), r.calls.end(), has_pose);
  return first == r.calls.end() ? std::nullopt : std::optional(first->sample.T_dh);
}

}  // namespace

result<device_replay> device_replay::open(const std::filesystem::path& file) {
  const auto in_file = [&](const error& e) { return error{e.code, file.string() + ": " + e.message}; };
  result<device_recording> loaded = load_device_recording(file, not_interrupted);
  if (!loaded) return loaded.error();
  if (const result<void> known = check_descriptor(*loaded); !known) return in_file(known.error());

  const std::vector<call_record>& calls = loaded->calls;
  const auto armed = std::find_if(calls.begin(), calls.end(), [](const call_record& c) {
    return c.call == device_call::arm && c.answered == status::ok;
  });
  if (armed == calls.end()) return in_file(not_a_session("its device was never armed"));
  const auto arm = static_cast<std::size_t>(armed - calls.begin());
  result<given_ticks> ticks = ticks_of(calls, arm + 1);
  if (!ticks) return in_file(ticks.error());

  device_replay out;
  out.T_dh_start_ = start_of(*loaded, arm);
  const auto writes_before = static_cast<std::uint64_t>(
      std::count_if(calls.begin(), armed, [](const call_record& c) { return c.call == device_call::write; }));
  out.ticks_ = std::move(ticks).value();
  if (loaded->end != recorded_end::not_reported) {
    const std::uint64_t reported = std::max(loaded->writes_before_end, writes_before) - writes_before;
    out.ticks_.of_session = std::min(out.ticks_.of_session, static_cast<std::size_t>(reported));
  }
  out.ticks_.end = loaded->end == recorded_end::interrupted ? gate_fault::interrupted : gate_fault::stopped;

  out.call_times_ns_.resize(calls.size());
  std::int64_t next_ns = out.ticks_.times_ns.back();
  for (std::size_t i = calls.size(); i-- > 0;) {
    if (calls[i].call == device_call::read || calls[i].call == device_call::write) next_ns = calls[i].now_ns;
    out.call_times_ns_[i] = next_ns;
  }
  out.cut_ = loaded->cut;
  std::vector<call_record> prelude(calls.begin(), armed);
  out.on_record_ = std::make_shared<replay_device>(std::move(loaded).value());
  for (const call_record& c : prelude) make(*out.on_record_, c);
  return out;
}

any_device device_replay::device() const { return any_device(shared_replay(on_record_)); }

double device_replay::seconds(std::int64_t device_period_ns) const noexcept {
  if (ticks_.of_session == 0) return 0.0;
  const std::int64_t last_ns = ticks_.times_ns[ticks_.of_session - 1];
  return 1e-9 * static_cast<double>(last_ns - ticks_.times_ns.front() + device_period_ns);
}

replay_outcome device_replay::outcome() const {
  replay_outcome out{.device = std::string(on_record_->capabilities().name),
                     .ticks = ticks_.of_session,
                     .differences = on_record_->differences(),
                     .first_difference_s = {},
                     .cut = cut_};
  // The ticks that take the wrench to zero are on no recording that was cut.
  if (cut_ && out.differences > 0 && on_record_->first_difference() == call_times_ns_.size()) out.differences = 0;
  if (out.differences == 0) return out;
  const std::size_t at = std::min(on_record_->first_difference(), call_times_ns_.size() - 1);
  const std::int64_t since_ns = std::max(call_times_ns_[at], ticks_.times_ns.front()) - ticks_.times_ns.front();
  out.first_difference_s = 1e-9 * static_cast<double>(since_ns);
  return out;
}

}  // namespace asperity::command
