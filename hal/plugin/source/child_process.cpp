#include "child_process.hpp"

#include <algorithm>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstring>
#include <ctime>
#include <fcntl.h>
#include <new>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>
#include <utility>
#include <vector>

#include "asperity/plugin/futex.hpp"

extern char** environ;  // NOLINT(readability-identifier-naming): POSIX names it

namespace asperity::plugin {
namespace {

error cannot(const char* what) {
  return {error_code::io_failed, std::string("no process could be started for the driver: ") + what + ": " +
                                     std::strerror(errno)};  // NOLINT(concurrency-mt-unsafe)
}

void nap() noexcept {
  const timespec pause{.tv_sec = 0, .tv_nsec = 2'000'000};
  ::nanosleep(&pause, nullptr);
}

// Zero-filled memory of its final size: a process that made it shorter would end the other one at its next access.
result<int> shared_memory() {
  const int fd = ::memfd_create("asperity-driver", MFD_CLOEXEC | MFD_ALLOW_SEALING);
  if (fd < 0) return cannot("memory to share");
  if (::ftruncate(fd, sizeof(child_page)) != 0 ||
      ::fcntl(fd, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) != 0) {
    const error e = cannot("memory to share");
    ::close(fd);
    return e;
  }
  return fd;
}

// A descriptor above those that the new process begins with: none of them is written over before it was copied.
int out_of_the_way(int fd) noexcept { return ::fcntl(fd, F_DUPFD_CLOEXEC, 64); }

// What the new process begins with: no signal blocked or ignored, a group of its own, so that Ctrl-C at a terminal ends
// the session and not the driver under it, and nothing of this program's but two descriptors.
int spawn(pid_t& pid, const std::string& program, const std::string& name, int page, int driver) {
  posix_spawn_file_actions_t files{};
  posix_spawnattr_t attributes{};
  ::posix_spawn_file_actions_init(&files);
  ::posix_spawnattr_init(&attributes);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    ::posix_spawn_file_actions_addopen(&files, stream, "/dev/null", O_RDWR, 0);
  }
  ::posix_spawn_file_actions_adddup2(&files, page, child_page_descriptor);
  ::posix_spawn_file_actions_adddup2(&files, driver, child_driver_descriptor);
  sigset_t none{};
  sigset_t all{};
  ::sigemptyset(&none);
  ::sigfillset(&all);
  ::posix_spawnattr_setsigmask(&attributes, &none);
  ::posix_spawnattr_setsigdefault(&attributes, &all);
  ::posix_spawnattr_setpgroup(&attributes, 0);
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
  std::string self = std::to_string(::getpid());
  std::string command = program;
  std::string file = name;
  char* arguments[] = {command.data(), self.data(), file.data(), nullptr};
  const int failed = ::posix_spawn(&pid, program.c_str(), &files, &attributes, &arguments[0], environ);
  ::posix_spawnattr_destroy(&attributes);
  ::posix_spawn_file_actions_destroy(&files);
  return failed;
}

}  // namespace

std::string find_host_program() {
  char self[PATH_MAX];
  const ssize_t length = ::readlink("/proc/self/exe", self, sizeof self);
  std::vector<std::filesystem::path> places;
  if (length > 0 && static_cast<std::size_t>(length) < sizeof self) {
    const std::filesystem::path folder =
        std::filesystem::path(std::string(self, static_cast<std::size_t>(length))).parent_path();
    places.push_back(folder / "asperity-driver-host");
    places.push_back(folder.parent_path() / ASPERITY_LIBEXEC / "asperity-driver-host");
  }
  places.emplace_back(ASPERITY_FULL_LIBEXEC "/asperity-driver-host");
  for (const std::filesystem::path& place : places) {
    if (::access(place.c_str(), X_OK) == 0) return place.string();
  }
  return {};
}

result<std::unique_ptr<child_process>> child_process::start(const driver_file& file, const child_settings& settings) {
  const std::string program = settings.host_program.empty() ? find_host_program() : settings.host_program.string();
  if (program.empty()) {
    return error{error_code::io_failed,
                 file.path().string() +
                     ": asperity-driver-host, in whose process a driver runs, is not beside this "
                     "program nor in " ASPERITY_FULL_LIBEXEC
                     ": install it, or name it in child_settings::host_program"};
  }
  const result<int> memory = shared_memory();
  if (!memory) return memory.error();
  void* const mapped = ::mmap(nullptr, sizeof(child_page), PROT_READ | PROT_WRITE, MAP_SHARED, *memory, 0);
  if (mapped == MAP_FAILED) {
    const error e = cannot("memory to share");
    ::close(*memory);
    return e;
  }
  auto* const page = new (mapped) child_page;
  page->paced = settings.pace == child_pace::paced ? 1 : 0;
  page->disarm_after_ns = settings.disarm_after_ns;

  const int page_fd = out_of_the_way(*memory);
  const int driver_fd = out_of_the_way(file.descriptor());
  pid_t pid = -1;
  errno = page_fd < 0 || driver_fd < 0 ? errno : spawn(pid, program, file.path().string(), page_fd, driver_fd);
  const bool failed = pid < 0 || errno != 0;
  const error e = cannot(program.c_str());
  ::close(*memory);
  if (page_fd >= 0) ::close(page_fd);
  if (driver_fd >= 0) ::close(driver_fd);
  if (failed) {
    ::munmap(page, sizeof(child_page));
    return e;
  }
  return std::unique_ptr<child_process>(new child_process(page, pid));
}

child_process::~child_process() {
  kill();
  ::munmap(page_, sizeof(child_page));
}

bool child_process::is_gone() noexcept {
  if (ended_) return true;
  int how = 0;
  const pid_t done = ::waitpid(pid_, &how, WNOHANG);
  if (done == pid_) ended_ = how;
  if (done < 0 && errno == ECHILD) ended_ = INT_MIN;
  return ended_.has_value();
}

void child_process::kill() noexcept {
  if (is_gone()) return;
  ::kill(pid_, SIGKILL);
  // A process that hangs in the kernel goes when the kernel lets it; the program does not wait for that.
  for (int i = 0; i < 250 && !is_gone(); ++i) nap();
}

void child_process::wait_or_kill(std::int64_t patience_ns) noexcept {
  const std::int64_t until_ns = monotonic_ns() + patience_ns;
  while (!is_gone() && monotonic_ns() < until_ns) nap();
  kill();
}

child_phase child_process::phase() const noexcept {
  return static_cast<child_phase>(page_->phase.load(std::memory_order_relaxed));
}

std::string child_process::end_text() const {
  std::string how = "is gone";
  if (ended_ && *ended_ != INT_MIN) {
    if (WIFSIGNALED(*ended_)) {
      const int signal = WTERMSIG(*ended_);
      const char* name = ::strsignal(signal);  // NOLINT(concurrency-mt-unsafe)
      how = "was ended by signal " + std::to_string(signal) + " (" + (name != nullptr ? name : "unknown") + ")";
    } else {
      how = "ended itself with status " + std::to_string(WEXITSTATUS(*ended_));
    }
  }
  return "the driver's process " + how + " " + to_string(phase());
}

}  // namespace asperity::plugin
