#include "run_abandon.hpp"

#include <chrono>
#include <cstdlib>
#include <mutex>

#include "cli.hpp"

namespace asperity::command {

void abandon(session_rescue& rescue, session_files& files, const std::string& what, bool as_json) {
  std::string of_the_files;
  {
    // Its main thread may be waiting for a disk or a pipe with the lock in its hands.
    const std::unique_lock lock(rescue.writing, std::chrono::milliseconds(500));
    if (lock.owns_lock()) {
      if (rescue.take_records) rescue.take_records();
      of_the_files = files.rescue();
    } else {
      of_the_files = "what was written of the recordings is in the files whose names end in .partial- and letters";
    }
  }
  report_error("io_failed", what + "; the process is ended" + (of_the_files.empty() ? "" : "; " + of_the_files),
               as_json);
  std::_Exit(exit_failed);
}

}  // namespace asperity::command
