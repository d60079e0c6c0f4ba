#include "device_panel.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include "asperity/control/real_time_thread.hpp"
#include "asperity/core/printable.hpp"
#include "asperity/device/any_device.hpp"
#include "asperity/device/simulated/simulated_device.hpp"
#include "device_document.hpp"
#include "driver_guard.hpp"
#include "driver_watch.hpp"
#include "heap_room.hpp"
#include "interrupt.hpp"
#include "model_report.hpp"
#include "panel_desk.hpp"
#include "panel_loop.hpp"
#include "run_view.hpp"
#include "text.hpp"
#include "view/page_server.hpp"

namespace asperity::command {
namespace {

using std::chrono::steady_clock;

std::int64_t clock_now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(steady_clock::now().time_since_epoch()).count();
}

result<void> check_panel(const panel_command& options) {
  if (!view_port_of(options.view)) {
    return error{error_code::invalid_argument,
                 "--view " + options.view + ": a port is a whole number from 0 (any that is free) to 65535"};
  }
  if (std::string_view(options.device).starts_with(replay_prefix)) {
    return error{error_code::invalid_argument,
                 "--device " + options.device +
                     ": a panel is of a device that is there; a recording is shown by `asperity run --view`"};
  }
  return {};
}

// A device and whatever it needs to live. The watch outlives it.
struct shown_device {
  driver_watch& watch;
  std::unique_ptr<known_devices> known;
  std::optional<any_device> device;

  explicit shown_device(driver_watch& calls) : watch(calls) {}
  shown_device(const shown_device&) = delete;
  shown_device& operator=(const shown_device&) = delete;
  ~shown_device() {
    device.reset();
    const driver_watch::call closing(watch, driver_call::close);
    known.reset();
  }

  result<void> open(const panel_command& options) {
    if (options.device == "simulated") {
      motion_settings motion;
      motion.kind = motion_kind::free;
      motion.amplitude_m = 0.02;
      motion.frequency_hz = 0.5;
      // So that buttons can be seen too: the first one, for half of every two seconds of the first minute.
      std::vector<scripted_press> presses;
      const std::int64_t begin_ns = clock_now_ns(), second_ns = 1'000'000'000;
      for (std::int64_t s = 1; s < 60; s += 2) {
        presses.push_back(
            {.buttons = 1U, .from_ns = begin_ns + s * second_ns, .until_ns = begin_ns + (s + 1) * second_ns});
      }
      device.emplace(simulated_device({.seed = options.seed, .motion = motion, .presses = std::move(presses)}));
      return device->open();
    }
    {
      const driver_watch::call finding(watch, driver_call::find);
      result<std::unique_ptr<known_devices>> looked =
          known_devices::look(options.drivers, options.device, options.firmware);
      if (!looked) return looked.error();
      known = std::move(looked).value();
    }
    const driver_watch::call opening(watch, driver_call::open);
    result<any_device> opened = known->open(options.device);
    if (!opened) return opened.error();
    device.emplace(watched_device(std::move(opened).value(), watch));
    return {};
  }
};

// The loop in a thread of its own, on the machine's clock.
class panel_thread {
 public:
  panel_thread(panel_loop<any_device>& loop, any_device& device, std::int64_t period_ns)
      : loop_(loop), device_(device), period_ns_(period_ns), thread_([this] { run(); }) {}
  panel_thread(const panel_thread&) = delete;
  panel_thread& operator=(const panel_thread&) = delete;
  ~panel_thread() { stop(gate_fault::stopped); }

  /// Takes the force to zero at the slew rate, disarms the device and joins.
  void stop(gate_fault cause) {
    if (!thread_.joinable()) return;
    cause_.store(cause, std::memory_order_relaxed);
    running_.store(false, std::memory_order_release);
    thread_.join();
  }

 private:
  static void sleep_until(std::int64_t due_ns) {
    std::this_thread::sleep_until(
        steady_clock::time_point(std::chrono::duration_cast<steady_clock::duration>(std::chrono::nanoseconds(due_ns))));
  }

  // Due times are absolute; periods that were missed are left out.
  void run() noexcept {
    set_up_real_time_thread(session_thread::device);
    for (std::int64_t due_ns = clock_now_ns(); running_.load(std::memory_order_acquire);) {
      sleep_until(due_ns);
      loop_.tick(clock_now_ns());
      due_ns += period_ns_;
      const std::int64_t now_ns = clock_now_ns();
      if (now_ns > due_ns + period_ns_) due_ns += (now_ns - due_ns) / period_ns_ * period_ns_;
    }
    constexpr std::int64_t longest_ns = 200'000'000;
    loop_.stop(cause_.load(std::memory_order_relaxed));
    for (const std::int64_t until_ns = clock_now_ns() + longest_ns;
         clock_now_ns() < until_ns && !loop_.gate().at_rest();) {
      sleep_until(clock_now_ns() + period_ns_);
      loop_.tick(clock_now_ns());
    }
    static_cast<void>(device_.disarm());
  }

  panel_loop<any_device>& loop_;
  any_device& device_;
  std::int64_t period_ns_;
  std::atomic<bool> running_{true};
  std::atomic<gate_fault> cause_{gate_fault::stopped};
  std::thread thread_;
};

json to_json(const press_record& p) {
  return {{"force", command::to_json(p.force_d)},
          {"ended", to_string(p.end)},
          {"seconds", 1e-9 * static_cast<double>(p.last_beat_ns - p.began_ns)},
          {"largest_force", p.largest_n},
          {"beat_to_zero", 1e-9 * static_cast<double>(p.zero_ns - p.last_beat_ns)}};
}

answer outcome(const panel_loop<any_device>& loop, const std::string& name, gate_fault fault, bool armed_at_end) {
  const rate_report& rates = loop.rates().report();
  answer out;
  json panel = {{"device", name},
                {"ticks", rates.ticks},
                {"lost_periods", rates.lost_periods},
                {"longest_gap", 1e-9 * static_cast<double>(rates.longest_gap_ns)},
                {"rejected_samples", loop.samples().rejected()},
                {"fault", fault == gate_fault::none ? json() : json(to_string(fault))},
                {"most_force", loop.most_n()},
                {"largest_force", loop.largest_n()},
                {"longest_without_beat", 1e-9 * static_cast<double>(loop.longest_without_beat_ns())},
                {"press_count", loop.presses()},
                {"presses", json::array()},
                {"armed_at_end", armed_at_end}};
  for (std::size_t i = 0; i < loop.records(); ++i) panel["presses"].push_back(to_json(loop.record(i)));
  out.document["panel"] = std::move(panel);
  out.document["units"] = "SI";
  out.text = row("device", name) +
             row("ticks", std::to_string(rates.ticks) + ", " + std::to_string(rates.lost_periods) +
                              " periods left out, " + std::to_string(loop.samples().rejected()) + " samples rejected") +
             row("presses", std::to_string(loop.presses()) + ", largest force " + brief(loop.largest_n()) + " N");
  if (fault != gate_fault::none) out.text += row("gate", std::string("shut: ") + to_string(fault));
  if (armed_at_end) out.text += row("device", "did NOT take its disarm: switch it off");
  return out;
}

}  // namespace

result<answer> show_device(const panel_command& options, const common_options& common) {
  if (const result<void> ok = check_panel(options); !ok) return ok.error();
  view::server_settings settings{.address = options.view_address, .port = *view_port_of(options.view), .token = {}};
  // On the loopback too: whoever else has an account on this machine reaches it, and a force is no picture.
  result<std::string> token = view::make_token();
  if (!token) return token.error();
  settings.token = std::move(token).value();

  driver_watch watch;
  const device_hold hold;
  std::optional<driver_guard> guard;
  if (options.device != "simulated") {
    guard.emplace(watch, [&](const std::string& what) {
      report_error("io_failed", what + "; the process is ended", common.json);
      std::_Exit(exit_failed);
    });
  }
  shown_device shown(watch);
  if (const result<void> opened = shown.open(options); !opened) return opened.error();
  any_device& device = *shown.device;
  const device_capabilities& can = device.capabilities();
  const std::string name = printable(can.name);

  const double rate_hz = std::clamp(can.nominal_rate_hz > 0.0 ? can.nominal_rate_hz : 1000.0, 100.0, 10000.0);
  panel_settings loop_settings{.period_ns = static_cast<std::int64_t>(1e9 / rate_hz)};
  double most_n = test_force_of(can);
  std::string why_not;
  if (!(most_n > 0.0)) {
    why_not = "the device states no force that it can hold";
  } else if (!view::is_loopback(settings.address)) {
    why_not = "the force test is for the machine that the device is at: leave --view-address out";
  } else if (const result<void> armed = device.arm(); !armed) {
    why_not = "the device was not armed: " + printable(armed.error().message);
  }
  if (!why_not.empty()) most_n = 0.0;
  loop_settings.offers_force = why_not.empty();

  const auto shared = std::make_unique<panel_exchange>();
  const auto loop = std::make_unique<panel_loop<any_device>>(device, loop_settings, *shared);
  json description = {{"device", name},
                      {"limits", to_json(can)},
                      {"period", 1e-9 * static_cast<double>(loop_settings.period_ns)},
                      {"force",
                       {{"offered", loop_settings.offers_force},
                        {"most", most_n},
                        {"why_not", why_not},
                        {"longest_silence", 1e-9 * static_cast<double>(loop_settings.button.longest_silence_ns)}}}};
  description["limits"]["name"] = name;
  panel_desk desk(*shared, description.dump(-1, ' ', false, json::error_handler_t::replace), most_n, can.actuated,
                  why_not, loop_settings.button);
  result<view::page_server> server = view::page_server::start(settings, {}, nullptr, nullptr, &desk);
  if (!server) {
    static_cast<void>(device.disarm());
    return server.error();
  }

  trim_heap();
  const memory_lock locked;
  gate_fault fault = gate_fault::none;
  {
    panel_thread thread(*loop, device, loop_settings.period_ns);
    complain("note: the page is at " + server->url());
    if (!why_not.empty() && !common.quiet) complain("note: no force test: " + why_not);
    const auto begin = steady_clock::now();
    while (!interrupted()) {
      const std::chrono::duration<double> passed = steady_clock::now() - begin;
      if (options.seconds && passed.count() >= *options.seconds) break;
      shared->application.fetch_add(1, std::memory_order_relaxed);
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    const driver_guard::ending ending(guard ? &*guard : nullptr);
    desk.end();
    thread.stop(interrupted() ? gate_fault::interrupted : gate_fault::stopped);
  }
  const gate_fault last = loop->gate().fault();
  if (last != gate_fault::stopped && last != gate_fault::interrupted) fault = last;
  return outcome(*loop, name, fault, may_put_out(device.state()));
}

}  // namespace asperity::command
