// One invocation for each leaf of samples at each pose: the plane of the leaf's deepest sample, where one is deeper than
// `above`. Meetings (samples of one body in another's field) are in z, poses in y, leaves in x.

layout(local_size_x = GROUP_SIZE) in;

layout(std430, binding = 3) readonly buffer pose_block { real places[]; };
layout(std430, binding = 4) writeonly buffer plane_block { real planes[]; };
layout(std430, binding = 5) buffer found_block { int found[]; };

uniform int first_pose;  // of this dispatch
uniform int meetings;
uniform int room;       // planes of a pose
uniform int at_once;    // poses of a dispatch: their counts come first in `found`

rvec3 place_vector(int at) { return rvec3(places[at], places[at + 1], places[at + 2]); }

void main() {
  int here = int(gl_WorkGroupID.y), meeting = int(gl_WorkGroupID.z);
  int m = meeting * MEETING_INTEGERS;
  int leaf = int(gl_GlobalInvocationID.x);
  if (leaf >= table[m + MEETING_LEAVES]) return;
  field_place y = field_place(table[m + MEETING_FIELD_NUMBERS], table[m + MEETING_FIELD_INTEGERS]);
  int at = ((first_pose + here) * meetings + meeting) * PLACE_NUMBERS;
  rmat3 R_yx = rmat3(place_vector(at), place_vector(at + 3), place_vector(at + 6));
  rvec3 shift_y = place_vector(at + 9);
  real above = bodies[SCENE_ABOVE], shallow = bodies[SCENE_SHALLOW];

  int ball = table[m + MEETING_FIRST_BALL] + leaf * BALL_NUMBERS;
  rvec3 centre_y = R_yx * rvec3(nodes[ball], nodes[ball + 1], nodes[ball + 2]) + shift_y;
  if (!(most_near(y, centre_y, real(nodes[ball + 3])) > above)) return;

  int range = table[m + MEETING_FIRST_LEAF] + leaf * LEAF_INTEGERS;
  int first = table[range], count = table[range + 1];
  int best = -1;
  rvec3 best_slope = rvec3(0.0);
  for (int i = first; i < first + count; ++i) {
    int s = table[m + MEETING_FIRST_SAMPLE] + i * SAMPLE_NUMBERS;
    rvec3 p_y = R_yx * rvec3(nodes[s], nodes[s + 1], nodes[s + 2]) + shift_y;
    real depth;
    rvec3 slope;
    read_field(y, p_y, above, depth, slope);
    if (!(depth > above)) continue;
    real square = dot(slope, slope);
    if (!(square > real(LEAST_SLOPE * LEAST_SLOPE))) continue;
    real full = real(nodes[s + 6]), none = real(nodes[s + 7]);
    rvec3 axis_y = R_yx * rvec3(nodes[s + 3], nodes[s + 4], nodes[s + 5]);
    real cosine = dot(axis_y, slope) / sqrt(square);
    real share = full > none ? smooth_step((cosine - none) / (full - none)) : real(1.0);
    if (!(share > real(LEAST_SHARE)) && depth < shallow) continue;
    if (depth > real(0.0)) {
      if (depth < shallow) slope *= share;
      depth = share * min(depth, shallow) + max(real(0.0), depth - shallow);
    }
    if (!(depth > above)) continue;
    above = depth;
    best = i;
    best_slope = slope;
  }
  if (best < 0) return;
  int slot = atomicAdd(found[here], 1);
  if (slot >= room) return;
  rmat3 R_wy = rmat3(place_vector(at + 12), place_vector(at + 15), place_vector(at + 18));
  rvec3 slope_w = R_wy * best_slope;
  int plane = (here * room + slot) * PLANE_NUMBERS;
  planes[plane] = above;
  planes[plane + 1] = slope_w.x;
  planes[plane + 2] = slope_w.y;
  planes[plane + 3] = slope_w.z;
  int id = at_once + (here * room + slot) * PLANE_INTEGERS;
  found[id] = meeting;
  found[id + 1] = best;
}
