// Between the pages of a device panel and its loop: who may hold the button, and what is told.
#pragma once

#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>

#include "panel_loop.hpp"
#include "view/panel_link.hpp"

namespace asperity::command {

/// Answers pages. Nothing here decides how long a force lasts: that is the loop's dead_man, which this only tells of beats.
class panel_desk final : public view::panel_link {
 public:
  /// @param most_n largest test force; 0: none is offered, because of `why_not`
  /// @param shared outlives the desk
  panel_desk(panel_exchange& shared, std::string description, double most_n, axis_mask axes, std::string why_not,
             const dead_man_settings& button)
      : shared_(&shared),
        description_(std::move(description)),
        most_n_(most_n),
        axes_(axes),
        why_not_(std::move(why_not)),
        button_(button) {}

  [[nodiscard]] std::string description() override { return description_; }
  [[nodiscard]] std::string state(std::uint64_t after) override;
  [[nodiscard]] told ask(std::string_view query) override;

  /// No press is taken any more.
  void end();

 private:
  [[nodiscard]] told press(std::string_view text);
  [[nodiscard]] told beat(std::string_view text);
  [[nodiscard]] told release(std::string_view text);
  [[nodiscard]] bool is_held(std::int64_t now_ns) const;
  void publish();

  panel_exchange* shared_;
  std::string description_;
  double most_n_;
  axis_mask axes_;
  std::string why_not_;
  dead_man_settings button_;

  std::mutex reading_;  // of shared_->seen, among pages
  std::mutex telling_;  // of shared_->wish and what follows
  std::string name_;    // of the press that is held: nobody else can guess it
  std::uint64_t number_ = 0;
  force_wish wish_{};
  bool ended_ = false;
};

}  // namespace asperity::command
