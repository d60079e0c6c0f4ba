// What the page of a gallery asks for, and what it is told: models of a list, and one session at a time.
#pragma once

#include <cstddef>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace asperity::view {

/// Between the threads of pages, which ask, and the one that starts sessions. Models are numbers of the list: no name
/// or path of a client goes any further.
class gallery {
 public:
  enum class phase { idle, starting, running };
  struct wish {
    std::size_t probe = 0;
    std::size_t fixed = 0;
  };
  struct told {
    phase now = phase::idle;
    std::string url;      ///< of the session's page, while it runs
    std::string trouble;  ///< why the last session ended by itself; empty where nothing was wrong
  };

  /// @param names of the models, as they are shown
  explicit gallery(std::vector<std::string> names) : names_(std::move(names)) {}

  [[nodiscard]] const std::vector<std::string>& names() const noexcept { return names_; }

  /// A page wants to touch one model with another. @return whether both are on the list
  [[nodiscard]] bool ask(std::size_t probe, std::size_t fixed) {
    if (probe >= names_.size() || fixed >= names_.size()) return false;
    const std::lock_guard lock(mutex_);
    wanted_ = {probe, fixed};
    asked_ = true;
    told_ = {phase::starting, {}, {}};
    return true;
  }
  /// A page is done with the session.
  void leave() {
    const std::lock_guard lock(mutex_);
    wanted_.reset();
    asked_ = true;
    told_ = {};
  }
  [[nodiscard]] told tell() const {
    const std::lock_guard lock(mutex_);
    return told_;
  }

  /// What was asked since the last call: first whether anything was, then what to start, if something.
  [[nodiscard]] std::pair<bool, std::optional<wish>> take() {
    const std::lock_guard lock(mutex_);
    return {std::exchange(asked_, false), wanted_};
  }
  /// What became of the session. Left out where something else was asked meanwhile.
  void became(told now) {
    const std::lock_guard lock(mutex_);
    if (!asked_) told_ = std::move(now);
  }

 private:
  std::vector<std::string> names_;
  mutable std::mutex mutex_;
  std::optional<wish> wanted_;
  bool asked_ = false;
  told told_;
};

}  // namespace asperity::view
