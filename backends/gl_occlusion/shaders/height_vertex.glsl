// A coarse triangle, cut to its tile: one instance per triangle, its outline a fan of up to seven corners.
//
// Everything else about the triangle goes to the fragment stage unchanged. Interpolated, it would carry the error of
// the rasteriser's fixed-point corners: 14 quanta of a 16-bit depth buffer.

layout(location = 0) in vec4 corners_0_1;  // pixels of the tile
layout(location = 1) in vec4 corners_2_3;
layout(location = 2) in vec4 corners_4_5;
layout(location = 3) in vec4 corner_6_tile;  // and the tile's first pixel
layout(location = 4) in vec4 in_edge_0;      // and the base texel's column
layout(location = 5) in vec4 in_edge_1;      // and its row
layout(location = 6) in vec4 in_edge_2;      // and 1 for the probe, -1 for the fixed body
layout(location = 7) in vec4 in_texel_x;     // and the coarse height at the window's centre
layout(location = 8) in vec4 in_texel_y;     // and by u
layout(location = 9) in vec4 in_axis;        // and by v
layout(location = 10) in vec4 in_near;  // and the height that rounding it left over

flat out vec2 tile;
flat out vec4 edge_0, edge_1, edge_2, texel_x, texel_y, axis, near_centre;

uniform vec2 atlas_size;  // pixels

void main() {
  vec2 corner = corners_0_1.xy;
  if (gl_VertexID == 1) corner = corners_0_1.zw;
  if (gl_VertexID == 2) corner = corners_2_3.xy;
  if (gl_VertexID == 3) corner = corners_2_3.zw;
  if (gl_VertexID == 4) corner = corners_4_5.xy;
  if (gl_VertexID == 5) corner = corners_4_5.zw;
  if (gl_VertexID == 6) corner = corner_6_tile.xy;
  tile = corner_6_tile.zw;
  edge_0 = in_edge_0;
  edge_1 = in_edge_1;
  edge_2 = in_edge_2;
  texel_x = in_texel_x;
  texel_y = in_texel_y;
  axis = in_axis;
  near_centre = in_near;
  gl_Position = vec4((tile + corner) / atlas_size * 2.0 - 1.0, 0.0, 1.0);
}
