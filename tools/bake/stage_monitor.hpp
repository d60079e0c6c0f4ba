// Progress and cancellation of a bake.
#pragma once

#include <functional>
#include <string_view>

namespace asperity::bake {

/// Tells the caller of each stage and remembers whether he cancelled. Used from the calling thread only.
class stage_monitor {
 public:
  using callback = std::function<bool(std::string_view stage, double done)>;

  stage_monitor() = default;
  explicit stage_monitor(callback report) : report_(std::move(report)) {}

  /// Starts a stage. @return false where the bake is cancelled
  bool begin(std::string_view stage) {
    stage_ = stage;
    return at(0.0);
  }

  /// Reports the share of the stage that is done, 0 to 1. @return false where the bake is cancelled
  bool at(double done) {
    done_ = done;
    if (!cancelled_ && report_) cancelled_ = !report_(stage_, done);
    return !cancelled_;
  }

  /// Reports the share that was reported last, for work between two steps. @return false where the bake is cancelled
  bool ask() { return at(done_); }

  [[nodiscard]] double done() const noexcept { return done_; }
  [[nodiscard]] bool cancelled() const noexcept { return cancelled_; }

 private:
  callback report_;
  std::string_view stage_;
  double done_ = 0.0;
  bool cancelled_ = false;
};

}  // namespace asperity::bake
