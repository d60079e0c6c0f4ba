// Leaves samples for a query to count: those that both bodies have, or those with a texel that is no position.

layout(binding = 0) uniform sampler2D heights;
uniform ivec2 tile_a, tile_b;  // first pixels of the heights
uniform ivec2 tile_difference;
uniform ivec2 tile_samples;
uniform int quarter;  // whose shared samples; -1: the bad texels of all

const float none = NO_SURFACE * 0.5;

bool bad(float h) { return h < 1.5 * NO_SURFACE; }

// The fixed body's, or the probe's where the fixed body is.
bool bad_sample(float a, float b) { return bad(b) || (bad(a) && b > none); }

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy) - tile_difference + tile_samples.y;
  vec4 a = texelFetch(heights, tile_a + pixel, 0), b = texelFetch(heights, tile_b + pixel, 0);
  bool wanted = false;
  if (quarter >= 0) {
    wanted = a[quarter] > none && b[quarter] > none;
  } else {
#ifdef PACKED
    wanted = bad_sample(a.x, b.x) || bad_sample(a.y, b.y) || bad_sample(a.z, b.z) || bad_sample(a.w, b.w);
#else
    wanted = bad_sample(a.x, b.x);
#endif
  }
  if (!wanted) discard;
}
