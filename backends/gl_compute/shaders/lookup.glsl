// From the coarse hit over a sample to the textured surface there: height_lookup.hpp, step by step.

#define SEARCH_STEPS 12

const int hit_none = 0;    // no surface, or a texel that is no position
const int hit_beside = 1;  // the texel of the coarse hit: its point may lie beside the sample
const int hit_above = 2;   // the point of the textured surface over the sample

struct surface_hit {
  int kind;
  real height;
  ivec2 base;  // texel that `texel` is counted from
  rvec2 texel;
  rvec3 point, along_x, along_y;  // of the textured surface at `texel`
};

// Bilinear patch between four texel centres, in window coordinates.
struct texture_cell {
  rvec3 corner, along_x, along_y, twist;
  ivec2 place;      // texel of the lower corner
  bvec2 low, high;  // the image ends there
  bool whole;       // all four texels are positions
};

vec4 texel_of(bool fixed_body, ivec2 at) {
  return fixed_body ? texelFetch(texture_b, at, 0) : texelFetch(texture_a, at, 0);
}

texture_cell read_cell(bool fixed_body, window_map map, ivec2 base, rvec2 z) {
  ivec2 size = fixed_body ? textureSize(texture_b, 0) : textureSize(texture_a, 0);
  ivec2 last = max(size - 2, ivec2(0));
  ivec2 next = min(size - 1, ivec2(1));
  texture_cell c;
  c.place = clamp(base + ivec2(floor(clamp(z, rvec2(-1e6), rvec2(1e6)))), ivec2(0), last);
  c.low = equal(c.place, ivec2(0));
  c.high = equal(c.place, last);
  vec4 t00 = texel_of(fixed_body, c.place);
  vec4 t10 = texel_of(fixed_body, c.place + ivec2(next.x, 0));
  vec4 t01 = texel_of(fixed_body, c.place + ivec2(0, next.y));
  vec4 t11 = texel_of(fixed_body, c.place + next);
  c.whole = t00.w * t10.w * t01.w * t11.w > 0.5;
  c.corner = point(map, t00.xyz);
  c.along_x = direction(map, rvec3(t10.xyz) - rvec3(t00.xyz));
  c.along_y = direction(map, rvec3(t01.xyz) - rvec3(t00.xyz));
  c.twist = direction(map, (rvec3(t11.xyz) - rvec3(t01.xyz)) - (rvec3(t10.xyz) - rvec3(t00.xyz)));
  return c;
}

bool holds(texture_cell c, ivec2 base, rvec2 z) {
  rvec2 from = rvec2(c.place - base);
  return (z.x >= from.x || c.low.x) && (z.x <= from.x + real(1.0) || c.high.x) && (z.y >= from.y || c.low.y) &&
         (z.y <= from.y + real(1.0) || c.high.y);
}

surface_hit hit_at(texture_cell c, ivec2 base, rvec2 z) {
  rvec2 f = clamp(z - rvec2(c.place - base), rvec2(0.0), rvec2(1.0));
  surface_hit h;
  h.along_x = c.along_x + f.y * c.twist;
  h.along_y = c.along_y + f.x * c.twist;
  h.point = c.corner + f.x * h.along_x + f.y * c.along_y;
  h.base = base;
  h.texel = z;
  h.kind = hit_beside;
  h.height = h.point.z;
  return h;
}

surface_hit no_hit() {
  return surface_hit(hit_none, real(0.0), ivec2(0), rvec2(0.0), rvec3(0.0), rvec3(0.0), rvec3(0.0));
}

// Where a body's triangles stand.
struct patch_place {
  int numbers, integers;
};

// What a search keeps at hand of the triangle that it is in.
struct chart {
  int numbers, integers;
  ivec2 base;
  rvec3 outside_0, outside_1, outside_2;  // distance from each edge, texels, as affine functions of the texel
  real det;                               // texels^2 per area across the window
};

rvec3 distances(chart c, rvec2 z) {
  rvec3 at = rvec3(real(1.0), z);
  return rvec3(dot(c.outside_0, at), dot(c.outside_1, at), dot(c.outside_2, at));
}

// True up to so many texels outside of the triangle. Beside an acute corner that is less than its edges alone say.
bool within(chart c, rvec3 outside, real reach) {
  rvec2 normal[3] = rvec2[3](c.outside_0.yz, c.outside_1.yz, c.outside_2.yz);  // unit, inward
  bool inside = true;
  for (int k = 0; k < 3; ++k) {
    real d = outside[k];
    if (d >= real(0.0)) continue;
    inside = false;
    // How far past the ends of the edge, where another one starts.
    real past = real(0.0);
    for (int other = 1; other < 3; ++other) {
      int j = (k + other) % 3;
      real c_kj = dot(normal[k], normal[j]);
      real s_kj = sqrt(max(real(1.0) - c_kj * c_kj, real(1e-12)));
      past = min(past, (outside[j] - c_kj * d) / s_kj);
    }
    if (d * d + past * past <= reach * reach) return true;
  }
  return inside;
}

// Point of the textured surface over a sample, or beside it. There is one place that reads a triangle and one that reads
// texels, for both bodies and both ways of looking up: a shader is compiled as often as it names them.
surface_hit look_up(bool fixed_body, window_map map, patch_place place, int owner, rvec2 uv) {
#ifdef EXACT_PARALLAX
  bool beside = false;  // the paper's lookup, which needs no search, or stands in where the search ends
#else
  bool beside = true;
#endif
  int enter = owner;  // the triangle to go on in, at the coarse point over `at`
  rvec2 at = uv, z = rvec2(0.0);
  chart c;
  texture_cell cell;
  for (int step = 0; step <= SEARCH_STEPS; ++step) {
    if (enter >= 0) {
      c.numbers = place.numbers + enter * TRIANGLE_NUMBERS;
      c.integers = place.integers + enter * TRIANGLE_INTEGERS;
      c.base = ivec2(integers[c.integers], integers[c.integers + 1]);
      rvec3 x = numbers3(c.numbers + TRIANGLE_TEXEL_X), y = numbers3(c.numbers + TRIANGLE_TEXEL_Y);
      z = rvec2(x.x + at.x * x.y + at.y * x.z, y.x + at.x * y.y + at.y * y.z);
      c.det = x.y * y.z - x.z * y.y;
      c.outside_0 = numbers3(c.numbers + TRIANGLE_OUTSIDE);
      c.outside_1 = numbers3(c.numbers + TRIANGLE_OUTSIDE + 3);
      c.outside_2 = numbers3(c.numbers + TRIANGLE_OUTSIDE + 6);
      enter = -1;
    }
    if (step == 0 || !holds(cell, c.base, z)) cell = read_cell(fixed_body, map, c.base, z);
    if (!cell.whole) {
      // A hole in the triangle is one in the surface; outside, the chart ends sooner than its gutter should.
      if (beside || within(c, distances(c, z), real(0.0))) break;
      beside = true;
      enter = owner;
      at = uv;
      continue;
    }
    surface_hit h = hit_at(cell, c.base, z);
    if (beside) return h;
    real det = h.along_x.x * h.along_y.y - h.along_x.y * h.along_y.x;
    beside = !(det * c.det > real(0.02));  // a fold
    if (!beside) {
      rvec2 miss = uv - h.point.xy;
      rvec2 dz =
          rvec2(h.along_y.y * miss.x - h.along_y.x * miss.y, h.along_x.x * miss.y - h.along_x.y * miss.x) / det;
      // Rounding may keep single precision from the last digits: what it got to in the last step is near enough.
      real tolerance = step + 1 < SEARCH_STEPS ? real(TOLERANCE) : real(LAST_TOLERANCE);
      if (abs(miss.x) <= tolerance && abs(miss.y) <= tolerance) {
        h.kind = hit_above;
        h.height = h.point.z + h.along_x.z * dz.x + h.along_y.z * dz.y;
        return h;
      }
      z += dz;
      rvec3 outside = distances(c, z);
      int outermost = outside.x <= outside.y && outside.x <= outside.z ? 0 : (outside.y <= outside.z ? 1 : 2);
      beside = step + 1 == SEARCH_STEPS;
      if (!beside && !within(c, outside, real(1.0))) {
        enter = integers[c.integers + 2 + (outermost + 1) % 3];
        beside = enter < 0;
        rvec3 bary = outside / numbers3(c.numbers + TRIANGLE_ALTITUDES);
        int corner = c.numbers + TRIANGLE_CORNERS;
        at = bary.x * rvec2(numbers[corner], numbers[corner + 1]) +
             bary.y * rvec2(numbers[corner + 2], numbers[corner + 3]) +
             bary.z * rvec2(numbers[corner + 4], numbers[corner + 5]);
      }
    }
    if (beside) {
      enter = owner;
      at = uv;
    }
  }
  return no_hit();
}
