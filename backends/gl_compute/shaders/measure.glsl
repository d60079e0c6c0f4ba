// One group of invocations goes over GROUP_SAMPLES samples of one job, and leaves the deepest of them and its share of
// the soft maximum. What comes of the whole window is put together from the groups by read_back.cpp.
//
// A sum is kept relative to the largest effective depth seen so far, which only ever grows; nothing is stored per sample.
// The order of every sum is fixed, so the same job gives the same bits in whatever batch it is.

layout(local_size_x = GROUP_SIZE) in;

shared real shared_depth[GROUP_SIZE];
shared real shared_radius2[GROUP_SIZE];
shared int shared_index[GROUP_SIZE];
shared int shared_winner;
shared ivec3 shared_counts[GROUP_SIZE];  // samples, inner samples, bad ones
shared real shared_inner[GROUP_SIZE];

const real nothing = real(-1e30);

// A sample's claim to be the deepest: deeper, of equals nearer to the centre, then of lower index.
struct claim {
  real depth, radius2;
  int index;  // -1: none
};

bool goes_before(claim a, claim b) {
  if (a.index < 0 || b.index < 0) return a.index >= 0;
  if (a.depth != b.depth) return a.depth > b.depth;
  return a.radius2 < b.radius2 || (a.radius2 == b.radius2 && a.index < b.index);
}

int owner_of(int map, int i) {
  int pair = integers[map + i / 2];
  return (i % 2 == 0 ? pair : pair >> 16) & 0xffff;
}

#ifdef SOFT_MAX
shared real shared_top[GROUP_SIZE];
shared real shared_sums[SOFT_SUMS * GROUP_SIZE];

// Sum, five first and fifteen second moments of the gradient (u, v; about u, v, n). Its component along n is always 1.
struct soft_sum {
  real top;
  real value[SOFT_SUMS];
};

real weight_of(real depth, real top, real tau) { return real(exp(float((depth - top) / tau))); }

void add_sample(inout soft_sum to, real effective, real tau, rvec3 linear, rvec3 angular) {
  real w = real(1.0);
  if (effective > to.top) {
    real scale = to.top > nothing ? weight_of(to.top, effective, tau) : real(0.0);
    for (int k = 0; k < SOFT_SUMS; ++k) to.value[k] *= scale;
    to.top = effective;
  } else {
    w = weight_of(effective, to.top, tau);
  }
  real g[5] = real[5](linear.x, linear.y, angular.x, angular.y, angular.z);
  to.value[0] += w;
  int k = 6;
  for (int i = 0; i < 5; ++i) {
    to.value[1 + i] += w * g[i];
    for (int j = 0; j <= i; ++j) to.value[k++] += w * (g[i] * g[j]);
  }
}

// Derivative of the height over a sample by a motion of the probe: height_gradient() of height_lookup.hpp.
void height_gradient(surface_hit hit, int triangle, rvec2 uv, out rvec3 linear, out rvec3 angular) {
  if (hit.kind == hit_above) {
    rvec3 normal = cross(hit.along_x, hit.along_y);
    linear = rvec3(normal.xy / normal.z, real(1.0));
    angular = cross(hit.point, linear);
    return;
  }
  int x = triangle + TRIANGLE_TEXEL_X, y = triangle + TRIANGLE_TEXEL_Y;
  rvec3 slope = rvec3(hit.along_x.z * numbers[x + 1] + hit.along_y.z * numbers[y + 1],
                      hit.along_x.z * numbers[x + 2] + hit.along_y.z * numbers[y + 2], real(0.0));
  rvec3 n = rvec3(0.0, 0.0, 1.0);
  rvec3 coarse = rvec3(uv, affine(triangle + TRIANGLE_HEIGHT, uv));
  linear = n - slope;
  angular = cross(hit.point, n) - cross(coarse, slope);
}
#endif

void main() {
  int job = (first_job + int(gl_WorkGroupID.y)) * JOB_INTEGERS;
  int header = integers[job + JOB_HEADER];
  window_map map_a = read_map(header + HEADER_MAP_A), map_b = read_map(header + HEADER_MAP_B);
  patch_place place_a = patch_place(integers[job + JOB_TRIANGLES_A], integers[job + JOB_TRIANGLE_INTEGERS_A]);
  patch_place place_b = patch_place(integers[job + JOB_TRIANGLES_B], integers[job + JOB_TRIANGLE_INTEGERS_B]);
  int owners_a = integers[job + JOB_OWNERS_A], owners_b = integers[job + JOB_OWNERS_B];
  bool all_of_b = integers[job + JOB_ALL_OF_B] != 0;
#ifdef SOFT_MAX
  int edges = integers[job + JOB_EDGES], edges_a = integers[job + JOB_EDGE_COUNT_A];
  int edges_both = edges_a + integers[job + JOB_EDGE_COUNT_B];
  real tau = numbers[header + HEADER_TAU], width = numbers[header + HEADER_TAPER];
  soft_sum soft;
  soft.top = nothing;
  for (int k = 0; k < SOFT_SUMS; ++k) soft.value[k] = real(0.0);
#endif

  int local = int(gl_LocalInvocationID.x);
  int first = int(gl_WorkGroupID.x) * GROUP_SAMPLES;
  claim best = claim(nothing, real(0.0), -1);
  real best_inner = nothing;
  ivec2 best_base = ivec2(0);
  rvec2 best_texel = rvec2(0.0);
  ivec3 counts = ivec3(0);
  for (int i = first + local; i < min(first + GROUP_SAMPLES, side * side); i += GROUP_SIZE) {
    int owner_a = owner_of(owners_a, i), owner_b = owner_of(owners_b, i);
    if (owner_b == NO_OWNER || (owner_a == NO_OWNER && !all_of_b)) continue;
    int column = i % side, row = i / side;
    rvec2 uv = rvec2(coordinate(column), coordinate(row));
    surface_hit a = no_hit();
    real height_b = real(0.0);
    // The fixed body first: without it there is nothing to look up on the probe.
    for (int body = 1; body >= 0; --body) {
      bool fixed_body = body == 1;
      int owner = fixed_body ? owner_b : owner_a;
      if (owner == NO_OWNER) break;
      window_map map = map_a;
      patch_place place = place_a;
      if (fixed_body) {
        map = map_b;
        place = place_b;
      }
      surface_hit h = look_up(fixed_body, map, place, owner, uv);
      if (h.kind == hit_none) {
        counts.z = 1;
        break;
      }
      if (fixed_body) height_b = h.height;
      if (!fixed_body) a = h;
    }
    if (a.kind == hit_none) continue;
    real d = a.height - height_b;
    counts.x += 1;
    claim mine = claim(d, dot(uv, uv), i);
    if (goes_before(mine, best)) {
      best = mine;
      best_base = a.base;
      best_texel = a.texel;
    }
    if (row > 0 && column > 0 && row + 1 < side && column + 1 < side) {
      counts.y += 1;
      best_inner = max(best_inner, d);
    }
#ifdef SOFT_MAX
    int triangle_a = place_a.numbers + owner_a * TRIANGLE_NUMBERS;
    real mu = border_value(uv, width) * numbers[triangle_a + TRIANGLE_FACING] *
              numbers[place_b.numbers + owner_b * TRIANGLE_NUMBERS + TRIANGLE_FACING];
    if (!(mu > real(0.0))) continue;
    rvec3 fade_linear = rvec3(0.0), fade_angular = rvec3(0.0);
    mu *= edges_value(edges, edges_a, edges_both, uv, width, tau, fade_linear, fade_angular);
    if (!(mu > real(SMALLEST_WEIGHT))) continue;
    real effective = d + (mu < real(1.0) ? tau * real(log(float(mu))) : real(0.0));
    if ((effective - soft.top) < real(-40.0) * tau) continue;
    rvec3 linear, angular;
    height_gradient(a, triangle_a, uv, linear, angular);
#ifdef TAPER_GRADIENT
    linear += fade_linear;
    angular += fade_angular + tau * numbers3(triangle_a + TRIANGLE_FACING_TURN);
#endif
    add_sample(soft, effective, tau, linear, angular);
#endif
  }

  shared_depth[local] = best.depth;
  shared_radius2[local] = best.radius2;
  shared_index[local] = best.index;
  shared_counts[local] = counts;
  shared_inner[local] = best_inner;
#ifdef SOFT_MAX
  shared_top[local] = soft.top;
#endif
  barrier();
  int to = ((first_job + int(gl_WorkGroupID.y)) * int(gl_NumWorkGroups.x) + int(gl_WorkGroupID.x)) * RESULT_NUMBERS;
  if (local == 0) {
    int winner = 0;
    claim won = best;
    ivec3 sum = ivec3(0);
    real inner = nothing;
    for (int k = 0; k < GROUP_SIZE; ++k) {
      claim other = claim(shared_depth[k], shared_radius2[k], shared_index[k]);
      if (goes_before(other, won)) {
        winner = k;
        won = other;
      }
      sum += shared_counts[k];
      inner = max(inner, shared_inner[k]);
    }
    shared_winner = winner;
    results[to + RESULT_SAMPLES] = real(sum.x);
    results[to + RESULT_INNER_SAMPLES] = real(sum.y);
    results[to + RESULT_BAD] = real(sum.z);
    results[to + RESULT_INNER_DEPTH] = inner;
  }
#ifdef SOFT_MAX
  real top = nothing;
  for (int k = 0; k < GROUP_SIZE; ++k) top = max(top, shared_top[k]);
  real scale = soft.top > nothing ? weight_of(soft.top, top, tau) : real(0.0);
  for (int k = 0; k < SOFT_SUMS; ++k) shared_sums[k * GROUP_SIZE + local] = scale * soft.value[k];
#endif
  barrier();
  if (local == shared_winner) {
    results[to + RESULT_DEPTH] = best.depth;
    results[to + RESULT_INDEX] = real(best.index);
    results[to + RESULT_TEXEL] = best_texel.x;
    results[to + RESULT_TEXEL + 1] = best_texel.y;
    results[to + RESULT_BASE] = real(best_base.x);
    results[to + RESULT_BASE + 1] = real(best_base.y);
  }
#ifdef SOFT_MAX
  if (local == 0) results[to + RESULT_TOP] = top;
  if (local < SOFT_SUMS) {
    real sum = real(0.0);
    for (int k = 0; k < GROUP_SIZE; ++k) sum += shared_sums[local * GROUP_SIZE + k];
    results[to + RESULT_SUMS + local] = sum;
  }
#endif
}
