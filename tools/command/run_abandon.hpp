// The end of a session whose driver does not return.
#pragma once

#include <string>

#include "run_files.hpp"

namespace asperity::command {

/// Closes the recordings with what there is, says what happened, and ends the process with exit_failed. Nothing is
/// destroyed on the way: a thread is still inside the driver. Takes two seconds at the most beside the disk's time.
[[noreturn]] void abandon(session_rescue& rescue, session_files& files, const std::string& what, bool as_json);

}  // namespace asperity::command
