#include <array>

#include "experiment.hpp"

namespace asperity::experiment {
namespace {

constexpr std::array<experiment, 2> experiments{{
    {"fig7", "A block drawn over a gear",
     "The textured block is drawn across the ridges of the fixed gear, as in the paper's Fig. 7: it moves in steps, "
     "and "
     "the tangential force winds up before each.",
     run_fig7},
    {"hammer", "A hammer on a torus",
     "The paper's textured hammer touches the wrinkled torus, is drawn along the ring, rocked and lifted: is the "
     "contact "
     "found and kept, does it follow the surface, and does its torque right the hammer.",
     run_hammer},
}};

}  // namespace

std::span<const experiment> all_experiments() noexcept { return experiments; }

}  // namespace asperity::experiment
