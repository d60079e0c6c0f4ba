// A session as Python holds it: both loops on the virtual clock, and the rows that they record.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "asperity/control/virtual_session.hpp"
#include "asperity/device/simulated/simulated_device.hpp"
#include "asperity/planes/plane_renderer.hpp"
#include "asperity/render/any_renderer.hpp"
#include "gpu_renderers.hpp"
#include "policies.hpp"
#include "recorded_row.hpp"
#include "scene_handle.hpp"

namespace asperity::python {

/// The newest tick of a session, for whoever steps it.
struct keep_last {
  session_record* last;
  void operator()(const session_record& record) const noexcept { *last = record; }
};

/// Rows of a recording as they come.
struct recorded_rows {
  std::vector<double> numbers;
  std::vector<std::uint8_t> sample, device, fault;

  void add(const session_record& r) {
    const auto row = command::numbers_of(r);
    numbers.insert(numbers.end(), row.begin(), row.end());
    sample.push_back(static_cast<std::uint8_t>(r.sample));
    device.push_back(static_cast<std::uint8_t>(r.device));
    fault.push_back(static_cast<std::uint8_t>(r.fault));
  }
};

/// What a session is made of, beside its renderer.
struct session_parts {
  scene_placement placement;
  simulated_settings device;
  control_settings control;
  virtual_schedule schedule;
  pose T_wa{};  // of the probe at the start
  std::shared_ptr<raised_in_tick> raised;
  std::function<void(double, const pose&)> lead;  // before each device tick; empty: the hand's own motion
  std::shared_ptr<scene_handle> edited;           // the scene where it changes
  scene_seen seen;
};

using scene_way = scene_hand_over<plane_scene>;

/// Both loops, whatever renderer they have.
class loops {
 public:
  virtual ~loops() = default;
  virtual void step() = 0;
  [[nodiscard]] virtual const output_gate& gate() = 0;
  virtual void stop_gate() = 0;
  [[nodiscard]] virtual std::int64_t now_ns() const = 0;
  [[nodiscard]] virtual std::uint64_t device_ticks() const = 0;
  /// Null where the scene never changes.
  [[nodiscard]] virtual scene_way* scenes() = 0;
  [[nodiscard]] virtual scene_use scene_in_use() = 0;
  /// Null where the renderer has none.
  [[nodiscard]] virtual std::shared_ptr<gpu_use> gpu() = 0;
};

template <class Feel>
class loops_of final : public loops {
 public:
  loops_of(Feel feel, const session_parts& parts, simulated_device& device, session_record& last)
      : session_(std::move(feel), parts.placement, device, parts.control, parts.schedule, keep_last{&last}) {}
  void step() override {
    session_.beat();
    static_cast<void>(session_.step());
  }
  [[nodiscard]] const output_gate& gate() override { return session_.device().gate(); }
  void stop_gate() override { session_.device().stop(gate_fault::stopped); }
  [[nodiscard]] std::int64_t now_ns() const override { return session_.now_ns(); }
  [[nodiscard]] std::uint64_t device_ticks() const override { return session_.device_ticks(); }
  [[nodiscard]] scene_way* scenes() override {
    if constexpr (scene_taker<Feel>) return &session_.scenes();
    return nullptr;
  }
  [[nodiscard]] scene_use scene_in_use() override { return session_.scene_in_use(); }
  [[nodiscard]] std::shared_ptr<gpu_use> gpu() override {
    if constexpr (std::same_as<Feel, any_renderer>) return gpu_use_of(session_.contact().renderer());
    return nullptr;
  }

 private:
  virtual_session<Feel, simulated_device, keep_last> session_;
};

/// A simulated device, both loops, and where its scene changes what it has of that.
class session_handle {
 public:
  session_handle(any_renderer feel, session_parts parts)
      : device_(std::move(parts.device)),
        period_ns_(parts.schedule.device_period_ns),
        raised_(std::move(parts.raised)),
        lead_(std::move(parts.lead)),
        edited_(std::move(parts.edited)),
        seen_(parts.seen) {
    if (edited_) {
      loops_ =
          std::make_unique<loops_of<plane_renderer>>(std::move(*feel.target<plane_renderer>()), parts, device_, last_);
    } else {
      loops_ = std::make_unique<loops_of<any_renderer>>(std::move(feel), parts, device_, last_);
    }
    last_.T_wa = parts.T_wa;
  }

  result<void> begin() {
    if (const result<void> opened = device_.open(); !opened) return opened;
    return device_.arm();
  }

  /// Device ticks of that time, fewer where the gate shuts.
  recorded_rows run(double seconds, const std::function<bool()>& keep_going) {
    recorded_rows rows;
    const gpu_visit visit(loops_->gpu());
    const auto until = loops_->device_ticks() +
                       static_cast<std::uint64_t>(std::llround(seconds * 1e9 / static_cast<double>(period_ns_)));
    while (loops_->device_ticks() < until && fault() == gate_fault::none && !raised_->what && keep_going()) step(rows);
    return rows;
  }

  /// Tells the gate to stop, lets the wrench go to zero and disarms.
  recorded_rows stop() {
    recorded_rows rows;
    const gpu_visit visit(loops_->gpu());
    if (stopped_) return rows;
    stopped_ = true;
    loops_->stop_gate();
    const std::int64_t longest = std::max<std::int64_t>(200, 200'000'000 / period_ns_);
    for (std::int64_t i = 0; i < longest && !loops_->gate().at_rest(); ++i) step(rows);
    static_cast<void>(device_.disarm());
    return rows;
  }

  /// Hands over what was changed in the scene since the last time; see scene_editor::commit(). While another thread
  /// runs the session as well.
  /// @return busy | invalid_argument (the scene never changes)
  result<std::uint64_t> commit() {
    if (!edited_) {
      return error{error_code::invalid_argument,
                   "the session's bodies are not in a Scene: make it with the renderer of one, Scene.renderer()"};
    }
    const std::lock_guard lock(edited_->busy);
    scene_way& way = *loops_->scenes();
    if (way.pending()) return edited_->editor.commit(way);  // busy, in the editor's words
    if (seen_.changes == edited_->changes) return seen_.version;
    // The editor's own commit() knows one session. A scene may have several, each of which takes what it lacks.
    static_cast<void>(way.offer(edited_->editor.prepare()));
    seen_ = {edited_->changes, edited_->editor.version()};
    return seen_.version;
  }
  [[nodiscard]] scene_use scene_in_use() { return loops_->scene_in_use(); }

  [[nodiscard]] gate_fault fault() noexcept { return loops_->gate().fault(); }
  [[nodiscard]] double time_s() const noexcept { return 1e-9 * static_cast<double>(loops_->now_ns()); }
  [[nodiscard]] bool stopped() const noexcept { return stopped_; }
  /// Raises what a contact or a hand in Python raised. @pre the GIL is held
  void rethrow() { raised_->rethrow(); }

  std::mutex busy;

 private:
  void step(recorded_rows& rows) {
    if (lead_) lead_(time_s(), last_.T_wa);
    loops_->step();
    rows.add(last_);
  }

  simulated_device device_;
  std::int64_t period_ns_;
  session_record last_{};
  std::shared_ptr<raised_in_tick> raised_;
  std::function<void(double, const pose&)> lead_;
  std::shared_ptr<scene_handle> edited_;
  scene_seen seen_;
  std::unique_ptr<loops> loops_;
  bool stopped_ = false;
};

}  // namespace asperity::python
