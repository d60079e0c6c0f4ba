// A triangle that covers everything: what of it is drawn, the scissor says.

#ifdef DEPTH_FROM_VERTEX
uniform float threshold;  // level / TOP_LEVEL
#endif

void main() {
  vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
#ifdef DEPTH_FROM_VERTEX
  gl_Position = vec4(corner, threshold, 1.0);
#else
  gl_Position = vec4(corner, 0.0, 1.0);
#endif
}
