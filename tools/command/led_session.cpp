#include "led_session.hpp"

#include <array>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <utility>

namespace asperity::command {
namespace {

constexpr std::string_view before_url = "the page is at ";

// Between fork() and exec() only calls that are safe after the other threads are gone.
[[noreturn]] void become(char* const* arguments, int said, pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGINT);
  if (getppid() != parent) _exit(127);
  const int nothing = open("/dev/null", O_RDWR | O_CLOEXEC);
  if (nothing < 0 || dup2(nothing, STDIN_FILENO) < 0 || dup2(nothing, STDOUT_FILENO) < 0 ||
      dup2(said, STDERR_FILENO) < 0) {
    _exit(127);
  }
  execv("/proc/self/exe", arguments);
  _exit(127);
}

}  // namespace

result<led_session> led_session::start(const std::string& probe, const std::string& fixed) {
  const error failed{error_code::io_failed, "the system starts no further process for the session: close another one"};
  // Absolute, so that no name looks like an option.
  std::array<std::string, 10> words{"asperity", "run",
                                    "--probe",  std::filesystem::absolute(probe).string(),
                                    "--fixed",  std::filesystem::absolute(fixed).string(),
                                    "--motion", "mouse",
                                    "--view",   "0"};
  std::array<char*, words.size() + 1> arguments{};
  for (std::size_t i = 0; i < words.size(); ++i) arguments[i] = words[i].data();
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) return failed;
  const pid_t parent = getpid();
  const pid_t process = fork();
  if (process == 0) become(arguments.data(), ends[1], parent);
  close(ends[1]);
  if (process < 0) {
    close(ends[0]);
    return failed;
  }
  static_cast<void>(fcntl(ends[0], F_SETFL, O_NONBLOCK));
  return led_session(process, ends[0]);
}

led_session::led_session(led_session&& other) noexcept
    : process_(std::exchange(other.process_, -1)),
      said_(std::exchange(other.said_, -1)),
      line_(std::move(other.line_)),
      last_(std::move(other.last_)),
      url_(std::move(other.url_)),
      trouble_(std::move(other.trouble_)) {}

led_session::~led_session() {
  using std::chrono::milliseconds;
  constexpr milliseconds patience{3000}, look_again{10};
  if (process_ > 0) kill(process_, SIGINT);
  for (milliseconds waited{0}; process_ > 0 && !has_ended(); waited += look_again) {
    if (waited == patience) kill(process_, SIGKILL);
    std::this_thread::sleep_for(look_again);
  }
  if (said_ >= 0) close(said_);
}

bool led_session::has_ended() {
  int how = 0;
  if (waitpid(process_, &how, WNOHANG) != process_) return false;
  process_ = -1;
  if (!WIFEXITED(how) || WEXITSTATUS(how) != 0) {
    trouble_ = last_.empty() ? "the session ended without a word" : last_;
  }
  return true;
}

bool led_session::look() {
  if (process_ < 0) return false;
  const bool ended = has_ended();
  std::array<char, 512> some;
  for (ssize_t n = read(said_, some.data(), some.size()); n > 0; n = read(said_, some.data(), some.size())) {
    for (const char c : std::string_view(some.data(), static_cast<std::size_t>(n))) {
      if (c != '\n') {
        if (line_.size() < 2000) line_ += c;
        continue;
      }
      if (const std::size_t at = line_.find(before_url); at != std::string::npos && url_.empty()) {
        url_ = line_.substr(at + before_url.size());
      }
      last_ = std::exchange(line_, {});
    }
  }
  if (ended && !trouble_.empty() && !last_.empty()) trouble_ = last_;
  return !ended;
}

}  // namespace asperity::command
