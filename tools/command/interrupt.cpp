#include "interrupt.hpp"

#include <array>
#include <atomic>
#include <csignal>
#include <cstddef>
#include <unistd.h>

namespace asperity::command {
namespace {

// A handler runs in any thread: lock-free atomics are safe there.
std::atomic<int> first_signal{0};
std::atomic<bool> held{false};
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<bool>::is_always_lock_free);

// Only what is safe in a signal handler: two flags, and for a second wish the signal's own effect.
extern "C" void request_stop(int number, siginfo_t* about, void* /*context*/) {
  // This process's own write to a pipe that nobody reads: the write fails, and whoever wrote deals with it.
  if (number == SIGPIPE && about != nullptr && about->si_code == SI_USER && about->si_pid == getpid()) return;
  int none = 0;
  if (!first_signal.compare_exchange_strong(none, number) && !held) {
    std::signal(number, SIG_DFL);
    std::raise(number);  // it waits until this handler returns
  }
}

struct named_signal {
  int number;
  const char* name;
};
constexpr std::array endings{
    named_signal{SIGHUP, "SIGHUP"},       named_signal{SIGINT, "SIGINT"},   named_signal{SIGQUIT, "SIGQUIT"},
    named_signal{SIGTERM, "SIGTERM"},     named_signal{SIGPIPE, "SIGPIPE"}, named_signal{SIGALRM, "SIGALRM"},
    named_signal{SIGVTALRM, "SIGVTALRM"}, named_signal{SIGPROF, "SIGPROF"}, named_signal{SIGUSR1, "SIGUSR1"},
    named_signal{SIGUSR2, "SIGUSR2"},     named_signal{SIGXCPU, "SIGXCPU"}, named_signal{SIGPOLL, "SIGPOLL"},
#ifdef SIGSTKFLT
    named_signal{SIGSTKFLT, "SIGSTKFLT"},
#endif
#ifdef SIGPWR
    named_signal{SIGPWR, "SIGPWR"},
#endif
};
constexpr std::array suspensions{named_signal{SIGTSTP, "SIGTSTP"}, named_signal{SIGTTIN, "SIGTTIN"},
                                 named_signal{SIGTTOU, "SIGTTOU"}};
std::array<struct sigaction, suspensions.size()> suspensions_before{};

void catch_one(int number, struct sigaction* before = nullptr) {
  struct sigaction on_signal {};
  sigemptyset(&on_signal.sa_mask);
  on_signal.sa_sigaction = request_stop;
  on_signal.sa_flags = SA_SIGINFO;
  sigaction(number, &on_signal, before);
}

bool is_ignored(int number) {
  struct sigaction now {};
  return sigaction(number, nullptr, &now) == 0 && (now.sa_flags & SA_SIGINFO) == 0 && now.sa_handler == SIG_IGN;
}

}  // namespace

void catch_interrupts() {
  for (const named_signal& s : endings) {
    // nohup's wish: a terminal that goes away is no reason to stop.
    if (s.number != SIGHUP || !is_ignored(SIGHUP)) catch_one(s.number);
  }
  for (int number = SIGRTMIN; number <= SIGRTMAX; ++number) catch_one(number);
  std::signal(SIGXFSZ, SIG_IGN);
}

bool interrupted() noexcept { return first_signal != 0; }

int stop_signal() noexcept { return first_signal; }

std::string signal_name(int number) {
  for (const named_signal& s : endings) {
    if (s.number == number) return s.name;
  }
  for (const named_signal& s : suspensions) {
    if (s.number == number) return s.name;
  }
  return "signal " + std::to_string(number);
}

device_hold::device_hold() {
  held = true;
  for (std::size_t i = 0; i < suspensions.size(); ++i) catch_one(suspensions[i].number, &suspensions_before[i]);
}

device_hold::~device_hold() {
  for (std::size_t i = 0; i < suspensions.size(); ++i) {
    sigaction(suspensions[i].number, &suspensions_before[i], nullptr);
  }
  held = false;
}

}  // namespace asperity::command
