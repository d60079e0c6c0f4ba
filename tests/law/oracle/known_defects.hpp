// What is known to be wrong with today's depth, counted at poses that the library had no part in (seed 1, which no day
// has). These are defects by name, not bounds. A test fails where one becomes worse, and where one is gone: then its
// line goes too.
//
// The causes behind most of them:
// - missed and shallow of the default, in light presses: what moves with a way out is round over convex edges, so that
//   two sharp edges that cross are felt late.
// - deep of the paper's: its renderer takes a depth along a contact's own direction, which can run along a wall.
// - missed of the paper's: no pair of convex pieces is near enough, or faces the other, where one body is wholly inside
//   the other.
#pragma once

#include <array>
#include <vector>

#include "law/oracle/fresh_poses.hpp"

namespace asperity::oracle {

// clang-format off
inline const std::vector<known_pair> known_benchmark_pairs{
    {"block", "gear", 700,
     {
         {formulation::least_motion, press::graze, verdict::doubtful, 5},
         {formulation::least_motion, press::light, verdict::missed, 48},
         {formulation::least_motion, press::light, verdict::shallow, 93},
         {formulation::least_motion, press::light, verdict::doubtful, 76},
         {formulation::least_motion, press::firm, verdict::missed, 1},
         {formulation::least_motion, press::firm, verdict::shallow, 58},
         {formulation::least_motion, press::firm, verdict::pulls, 1},
         {formulation::least_motion, press::firm, verdict::doubtful, 21},
         {formulation::least_motion, press::deep, verdict::shallow, 3},
         {formulation::least_motion, press::deep, verdict::doubtful, 3},
         {formulation::window, press::graze, verdict::pulls, 1},
         {formulation::window, press::graze, verdict::doubtful, 20},
         {formulation::window, press::light, verdict::missed, 18},
         {formulation::window, press::light, verdict::shallow, 40},
         {formulation::window, press::light, verdict::pulls, 17},
         {formulation::window, press::light, verdict::doubtful, 110},
         {formulation::window, press::firm, verdict::shallow, 58},
         {formulation::window, press::firm, verdict::deep, 8},
         {formulation::window, press::firm, verdict::pulls, 26},
         {formulation::window, press::firm, verdict::doubtful, 87},
         {formulation::window, press::deep, verdict::missed, 92},
         {formulation::window, press::deep, verdict::shallow, 97},
         {formulation::window, press::deep, verdict::deep, 3},
         {formulation::window, press::deep, verdict::doubtful, 56},
     },
     29, 0, 6.0e-6},
    {"file", "cad_part", 700,
     {
         {formulation::least_motion, press::graze, verdict::doubtful, 1},
         {formulation::least_motion, press::light, verdict::missed, 6},
         {formulation::least_motion, press::light, verdict::shallow, 18},
         {formulation::least_motion, press::light, verdict::doubtful, 299},
         {formulation::least_motion, press::firm, verdict::shallow, 12},
         {formulation::least_motion, press::firm, verdict::doubtful, 199},
         {formulation::least_motion, press::deep, verdict::shallow, 1},
         {formulation::least_motion, press::deep, verdict::deep, 2},
         {formulation::least_motion, press::deep, verdict::doubtful, 15},
         {formulation::window, press::graze, verdict::deep, 4},
         {formulation::window, press::graze, verdict::doubtful, 5},
         {formulation::window, press::light, verdict::deep, 8},
         {formulation::window, press::light, verdict::pulls, 7},
         {formulation::window, press::light, verdict::doubtful, 182},
         {formulation::window, press::firm, verdict::deep, 34},
         {formulation::window, press::firm, verdict::pulls, 14},
         {formulation::window, press::firm, verdict::doubtful, 72},
         {formulation::window, press::deep, verdict::missed, 8},
         {formulation::window, press::deep, verdict::shallow, 1},
         {formulation::window, press::deep, verdict::deep, 40},
         {formulation::window, press::deep, verdict::doubtful, 17},
     },
     2, 0, 28.6e-6},
    {"hammer", "torus", 700,
     {
         {formulation::least_motion, press::graze, verdict::doubtful, 2},
         {formulation::least_motion, press::light, verdict::doubtful, 28},
         {formulation::least_motion, press::firm, verdict::doubtful, 41},
         {formulation::least_motion, press::deep, verdict::doubtful, 28},
         {formulation::window, press::graze, verdict::pulls, 1},
         {formulation::window, press::graze, verdict::doubtful, 7},
         {formulation::window, press::light, verdict::shallow, 1},
         {formulation::window, press::light, verdict::pulls, 1},
         {formulation::window, press::light, verdict::doubtful, 78},
         {formulation::window, press::firm, verdict::deep, 2},
         {formulation::window, press::firm, verdict::pulls, 1},
         {formulation::window, press::firm, verdict::doubtful, 61},
         {formulation::window, press::deep, verdict::missed, 1},
         {formulation::window, press::deep, verdict::deep, 8},
         {formulation::window, press::deep, verdict::doubtful, 36},
     },
     24, 1, 7.3e-6},
};

inline const std::vector<known_pair> known_real_pairs{
    {"igea", "rocker-arm", 700,
     {
         {formulation::least_motion, press::light, verdict::doubtful, 24},
         {formulation::least_motion, press::firm, verdict::pulls, 1},
         {formulation::least_motion, press::firm, verdict::doubtful, 23},
         {formulation::least_motion, press::deep, verdict::doubtful, 2},
         {formulation::window, press::graze, verdict::deep, 1},
         {formulation::window, press::graze, verdict::doubtful, 5},
         {formulation::window, press::light, verdict::deep, 1},
         {formulation::window, press::light, verdict::pulls, 1},
         {formulation::window, press::light, verdict::doubtful, 12},
         {formulation::window, press::firm, verdict::deep, 4},
         {formulation::window, press::firm, verdict::doubtful, 18},
         {formulation::window, press::deep, verdict::deep, 29},
         {formulation::window, press::deep, verdict::doubtful, 9},
     },
     0, 0, 25.4e-6},
    {"stanford-bunny", "igea", 700,
     {
         {formulation::least_motion, press::light, verdict::doubtful, 13},
         {formulation::least_motion, press::firm, verdict::doubtful, 13},
         {formulation::least_motion, press::deep, verdict::doubtful, 6},
         {formulation::window, press::graze, verdict::doubtful, 11},
         {formulation::window, press::light, verdict::deep, 1},
         {formulation::window, press::light, verdict::doubtful, 25},
         {formulation::window, press::firm, verdict::missed, 1},
         {formulation::window, press::firm, verdict::deep, 6},
         {formulation::window, press::firm, verdict::pulls, 1},
         {formulation::window, press::firm, verdict::doubtful, 23},
         {formulation::window, press::deep, verdict::deep, 33},
         {formulation::window, press::deep, verdict::doubtful, 13},
     },
     0, 0, 25.9e-6},
    {"rocker-arm", "stanford-bunny", 700,
     {
         {formulation::least_motion, press::light, verdict::doubtful, 26},
         {formulation::least_motion, press::firm, verdict::pulls, 1},
         {formulation::least_motion, press::firm, verdict::doubtful, 23},
         {formulation::least_motion, press::deep, verdict::deep, 3},
         {formulation::least_motion, press::deep, verdict::doubtful, 1},
         {formulation::window, press::drawn_back, verdict::doubtful, 5},
         {formulation::window, press::graze, verdict::deep, 11},
         {formulation::window, press::graze, verdict::doubtful, 18},
         {formulation::window, press::light, verdict::deep, 14},
         {formulation::window, press::light, verdict::doubtful, 37},
         {formulation::window, press::firm, verdict::deep, 37},
         {formulation::window, press::firm, verdict::pulls, 1},
         {formulation::window, press::firm, verdict::doubtful, 21},
         {formulation::window, press::deep, verdict::deep, 95},
         {formulation::window, press::deep, verdict::doubtful, 17},
     },
     2, 0, 30.8e-6},
};

/// The worst pose of each kind.
inline const std::vector<known_defect> known_benchmark_defects{
    {"block", "gear", 1, 696, formulation::least_motion, press::light, verdict::missed, 0.1423e-3},
    {"block", "gear", 1, 2, formulation::least_motion, press::light, verdict::shallow, 0.2776e-3},
    {"block", "gear", 1, 83, formulation::least_motion, press::firm, verdict::missed, 0.1222e-3},
    {"block", "gear", 1, 105, formulation::least_motion, press::firm, verdict::shallow, 0.1581e-3},
    {"block", "gear", 1, 419, formulation::least_motion, press::firm, verdict::pulls, 0.0637e-3},
    {"block", "gear", 1, 232, formulation::least_motion, press::deep, verdict::shallow, 0.0849e-3},
    {"block", "gear", 1, 380, formulation::window, press::graze, verdict::pulls, 0.0170e-3},
    {"block", "gear", 1, 78, formulation::window, press::light, verdict::missed, 0.1587e-3},
    {"block", "gear", 1, 2, formulation::window, press::light, verdict::shallow, 0.2426e-3},
    {"block", "gear", 1, 26, formulation::window, press::light, verdict::pulls, 0.6712e-3},
    {"block", "gear", 1, 78, formulation::window, press::firm, verdict::shallow, 0.2146e-3},
    {"block", "gear", 1, 195, formulation::window, press::firm, verdict::deep, 0.1254e-3},
    {"block", "gear", 1, 443, formulation::window, press::firm, verdict::pulls, 2.1762e-3},
    {"block", "gear", 1, 509, formulation::window, press::deep, verdict::missed, 7.2122e-3},
    {"block", "gear", 1, 174, formulation::window, press::deep, verdict::shallow, 0.1805e-3},
    {"block", "gear", 1, 29, formulation::window, press::deep, verdict::deep, 0.2416e-3},
    {"file", "cad_part", 1, 148, formulation::least_motion, press::light, verdict::missed, 0.0278e-3},
    {"file", "cad_part", 1, 631, formulation::least_motion, press::light, verdict::shallow, 0.1238e-3},
    {"file", "cad_part", 1, 594, formulation::least_motion, press::firm, verdict::shallow, 0.0557e-3},
    {"file", "cad_part", 1, 186, formulation::least_motion, press::deep, verdict::shallow, 0.2255e-3},
    {"file", "cad_part", 1, 555, formulation::least_motion, press::deep, verdict::deep, 9.3676e-3},
    {"file", "cad_part", 1, 345, formulation::window, press::graze, verdict::deep, 11.2178e-3},
    {"file", "cad_part", 1, 345, formulation::window, press::light, verdict::deep, 11.4568e-3},
    {"file", "cad_part", 1, 260, formulation::window, press::light, verdict::pulls, 0.6205e-3},
    {"file", "cad_part", 1, 154, formulation::window, press::firm, verdict::deep, 14.6553e-3},
    {"file", "cad_part", 1, 579, formulation::window, press::firm, verdict::pulls, 2.1643e-3},
    {"file", "cad_part", 1, 527, formulation::window, press::deep, verdict::missed, 6.9227e-3},
    {"file", "cad_part", 1, 22, formulation::window, press::deep, verdict::shallow, 0.0385e-3},
    {"file", "cad_part", 1, 386, formulation::window, press::deep, verdict::deep, 20.8809e-3},
    {"hammer", "torus", 1, 681, formulation::window, press::graze, verdict::pulls, 0.0474e-3},
    {"hammer", "torus", 1, 56, formulation::window, press::light, verdict::shallow, 0.0390e-3},
    {"hammer", "torus", 1, 613, formulation::window, press::light, verdict::pulls, 0.0983e-3},
    {"hammer", "torus", 1, 523, formulation::window, press::firm, verdict::deep, 1.0419e-3},
    {"hammer", "torus", 1, 163, formulation::window, press::firm, verdict::pulls, 0.8772e-3},
    {"hammer", "torus", 1, 218, formulation::window, press::deep, verdict::missed, 8.5498e-3},
    {"hammer", "torus", 1, 590, formulation::window, press::deep, verdict::deep, 12.9688e-3},
};

inline const std::vector<known_defect> known_real_defects{
    {"igea", "rocker-arm", 1, 430, formulation::least_motion, press::firm, verdict::pulls, 0.0822e-3},
    {"igea", "rocker-arm", 1, 143, formulation::window, press::graze, verdict::deep, 0.1153e-3},
    {"igea", "rocker-arm", 1, 143, formulation::window, press::light, verdict::deep, 0.8265e-3},
    {"igea", "rocker-arm", 1, 341, formulation::window, press::light, verdict::pulls, 0.1321e-3},
    {"igea", "rocker-arm", 1, 283, formulation::window, press::firm, verdict::deep, 5.1469e-3},
    {"igea", "rocker-arm", 1, 61, formulation::window, press::deep, verdict::deep, 29.8290e-3},
    {"stanford-bunny", "igea", 1, 395, formulation::window, press::light, verdict::deep, 2.9333e-3},
    {"stanford-bunny", "igea", 1, 487, formulation::window, press::firm, verdict::missed, 0.2325e-3},
    {"stanford-bunny", "igea", 1, 395, formulation::window, press::firm, verdict::deep, 3.7317e-3},
    {"stanford-bunny", "igea", 1, 210, formulation::window, press::firm, verdict::pulls, 0.6794e-3},
    {"stanford-bunny", "igea", 1, 309, formulation::window, press::deep, verdict::deep, 25.6173e-3},
    {"rocker-arm", "stanford-bunny", 1, 448, formulation::least_motion, press::firm, verdict::pulls, 0.8327e-3},
    {"rocker-arm", "stanford-bunny", 1, 161, formulation::least_motion, press::deep, verdict::deep, 8.7342e-3},
    {"rocker-arm", "stanford-bunny", 1, 412, formulation::window, press::graze, verdict::deep, 3.3873e-3},
    {"rocker-arm", "stanford-bunny", 1, 412, formulation::window, press::light, verdict::deep, 6.6737e-3},
    {"rocker-arm", "stanford-bunny", 1, 612, formulation::window, press::firm, verdict::deep, 11.6200e-3},
    {"rocker-arm", "stanford-bunny", 1, 274, formulation::window, press::firm, verdict::pulls, 0.6382e-3},
    {"rocker-arm", "stanford-bunny", 1, 212, formulation::window, press::deep, verdict::deep, 50.5436e-3},
};
// clang-format on

/// Poses at which a contact in the window of the library's own finder was further from the originals than bakes and
/// samples explain: those that showed first how much depended on seeds.
struct known_pose {
  const char *probe, *fixed, *found_by;
  pose T_wa;
  double steepest;  ///< slope up to which a bake's error counts along n
  double excess_m;  ///< beyond the bound, of the worst contact
};
inline const known_pose file_on_cad_part{
    "file",
    "cad_part",
    "seed 52 of the sampler that asked the finder",
    {{0.28980306864046546, 0.44363215101733211, -0.49000998129141743, 0.69216682542945485},
     {-0.014369602449798638, 0.012713639838822463, 0.05927704959546954}},
    1.0,
    0.4985e-3};
inline const known_pose bunny_on_igea{
    "stanford-bunny",
    "igea",
    "pose 70 of seed 32 of the sampler that asked the finder",
    {{-0.52650254943863994, -0.30438157425211504, 0.76886673136985662, -0.19746106472682012},
     {-0.0038577844537357395, -0.08706643974452144, 0.039620197201438535}},
    3.0,
    0.2992e-3};

}  // namespace asperity::oracle
