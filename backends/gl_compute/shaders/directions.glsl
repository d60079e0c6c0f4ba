// One group of invocations for each pose: of the planes that its leaves left, the deepest of each direction, the deepest
// of all first. The leaves came in any order, so that of planes equally deep the one of the lower sample is taken.

layout(local_size_x = GROUP_SIZE) in;

layout(std430, binding = 2) readonly buffer body_block { real bodies[]; };
layout(std430, binding = 4) readonly buffer plane_block { real planes[]; };
layout(std430, binding = 5) buffer found_block { int found[]; };
layout(std430, binding = 6) writeonly buffer answer_block { real answers[]; };
layout(std430, binding = 7) writeonly buffer told_block { int told[]; };

uniform int first_pose;
uniform int room;
uniform int at_once;

shared real shared_depth[GROUP_SIZE];
shared int shared_slot[GROUP_SIZE];
shared rvec3 taken_n[MOST_DIRECTIONS];
shared int taken_body[MOST_DIRECTIONS];
shared int taken;
shared bool is_over;

// Meetings of one fixed body are neighbours: the probe's samples, then its own.
int body_of(int meeting) { return meeting / 2; }

bool goes_before(int here, real depth_a, int slot_a, real depth_b, int slot_b) {
  if (slot_a < 0 || slot_b < 0) return slot_a >= 0;
  if (depth_a != depth_b) return depth_a > depth_b;
  int a = at_once + (here * room + slot_a) * PLANE_INTEGERS, b = at_once + (here * room + slot_b) * PLANE_INTEGERS;
  return found[a] < found[b] || (found[a] == found[b] && found[a + 1] < found[b + 1]);
}

rvec3 direction(int plane) { return normalize(rvec3(planes[plane + 1], planes[plane + 2], planes[plane + 3])); }

void main() {
  int here = int(gl_WorkGroupID.x), pose = first_pose + here, local = int(gl_LocalInvocationID.x);
  int all = found[here], kept = min(all, room);
  real same = bodies[SCENE_SAME_DIRECTION];
  if (local == 0) {
    taken = 0;
    is_over = kept == 0;
  }
  barrier();
  while (!is_over) {
    real depth = real(0.0);
    int slot = -1;
    for (int i = local; i < kept; i += GROUP_SIZE) {
      int plane = (here * room + i) * PLANE_NUMBERS;
      if (!goes_before(here, planes[plane], i, depth, slot)) continue;
      rvec3 n = direction(plane);
      int body = body_of(found[at_once + (here * room + i) * PLANE_INTEGERS]);
      bool known = false;
      for (int t = 0; t < taken; ++t) known = known || (taken_body[t] == body && dot(taken_n[t], n) >= same);
      if (known) continue;
      depth = planes[plane];
      slot = i;
    }
    shared_depth[local] = depth;
    shared_slot[local] = slot;
    barrier();
    if (local == 0) {
      for (int k = 1; k < GROUP_SIZE; ++k) {
        if (goes_before(here, shared_depth[k], shared_slot[k], depth, slot)) {
          depth = shared_depth[k];
          slot = shared_slot[k];
        }
      }
      if (slot >= 0) {
        int plane = (here * room + slot) * PLANE_NUMBERS, id = at_once + (here * room + slot) * PLANE_INTEGERS;
        int to = (pose * MOST_DIRECTIONS + taken) * PLANE_NUMBERS;
        for (int k = 0; k < PLANE_NUMBERS; ++k) answers[to + k] = planes[plane + k];
        int which = pose * TOLD_INTEGERS + TOLD_PLANES + taken * PLANE_INTEGERS;
        told[which] = found[id];
        told[which + 1] = found[id + 1];
        taken_n[taken] = direction(plane);
        taken_body[taken] = body_of(found[id]);
        ++taken;
      }
      is_over = slot < 0 || taken == MOST_DIRECTIONS;
    }
    barrier();
  }
  if (local == 0) {
    told[pose * TOLD_INTEGERS + TOLD_COUNT] = taken;
    told[pose * TOLD_INTEGERS + TOLD_LEFT_OUT] = all - kept;
    found[here] = 0;  // for the next call
  }
}
