// One line on the terminal that says how far long work has come.
#pragma once

#include <cstdio>
#include <string>
#include <string_view>
#include <unistd.h>

#include "asperity/core/printable.hpp"

namespace asperity::command {

/// Writes "stage  42 %" over itself on stderr, only where that is a terminal, and wipes it at the end. No colour.
class progress_line {
 public:
  explicit progress_line(bool quiet) : shown_(!quiet && isatty(STDERR_FILENO) != 0) {}
  progress_line(const progress_line&) = delete;
  progress_line& operator=(const progress_line&) = delete;
  ~progress_line() {
    if (shown_ && !last_.empty()) std::fprintf(stderr, "\r%*s\r", static_cast<int>(last_.size()), "");
  }

  /// @param done share of the stage, 0 to 1
  void show(std::string_view stage, double done) {
    if (!shown_) return;
    std::string line = printable(stage);
    line += "  " + std::to_string(static_cast<int>(100.0 * done)) + " %";
    if (line == last_) return;
    const int wipe = static_cast<int>(last_.size() > line.size() ? last_.size() - line.size() : 0);
    std::fprintf(stderr, "\r%s%*s", line.c_str(), wipe, "");
    last_ = std::move(line);
  }

 private:
  bool shown_;
  std::string last_;
};

}  // namespace asperity::command
