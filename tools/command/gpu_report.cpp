#include "gpu_report.hpp"

#include <cstdio>

#include "text.hpp"

namespace asperity::command {

json to_json(const gpu_use& use) {
  const auto text_or_null = [](const std::string& text) { return text.empty() ? json() : json(text); };
  return {{"device", text_or_null(use.device)},
          {"version", text_or_null(use.version)},
          {"software", use.software},
          {"device_memory", use.device_bytes},
          {"problem", text_or_null(use.problem)},
          {"fallback", use.fallback},
          {"ticks", use.ticks},
          {"failed_ticks", use.failed},
          {"fallback_ticks", use.fallbacks}};
}

std::string to_text(const gpu_use& use) {
  std::string out = row("GPU", use.device.empty() ? "none" : use.device + ", " + memory_text(use.device_bytes));
  if (use.fallback) {
    out += row("answered by the CPU", std::to_string(use.fallbacks) + " of " + std::to_string(use.ticks) + " ticks");
  }
  return out;
}

void warn(const gpu_use& use) {
  const auto say = [](const std::string& what) {
    std::fputs(("asperity: note: " + printable(what) + "\n").c_str(), stderr);
  };
  if (!use.problem.empty()) say("the CPU answers in place of the GPU: " + use.problem);
  if (use.software) {
    say(use.device + " draws on the processor: right for checking results, and slower than --backend cpu");
  }
}

error gpu_failed(const gpu_use& use) {
  return {error_code::unsupported, "the GPU did not answer in " + std::to_string(use.failed) + " of " +
                                       std::to_string(use.ticks) + " ticks (" + use.device +
                                       "): its driver lost the context or reports an error; add --fallback to let the "
                                       "CPU answer, or use --backend cpu"};
}

}  // namespace asperity::command
