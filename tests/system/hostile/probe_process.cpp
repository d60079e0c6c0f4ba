#include "probe_process.hpp"

#include <array>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "support/sanitizers.hpp"

namespace asperity::hostile {
namespace {

void limit(__rlimit_resource what, rlim_t most) {
  const rlimit both{most, most};
  ::setrlimit(what, &both);
}

[[noreturn]] void become_probe(const char* how, const char* file, const probe_limits& limits, int out) {
  ::dup2(out, STDOUT_FILENO);
  limit(RLIMIT_CPU, limits.cpu_s);
  limit(RLIMIT_CORE, 0);
  if (limits.address_space_bytes != 0 && !ASPERITY_ADDRESS_SANITIZER) limit(RLIMIT_AS, limits.address_space_bytes);
  ::alarm(limits.wall_s);  // lives on in the probe; it ends what waits without using the processor
  ::execl(ASPERITY_LOAD_PROBE, ASPERITY_LOAD_PROBE, how, file, static_cast<char*>(nullptr));
  ::_exit(126);
}

std::string read_to_end(int from) {
  std::string out;
  std::array<char, 4096> some{};
  for (ssize_t n = 0; (n = ::read(from, some.data(), some.size())) > 0;)
    out.append(some.data(), static_cast<std::size_t>(n));
  return out;
}

}  // namespace

probe_outcome run_probe(const char* how, const std::filesystem::path& file, const probe_limits& limits) {
  std::array<int, 2> ends{};
  probe_outcome out;
  if (::pipe(ends.data()) != 0) return out;
  const pid_t child = ::fork();
  if (child == 0) become_probe(how, file.c_str(), limits, ends[1]);
  ::close(ends[1]);
  const std::string text = read_to_end(ends[0]);
  ::close(ends[0]);
  int status = 0;
  rusage used{};
  ::wait4(child, &status, 0, &used);
  out.signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  out.cpu_s = static_cast<double>(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
              1e-6 * static_cast<double>(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
  const std::size_t first_line = text.find('\n');
  if (first_line != std::string::npos) {
    out.peak_bytes = std::stoul(text);
    out.said = text.substr(first_line + 1);
    if (!out.said.empty()) out.said.pop_back();
  }
  return out;
}

}  // namespace asperity::hostile
