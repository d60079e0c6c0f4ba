// The groups of checks, in the order in which they are run.
#pragma once

#include "ledger.hpp"
#include "subject.hpp"

namespace asperity::conformance {

/// How long the session is that samples and timing are judged by.
struct session_length {
  int ticks = 2000;
};

/// What the driver says of its device: capabilities and units.
void check_statements(subject& device, ledger& found);
/// Every call in every state that can be reached.
void check_states(subject& device, ledger& found);
/// A session: samples, timing, what the real-time calls do.
void check_session(subject& device, ledger& found, const session_length& length);
/// Commands that should not be put out, and one that should.
void check_commands(subject& device, ledger& found);
/// Failed writes, departures, returns, closing and opening again.
void check_faults(subject& device, ledger& found);

}  // namespace asperity::conformance
