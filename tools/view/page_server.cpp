#include "view/page_server.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <chrono>
#include <civetweb.h>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <optional>
#include <pthread.h>
#include <string_view>
#include <sys/random.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <thread>
#include <unistd.h>
#include <utility>
#include <vector>

#include "asperity/core/printable.hpp"
#include "view/page_files.hpp"

namespace asperity::view {
namespace {

using std::chrono::milliseconds;

constexpr std::size_t most_rows = 4096;  // of one answer
constexpr milliseconds longest_wait{250};
constexpr milliseconds look_again{4};
constexpr std::size_t stack_bytes = std::size_t{512} << 10U;

// Nothing is asked of anybody else, nothing runs but the page's own files, and nobody may put the page into theirs.
constexpr const char* headers =
    "Content-Security-Policy: default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'\r\n"
    "X-Content-Type-Options: nosniff\r\n"
    "Referrer-Policy: no-referrer\r\n"
    "Cross-Origin-Resource-Policy: same-origin\r\n"
    "Cross-Origin-Opener-Policy: same-origin\r\n"
    "Cache-Control: no-store\r\n";

const char* reason_of(int code) {
  switch (code) {
    case 200:
      return "OK";
    case 204:
      return "No Content";
    case 400:
      return "Bad Request";
    case 403:
      return "Forbidden";
    case 404:
      return "Not Found";
    case 405:
      return "Method Not Allowed";
    case 409:
      return "Conflict";
    case 410:
      return "Gone";
    default:
      return "Service Unavailable";
  }
}

// One write: what a page does not take in two seconds (request_timeout_ms) ends its connection.
int answer(mg_connection* to, int code, std::string_view type, std::string_view body, bool keep = true) {
  std::string out = "HTTP/1.1 " + std::to_string(code) + ' ' + reason_of(code) + "\r\n" + headers;
  if (!body.empty()) (out += "Content-Type: ") += std::string(type) + "\r\n";
  out += "Content-Length: " + std::to_string(body.size()) + "\r\n";
  out += keep ? "Connection: keep-alive\r\n\r\n" : "Connection: close\r\n\r\n";
  if (!keep) mg_disable_connection_keep_alive(to);
  out += body;
  static_cast<void>(mg_write(to, out.data(), out.size()));
  return code;
}

int refuse(mg_connection* to, int code, std::string_view why) {
  return answer(to, code, "text/plain; charset=utf-8", std::string(why) + '\n', false);
}

std::string_view header_of(const mg_connection* of, const char* name) {
  const char* const value = mg_get_header(of, name);
  return value == nullptr ? std::string_view() : std::string_view(value);
}

// The number behind "NAME=", where the query is that and nothing else.
template <class Number>
std::optional<Number> number_of(std::string_view query, std::string_view name) {
  if (!query.starts_with(name)) return std::nullopt;
  query.remove_prefix(name.size());
  Number value{};
  const auto [end, failed] = std::from_chars(query.data(), query.data() + query.size(), value);
  if (failed != std::errc() || end != query.data() + query.size()) return std::nullopt;
  return value;
}

// Seven numbers: a place within ten metres and a quaternion, x y z w, whose length is nearly one.
std::optional<pose> pose_of(std::string_view text) {
  std::array<double, 7> n{};
  for (std::size_t i = 0; i < n.size(); ++i) {
    const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), n[i]);
    if (failed != std::errc()) return std::nullopt;
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    const bool last = i + 1 == n.size();
    if (last ? !text.empty() : !text.starts_with(',')) return std::nullopt;
    if (!last) text.remove_prefix(1);
  }
  constexpr double farthest_m = 10.0, apart = 1e-3;
  const vec3 place(n[0], n[1], n[2]);
  const quat turn(n[6], n[3], n[4], n[5]);
  const double length = glm::length(turn);
  if (!(glm::length(place) <= farthest_m) || !(std::fabs(length - 1.0) <= apart)) return std::nullopt;
  return pose{glm::normalize(turn), place};
}

template <class T>
void append(std::string& to, const T& value) {
  to.append(reinterpret_cast<const char*>(&value), sizeof value);
}

// Threads of pages give way to those of a session.
void* give_way(const mg_context*, int) {
  static_cast<void>(setpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)), 10));
  return nullptr;
}

int say_nothing(const mg_connection*, const char*) { return 1; }

// While one lives, new threads get small stacks: a session on the real clock keeps all memory of the process in place.
class small_stacks {
 public:
  small_stacks() {
    pthread_attr_init(&before_);
    known_ = pthread_getattr_default_np(&before_) == 0;
    pthread_attr_t small;
    pthread_attr_init(&small);
    pthread_attr_setstacksize(&small, stack_bytes);
    if (known_) pthread_setattr_default_np(&small);
    pthread_attr_destroy(&small);
  }
  small_stacks(const small_stacks&) = delete;
  small_stacks& operator=(const small_stacks&) = delete;
  ~small_stacks() {
    if (known_) pthread_setattr_default_np(&before_);
    pthread_attr_destroy(&before_);
  }

 private:
  pthread_attr_t before_{};
  bool known_ = false;
};

}  // namespace

struct page_server::inside {
  page_content content;
  feed* live = nullptr;
  gallery* models = nullptr;
  panel_link* panel = nullptr;
  std::string token;
  std::vector<std::string> hosts;  // whose page it is; empty where the token says that
  std::string url;
  std::uint16_t port = 0;
  mg_context* context = nullptr;
  std::atomic<int> pages{0};
  std::atomic<bool> stopping{false};

  ~inside() {
    stopping.store(true, std::memory_order_relaxed);
    if (context != nullptr) mg_stop(context);
  }

  int serve(mg_connection* to) {
    const mg_request_info& asked = *mg_get_request_info(to);
    const std::string_view path = asked.local_uri == nullptr ? "" : asked.local_uri;
    const std::string_view method = asked.request_method == nullptr ? "" : asked.request_method;
    const std::string_view query = asked.query_string == nullptr ? "" : asked.query_string;
    if (!comes_from_its_own_page(to)) return refuse(to, 403, "this page is for the address that it was opened at");
    // A body would have to be read to keep the connection, and nothing here has one.
    if (asked.content_length > 0 || !header_of(to, "Transfer-Encoding").empty()) {
      return refuse(to, 400, "a request has no body here");
    }
    if (method == "POST")
      return may_look(to) ? command(to, path, query) : refuse(to, 403, "the token is missing or wrong");
    if (method != "GET") return refuse(to, 405, "GET, or POST to /do");
    if (panel != nullptr) {
      for (const page_file& f : panel_files()) {
        if (path == f.path) return answer(to, 200, f.type, f.bytes);
      }
    }
    for (const page_file& f : page_files()) {
      if (path == f.path) return answer(to, 200, f.type, f.bytes);
    }
    if (!is_data(path)) return refuse(to, 404, "there is no such page");
    if (!may_look(to)) return refuse(to, 403, "the token is missing or wrong");
    if (path == "/panel.json" || path == "/panel-state") return of_panel(to, path, query);
    if (path == "/scene.json") return answer(to, 200, "application/json", content.document);
    if (path == "/frame") return frame(to, query);
    if (path == "/session.json") return led(to);
    const bool of_rows = path.starts_with("/rows/");
    const std::vector<std::string>& all = of_rows ? content.rows : content.meshes;
    const auto number = number_of<std::size_t>(path, of_rows ? "/rows/" : "/mesh/");
    if (!number || *number >= all.size()) return refuse(to, 404, "there is no such mesh or recording");
    return answer(to, 200, "application/octet-stream", all[*number]);
  }

 private:
  static bool is_data(std::string_view path) {
    return path == "/scene.json" || path == "/frame" || path == "/session.json" || path == "/panel.json" ||
           path == "/panel-state" || path.starts_with("/rows/") || path.starts_with("/mesh/");
  }

  // A page of somebody else's, in the same browser, reaches this address too: by name, or by a name of its own that it
  // points here.
  [[nodiscard]] bool comes_from_its_own_page(const mg_connection* from) const {
    const std::string_view host = header_of(from, "Host");
    const std::string_view origin = header_of(from, "Origin");
    if (!origin.empty() && origin != "http://" + std::string(host)) return false;
    return hosts.empty() || std::find(hosts.begin(), hosts.end(), host) != hosts.end();
  }

  [[nodiscard]] bool may_look(const mg_connection* from) const {
    return token.empty() || same_token(header_of(from, "X-Asperity-Token"), token);
  }

  // Everything newer than row `after`, as soon as there is something.
  int frame(mg_connection* to, std::string_view query) {
    const std::optional<std::uint64_t> after = number_of<std::uint64_t>(query, "after=");
    if (!after) return refuse(to, 400, "ask for /frame?after=NUMBER");
    if (live == nullptr) return refuse(to, 404, "nothing happens here: the page shows what was recorded");
    const struct counted {
      explicit counted(std::atomic<int>& n) : all(n), now(++n) {}
      ~counted() { --all; }
      std::atomic<int>& all;
      int now;
    } page(pages);
    if (page.now > most_pages) return refuse(to, 503, "too many pages are open: close one");
    const std::uint64_t from = *after <= live->rows().written() ? *after : 0;
    const auto until = std::chrono::steady_clock::now() + longest_wait;
    while (live->rows().written() == from && !live->ended() && !stopping.load(std::memory_order_relaxed) &&
           std::chrono::steady_clock::now() < until) {
      std::this_thread::sleep_for(look_again);
    }
    std::vector<trace_row> rows_now;
    const std::uint64_t first = live->rows().read(from, most_rows, rows_now);
    return answer(to, 200, "application/octet-stream", frame_bytes(first, first - from, rows_now));
  }

  // Head of eight 32-bit words and two doubles: "ASPF", rows, contacts, bodies, flags (1 paused, 2 over), contacts that
  // did not fit, 0, 0; number of the row after the last, rows missed; then speed, rows, contacts, poses of bodies,
  // pose of the probe at those contacts.
  [[nodiscard]] std::string frame_bytes(std::uint64_t first, std::uint64_t missed,
                                        const std::vector<trace_row>& rows_now) const {
    const contact_snapshot touched = live->contacts();
    std::string out = "ASPF";
    append(out, static_cast<std::uint32_t>(rows_now.size()));
    append(out, static_cast<std::uint32_t>(touched.list.size()));
    append(out, static_cast<std::uint32_t>(touched.T_wb.size()));
    append(out, (live->paused() ? 1U : 0U) | (live->ended() ? 2U : 0U));
    append(out, static_cast<std::uint32_t>(touched.list.dropped()));
    append(out, std::uint64_t{0});
    append(out, static_cast<double>(first + rows_now.size()));
    append(out, static_cast<double>(missed));
    append(out, live->speed());
    append_rows(out, rows_now);
    const auto put = [&](double x) { append(out, static_cast<float>(x)); };
    for (const shown_contact& c : touched.list) {
      for (const double x :
           {c.point_w.x, c.point_w.y, c.point_w.z, c.n_ab_w.x, c.n_ab_w.y, c.n_ab_w.z, c.depth_m, c.spread_m}) {
        put(x);
      }
    }
    const auto put_pose = [&](const pose& T) {
      for (const double x : {T.position.x, T.position.y, T.position.z}) put(x);
      for (const double q : to_xyzw(T.rotation)) put(q);
    };
    for (const pose& T : touched.T_wb) put_pose(T);
    put_pose(touched.T_wa);
    return out;
  }

  // What became of the session that a gallery's page asked for.
  int led(mg_connection* to) {
    if (models == nullptr) return refuse(to, 404, "this page is no gallery");
    const gallery::told now = models->tell();
    const char* const phase = now.now == gallery::phase::idle       ? "idle"
                              : now.now == gallery::phase::starting ? "starting"
                                                                    : "running";
    const nlohmann::json document = {{"phase", phase}, {"url", now.url}, {"trouble", printable(now.trouble)}};
    return answer(to, 200, "application/json", document.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  }

  int of_panel(mg_connection* to, std::string_view path, std::string_view query) {
    if (panel == nullptr) return refuse(to, 404, "this page is of no device");
    if (path == "/panel.json") return answer(to, 200, "application/json", panel->description());
    const auto after = number_of<std::uint64_t>(query, "after=");
    if (!after) return refuse(to, 400, "ask for /panel-state?after=NUMBER");
    return answer(to, 200, "application/json", panel->state(*after));
  }

  int tell_panel(mg_connection* to, std::string_view query) {
    const panel_link::told said = panel->ask(query);
    // A page beats again and again: a beat that is refused costs no connection.
    return said.code < 400 ? answer(to, said.code, "application/json", said.body)
                           : answer(to, said.code, "text/plain; charset=utf-8", said.body + '\n');
  }

  int choose(mg_connection* to, std::string_view query) {
    if (query == "leave") {
      models->leave();
      return answer(to, 204, {}, {});
    }
    const std::size_t comma = query.find(',');
    if (comma == std::string_view::npos) return refuse(to, 400, "touch=PROBE,FIXED or leave");
    const auto probe = number_of<std::size_t>(query.substr(0, comma), "touch=");
    const auto fixed = number_of<std::size_t>(query.substr(comma), ",");
    if (!probe || !fixed || !models->ask(*probe, *fixed)) {
      return refuse(to, 400, "touch=PROBE,FIXED: numbers of two models on the list, from 0");
    }
    return answer(to, 204, {}, {});
  }

  int command(mg_connection* to, std::string_view path, std::string_view query) {
    // A header of its own: a form of somebody else's page cannot send one.
    if (path != "/do" || header_of(to, "X-Asperity").empty())
      return refuse(to, 404, "POST is for /do, with X-Asperity");
    if (models != nullptr) return choose(to, query);
    if (panel != nullptr) return tell_panel(to, query);
    if (live == nullptr) return refuse(to, 404, "there is no session to pause");
    if (query == "pause" || query == "resume") {
      live->forget_steps();
      live->pause(query == "pause");
    } else if (const auto ticks = number_of<std::uint32_t>(query, "step="); ticks && *ticks >= 1 && *ticks <= 10'000) {
      live->pause(true);
      live->allow_steps(*ticks);
    } else if (const auto speed = number_of<double>(query, "speed="); speed && *speed >= 0.001 && *speed <= 10.0) {
      live->set_speed(*speed);
    } else if (query.starts_with("hand=")) {
      if (!live->leads()) return refuse(to, 404, "the hand of this session is led by nobody: --motion mouse");
      const std::optional<pose> T_wa = pose_of(query.substr(5));
      if (!T_wa) return refuse(to, 400, "hand=x,y,z,qx,qy,qz,qw: metres, within 10 m, and a rotation");
      live->lead_to(*T_wa);
    } else {
      return refuse(to, 400, "pause, resume, step=1..10000, speed=0.001..10 or hand=POSE");
    }
    return answer(to, 204, {}, {});
  }
};

result<std::string> make_token() {
  std::array<unsigned char, 16> random{};
  if (getrandom(random.data(), random.size(), 0) != static_cast<ssize_t>(random.size())) {
    return error{error_code::io_failed, "the system gave no random numbers for a token: try again"};
  }
  std::string out;
  for (const unsigned char byte : random) {
    out += "0123456789abcdef"[byte >> 4U];
    out += "0123456789abcdef"[byte & 15U];
  }
  return out;
}

bool same_token(std::string_view given, std::string_view token) noexcept {
  if (given.size() != token.size()) return false;
  volatile unsigned char different = 0;
  for (std::size_t i = 0; i < token.size(); ++i) {
    different = different | static_cast<unsigned char>(given[i] ^ token[i]);
  }
  return different == 0;
}

bool is_loopback(std::string_view address) noexcept {
  return address == "::1" ||
         (address.starts_with("127.") && address.find_first_not_of("0123456789.") == std::string_view::npos);
}

result<page_server> page_server::start(const server_settings& settings, page_content content, feed* live,
                                       gallery* models, panel_link* panel) {
  if (settings.token.empty() && !is_loopback(settings.address)) {
    return error{error_code::invalid_argument, settings.address + " is open to other machines: it needs a token"};
  }
  auto self = std::make_unique<inside>();
  self->content = std::move(content);
  self->live = live;
  self->models = models;
  self->panel = panel;
  self->token = settings.token;
  const bool six = settings.address.find(':') != std::string::npos;
  const std::string host = six ? '[' + settings.address + ']' : settings.address;
  const std::string listen = host + ':' + std::to_string(settings.port);
  const std::string threads = std::to_string(most_pages + 8);
  std::array<const char*, 21> options{"listening_ports", listen.c_str(), "num_threads", threads.c_str(),
                                      // What a client may take to say what it wants, and to read the answer.
                                      "request_timeout_ms", "2000", "keep_alive_timeout_ms", "1000",
                                      "enable_keep_alive", "yes", "max_request_size", "4096", "tcp_nodelay", "1",
                                      "enable_directory_listing", "no", "linger_timeout_ms", "0", "decode_url", "no",
                                      nullptr};
  mg_callbacks callbacks{};
  // Every request ends here: nothing of the server's own, which would read files, is reached.
  callbacks.begin_request = [](mg_connection* to) {
    return static_cast<inside*>(mg_get_user_data(mg_get_context(to)))->serve(to);
  };
  callbacks.init_thread = give_way;
  callbacks.log_message = say_nothing;
  std::array<char, 256> why{};
  unsigned code = 0;
  mg_error_data failed{&code, why.data(), why.size()};
  mg_init_data init{&callbacks, self.get(), options.data()};
  {
    const small_stacks small;
    self->context = mg_start2(&init, &failed);
  }
  if (self->context == nullptr) {
    return error{error_code::io_failed, "nothing can listen at " + listen +
                                            ": another program may have the port, or this machine not the address; "
                                            "name another port"};
  }
  std::array<mg_server_port, 1> ports{};
  if (mg_get_server_ports(self->context, 1, ports.data()) == 1) self->port = static_cast<std::uint16_t>(ports[0].port);
  const std::string port = std::to_string(self->port);
  // A force is asked for by a page of this address alone, whatever else it knows.
  if (self->token.empty() || (panel != nullptr && is_loopback(settings.address)))
    self->hosts = {host + ':' + port, "localhost:" + port, "127.0.0.1:" + port};
  self->url = "http://" + host + ':' + port + '/' + (self->token.empty() ? "" : "#token=" + self->token);
  return page_server(std::move(self));
}

page_server::page_server(std::unique_ptr<inside> self) : self_(std::move(self)) {}
page_server::page_server(page_server&&) noexcept = default;
page_server::~page_server() = default;
const std::string& page_server::url() const noexcept { return self_->url; }
std::uint16_t page_server::port() const noexcept { return self_->port; }

}  // namespace asperity::view
