// What of the surface under a texel the texel keeps. Component asperity::bake.
#pragma once

namespace asperity::bake {

/// Of the part of the original that a texel stands for. Detail finer than a texel cannot be kept; the choice is what
/// becomes of it. The paper (7.2) names the aliasing of `point` and leaves it.
enum class texel_filter {
  point,    ///< the point at the texel's middle: exact there, but detail finer than a texel turns into coarser waves
  mean,     ///< the average: no such waves, and the surface lies lower than its crests
  highest,  ///< the outermost: what a probe wider than a texel rests on
};

}  // namespace asperity::bake
