// The machine in words, for reports that hold times.
#include <fstream>
#include <string>
#include <sys/utsname.h>
#include <thread>

#include "publish.hpp"

namespace asperity::experiment {
namespace {

// Linux tells it here; elsewhere the kind of processor has to do.
std::string processor(const std::string& kind) {
  std::ifstream facts("/proc/cpuinfo");
  for (std::string line; std::getline(facts, line);) {
    const std::size_t colon = line.find(": ");
    if (line.rfind("model name", 0) == 0 && colon != std::string::npos) return line.substr(colon + 2);
  }
  return kind.empty() ? "unknown processor" : kind;
}

}  // namespace

std::string machine_text() {
  utsname system{};
  const bool known = uname(&system) == 0;
  const unsigned cores = std::thread::hardware_concurrency();
  return processor(known ? system.machine : "") + ", " + std::to_string(cores) + (cores == 1 ? " core" : " cores") +
         (known ? std::string(", ") + system.sysname + ' ' + system.release : "");
}

}  // namespace asperity::experiment
