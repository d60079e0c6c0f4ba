#include "bodies/joint_solver.hpp"

#include <algorithm>
#include <cmath>

#include "asperity/core/memory.hpp"

namespace asperity::detail {

namespace {

constexpr double tolerance_n = 1e-11;
constexpr int most_passes = 50;

/// The part of a spring that a and b meet: on b it acts through this, v_b seen from a's centre.
mat6 seen_from_matrix(const vec3& arm_w) noexcept {
  mat6 out;
  for (std::size_t i = 0; i < 6; ++i) out(i, i) = 1.0;
  // w x arm = -arm x w
  out(0, 4) = arm_w.z;
  out(0, 5) = -arm_w.y;
  out(1, 3) = -arm_w.z;
  out(1, 5) = arm_w.x;
  out(2, 3) = arm_w.y;
  out(2, 4) = -arm_w.x;
  return out;
}

mat6 transposed(const mat6& m) noexcept {
  mat6 out;
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t j = 0; j < 6; ++j) out(i, j) = m(j, i);
  }
  return out;
}

mat6 product(const mat6& a, const mat6& b) noexcept {
  mat6 out;
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t j = 0; j < 6; ++j) {
      double s = 0.0;
      for (std::size_t k = 0; k < 6; ++k) s += a(i, k) * b(k, j);
      out(i, j) = s;
    }
  }
  return out;
}

vec6 at(const std::vector<double>& x, std::uint32_t place) noexcept {
  const double* const p = x.data() + 6 * static_cast<std::size_t>(place);
  return {{p[0], p[1], p[2]}, {p[3], p[4], p[5]}};
}

void add(std::vector<double>& x, std::uint32_t place, const vec6& y) noexcept {
  for (std::size_t i = 0; i < 6; ++i) x[6 * static_cast<std::size_t>(place) + i] += y[i];
}

}  // namespace

joint_solver::joint_solver(std::size_t bodies, std::size_t planes)
    : first_(bodies),
      base_(36 * bodies * bodies),
      factors_(36 * bodies * bodies),
      step_(6 * bodies),
      imbalance_(6 * bodies),
      change_of_(6 * bodies),
      depth_m_(planes),
      change_m_(planes),
      turns_(planes) {}

std::size_t joint_solver::heap_bytes() const noexcept {
  return asperity::heap_bytes(first_, base_, factors_, step_, imbalance_, change_of_, depth_m_, change_m_, turns_);
}

void joint_solver::find_profile(std::span<const joint_plane> planes, std::span<const joint_spring> springs) noexcept {
  for (std::uint32_t i = 0; i < bodies_; ++i) first_[i] = i;
  const auto meet = [&](std::uint32_t a, std::uint32_t b) noexcept {
    if (a == unmoved || b == unmoved) return;
    first_[std::max(a, b)] = std::min(first_[std::max(a, b)], std::min(a, b));
  };
  for (const joint_plane& p : planes) meet(p.a, p.b);
  for (const joint_spring& s : springs) meet(s.a, s.b);
}

void joint_solver::add_block(std::vector<double>& to, std::uint32_t row, std::uint32_t col,
                             const mat6& m) const noexcept {
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t j = 0; j < 6; ++j) to[(6 * row + i) * rows_ + 6 * col + j] += m(i, j);
  }
}

void joint_solver::add_plane(const joint_plane& p, double s) noexcept {
  const auto add_pair = [&](std::uint32_t row, const vec6& g, std::uint32_t col, const vec6& of) noexcept {
    for (std::size_t i = 0; i < 6; ++i) {
      double* const to = factors_.data() + (6 * row + i) * rows_ + 6 * col;
      for (std::size_t j = 0; j < 6; ++j) to[j] += s * (g[i] * of[j]);
    }
  };
  add_pair(p.a, p.gradient_a, p.a, p.gradient_a);
  if (p.b == unmoved) return;
  add_pair(p.b, p.gradient_b, p.b, p.gradient_b);
  if (p.a > p.b) {
    add_pair(p.a, p.gradient_a, p.b, p.gradient_b);
  } else {
    add_pair(p.b, p.gradient_b, p.a, p.gradient_a);
  }
}

bool joint_solver::factorise() noexcept {
  for (std::size_t r = 0; r < rows_; ++r) {
    double* const row = factors_.data() + r * rows_;
    const std::size_t from = 6 * static_cast<std::size_t>(first_[r / 6]);
    for (std::size_t c = from; c <= r; ++c) {
      const double* const other = factors_.data() + c * rows_;
      double s = row[c];
      for (std::size_t k = std::max(from, 6 * static_cast<std::size_t>(first_[c / 6])); k < c; ++k) {
        s -= row[k] * other[k];
      }
      if (c < r) {
        row[c] = s * other[c];  // the diagonal holds its inverse
      } else {
        if (!(s > 0.0)) return false;  // zero, negative or NaN
        row[c] = 1.0 / std::sqrt(s);
      }
    }
  }
  return true;
}

void joint_solver::back_substitute() noexcept {
  for (std::size_t r = 0; r < rows_; ++r) {
    const double* const row = factors_.data() + r * rows_;
    double s = step_[r];
    for (std::size_t k = 6 * static_cast<std::size_t>(first_[r / 6]); k < r; ++k) s -= row[k] * step_[k];
    step_[r] = s * row[r];
  }
  for (std::size_t r = rows_; r-- > 0;) {
    const double* const row = factors_.data() + r * rows_;
    step_[r] *= row[r];
    for (std::size_t k = 6 * static_cast<std::size_t>(first_[r / 6]); k < r; ++k) step_[k] -= row[k] * step_[r];
  }
}

double joint_solver::least_along(std::span<const joint_plane> planes, double slope, double rate) noexcept {
  std::size_t count = 0;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const double x = depth_m_[i], dx = change_m_[i];
    const double of_plane = planes[i].stiffness_n_per_m * dx / planes[i].horizon_s;
    const bool pressed = x > 0.0 || (x == 0.0 && dx > 0.0);
    if (pressed) {
      slope += of_plane * x;
      rate += of_plane * dx;
    }
    // A plane that begins to be pressed on the way adds its part from there on; one that ceases takes it away.
    const double sign = pressed ? -1.0 : 1.0;
    if (dx != 0.0 && -x / dx > 0.0) turns_[count++] = {-x / dx, sign * of_plane * x, sign * of_plane * dx};
  }
  std::sort(turns_.begin(), turns_.begin() + static_cast<std::ptrdiff_t>(count),
            [](const turn& p, const turn& q) { return p.at < q.at; });
  double from = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const double least = -slope / rate;
    if (!(least > turns_[i].at)) return std::max(from, least);
    from = turns_[i].at;
    slope += turns_[i].slope;
    rate += turns_[i].rate;
  }
  return std::max(from, -slope / rate);
}

joint_answer joint_solver::solve(std::span<const mat6> a, std::span<const vec6> load, std::span<const vec6> v0,
                                 std::span<joint_plane> planes, std::span<const joint_spring> springs,
                                 std::span<vec6> v) noexcept {
  joint_answer out;
  bodies_ = a.size();
  rows_ = 6 * bodies_;
  find_profile(planes, springs);
  for (std::size_t r = 0; r < rows_; ++r) {
    const std::size_t from = 6 * static_cast<std::size_t>(first_[r / 6]);
    std::fill_n(base_.begin() + static_cast<std::ptrdiff_t>(r * rows_ + from), 6 * (r / 6 + 1) - from, 0.0);
  }
  for (std::uint32_t i = 0; i < bodies_; ++i) {
    add_block(base_, i, i, a[i]);
    v[i] = v0[i];
    for (std::size_t k = 0; k < 6; ++k) imbalance_[6 * i + k] = -load[i][k];
  }
  for (const joint_spring& s : springs) {
    const bool has_a = s.a != unmoved, has_b = s.b != unmoved;
    vec6 slide;
    if (has_a) slide = v0[s.a];
    if (has_b) slide = slide - seen_from(v0[s.b], s.arm_w);
    const mat6 m = s.horizon_s * s.matrix;
    const vec6 pull = s.matrix * (s.stretch + s.horizon_s * slide);
    if (has_a) {
      add_block(base_, s.a, s.a, m);
      add(imbalance_, s.a, pull);
    }
    if (!has_b) continue;
    const mat6 c = seen_from_matrix(s.arm_w), ct = transposed(c), mc = product(m, c);
    add_block(base_, s.b, s.b, product(ct, mc));
    add(imbalance_, s.b, -1.0 * (ct * pull));
    if (!has_a) continue;
    if (s.a > s.b) {
      add_block(base_, s.a, s.b, -1.0 * mc);
    } else {
      add_block(base_, s.b, s.a, -1.0 * transposed(mc));
    }
  }
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const joint_plane& p = planes[i];
    depth_m_[i] = p.depth_m + p.horizon_s * dot(p.gradient_a, v[p.a]);
    if (p.b != unmoved) depth_m_[i] += p.horizon_s * dot(p.gradient_b, v[p.b]);
  }
  for (;;) {
    ++out.passes;
    for (std::size_t r = 0; r < rows_; ++r) {
      const auto from = static_cast<std::ptrdiff_t>(r * rows_ + 6 * static_cast<std::size_t>(first_[r / 6]));
      std::copy_n(base_.begin() + from, 6 * (r / 6 + 1) - 6 * static_cast<std::size_t>(first_[r / 6]),
                  factors_.begin() + from);
    }
    for (std::size_t r = 0; r < rows_; ++r) step_[r] = -imbalance_[r];
    for (std::size_t i = 0; i < planes.size(); ++i) {
      const joint_plane& p = planes[i];
      if (!(depth_m_[i] > 0.0)) continue;
      add_plane(p, p.stiffness_n_per_m * p.horizon_s);
      const double push_n = p.stiffness_n_per_m * depth_m_[i];
      add(step_, p.a, -push_n * p.gradient_a);
      if (p.b != unmoved) add(step_, p.b, -push_n * p.gradient_b);
    }
    if (!factorise()) return out;
    back_substitute();
    // A full step is exact where no plane changes between pressed and free.
    out.residual_n = 0.0;
    for (std::size_t i = 0; i < planes.size(); ++i) {
      const joint_plane& p = planes[i];
      double change = dot(p.gradient_a, at(step_, p.a));
      if (p.b != unmoved) change += dot(p.gradient_b, at(step_, p.b));
      change_m_[i] = p.horizon_s * change;
      const double end = depth_m_[i] + change_m_[i];
      const double supposed = depth_m_[i] > 0.0 ? end : 0.0;
      out.residual_n = std::max(out.residual_n, p.stiffness_n_per_m * std::fabs(std::max(0.0, end) - supposed));
    }
    const bool done = out.residual_n <= tolerance_n || out.passes >= most_passes;
    // Along the step the quadratic part has the slope p0 and the curvature p1; base times step is also what the imbalance
    // changes by.
    double p0 = 0.0, p1 = 0.0;
    for (std::size_t r = 0; r < rows_; ++r) p0 += step_[r] * imbalance_[r];
    std::fill_n(change_of_.begin(), rows_, 0.0);
    for (std::size_t r = 0; r < rows_; ++r) {
      const double* const row = base_.data() + r * rows_;
      double s = row[r] * step_[r];
      for (std::size_t k = 6 * static_cast<std::size_t>(first_[r / 6]); k < r; ++k) {
        s += row[k] * step_[k];
        change_of_[k] += row[k] * step_[r];
      }
      change_of_[r] += s;
    }
    for (std::size_t r = 0; r < rows_; ++r) p1 += step_[r] * change_of_[r];
    const double part = done ? 1.0 : least_along(planes, p0, p1);
    for (std::uint32_t i = 0; i < bodies_; ++i) v[i] += part * at(step_, i);
    for (std::size_t r = 0; r < rows_; ++r) imbalance_[r] += part * change_of_[r];
    for (std::size_t i = 0; i < planes.size(); ++i) depth_m_[i] += part * change_m_[i];
    if (done) break;
  }
  for (std::size_t i = 0; i < planes.size(); ++i) {
    planes[i].lambda_n = planes[i].stiffness_n_per_m * std::max(0.0, depth_m_[i]);
  }
  out.solved = true;
  return out;
}

}  // namespace asperity::detail
