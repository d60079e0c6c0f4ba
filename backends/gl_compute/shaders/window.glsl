// What a job reads: numbers, integers, textures; and a body seen in the window's coordinates.
//
// Lengths are in half sizes of the window, measured from its centre, and texel positions from a texel near that centre, so
// that every number here is small whatever the size of the body and its place in the world. The layout of a job, a
// triangle and an edge is that of job_layout.hpp.

layout(std430, binding = 0) readonly buffer number_block { real numbers[]; };
layout(std430, binding = 1) readonly buffer integer_block { int integers[]; };
layout(std430, binding = 2) writeonly buffer result_block { real results[]; };
layout(binding = 0) uniform sampler2D texture_a;
layout(binding = 1) uniform sampler2D texture_b;

uniform int first_job;
uniform int side;  // samples per side of the window

rvec3 numbers3(int at) { return rvec3(numbers[at], numbers[at + 1], numbers[at + 2]); }

// Body coordinates to window coordinates. Texels and `near` are single precision and close to each other: their
// difference loses nothing. What rounding `near` left over comes in window coordinates: as a vector to be taken off as
// well, it would be lost to a compiler that adds the two up first, which not every GLSL can forbid.
struct window_map {
  rvec3 u, v, n;
  rvec3 near;  // the window's centre in the body's frame, rounded
  rvec3 rest;  // what that leaves, in window coordinates
};

window_map read_map(int at) {
  return window_map(numbers3(at), numbers3(at + 3), numbers3(at + 6), numbers3(at + 9), numbers3(at + 12));
}

rvec3 direction(window_map map, rvec3 d) { return rvec3(dot(map.u, d), dot(map.v, d), dot(map.n, d)); }

rvec3 point(window_map map, vec3 p) { return direction(map, rvec3(p) - map.near) - map.rest; }

// f(u, v) over a projected triangle
real affine(int at, rvec2 uv) { return numbers[at] + uv.x * numbers[at + 1] + uv.y * numbers[at + 2]; }

real smooth_step(real x) {
  real t = clamp(x, real(0.0), real(1.0));
  return t * t * (real(3.0) - real(2.0) * t);
}

real smooth_step_slope(real x) {
  return x <= real(0.0) || x >= real(1.0) ? real(0.0) : real(6.0) * x * (real(1.0) - x);
}

real coordinate(int i) { return (real(i) + real(0.5)) * (real(2.0) / real(side)) - real(1.0); }
