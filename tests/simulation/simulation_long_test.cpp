#include <gtest/gtest.h>

#include "simulation/every_session.hpp"
#include "support/extent.hpp"

namespace {

using namespace asperity::simulation;

TEST(simulation, every_invariant_holds_in_every_tick_of_every_session) {
  // With the seeds of simulation_test, 2000 at length and 500 otherwise.
  static_cast<void>(check_every_session({201, asperity::test_support::extent(300U, 1800U)}));
}

}  // namespace
