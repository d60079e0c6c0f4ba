#include <array>

#include "experiment.hpp"

namespace asperity::experiment {
namespace {

constexpr std::array<experiment, 1> experiments{{
    {"fig7", "A block drawn over a gear",
     "The textured block is drawn across the ridges of the fixed gear, as in the paper's Fig. 7: it moves in steps, "
     "and "
     "the tangential force winds up before each.",
     run_fig7},
}};

}  // namespace

std::span<const experiment> all_experiments() noexcept { return experiments; }

}  // namespace asperity::experiment
