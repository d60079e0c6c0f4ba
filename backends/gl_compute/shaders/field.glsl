// The depth field of a body, as asperity/field has it: a smooth signed distance and the relief of the fine surface over it.
//
// Numbers of all bodies lie one after the other in `nodes`: grids, bricks, samples and the balls of leaves. What says
// where each begins is in `table`, what is to be exact in `bodies`. The layout is that of plane_layout.hpp.

layout(std430, binding = 0) readonly buffer node_block { float nodes[]; };
layout(std430, binding = 1) readonly buffer table_block { int table[]; };
layout(std430, binding = 2) readonly buffer body_block { real bodies[]; };

struct field_place {
  int numbers, integers;  // of a body in `bodies` and `table`
};

rvec3 body_vector(int at) { return rvec3(bodies[at], bodies[at + 1], bodies[at + 2]); }

struct smooth_reading {
  real value;
  rvec3 slope;
  rmat3 bend;  // second derivatives, symmetric
};

void cubic(real f, out real value[4], out real slope[4], out real bend[4]) {
  real g = real(1.0) - f, third = real(2.0) / real(3.0), sixth = real(1.0) / real(6.0), half_ = real(0.5);
  value[0] = g * g * g * sixth;
  value[1] = third + f * f * (half_ * f - real(1.0));
  value[2] = third + g * g * (half_ * g - real(1.0));
  value[3] = f * f * f * sixth;
  slope[0] = -half_ * g * g;
  slope[1] = f * (real(1.5) * f - real(2.0));
  slope[2] = -g * (real(1.5) * g - real(2.0));
  slope[3] = half_ * f * f;
  bend[0] = g;
  bend[1] = real(3.0) * f - real(2.0);
  bend[2] = real(3.0) * g - real(2.0);
  bend[3] = f;
}

void quadratic(real f, out real value[3], out real slope[3]) {
  real half_ = real(0.5);
  value[0] = half_ * (half_ - f) * (half_ - f);
  value[1] = real(0.75) - f * f;
  value[2] = half_ * (half_ + f) * (half_ + f);
  slope[0] = f - half_;
  slope[1] = real(-2.0) * f;
  slope[2] = f + half_;
}

ivec3 node_counts(field_place y) {
  return ivec3(table[y.integers + BODY_NODES], table[y.integers + BODY_NODES + 1], table[y.integers + BODY_NODES + 2]);
}

rvec3 clamped(field_place y, rvec3 p) {
  rvec3 low = body_vector(y.numbers + BODY_LOW);
  real pitch = bodies[y.numbers + BODY_PITCH];
  return min(max(low + rvec3(pitch), p), low + (rvec3(node_counts(y)) - rvec3(2.0)) * pitch);
}

smooth_reading read_smooth(field_place y, rvec3 p) {
  ivec3 count = node_counts(y);
  real pitch = bodies[y.numbers + BODY_PITCH], per_pitch = real(1.0) / pitch;
  rvec3 c = clamped(y, p);
  rvec3 g = (c - body_vector(y.numbers + BODY_LOW)) * per_pitch;
  ivec3 cell = ivec3(min(max(rvec3(1.0), g), rvec3(count - ivec3(3))));
  rvec3 f = g - rvec3(cell);
  real wx[4], sx[4], bx[4], wy[4], sy[4], by[4], wz[4], sz[4], bz[4];
  cubic(f.x, wx, sx, bx);
  cubic(f.y, wy, sy, by);
  cubic(f.z, wz, sz, bz);
  int first = table[y.integers + BODY_FIRST_NODE] + ((cell.z - 1) * count.y + cell.y - 1) * count.x + cell.x - 1;
  real v = real(0.0);
  rvec3 d = rvec3(0.0), dd = rvec3(0.0), mixed = rvec3(0.0);  // xx, yy, zz; xy, xz, yz
  for (int k = 0; k < 4; ++k) {
    real s = real(0.0), s_x = real(0.0), s_y = real(0.0), s_xx = real(0.0), s_xy = real(0.0), s_yy = real(0.0);
    for (int j = 0; j < 4; ++j) {
      int at = first + (k * count.y + j) * count.x;
      real n0 = real(nodes[at]), n1 = real(nodes[at + 1]), n2 = real(nodes[at + 2]), n3 = real(nodes[at + 3]);
      real r = wx[0] * n0 + wx[1] * n1 + wx[2] * n2 + wx[3] * n3;
      real r_x = sx[0] * n0 + sx[1] * n1 + sx[2] * n2 + sx[3] * n3;
      real r_xx = bx[0] * n0 + bx[1] * n1 + bx[2] * n2 + bx[3] * n3;
      s += wy[j] * r;
      s_x += wy[j] * r_x;
      s_xx += wy[j] * r_xx;
      s_y += sy[j] * r;
      s_xy += sy[j] * r_x;
      s_yy += by[j] * r;
    }
    v += wz[k] * s;
    d += rvec3(wz[k] * s_x, wz[k] * s_y, sz[k] * s);
    dd += rvec3(wz[k] * s_xx, wz[k] * s_yy, bz[k] * s);
    mixed += rvec3(wz[k] * s_xy, sz[k] * s_x, sz[k] * s_y);
  }
  real per_pitch2 = per_pitch * per_pitch;
  dd *= per_pitch2;
  mixed *= per_pitch2;
  smooth_reading out_;
  out_.value = v;
  out_.slope = per_pitch * d;
  out_.bend = rmat3(dd.x, mixed.x, mixed.y, mixed.x, dd.y, mixed.z, mixed.y, mixed.z, dd.z);
  rvec3 beyond = p - c;
  if (beyond == rvec3(0.0)) return out_;
  // The relief ends with the grid, so that only value and slope count from here on.
  real away = length(beyond);
  // By name, not by index: NVIDIA's compiler does not link a write to an indexed component of a dvec3.
  if (beyond.x != real(0.0)) out_.slope.x = real(0.0);
  if (beyond.y != real(0.0)) out_.slope.y = real(0.0);
  if (beyond.z != real(0.0)) out_.slope.z = real(0.0);
  out_.value -= away;
  out_.slope -= beyond / away;
  return out_;
}

// The relief's spline and its slope; both are zero beyond the box.
void read_bricks(field_place y, rvec3 p, out real value, out rvec3 slope) {
  value = real(0.0);
  slope = rvec3(0.0);
  real pitch = bodies[y.numbers + BODY_RELIEF_PITCH];
  ivec3 along = ivec3(table[y.integers + BODY_BRICKS], table[y.integers + BODY_BRICKS + 1],
                      table[y.integers + BODY_BRICKS + 2]);
  rvec3 g = (p - body_vector(y.numbers + BODY_RELIEF_LOW)) / pitch + rvec3(0.5);
  rvec3 end = rvec3(BRICK_SIDE * along) - rvec3(1.0);
  if (!(g.x >= real(1.0) && g.y >= real(1.0) && g.z >= real(1.0) && g.x < end.x && g.y < end.y && g.z < end.z)) return;
  ivec3 middle = ivec3(g);
  rvec3 f = g - rvec3(0.5) - rvec3(middle);
  real wx[3], sx[3], wy[3], sy[3], wz[3], sz[3];
  quadratic(f.x, wx, sx);
  quadratic(f.y, wy, sy);
  quadratic(f.z, wz, sz);
  int index = table[y.integers + BODY_FIRST_INDEX], bricks = table[y.integers + BODY_FIRST_BRICK];
  for (int k = 0; k < 3; ++k) {
    int z = middle.z + k - 1;
    for (int j = 0; j < 3; ++j) {
      int row = middle.y + j - 1;
      int layer = (z / BRICK_SIDE * along.y + row / BRICK_SIDE) * along.x;
      int within = (z % BRICK_SIDE * BRICK_SIDE + row % BRICK_SIDE) * BRICK_SIDE;
      real v = real(0.0), v_x = real(0.0);
      for (int i = 0; i < 3; ++i) {
        int x = middle.x + i - 1;
        int brick = table[index + layer + x / BRICK_SIDE];
        real c = real(nodes[bricks + brick * BRICK_SIDE * BRICK_SIDE * BRICK_SIDE + within + x % BRICK_SIDE]);
        v += wx[i] * c;
        v_x += sx[i] * c;
      }
      value += wz[k] * wy[j] * v;
      slope += rvec3(wz[k] * wy[j] * v_x, wz[k] * sy[j] * v, sz[k] * wy[j] * v);
    }
  }
  slope /= pitch;
}

real smooth_step(real x) {
  real t = clamp(x, real(0.0), real(1.0));
  return t * t * (real(3.0) - real(2.0) * t);
}

// Depth and its slope: body_field::read(). Where the smooth part with the highest relief stays at or below `above`, the
// relief is left out.
void read_field(field_place y, rvec3 p, real above, out real depth, out rvec3 slope) {
  smooth_reading at = read_smooth(y, p);
  depth = at.value;
  slope = at.slope;
  if (!(depth + bodies[y.numbers + BODY_HIGHEST_RELIEF] > above) || clamped(y, p) != p) return;
  real pitch = bodies[y.numbers + BODY_PITCH];
  real s = at.value, square = dot(at.slope, at.slope);
  real pitch2 = pitch * pitch, near = pitch2 / (pitch2 + s * s);
  real fade_full = real(FADE_FULL), span = real(FADE_FULL) - real(FADE_NONE);
  real x = (square + fade_full * near - real(FADE_NONE)) / span;
  if (!(x > real(0.0))) return;
  real fade = smooth_step(x);
  real fade_slope = x >= real(1.0) ? real(0.0) : real(6.0) * x * (real(1.0) - x) / span;
  real by_value = real(-2.0) * fade_full * s * near * near / pitch2;
  real a = real(1.0) / (square + real(1e-3));
  rvec3 g = at.slope;
  real t;
  rvec3 t_slope;
  read_bricks(y, p - s * a * g, t, t_slope);
  rvec3 bent = at.bend * g;
  real along = dot(g, t_slope);
  rvec3 by_foot = t_slope - a * along * g - s * a * (at.bend * t_slope) + real(2.0) * s * a * a * along * bent;
  rvec3 by_fade = fade_slope * (real(2.0) * bent + by_value * g);
  depth += fade * t;
  slope += fade * by_foot + t * by_fade;
}

// No point of a ball is deeper: body_field::most_near().
real most_near(field_place y, rvec3 p, real radius) {
  ivec3 count = node_counts(y);
  real pitch = bodies[y.numbers + BODY_PITCH];
  rvec3 c = clamped(y, p);
  rvec3 g = (c - body_vector(y.numbers + BODY_LOW)) / pitch;
  ivec3 n = ivec3(min(max(rvec3(0.0), g + rvec3(0.5)), rvec3(count - ivec3(1))));
  real beside = real(nodes[table[y.integers + BODY_FIRST_NODE] + (n.z * count.y + n.y) * count.x + n.x]) +
                pitch * length(g - rvec3(n));
  return beside + radius + real(1.0 + DISTANCE_SLACK) * pitch + bodies[y.numbers + BODY_HIGHEST_RELIEF] -
         max(real(0.0), length(p - c) - radius);
}
