// One seed, one session: both loops of the library on a virtual clock, among everything that the seed has in store.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>

#include "asperity/control/contact_loop.hpp"
#include "asperity/control/device_loop.hpp"
#include "session/simulation/checker.hpp"
#include "session/simulation/hostile_renderer.hpp"
#include "session/simulation/outcome.hpp"
#include "session/simulation/scenario.hpp"
#include "session/simulation/watched_device.hpp"

namespace asperity::simulation {

/// A session that has not begun; run() takes it to its end, or to the first tick in which something breaks.
class session {
 public:
  explicit session(const scenario& s)
      : scenario_(s),
        device_(scenario_.device),
        checker_(scenario_, device_),
        contact_(hostile_renderer(scenario_), {{pose{}}, vec3(0.0)}, shared_),
        loop_(device_, scenario_.control, vec3(0.0), shared_, last_record{&record_}),
        fate_(scenario_.seed ^ 0x666174650000ULL),
        person_(scenario_.seed ^ 0x706572736f6eULL) {}

  // The loops hold addresses of their neighbours.
  session(const session&) = delete;
  session& operator=(const session&) = delete;

  [[nodiscard]] outcome run() {
    outcome out;
    out.seed = scenario_.seed;
    out.textured = scenario_.textured;
    static_cast<void>(device_.open());
    static_cast<void>(device_.arm());
    std::int64_t since_start_ns = 0;
    std::int64_t next_contact_ns = 0;
    while (since_start_ns < scenario_.length_ns && out.broken == nullptr) {
      while (next_contact_ns <= since_start_ns) {
        touch(next_contact_ns);
        next_contact_ns += scenario_.contact_period_ns;
      }
      set_stamps(since_start_ns);
      const gate_fault before = loop_.gate().fault();
      facts_.clock_ns = scenario_.start_ns + since_start_ns - set_back_ns_;
      static_cast<void>(loop_.tick(facts_.clock_ns));
      if (record_.probe_status != status::not_ready) posed_at_ns_ = record_.time_ns;
      out.broken = checker_.check(record_, facts_);

      ++out.ticks;
      add(out.digest, record_, device_.command());
      out.touched += record_.on_probe_w.force != vec3(0.0) ? 1U : 0U;
      out.guarded += record_.guard_alpha_per_s > 0.0 || record_.guard_scale < 1.0 ? 1U : 0U;
      if (checker_.book().unknown_j() == 0.0) out.surplus_j = std::max(out.surplus_j, checker_.book().surplus_j());
      out.rejected += record_.sample != sample_verdict::accepted ? 1U : 0U;
      out.faults += before == gate_fault::none && record_.fault != gate_fault::none ? 1U : 0U;
      out.clears += let_person_act() ? 1U : 0U;
      since_start_ns += next_step_ns();
    }
    return out;
  }

 private:
  struct last_record {
    session_record* to;
    void operator()(const session_record& r) noexcept { *to = r; }
  };

  [[nodiscard]] bool happens(trouble_kind kind, std::int64_t at_ns) const noexcept {
    for (const trouble& t : scenario_.troubles) {
      if (t.kind == kind && at_ns >= t.from_ns && at_ns < t.until_ns) return true;
    }
    return false;
  }

  // The contact thread's tick.
  void touch(std::int64_t at_ns) noexcept {
    if (happens(trouble_kind::contact_stalled, at_ns)) return;
    const bool withheld = happens(trouble_kind::contact_withheld, at_ns);
    if (scenario_.contact_one_period_late && !withheld) hand_over();
    contact_.renderer().set_time(at_ns);
    const std::uint64_t before = contact_.computed();
    static_cast<void>(contact_.compute(scenario_.start_ns + at_ns));
    if (contact_.computed() > before) {
      computed_pose_ns_ = posed_at_ns_;
      waiting_ = true;
    }
    if (!scenario_.contact_one_period_late && !withheld) hand_over();
  }

  void hand_over() noexcept {
    contact_.publish();
    if (!waiting_) return;
    waiting_ = false;
    facts_.contact_given = true;
    facts_.contact_pose_ns = computed_pose_ns_;
  }

  void set_stamps(std::int64_t at_ns) noexcept {
    device_.keep_stamp();
    if (happens(trouble_kind::stamp_zero, at_ns)) device_.falsify_stamp(0);
    if (happens(trouble_kind::stamp_future, at_ns)) device_.falsify_stamp(scenario_.start_ns + 3'600'000'000'000);
    if (happens(trouble_kind::stamp_lowest, at_ns)) device_.falsify_stamp(std::numeric_limits<std::int64_t>::min());
    if (happens(trouble_kind::stamp_highest, at_ns)) device_.falsify_stamp(std::numeric_limits<std::int64_t>::max());
  }

  // A person who looks now and then, mends one thing at a time and sometimes does what nobody asked for.
  // @return whether the loop's fault was cleared
  [[nodiscard]] bool let_person_act() {
    if (person_.chance(scenario_.person_meddles)) meddle();
    if (!person_.chance(scenario_.person_looks)) return false;
    device_.plug_in();
    if (device_.state() == device_state::fault) static_cast<void>(device_.clear_fault());
    if (device_.state() == device_state::present || device_.state() == device_state::closed) {
      static_cast<void>(device_.open());
    }
    bool cleared = false;
    if (loop_.gate().fault() != gate_fault::none) {
      cleared = loop_.clear_fault();
      if (cleared) checker_.on_cleared();
    }
    // Arming before the fault is cleared is a mistake that people make.
    if (person_.chance(0.7)) static_cast<void>(device_.arm());
    return cleared;
  }

  void meddle() {
    switch (person_.below(4)) {
      case 0:
        loop_.stop();
        checker_.on_stopped();
        break;
      case 1:
        static_cast<void>(device_.disarm());
        break;
      case 2:
        device_.close();
        break;
      default:
        static_cast<void>(device_.arm());
        break;
    }
  }

  [[nodiscard]] std::int64_t next_step_ns() noexcept {
    const clock_manners& c = scenario_.clock;
    if (fate_.chance(c.back)) set_back_ns_ += fate_.between_ns(0.0, 200.0);
    if (fate_.chance(c.twin)) return 0;
    if (fate_.chance(c.late)) {
      return static_cast<std::int64_t>(fate_.log_between(1.0, 60.0) * static_cast<double>(scenario_.device_period_ns));
    }
    return scenario_.device_period_ns;
  }

  static void add(std::uint64_t& digest, std::uint64_t bits) noexcept {
    digest = (std::rotl(digest, 5) ^ bits) * 0x517cc1b727220a95ULL;
  }
  static void add(std::uint64_t& digest, const vec3& v) noexcept {
    for (int i = 0; i < 3; ++i) add(digest, std::bit_cast<std::uint64_t>(v[i]));
  }
  static void add(std::uint64_t& digest, const session_record& r, const device_command& commanded) noexcept {
    add(digest, static_cast<std::uint64_t>(r.time_ns));
    add(digest, r.T_dh.position);
    add(digest, r.T_wa.position);
    add(digest, vec3(r.T_wa.rotation.x, r.T_wa.rotation.y, r.T_wa.rotation.z));
    add(digest, commanded.on_hand.force);
    add(digest, commanded.on_hand.torque);
    add(digest, r.on_probe_w.force);
    add(digest, r.on_probe_w.torque);
    add(digest, std::bit_cast<std::uint64_t>(r.surplus_j));
    add(digest, static_cast<std::uint64_t>(r.device) << 8 | static_cast<std::uint64_t>(r.fault));
  }

  scenario scenario_;
  watched_device device_;
  asperity::simulation::checker checker_;
  exchange shared_{};
  session_record record_{};
  contact_loop<hostile_renderer> contact_;
  device_loop<watched_device, last_record> loop_;
  dice fate_;
  dice person_;
  tick_facts facts_{};
  std::int64_t set_back_ns_ = 0;
  std::int64_t posed_at_ns_ = 0;
  std::int64_t computed_pose_ns_ = 0;
  bool waiting_ = false;
};

}  // namespace asperity::simulation
