// The live page of a session: `asperity run --view`.
#pragma once

#include <charconv>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "asperity/control/workspace_map.hpp"
#include "asperity/device/capabilities.hpp"
#include "asperity/device/simulated/hand_lead.hpp"
#include "asperity/render/any_renderer.hpp"
#include "run_command.hpp"
#include "session.hpp"

namespace asperity::command {

inline constexpr std::uint16_t usual_view_port = 8765;

/// Port of `--view [PORT]` and `view --port`; nothing where the text is none. Where nothing was given, CLI11 hands on "true".
[[nodiscard]] inline std::optional<std::uint16_t> view_port_of(const std::string& text) {
  if (text.empty() || text == "true") return usual_view_port;
  std::uint16_t port = 0;
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), port);
  if (failed != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return port;
}

/// A page that shows a session, and the way to it. Pages see the newest of it and hold nothing up.
class run_view {
 public:
  /// Draws the bodies and begins to listen. @param lead that pages lead the hand by; null: they do not
  /// @return unsupported where this build has no page | invalid_argument | io_failed
  [[nodiscard]] static result<run_view> open(const run_command& options, const scene& bodies,
                                             const std::vector<pose>& T_wb, const pose& T_wa, const workspace_map& map,
                                             const device_capabilities& device, std::shared_ptr<hand_lead> lead);

  run_view(run_view&&) noexcept;
  run_view& operator=(run_view&&) = delete;
  /// Ends the page, once those who look have been told that the session is over.
  ~run_view();

  /// Where the page is, with its token where it has one.
  [[nodiscard]] const std::string& url() const noexcept;
  /// The renderer, watched. It is used no longer than this lives.
  [[nodiscard]] any_renderer around(any_renderer feel) const;
  /// What a session is given to be watched by. It is used no longer than this lives.
  [[nodiscard]] session_watch watch() const;

 private:
  struct inside;
  explicit run_view(std::unique_ptr<inside> self);
  std::unique_ptr<inside> self_;
};

}  // namespace asperity::command
