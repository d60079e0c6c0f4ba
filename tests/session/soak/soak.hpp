// One session for very long on a virtual clock, and the books that must close at its end.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <malloc.h>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "asperity/control/virtual_session.hpp"
#include "asperity/device/simulated/simulated_device.hpp"
#include "asperity/least_motion/least_motion_renderer.hpp"
#include "asperity/window/window_renderer.hpp"
#include "support/small_models.hpp"

namespace asperity::soak {

/// What the process holds.
struct memory_use {
  std::int64_t resident_pages = 0;
  std::int64_t heap_bytes = 0;  ///< in blocks that were asked for and not given back
};

[[nodiscard]] inline memory_use memory_now() {
  memory_use m;
  if (std::FILE* f = std::fopen("/proc/self/statm", "r")) {
    long total = 0;
    long resident = 0;
    if (std::fscanf(f, "%ld %ld", &total, &resident) == 2) m.resident_pages = resident;
    std::fclose(f);
  }
  const struct mallinfo2 heap = mallinfo2();
  m.heap_bytes = static_cast<std::int64_t>(heap.uordblks + heap.hblkhd);
  return m;
}

/// One book: what should be zero, and the energy that went through it.
struct book {
  double residual_j = 0.0;
  double turnover_j = 0.0;

  [[nodiscard]] double relative() const noexcept { return std::fabs(residual_j) / turnover_j; }
};

/// What the end of a soak looks like.
struct report {
  std::int64_t length_ns = 0;  ///< what was to be run; less than asked for where it was stopped
  std::int64_t end_ns = 0;     ///< the session's clock
  std::uint64_t device_ticks = 0;
  std::uint64_t contact_ticks = 0;
  std::uint64_t touching = 0;  ///< device ticks with a contact
  std::uint64_t not_ok = 0;    ///< device ticks that did not end ok
  std::uint64_t off_beat = 0;  ///< device ticks whose time is not the one before plus the period
  memory_use before{};         ///< after the warm-up
  memory_use after{};
  book port{};   ///< the device's wrench: by the true plant, and by the guard from measured poses
  book plant{};  ///< work of device and hand, against damping and motion of the handle
  book probe{};  ///< work of coupling and contact, against the motion of the probe
  plant_energy plant_parts{};
  probe_energy probe_parts{};
  double between_j = 0.0;  ///< what went in at the port and did not come out at the probe: the coupling's damper
};

struct options {
  std::int64_t length_ns = 60'000'000'000;
  std::int64_t warm_up_ns = 2'000'000'000;
  std::int64_t device_period_ns = 1'000'000;
  std::int64_t contact_period_ns = 4'000'000;
};

/// A hand that taps on a ridged plate with a ridged cube, at a slant, so that blows slip: contact comes and goes some
/// four times a second, and energy goes through every part of the loop.
[[nodiscard]] inline simulated_settings tapping_hand() {
  simulated_settings c;
  c.seed = 24;
  c.motion = {.kind = motion_kind::tap,
              .T_dh = {exp_rotation({0.05, -0.03, 0.2}), {0.0, 0.0, 0.0095}},
              .direction_d = {0.28, 0.0, -0.96},
              .depth_m = 0.012,
              .approach_s = 0.3,
              .amplitude_m = 0.015,
              .frequency_hz = 4.0};
  return c;
}

/// Follows every tick. The guard knows measured poses only; what it misses by that is known from the true ones, summed
/// by parts, and is no fault of the book.
class watch {
 public:
  void operator()(const session_record& r) noexcept { last = r; }

  void after_tick(const pose& true_T_dh, double delivered_j, std::int64_t period_ns) noexcept {
    if (ticks_++ > 0 && last.time_ns != before_ns_ + period_ns) ++off_beat;
    before_ns_ = last.time_ns;
    if (last.contacts > 0) ++touching;
    const vec6 error{true_T_dh.position - last.T_dh.position,
                     log_rotation(true_T_dh.rotation * glm::conjugate(last.T_dh.rotation))};
    const vec6 now = to_vec6(last.on_hand_d);
    changes_j_ -= dot(now - sent_, error);
    end_j_ = dot(now, error);
    sent_ = now;
    turnover_j += std::fabs(delivered_j - delivered_j_);
    delivered_j_ = delivered_j;
  }

  [[nodiscard]] double measurement_j() const noexcept { return changes_j_ + end_j_; }

  session_record last;
  std::uint64_t touching = 0;
  std::uint64_t off_beat = 0;
  double turnover_j = 0.0;

 private:
  std::uint64_t ticks_ = 0;
  std::int64_t before_ns_ = 0;
  vec6 sent_{};
  double changes_j_ = 0.0;
  double end_j_ = 0.0;
  double delivered_j_ = 0.0;
};

/// A cube over a plate, both with ridges, under the default renderer.
[[nodiscard]] inline result<window_renderer> make_soak_renderer() {
  using namespace test_support;
  const auto cube =
      std::make_shared<const textured_model>(make_textured_box({0.006, 0.006, 0.006}, 48, ridges(0.0002, 0.003)));
  const auto plate =
      std::make_shared<const textured_model>(make_textured_box({0.04, 0.04, 0.01}, 96, ridges(0.0003, 0.01)));
  window_renderer_settings settings;
  settings.depth.grid = 16;  // coarse, so that a day of ticks takes minutes
  return make_window_renderer({cube, {plate}}, settings);
}

/// Runs the session. `Device` is a simulated_device or derived from one.
/// @param progress called with the virtual time that is done, a thousand times; false stops
template <class Device, class Progress>
[[nodiscard]] result<report> run(const options& o, Device& dev, Progress&& progress) {
  result<window_renderer> made = make_soak_renderer();
  if (!made) return made.error();
  const vec3 centre = made->scene().probe->mass.centre_of_mass;
  if (result<void> opened = dev.open(); !opened) return opened.error();
  if (result<void> armed = dev.arm(); !armed) return armed.error();
  const pose T_wb{quat(1.0, 0.0, 0.0, 0.0), {0.0, 0.0, -0.0103}};
  virtual_session<window_renderer, Device, watch> session(
      std::move(*made), {{T_wb}, centre}, dev, control_settings{},
      {.device_period_ns = o.device_period_ns, .contact_period_ns = o.contact_period_ns});

  report out;
  const auto run_until = [&](std::int64_t until_ns) {
    while (session.now_ns() < until_ns) {
      if (session.step() != status::ok) ++out.not_ok;
      session.device().observer().after_tick(dev.true_T_dh(), dev.delivered_j(), o.device_period_ns);
    }
  };
  run_until(o.warm_up_ns);
  static_cast<void>(memory_now());  // what the measurement itself needs is taken here
  out.before = memory_now();
  constexpr std::int64_t parts = 1000;
  for (std::int64_t part = 1; part <= parts; ++part) {
    out.length_ns = o.warm_up_ns + (o.length_ns - o.warm_up_ns) / parts * part;
    if (part == parts) out.length_ns = o.length_ns;
    run_until(out.length_ns);
    if (!progress(out.length_ns)) break;
  }
  out.after = memory_now();

  const watch& seen = session.device().observer();
  const device_loop<Device, watch>& loop = session.device();
  out.end_ns = session.now_ns();
  out.device_ticks = session.device_ticks();
  out.contact_ticks = session.contact_ticks();
  out.touching = seen.touching;
  out.off_beat = seen.off_beat;
  out.plant_parts = dev.energy();
  out.probe_parts = loop.probe().energy();

  const plant_energy& p = out.plant_parts;
  const probe_energy& q = out.probe_parts;
  out.port = {dev.delivered_j() - loop.guard().delivered_j() - seen.measurement_j(), seen.turnover_j};
  out.plant = {p.by_device_j + p.by_hand_j - p.damped_j - p.numerical_j - dev.kinetic_j(),
               std::fabs(p.by_device_j) + std::fabs(p.by_hand_j)};
  out.probe = {q.by_coupling_j + q.by_contact_j + q.by_friction_j + q.by_external_j + q.by_border_j - q.numerical_j -
                   loop.probe().kinetic_j(),
               std::fabs(q.by_coupling_j) + std::fabs(q.by_contact_j)};
  out.between_j = -p.by_device_j - q.by_coupling_j;
  return out;
}

/// What a soak must keep to. Each limit is far above what was measured and far below what a fault would leave.
struct limits {
  std::int64_t more_pages = 64;      ///< resident; code and data that are first used after the warm-up
  std::int64_t more_heap_bytes = 0;  ///< not one
  double port = 1e-7;                ///< residuals, as a part of the turnover
  double plant = 1e-9;
  double probe = 1e-9;
};

/// What is wrong with a soak, one sentence each; empty where all is well.
[[nodiscard]] inline std::vector<std::string> faults_of(const report& r, const options& o, const limits& l = {}) {
  std::vector<std::string> out;
  const auto expect = [&out](bool holds, const std::string& what) {
    if (!holds) out.push_back(what);
  };
  const auto ticks = [&r](std::int64_t period_ns) {
    return static_cast<std::uint64_t>((r.length_ns + period_ns - 1) / period_ns);
  };
  expect(r.end_ns == static_cast<std::int64_t>(ticks(o.device_period_ns)) * o.device_period_ns,
         "the clock is not where the ticks have brought it");
  expect(r.device_ticks == ticks(o.device_period_ns), "device ticks are not length / period");
  expect(r.contact_ticks == ticks(o.contact_period_ns), "contact ticks are not length / period");
  expect(r.off_beat == 0, std::to_string(r.off_beat) + " device ticks were not one period after the tick before");
  expect(r.not_ok == 0, std::to_string(r.not_ok) + " device ticks did not end ok");
  expect(r.touching > r.device_ticks / 10, "the probe hardly touched anything");
  const std::int64_t pages = r.after.resident_pages - r.before.resident_pages;
  expect(pages <= l.more_pages, "resident memory grew by " + std::to_string(pages) + " pages");
  const std::int64_t bytes = r.after.heap_bytes - r.before.heap_bytes;
  expect(bytes <= l.more_heap_bytes, "the heap grew by " + std::to_string(bytes) + " bytes");
  const auto closes = [&expect](const char* name, const book& b, double limit) {
    expect(b.relative() <= limit, std::string("the book of the ") + name + " does not close: " +
                                      std::to_string(b.residual_j) + " J of " + std::to_string(b.turnover_j) + " J");
  };
  closes("port", r.port, l.port);
  closes("plant", r.plant, l.plant);
  closes("probe", r.probe, l.probe);
  return out;
}

}  // namespace asperity::soak
