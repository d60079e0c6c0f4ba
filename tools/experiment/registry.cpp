#include <array>

#include "experiment.hpp"

namespace asperity::experiment {
namespace {

constexpr std::array<experiment, 8> experiments{{
    {"fig7", "A block drawn over a gear",
     "The textured block is drawn across the ridges of the fixed gear, as in the paper's Fig. 7: it moves in steps, "
     "and "
     "the tangential force winds up before each.",
     run_fig7},
    {"fig8", "A block turned on its twin",
     "Two identical striped blocks lie interlocked, and the upper one is turned a little about the contact normal, as "
     "in the paper's Fig. 8: it rises along the normal, and a torque opposes the turn.",
     run_fig8},
    {"fig9", "A file scrubs the CAD part",
     "What a frame takes in the paper's hardest scene, Fig. 9: time for collision, for texture force and in all, and "
     "the number of contacts.",
     run_fig9},
    {"hammer", "A hammer on a torus",
     "The paper's textured hammer touches the wrinkled torus, is drawn along the ring, rocked and lifted: is the "
     "contact "
     "found and kept, does it follow the surface, and does its torque right the hammer.",
     run_hammer},
    {"roughness", "What makes dots feel rough",
     "A stylus with a ball for its tip is stroked over rows of dots, as in the experiments on perceived roughness: "
     "which "
     "spacing shakes the hand most, and how that goes with the ball's radius, the force, the speed and the rate of the "
     "contacts.",
     run_roughness},
    {"baselines", "What models of one point cannot show",
     "The force models of Minsky, of Ho et al. and of Siira and Pai, which read one texture at one point, take the "
     "place of the paper's: the block does not rise, nothing opposes its turn, and some of them make energy.",
     run_baselines},
    {"patterns", "Textures told apart by feel alone",
     "Striped, dotted, scattered, random and flat plates are stroked, and the spectra of the forces are sorted: the "
     "paper's informal test, in which people described regular patterns and had more difficulty with irregular ones.",
     run_patterns},
    {"stability", "How stiff a contact may be",
     "A block is held still in a notch of another one. How stiff may the contact be before it shakes the hand: by the "
     "rate of the contact thread, by its latency, and by what it hands over of a contact?",
     run_stability},
}};

}  // namespace

std::span<const experiment> all_experiments() noexcept { return experiments; }

}  // namespace asperity::experiment
