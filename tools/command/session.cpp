#include "session.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <ctime>
#include <exception>
#include <memory>
#include <optional>
#include <thread>
#include <utility>

#include "asperity/control/real_session.hpp"
#include "asperity/control/virtual_session.hpp"
#include "cpu_clock.hpp"
#include "heap_room.hpp"
#include "interrupt.hpp"
#include "record_queue.hpp"

namespace asperity::command {
namespace {

struct keep_last {
  session_record* last;
  void operator()(const session_record& record) const noexcept { *last = record; }
};

std::uint64_t count_above(const std::vector<double>& seconds, std::int64_t period_ns) {
  const double period_s = 1e-9 * static_cast<double>(period_ns);
  return static_cast<std::uint64_t>(
      std::count_if(seconds.begin(), seconds.end(), [&](double t) { return t > period_s; }));
}

// Of this program on the real clock, where it beats every few milliseconds; a disk may keep it for a while.
constexpr std::int64_t longest_silence_ns = 1'000'000'000;

// An error that ended a session: whoever reads it wants to know what became of the hand.
error after_session(error why, const session_outcome& out) {
  why.message += out.armed_at_end ? " (the session was ended, and the device did NOT take its disarm: switch it off)"
                                  : " (the session was ended: the wrench is zero, the device is disarmed)";
  return why;
}

// What the gate saw last, where it shut by itself.
void keep_fault(const output_gate& gate, std::int64_t origin_ns, session_outcome& out) {
  if (out.fault == gate_fault::none) return;
  for (std::size_t i = 0; i < gate.flight().size(); ++i) out.last_ticks.push_back(gate.flight()[i]);
  for (flight_entry& e : out.last_ticks) e.time_ns -= origin_ns;
}

// Tells a session where its bodies are.
class told_bodies {
 public:
  told_bodies(const std::vector<body_script>& moves, const scene_placement& placement)
      : moves_(&moves), T_wb_(placement.T_wb) {}

  template <class Session>
  void tell(Session& session, std::int64_t now_ns, std::int64_t origin_ns) const {
    if (moves_->empty()) return;
    moving_bodies told;
    told.time_ns = now_ns;
    for (const body_script& m : *moves_) {
      static_cast<void>(told.list.push_back(m.at(1e-9 * static_cast<double>(now_ns - origin_ns), T_wb_[m.body()])));
    }
    session.move_bodies(told);
  }

 private:
  const std::vector<body_script>* moves_;
  std::vector<pose> T_wb_;
};

// When the device ticks of a virtual session are, in its own time and on the clock.
class tick_times {
 public:
  tick_times(const std::optional<given_ticks>& given, double seconds, std::int64_t device_period_ns)
      : given_(given ? &*given : nullptr) {
    const auto period_ns = static_cast<double>(device_period_ns);
    if (given_ == nullptr) {
      ticks_ = static_cast<std::uint64_t>(std::llround(seconds * 1e9 / period_ns));
      return;
    }
    const auto until_ns = static_cast<double>(origin_ns()) + seconds * 1e9 - 0.5 * period_ns;
    while (ticks_ < given_->of_session && static_cast<double>(given_->times_ns[ticks_]) < until_ns) ++ticks_;
  }

  /// Ticks before the session is told to end.
  [[nodiscard]] std::uint64_t ticks() const noexcept { return ticks_; }
  [[nodiscard]] std::int64_t origin_ns() const noexcept {
    return given_ == nullptr || given_->times_ns.empty() ? 0 : given_->times_ns.front();
  }
  /// Time of a tick, or nothing where it is one period after the last.
  [[nodiscard]] std::optional<std::int64_t> at(std::uint64_t tick) const noexcept {
    if (given_ == nullptr || tick >= given_->times_ns.size()) return std::nullopt;
    return given_->times_ns[tick];
  }
  /// What the gate is told where all ticks were made.
  [[nodiscard]] gate_fault end() const noexcept { return given_ == nullptr ? gate_fault::stopped : given_->end; }

 private:
  const given_ticks* given_;
  std::uint64_t ticks_ = 0;
};

result<session_outcome> run_virtual(session_setup setup, any_device& dev, progress_line& progress) {
  session_outcome out;
  const loop_periods& periods = setup.periods;
  const tick_times times(setup.ticks, setup.seconds, periods.device_ns);
  const std::uint64_t device_ticks = times.ticks();
  const double contact_ticks = setup.seconds * 1e9 / static_cast<double>(periods.contact_ns);
  out.device.seconds.reserve(device_ticks);
  const std::size_t contact_room = static_cast<std::size_t>(std::ceil(contact_ticks)) + 1;
  out.contact.seconds.reserve(contact_room);

  session_record last;
  const virtual_schedule schedule{.start_ns = times.origin_ns(),
                                  .device_period_ns = periods.device_ns,
                                  .contact_period_ns = periods.contact_ns,
                                  .contact_one_period_late = setup.contact_one_period_late};
  virtual_session session(std::move(setup.feel), setup.placement, dev, setup.control, schedule, keep_last{&last});
  const told_bodies bodies(setup.moves, setup.placement);
  std::optional<error> failed;
  std::exception_ptr thrown;
  // Neither loop reads a clock itself.
  const auto seconds_of = [](auto&& run) {
    const double begin = cpu_seconds();
    run();
    return cpu_seconds() - begin;
  };
  const auto step = [&] {
    if (setup.watch) setup.watch->pace(session.now_ns() - times.origin_ns());
    if (const std::optional<std::int64_t> at_ns = times.at(session.device_ticks())) session.next_device_at(*at_ns);
    session.beat();
    bodies.tell(session, session.now_ns(), times.origin_ns());
    for (bool ran = true; ran;) {
      const std::uint64_t before = session.contact().computed();
      const double taken = seconds_of([&] { ran = session.step_contact(); });
      const bool kept = session.contact().computed() != before && out.contact.seconds.size() < contact_room;
      if (kept) out.contact.seconds.push_back(taken);
    }
    const double taken = seconds_of([&] { static_cast<void>(session.step()); });
    if (out.device.seconds.size() < device_ticks) out.device.seconds.push_back(taken);
    if (failed) return;
    last.time_ns -= times.origin_ns();
    if (setup.watch) setup.watch->on_tick(last, taken);
    try {
      if (const result<void> seen = setup.on_tick(last); !seen) failed = seen.error();
    } catch (...) {  // thrown on when the device is at rest
      thrown = std::current_exception();
      failed = error{error_code::limit_exceeded, "an exception"};
    }
  };

  while (session.device_ticks() < device_ticks && !failed && !interrupted() &&
         session.device().gate().fault() == gate_fault::none) {
    step();
    const std::uint64_t done = session.device_ticks();
    if (done % 64 == 0) progress.show("session", static_cast<double>(done) / static_cast<double>(device_ticks));
  }
  out.fault = session.device().gate().fault();
  out.interrupted = interrupted();
  out.ended_at_s = 1e-9 * static_cast<double>(session.now_ns() - times.origin_ns());
  out.device.ticks = session.device_ticks();
  out.contact.ticks = session.contact().computed();
  out.contact.idle = session.contact_ticks() - out.contact.ticks;
  keep_fault(session.device().gate(), times.origin_ns(), out);
  const gate_fault end = session.device_ticks() == device_ticks ? times.end() : gate_fault::stopped;
  session.device().stop(out.interrupted ? gate_fault::interrupted : end);
  const std::int64_t longest_wind_down = std::max<std::int64_t>(200, 200'000'000 / periods.device_ns);
  for (std::int64_t i = 0; i < longest_wind_down && !session.device().gate().at_rest(); ++i) step();
  static_cast<void>(dev.disarm());
  if (thrown) std::rethrow_exception(thrown);
  if (failed) return after_session(*failed, out);

  out.rates = session.device().rates().report();
  out.rejected_samples = session.device().samples().rejected();
  out.contact.late = out.contact.over_period = count_above(out.contact.seconds, periods.contact_ns);
  out.device.late = out.device.over_period = count_above(out.device.seconds, periods.device_ns);
  return out;
}

loop_times to_times(const tick_timing& t, std::int64_t period_ns) {
  loop_times out{.seconds = {}, .ticks = t.ticks - t.idle, .idle = t.idle, .late = t.late, .skipped = t.skipped};
  for (const std::int64_t ns : t.durations_ns) out.seconds.push_back(1e-9 * static_cast<double>(ns));
  out.over_period = count_above(out.seconds, period_ns);
  return out;
}

std::atomic<int> threads_set_up{0};

void set_up_and_count(session_thread which) {
  set_up_real_time_thread(which);
  ++threads_set_up;
}

real_time_grants grants_of(const memory_lock& locked) {
  return {.device = latest_grants(session_thread::device),
          .contact = latest_grants(session_thread::contact),
          .memory = locked.outcome(),
          .memory_error = locked.refusal(),
          .later_memory = locked.keeps_later_memory()};
}

// The way to a session's records, open while it runs.
class rescue_line {
 public:
  rescue_line(session_rescue& rescue, std::function<void()> take_records) : rescue_(rescue) {
    const std::lock_guard lock(rescue_.writing);
    rescue_.take_records = std::move(take_records);
  }
  rescue_line(const rescue_line&) = delete;
  rescue_line& operator=(const rescue_line&) = delete;
  ~rescue_line() {
    const std::lock_guard lock(rescue_.writing);
    rescue_.take_records = nullptr;
  }

 private:
  session_rescue& rescue_;
};

result<session_outcome> run_real(session_setup setup, any_device& dev, progress_line& progress) {
  session_outcome out;
  // Times of an hour at 1 kHz; what comes later is counted, not timed.
  constexpr double most_timed = 3.6e6;
  const std::int64_t shortest = std::min(setup.periods.device_ns, setup.periods.contact_ns);
  const double wanted = 1.1 * setup.seconds * 1e9 / static_cast<double>(shortest) + 1000.0;
  const real_schedule schedule{.device_period_ns = setup.periods.device_ns,
                               .contact_period_ns = setup.periods.contact_ns,
                               .timed_ticks = static_cast<std::size_t>(std::min(wanted, most_timed)),
                               .set_up_thread = set_up_and_count};
  setup.control.watchdog_ns = longest_silence_ns;
  const auto queue = std::make_unique<record_queue>();
  constexpr auto clock_ns = &real_session<any_renderer, any_device, record_queue::writer>::clock_ns;
  real_session session(std::move(setup.feel), setup.placement, dev, setup.control, schedule,
                       record_queue::writer{queue.get(), setup.watch ? clock_ns : nullptr});

  std::optional<std::int64_t> origin_ns;
  std::optional<error> failed;
  bool shut = false;
  session_rescue unshared;
  session_rescue& rescue = setup.rescue != nullptr ? *setup.rescue : unshared;
  const auto take_records = [&] {
    session_record record;
    std::int64_t took_ns = 0;
    while (!failed && queue->pop(record, took_ns)) {
      if (!origin_ns) origin_ns = record.time_ns;
      record.time_ns -= *origin_ns;
      shut = shut || record.fault != gate_fault::none;
      if (setup.watch) setup.watch->on_tick(record, 1e-9 * static_cast<double>(took_ns));
      if (!shut) out.ended_at_s = 1e-9 * static_cast<double>(record.time_ns);
      if (const result<void> seen = setup.on_tick(record); !seen) failed = seen.error();
    }
  };
  const auto drain = [&] {
    const std::lock_guard lock(rescue.writing);
    take_records();
  };
  const rescue_line line(rescue, take_records);
  trim_heap();
  const memory_lock locked;
  const told_bodies bodies(setup.moves, setup.placement);
  const std::int64_t began_ns = real_session<any_renderer, any_device>::clock_ns();
  const auto begin = std::chrono::steady_clock::now();
  bool reported = !setup.on_start;
  threads_set_up = 0;
  session.start();
  for (double elapsed = 0.0; elapsed < setup.seconds && !failed && !shut && !interrupted();) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    drain();
    session.beat();
    bodies.tell(session, decltype(session)::clock_ns(), began_ns);
    if (!reported && threads_set_up == 2) {
      setup.on_start(grants_of(locked));
      reported = true;
    }
    elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    progress.show("session", std::min(1.0, elapsed / setup.seconds));
  }
  out.interrupted = interrupted();
  {
    const driver_guard::ending ending(setup.guard);
    session.stop(out.interrupted ? gate_fault::interrupted : gate_fault::stopped);
  }
  drain();
  out.armed_at_end = may_put_out(dev.state());
  if (failed) return after_session(*failed, out);
  out.real_time = grants_of(locked);

  const gate_fault fault = session.device().gate().fault();
  // Stopping is how every session ends.
  const bool ended = fault == gate_fault::stopped || fault == gate_fault::interrupted;
  out.fault = ended ? gate_fault::none : fault;
  keep_fault(session.device().gate(), origin_ns.value_or(0), out);
  out.contact = to_times(session.contact_timing(), schedule.contact_period_ns);
  out.device = to_times(session.device_timing(), schedule.device_period_ns);
  out.rates = session.device().rates().report();
  out.rejected_samples = session.device().samples().rejected();
  out.lost_records = queue->lost();
  return out;
}

}  // namespace

result<session_outcome> run_session(session_setup setup, progress_line& progress) {
  any_device dev = std::move(setup.device);
  if (const result<void> armed = dev.arm(); !armed) return armed.error();
  return setup.clock == session_clock::virtual_time ? run_virtual(std::move(setup), dev, progress)
                                                    : run_real(std::move(setup), dev, progress);
}

}  // namespace asperity::command
