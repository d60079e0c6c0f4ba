// One tile of height differences per instance.

layout(location = 0) in vec4 in_tiles;   // first pixels of the tile, and of the probe's heights
layout(location = 1) in vec4 in_scale;   // first pixel of the fixed body's heights; lowest difference; levels per unit
layout(location = 2) in vec4 in_motion;  // cosine and sine of a turn about n, shift in samples

flat out vec4 tiles, scale, motion;

uniform vec2 atlas_size;
uniform float tile_pixels;

void main() {
  tiles = in_tiles;
  scale = in_scale;
  motion = in_motion;
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * tile_pixels;
  gl_Position = vec4((in_tiles.xy + corner) / atlas_size * 2.0 - 1.0, 0.0, 1.0);
}
