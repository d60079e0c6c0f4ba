#include "interrupt.hpp"

#include <csignal>

namespace asperity::command {
namespace {

volatile std::sig_atomic_t stop_requested = 0;

extern "C" void request_stop(int) { stop_requested = 1; }

}  // namespace

void catch_interrupts() {
  struct sigaction on_stop {};
  on_stop.sa_handler = request_stop;
  on_stop.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &on_stop, nullptr);
  sigaction(SIGTERM, &on_stop, nullptr);
  std::signal(SIGXFSZ, SIG_IGN);
}

bool interrupted() noexcept { return stop_requested != 0; }

}  // namespace asperity::command
