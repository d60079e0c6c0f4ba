// Height of the textured surface over one sample, in half sizes of the window: the texel that belongs to the coarse
// hit, projected onto n (paper, Eq. 8).

flat in vec2 tile;
flat in vec4 edge_0, edge_1, edge_2, texel_x, texel_y, axis, near_centre;

layout(location = 0) out vec4 height;

layout(binding = 0) uniform sampler2D texture_a;
layout(binding = 1) uniform sampler2D texture_b;
uniform ivec2 tile_samples;  // samples per side of a tile, and of its margin
uniform ivec2 mirrored;      // which quarter of the tile is drawn; 0 where tiles are not packed

vec4 texel_of(bool probe, ivec2 at) { return probe ? texelFetch(texture_a, at, 0) : texelFetch(texture_b, at, 0); }

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy) - ivec2(tile);
  ivec2 sample_at = pixel + mirrored * (tile_samples.x - 1 - 2 * pixel);
  float samples = float(tile_samples.x - 2 * tile_samples.y);
  vec3 uv = vec3((vec2(sample_at - tile_samples.y) + 0.5) * (2.0 / samples) - 1.0, 1.0);
  // The rasteriser was given a shade more than the triangle; these decide. An edge belongs to both its triangles.
  float inside = min(min(dot(edge_0.xyz, uv), dot(edge_1.xyz, uv)), dot(edge_2.xyz, uv));
  if (inside < -1e-7) discard;

  bool probe = edge_2.w > 0.0;
  ivec2 base = ivec2(edge_0.w, edge_1.w);
  vec2 z = vec2(dot(texel_x.xyz, uv), dot(texel_y.xyz, uv));
  ivec2 size = probe ? textureSize(texture_a, 0) : textureSize(texture_b, 0);
  ivec2 next = min(size - 1, ivec2(1));
  ivec2 place = clamp(base + ivec2(floor(clamp(z, vec2(-1e6), vec2(1e6)))), ivec2(0), max(size - 2, ivec2(0)));
  vec4 t00 = texel_of(probe, place);
  vec4 t10 = texel_of(probe, place + ivec2(next.x, 0));
  vec4 t01 = texel_of(probe, place + ivec2(0, next.y));
  vec4 t11 = texel_of(probe, place + next);
  vec2 f = clamp(z - vec2(place - base), vec2(0.0), vec2(1.0));
  float along_x = dot(axis.xyz, t10.xyz - t00.xyz);
  float along_y = dot(axis.xyz, t01.xyz - t00.xyz);
  float twist = dot(axis.xyz, (t11.xyz - t01.xyz) - (t10.xyz - t00.xyz));
  // Texels and near_centre are single precision: their difference loses nothing. What near_centre is off the window's
  // centre comes as a height, because as a vector it would be lost to a compiler that sums up the two first.
  float h = dot(axis.xyz, t00.xyz - near_centre.xyz) - near_centre.w + f.x * (along_x + f.y * twist) + f.y * along_y;
  bool whole = t00.w * t10.w * t01.w * t11.w > 0.5;
  height = vec4(whole ? h : BAD_TEXEL);

  // Of several layers the probe's highest and the fixed body's lowest counts, by coarse height.
  float coarse = edge_2.w * dot(vec3(texel_y.w, axis.w, texel_x.w), uv);
  gl_FragDepth = 0.5 + 0.5 * coarse / (1.0 + abs(coarse));
}
