// What stands in for the live page where the build has none.
#include "run_view.hpp"

namespace asperity::command {

struct run_view::inside {
  std::string url;
};

result<run_view> run_view::open(const run_command&, const scene&, const std::vector<pose>&, const pose&,
                                const workspace_map&, const device_capabilities&, std::shared_ptr<hand_lead>) {
  return error{error_code::unsupported,
               "--view: this build has no live page, which needs libcivetweb-dev; build with it, or leave --view out"};
}

run_view::run_view(std::unique_ptr<inside> self) : self_(std::move(self)) {}
run_view::run_view(run_view&&) noexcept = default;
run_view::~run_view() = default;
const std::string& run_view::url() const noexcept { return self_->url; }
any_renderer run_view::around(any_renderer feel) const { return feel; }
session_watch run_view::watch() const { return {}; }

}  // namespace asperity::command
