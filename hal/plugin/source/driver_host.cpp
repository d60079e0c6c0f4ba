// asperity-driver-host: the process that a driver runs in. Started by child_driver and by nobody else.
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <thread>
#include <unistd.h>

#include "child_server.hpp"

namespace {

using namespace asperity::plugin;

constexpr int bad_start = 2;
constexpr int driver_hung = 3;

extern "C" void only_wake(int) {}

// What this process begins with, and nothing else of the program's: a driver has no business with its open files.
void close_the_rest() { static_cast<void>(::syscall(SYS_close_range, child_driver_descriptor + 1, ~0U, 0U)); }

// SIGUSR1 interrupts a wait when the program is gone; whether it is, its number says. Ends that people send to all
// processes of a session are left to the program, which winds the force down first.
void set_up_signals() {
  struct sigaction wake {};
  wake.sa_handler = only_wake;
  ::sigaction(SIGUSR1, &wake, nullptr);
  ::prctl(PR_SET_PDEATHSIG, SIGUSR1);
  for (const int s : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) std::signal(s, SIG_IGN);
}

// A driver that hangs while the program ends keeps nobody: who would put out zero is the one that hangs.
void end_with(pid_t program) {
  std::thread([program] {
    while (::getppid() == program) ::usleep(100'000);
    ::sleep(1);
    ::_exit(driver_hung);
  }).detach();
}

child_page* shared_page() {
  struct stat s {};
  if (::fstat(child_page_descriptor, &s) != 0 || s.st_size != static_cast<off_t>(sizeof(child_page))) return nullptr;
  void* const mapped =
      ::mmap(nullptr, sizeof(child_page), PROT_READ | PROT_WRITE, MAP_SHARED, child_page_descriptor, 0);
  if (mapped == MAP_FAILED) return nullptr;
  ::close(child_page_descriptor);
  auto* const page = std::launder(static_cast<child_page*>(mapped));
  return page->version == child_page::layout && page->size == sizeof(child_page) ? page : nullptr;
}

}  // namespace

int main(int argc, char** argv) {
  const pid_t program = argc == 3 ? static_cast<pid_t>(std::strtol(argv[1], nullptr, 10)) : 0;
  child_page* const page = program > 0 ? shared_page() : nullptr;
  if (page == nullptr) {
    std::fputs("asperity-driver-host runs a device driver for another program; it is not started by hand\n", stderr);
    return bad_start;
  }
  close_the_rest();
  set_up_signals();
  if (::getppid() != program) return bad_start;  // it went before the kernel was asked to tell
  end_with(program);
  int status = 0;
  {
    child_server server(*page, driver_file::adopt(child_driver_descriptor, argv[2]), program);
    status = server.serve();
  }
  // Without the ends of static objects: a driver's code is not to have another word.
  ::_exit(status);
}
