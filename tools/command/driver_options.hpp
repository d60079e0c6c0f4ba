// Which drivers of others may run, on the command line.
#pragma once

#include <CLI/CLI.hpp>

#include "known_devices.hpp"

namespace asperity::command {

inline void add_driver_options(CLI::App& to, driver_choice& choice) {
  to.add_option(
        "--enable", choice.enabled,
        "Driver in a shared object that may run, in a process of its own: its name in `asperity devices`, or its "
        "file with its folder; may be given several times")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  to.add_option("--in-process", choice.in_process,
                "As --enable, for a driver that you trust like the command itself: it runs in the command's process, "
                "which saves the way to another one, and ends or hangs it where the driver does")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

}  // namespace asperity::command
