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
    {"roughness", "What makes dots feel rough",
     "A stylus with a ball for its tip is stroked over rows of dots, as in the experiments on perceived roughness: "
     "which "
     "spacing shakes the hand most, and how that goes with the ball's radius, the force, the speed and the rate of the "
     "contacts.",
     run_roughness},
    {"patterns", "Textures told apart by feel alone",
     "Striped, dotted, scattered, random and flat plates are stroked, and the spectra of the forces are sorted: the "
     "paper's informal test, in which people described regular patterns and had more difficulty with irregular ones.",
     run_patterns},
}};

}  // namespace

std::span<const experiment> all_experiments() noexcept { return experiments; }

}  // namespace asperity::experiment
