// h_A - h_B over one sample as a level of the depth buffer. Level 0: no sample; 1: below the range; TOP: above it.
// Packed, a pixel holds the largest of the four samples that lie in its place in the four quarters.

flat in vec4 tiles, scale, motion;

layout(binding = 0) uniform sampler2D heights;
uniform ivec2 tile_samples;  // samples per side of a tile of heights, and of its margin

const float none = NO_SURFACE * 0.5;

// Height at a sample of a tile, counted from the margin's corner.
float height_at(ivec2 tile, ivec2 at) {
  if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, ivec2(tile_samples.x)))) return NO_SURFACE;
#ifdef PACKED
  ivec2 far = ivec2(greaterThanEqual(at, ivec2(tile_samples.x / 2)));
  return texelFetch(heights, tile + at + far * (tile_samples.x - 1 - 2 * at), 0)[far.x + 2 * far.y];
#else
  return texelFetch(heights, tile + at, 0).r;
#endif
}

// Height of the probe after a turn about n or a shift, out of the heights that it had before.
float moved_height(ivec2 tile, ivec2 at) {
  vec2 centre = vec2(0.5 * float(tile_samples.x - 1));
  vec2 from = vec2(at) - centre;
  from = vec2(motion.x * from.x + motion.y * from.y, motion.x * from.y - motion.y * from.x) + centre - motion.zw;
  if (motion.y == 0.0) return height_at(tile, ivec2(floor(from + 0.5)));
  ivec2 low = ivec2(floor(from));
  vec2 f = from - vec2(low);
  float h00 = height_at(tile, low), h10 = height_at(tile, low + ivec2(1, 0));
  float h01 = height_at(tile, low + ivec2(0, 1)), h11 = height_at(tile, low + ivec2(1, 1));
  if (min(min(h00, h10), min(h01, h11)) <= none) return height_at(tile, ivec2(floor(from + 0.5)));
  return mix(mix(h00, h10, f.x), mix(h01, h11, f.x), f.y);
}

float level_of(float a, float b) {
  if (a <= none || b <= none) return 0.0;
  return clamp(floor((a - b - scale.z) * scale.w + (FIRST_LEVEL + 0.5)), 1.0, TOP_LEVEL);
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy) - ivec2(tiles.xy) + tile_samples.y;
  ivec2 tile_a = ivec2(tiles.zw), tile_b = ivec2(scale.xy);
  bool still = motion.y == 0.0 && motion.zw == vec2(0.0);
  float level = 0.0;
#ifdef PACKED
  vec4 b = texelFetch(heights, tile_b + pixel, 0);
  vec4 a;
  if (still) {
    a = texelFetch(heights, tile_a + pixel, 0);
  } else {
    int last = tile_samples.x - 1;
    a = vec4(moved_height(tile_a, pixel), moved_height(tile_a, ivec2(last - pixel.x, pixel.y)),
             moved_height(tile_a, ivec2(pixel.x, last - pixel.y)), moved_height(tile_a, last - pixel));
  }
  level = max(max(level_of(a.x, b.x), level_of(a.y, b.y)), max(level_of(a.z, b.z), level_of(a.w, b.w)));
#else
  float b = height_at(tile_b, pixel);
  level = level_of(still ? height_at(tile_a, pixel) : moved_height(tile_a, pixel), b);
#endif
  gl_FragDepth = level / TOP_LEVEL;
}
