// Passes the depth test where the stored level is larger.
//
// The threshold must be exactly a level. With depths from 0 to 1 in clip space the vertex stage can give it; from -1 to 1
// the viewport transform would make some thresholds wrong, so there it is written by hand, which is slower.

#ifdef DEPTH_FROM_VERTEX
void main() {}
#else
uniform float threshold;  // level / TOP_LEVEL

void main() { gl_FragDepth = threshold; }
#endif
