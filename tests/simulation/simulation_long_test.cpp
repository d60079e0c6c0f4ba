#include <gtest/gtest.h>

#include "simulation/every_session.hpp"

namespace {

using namespace asperity::simulation;

TEST(simulation, every_invariant_holds_in_every_tick_of_every_session) {
  // With the seeds of simulation_test, 2000.
  static_cast<void>(check_every_session({201, 1800}));
}

}  // namespace
