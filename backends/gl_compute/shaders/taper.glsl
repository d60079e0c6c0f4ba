// Weights that let samples fade in from silhouettes, patch boundaries and the window's border: edge_taper.hpp.

struct fade {
  real value;         // 1 - strength (1 - shape)
  real shape;         // smooth step of the distance
  real per_distance;  // d value / d distance
  rvec2 away;         // unit, from the edge to the sample
  rvec3 nearest;      // nearest point of the edge
};

fade fade_at(int edge, rvec2 uv, real width) {
  rvec3 from = numbers3(edge + EDGE_FROM);
  rvec3 along = numbers3(edge + EDGE_TO) - from;
  real strength = numbers[edge + EDGE_STRENGTH];
  real length2 = dot(along.xy, along.xy);
  real t = length2 > real(0.0) ? clamp(dot(uv - from.xy, along.xy) / length2, real(0.0), real(1.0)) : real(0.0);
  fade f = fade(real(1.0), real(1.0), real(0.0), rvec2(0.0), from + t * along);
  rvec2 d = uv - f.nearest.xy;
  real distance2 = dot(d, d);
  if (distance2 >= width * width) return f;
  real distance = sqrt(distance2);
  f.shape = smooth_step(distance / width);
  f.value = real(1.0) - strength * (real(1.0) - f.shape);
  f.per_distance = strength * smooth_step_slope(distance / width) / width;
  if (distance > real(0.0)) f.away = d / distance;
  return f;
}

real border_value(rvec2 uv, real width) {
#ifdef TAPER_WINDOW
  return smooth_step((real(1.0) - abs(uv.x)) / width) * smooth_step((real(1.0) - abs(uv.y)) / width);
#else
  return real(1.0);
#endif
}

// Weight of the edges of both bodies, the probe's first, and the gradient of the logarithm of the probe's part of it by
// the probe's motion: times tau, arms from the window's centre.
real edges_value(int edges, int probe_count, int count, rvec2 uv, real width, real tau, inout rvec3 linear,
                 inout rvec3 angular) {
  real value = real(1.0);
  for (int i = 0; i < count; ++i) {
    int edge = edges + i * EDGE_NUMBERS;
    fade f = fade_at(edge, uv, width);
    if (f.value >= real(1.0)) continue;
    value *= f.value;
#ifdef TAPER_GRADIENT
    if (i >= probe_count || !(f.value > real(0.0))) continue;
    rvec3 slope = rvec3(f.per_distance * f.away, real(0.0));
    linear -= tau / f.value * slope;
    angular -= tau / f.value * (cross(f.nearest, slope) + (real(1.0) - f.shape) * numbers3(edge + EDGE_TURN));
#endif
  }
  return value;
}
