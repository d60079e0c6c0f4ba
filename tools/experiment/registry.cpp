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
    {"fig9", "A file scrubs the CAD part",
     "What a frame takes in the paper's hardest scene, Fig. 9: time for collision, for texture force and in all, and "
     "the number of contacts.",
     run_fig9},
    {"stability", "How stiff a contact may be",
     "A block is held still in a notch of another one. How stiff may the contact be before it shakes the hand: by the "
     "rate of the contact thread, by its latency, and by what it hands over of a contact?",
     run_stability},
}};

}  // namespace

std::span<const experiment> all_experiments() noexcept { return experiments; }

}  // namespace asperity::experiment
