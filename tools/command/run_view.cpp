#include "run_view.hpp"

#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include "session_pace.hpp"
#include "view/page_server.hpp"
#include "view/shown_mesh.hpp"

namespace asperity::command {

struct run_view::inside {
  std::unique_ptr<view::feed> feed = std::make_unique<view::feed>();
  session_pace pace{*feed};
  std::optional<view::page_server> server;  // asks the feed, so it ends first
};

result<run_view> run_view::open(const run_command& options, const scene& bodies, const std::vector<pose>& T_wb,
                                const pose& T_wa, const workspace_map& map, const device_capabilities& device,
                                std::shared_ptr<hand_lead> lead) {
  view::page_scene shown;
  shown.title = file_stem(options.probe) + " on " + file_stem(options.fixed.front());
  shown.bodies.push_back({file_stem(options.probe), bodies.probe, T_wa});
  for (std::size_t b = 0; b < bodies.fixed.size(); ++b) {
    shown.bodies.push_back({file_stem(options.fixed[b]), bodies.fixed[b], T_wb[b]});
  }
  shown.map = map;
  shown.leads = lead != nullptr;
  shown.virtual_clock = clock_of(options) == "virtual";
  shown.device_period_s = 1e-9 * static_cast<double>(periods_of(options).device_ns);
  shown.most_force_n = device.peak_force_n;
  view::server_settings settings{.address = options.view_address,
                                 .port = view_port_of(options.view.value_or("")).value_or(usual_view_port),
                                 .token = {}};
  if (!view::is_loopback(settings.address)) {
    result<std::string> token = view::make_token();
    if (!token) return token.error();
    settings.token = std::move(token).value();
  }
  auto self = std::make_unique<inside>();
  if (lead) self->feed->take_lead(std::move(lead), map);
  result<view::page_server> server =
      view::page_server::start(settings, view::make_content(shown, {}, view::live_points), self->feed.get());
  if (!server) return server.error();
  self->server.emplace(std::move(server).value());
  return run_view(std::move(self));
}

run_view::run_view(std::unique_ptr<inside> self) : self_(std::move(self)) {}
run_view::run_view(run_view&&) noexcept = default;
run_view::~run_view() {
  if (!self_) return;
  constexpr std::chrono::milliseconds for_the_last_frame{300};
  self_->feed->end();
  std::this_thread::sleep_for(for_the_last_frame);
}

const std::string& run_view::url() const noexcept { return self_->server->url(); }

any_renderer run_view::around(any_renderer feel) const {
  return any_renderer(view::watched_renderer(std::move(feel), *self_->feed));
}

session_watch run_view::watch() const {
  inside* const self = self_.get();
  return {.on_tick = [self](const session_record& tick, double took_s) { self->feed->saw(tick, took_s); },
          .pace = [self](std::int64_t time_ns) { self->pace.wait_for(time_ns); }};
}

}  // namespace asperity::command
