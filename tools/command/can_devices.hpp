// The CAN interfaces that drives can be on. In builds with asperity::can.
#pragma once

#include "cli.hpp"

namespace asperity::command {

/// Adds `can_interfaces` and a line for each, with what keeps it from being used.
void add_can_interfaces(answer& devices);

}  // namespace asperity::command
