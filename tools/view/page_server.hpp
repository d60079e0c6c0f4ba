// Serves a page on this machine, in threads of its own.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "asperity/core/status.hpp"
#include "view/feed.hpp"
#include "view/gallery.hpp"
#include "view/panel_link.hpp"
#include "view/scene_document.hpp"

namespace asperity::view {

struct server_settings {
  std::string address = "127.0.0.1";  ///< a number of IPv4, or of IPv6 without brackets
  std::uint16_t port = 0;             ///< 0: any that is free
  /// What a page has to know. Empty: everybody on this machine may look; allowed for the loopback alone.
  std::string token;
};

/// How many pages a server answers at once; one more is told so.
inline constexpr int most_pages = 16;

/// A token that nobody guesses: 128 random bits. @return io_failed where the system has none
[[nodiscard]] result<std::string> make_token();

/// Whether both are the same; takes as long wherever they differ. Only their lengths may show.
[[nodiscard]] bool same_token(std::string_view given, std::string_view token) noexcept;

/// Whether an address reaches this machine alone.
[[nodiscard]] bool is_loopback(std::string_view address) noexcept;

/// A page, its assets, what it shows, and the newest of a feed. It listens from start() until it is destroyed.
///
/// A page asks for what is newer than what it has, and that request acknowledges the last answer: a page that is slow,
/// or that does not read, misses rows and holds up nobody but itself. Requests have no body, so that there is nothing
/// of them to keep; each answer is written by the thread of its own connection, for two seconds at the most.
class page_server {
 public:
  /// @param live null where nothing happens; otherwise it outlives the server
  /// @param models null but for page_mode::gallery; otherwise it outlives the server
  /// @param panel null but for the page of a device, which takes the place of the other; otherwise it outlives the server
  /// @return invalid_argument (another address than the loopback without a token) | io_failed (the port is taken)
  [[nodiscard]] static result<page_server> start(const server_settings& settings, page_content content, feed* live,
                                                 gallery* models = nullptr, panel_link* panel = nullptr);

  page_server(page_server&&) noexcept;
  page_server& operator=(page_server&&) = delete;
  ~page_server();

  /// Address of the page, with the token behind '#', which no browser sends on.
  [[nodiscard]] const std::string& url() const noexcept;
  [[nodiscard]] std::uint16_t port() const noexcept;

 private:
  struct inside;
  explicit page_server(std::unique_ptr<inside> self);
  std::unique_ptr<inside> self_;
};

}  // namespace asperity::view
