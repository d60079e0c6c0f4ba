#include "own_process.hpp"

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <new>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "kit_clock.hpp"

namespace asperity::conformance {
namespace {

// No driver answers with these by chance.
constexpr int conforms = 40;
constexpr int conforms_not = 41;

std::string where(const progress& p) {
  return std::string(" in ") + p.call + "(), during " + (p.stage[0] != '\0' ? p.stage : "start");
}

}  // namespace

process_end in_own_process(const std::function<int(progress&)>& work, int patience_s) {
  void* const page = ::mmap(nullptr, sizeof(progress), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (page == MAP_FAILED) return {1, "no memory for two processes to share: " + std::string(std::strerror(errno))};
  auto& shared = *new (page) progress;

  const pid_t child = ::fork();
  if (child < 0) return {1, "no process could be started: " + std::string(std::strerror(errno))};
  if (child == 0) {
    const int answer = work(shared);
    std::fflush(nullptr);
    ::_exit(answer == 0 ? conforms : conforms_not);
  }

  std::uint64_t calls = 0;
  std::int64_t since_ns = kit_clock::monotonic_ns();
  int end = 0;
  while (::waitpid(child, &end, WNOHANG) == 0) {
    const timespec pause{.tv_sec = 0, .tv_nsec = 5'000'000};
    ::nanosleep(&pause, nullptr);
    const std::uint64_t now_calls = shared.calls.load(std::memory_order_acquire);
    const std::int64_t now_ns = kit_clock::monotonic_ns();
    if (now_calls != calls) {
      calls = now_calls;
      since_ns = now_ns;
    } else if (now_ns - since_ns > std::int64_t{1'000'000'000} * patience_s) {
      ::kill(child, SIGKILL);
      ::waitpid(child, &end, 0);
      return {1, "no answer for " + std::to_string(patience_s) + " s" + where(shared)};
    }
  }
  if (WIFSIGNALED(end)) {
    return {1, "signal " + std::to_string(WTERMSIG(end)) + " (" + ::strsignal(WTERMSIG(end)) + ")" + where(shared)};
  }
  const int status = WEXITSTATUS(end);
  if (status != conforms && status != conforms_not) {
    return {1, "the process was ended with status " + std::to_string(status) + where(shared)};
  }
  return {status == conforms ? 0 : 1, {}};
}

}  // namespace asperity::conformance
