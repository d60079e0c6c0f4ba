#include <array>

#include "experiment.hpp"

namespace asperity::experiment {
namespace {

constexpr std::array<experiment, 3> experiments{{
    {"fig7", "A block drawn over a gear",
     "The textured block is drawn across the ridges of the fixed gear, as in the paper's Fig. 7: it moves in steps, "
     "and "
     "the tangential force winds up before each.",
     run_fig7},
    {"fig8", "A block turned on its twin",
     "Two identical striped blocks lie interlocked, and the upper one is turned a little about the contact normal, as "
     "in the paper's Fig. 8: it rises along the normal, and a torque opposes the turn.",
     run_fig8},
    {"baselines", "What models of one point cannot show",
     "The force models of Minsky, of Ho et al. and of Siira and Pai, which read one texture at one point, take the "
     "place of the paper's: the block does not rise, nothing opposes its turn, and some of them make energy.",
     run_baselines},
}};

}  // namespace

std::span<const experiment> all_experiments() noexcept { return experiments; }

}  // namespace asperity::experiment
