// Passes the depth test where the stored level is larger. Written by hand: a level that came through the viewport
// transform would be wrong for some thresholds.

uniform float threshold;  // level / TOP_LEVEL

void main() { gl_FragDepth = threshold; }
