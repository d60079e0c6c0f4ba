#include <gtest/gtest.h>

#include "simulation/every_session.hpp"

namespace {

using namespace asperity::simulation;

TEST(simulation, every_invariant_holds_in_every_tick_of_every_session) {
  static_cast<void>(check_every_session({1, 2000}));
}

}  // namespace
