// The wrench is minus the gradient of an energy, its stiffness is its derivative, and limits are told.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>
#include <numbers>

#include "exit_lab.hpp"
#include "support/extent.hpp"
#include "support/fresh_seed.hpp"

namespace asperity {
namespace {

using namespace test_support;

constexpr double lever_m = 0.01;

const vec3 centre_a(0.6 * mm, -0.4 * mm, 0.3 * mm);

exit_lab& waved_boxes() {
  static exit_lab made(waved_box(vec3(7, 6, 5) * mm, 0.04 * mm, 0.4 * mm),
                       {waved_box(vec3(12, 11, 6) * mm, 0.06 * mm, 0.7 * mm)}, {}, centre_a);
  return made;
}

pose moved(const pose& from, const vec3& by, const vec3& turned) {
  const quat rotation = exp_rotation(turned) * from.rotation;
  return {rotation, from * centre_a + by - rotation * centre_a};
}

// A box somewhere over the large face, edge or corner first, or flat, this deep.
pose pressed(exit_lab& lab, drawing& draw, double depth_m) {
  pose T{draw.rotation(), vec3(5, 5, 0) * mm * draw.vector() + vec3(0.0, 0.0, 20.0 * mm)};
  double low = 0.0, high = 20.0 * mm;
  for (int i = 0; i < 30; ++i) {
    const double middle = 0.5 * (low + high);
    (lab.at(moved(T, vec3(0.0, 0.0, -middle), {})).deepest_m > 0.0 ? high : low) = middle;
  }
  return moved(T, vec3(0.0, 0.0, -high - depth_m), {});
}

TEST(ExitPotential, TheWrenchIsMinusTheGradientOfTheEnergy) {
  drawing draw{std::mt19937_64(fresh_seed("ExitPotential.TheWrenchIsMinusTheGradient", "12 poses, 40 at length"))};
  exit_lab& lab = waved_boxes();
  for (int n = 0; n < extent(12, 40); ++n) {
    const pose T = pressed(lab, draw, std::exp(draw.between(std::log(0.03), std::log(2.5))) * mm);
    const exit_answer a = lab.at(T);
    ASSERT_FALSE(a.hit.any());
    ASSERT_FALSE(a.ways.empty());
    const double scale = glm::length(a.on_probe_w.force);
    for (std::size_t i = 0; i < 6; ++i) {
      const auto energy = [&](double h) {
        vec6 step;
        step[i] = i < 3 ? h : h / lever_m;
        return lab.at(moved(T, step.linear, step.angular)).energy_j;
      };
      const double h = 4e-8;  // a sample that begins to touch within it leaves an error of the order of its square
      const double slope = (8.0 * (energy(h) - energy(-h)) - (energy(2.0 * h) - energy(-2.0 * h))) / (12.0 * h);
      const double reported =
          i < 3 ? a.on_probe_w.force[static_cast<int>(i)] : a.on_probe_w.torque[static_cast<int>(i - 3)] / lever_m;
      EXPECT_NEAR(reported, -slope, 1e-6 * scale) << "pose " << n << ", coordinate " << i << ", ways " << a.ways.size();
    }
  }
}

TEST(ExitPotential, TheWrenchIsAFunctionOfThePose) {
  drawing draw{std::mt19937_64(fresh_seed("ExitPotential.TheWrenchIsAFunctionOfThePose", "20 poses"))};
  exit_lab& lab = waved_boxes();
  for (int n = 0; n < 20; ++n) {
    const pose T = pressed(lab, draw, 0.5 * mm);
    const exit_answer first = lab.at(T);
    static_cast<void>(lab.at(pressed(lab, draw, 2.0 * mm)));
    const exit_answer again = lab.at(T);
    EXPECT_EQ(first.on_probe_w.force, again.on_probe_w.force);
    EXPECT_EQ(first.on_probe_w.torque, again.on_probe_w.torque);
    EXPECT_EQ(first.readings, again.readings);
  }
}

TEST(ExitPotential, ClosedLoopsDoNoWork) {
  drawing draw{std::mt19937_64(fresh_seed("ExitPotential.ClosedLoopsDoNoWork", "4 loops"))};
  exit_lab& lab = waved_boxes();
  for (int n = 0; n < 4; ++n) {
    const pose start = pressed(lab, draw, 0.4 * mm);
    double phase[6];
    for (double& p : phase) p = draw.between(0.0, 6.0);
    const auto at = [&](double t) {
      const auto wave = [&](int i, double times) { return std::sin(times * t + phase[i]) - std::sin(phase[i]); };
      return moved(start, 0.1 * mm * vec3(wave(0, 1), wave(1, 1), wave(2, 2)),
                   0.003 * vec3(wave(3, 1), wave(4, 2), wave(5, 1)));
    };
    double work = 0.0, exchanged = 0.0;
    const int steps = 1500;
    pose last = at(0.0);
    wrench before = lab.at(last).on_probe_w;
    for (int i = 1; i <= steps; ++i) {
      const auto turn = [&](double of) { return at(2.0 * std::numbers::pi * of / steps); };
      const pose now = turn(i);
      const wrench middle = lab.at(turn(i - 0.5)).on_probe_w, after = lab.at(now).on_probe_w;
      const wrench mean = (1.0 / 6.0) * (before + 4.0 * middle + after);
      const double done = glm::dot(mean.force, now * centre_a - last * centre_a) +
                          glm::dot(mean.torque, log_rotation(now.rotation * glm::conjugate(last.rotation)));
      work += done;
      exchanged += std::fabs(done);
      last = now;
      before = after;
    }
    EXPECT_LT(std::fabs(work), 1e-5 * exchanged) << "loop " << n;
  }
}

// dW/dq by central differences; lengths in lever_m, so that all numbers are N/m. The part that is not symmetric goes:
// a torque turns with the body, and no symmetric J says so. So does what is positive: a contact far from the centre of
// mass tips over.
mat6 measured_stiffness(exit_lab& lab, const pose& T) {
  const double h = 1e-7;
  mat6 out;
  for (std::size_t c = 0; c < 6; ++c) {
    vec6 step;
    step[c] = c < 3 ? h : h / lever_m;
    const vec6 back = -1.0 * step;
    const vec6 change = to_vec6(lab.at(moved(T, step.linear, step.angular)).on_probe_w) -
                        to_vec6(lab.at(moved(T, back.linear, back.angular)).on_probe_w);
    for (std::size_t r = 0; r < 6; ++r) {
      const double half = 0.5 * (r < 3 ? change[r] : change[r] / lever_m) / (2.0 * h);
      out(r, c) += half;
      out(c, r) += half;
    }
  }
  return exits::negative_part(out, 1.0);
}

// Errors of J for pressing and tilting, sorted, where one way out decides: parts of the measured change.
std::vector<double> stiffness_errors(exit_lab& lab, drawing& draw, int poses) {
  std::vector<double> errors;
  for (int n = 0; n < poses; ++n) {
    const pose T = pressed(lab, draw, draw.between(0.05, 0.5) * mm);
    const exit_answer a = lab.at(T);
    if (a.ways.size() != 1) continue;
    mat6 reported = a.stiffness;
    for (std::size_t i = 0; i < 36; ++i) reported.m[i] /= (i / 6 < 3 ? 1.0 : lever_m) * (i % 6 < 3 ? 1.0 : lever_m);
    const mat6 measured = measured_stiffness(lab, T);
    const vec3 out = glm::normalize(a.on_probe_w.force), across = any_orthogonal(out);
    for (const vec6& m : {vec6{out, {}}, vec6{{}, across}, vec6{{}, glm::cross(out, across)}}) {
      const vec6 right = measured * m, off = reported * m - right;
      // A tilt about the contact itself has next to no stiffness.
      const double size = std::max(std::sqrt(dot(right, right)), 0.2 * lab.rule().stiffness_n_per_m);
      errors.push_back(std::sqrt(dot(off, off)) / size);
      EXPECT_LE(dot(m, reported * m), 1e-9);
    }
  }
  std::sort(errors.begin(), errors.end());
  return errors;
}

TEST(ExitPotential, TheStiffnessIsTheDerivativeOfTheWrench) {
  drawing draw{
      std::mt19937_64(fresh_seed("ExitPotential.TheStiffnessIsTheDerivative", "2 x 20 poses, 2 x 60 at length"))};
  const int poses = extent(20, 60);
  exit_lab smooth(waved_box(vec3(7, 6, 5) * mm, 0.01 * mm, 2.0 * mm),
                  {waved_box(vec3(12, 11, 6) * mm, 0.01 * mm, 3.0 * mm)}, {}, centre_a);
  const std::vector<double> of_smooth = stiffness_errors(smooth, draw, poses);
  // J leaves the curvature of the relief out.
  const std::vector<double> of_rough = stiffness_errors(waved_boxes(), draw, poses);
  const auto part = [](const std::vector<double>& e, std::size_t percent) { return e[e.size() * percent / 100]; };
  ASSERT_GT(std::min(of_smooth.size(), of_rough.size()), extent(33U, 100U));
  std::printf("stiffness: error %.3f at the median, %.3f for nine of ten; with fine waves %.3f, %.3f\n",
              part(of_smooth, 50), part(of_smooth, 90), part(of_rough, 50), part(of_rough, 90));
  EXPECT_LT(part(of_smooth, 50), 0.005);
  EXPECT_LT(part(of_smooth, 90), 0.02);
  EXPECT_LT(part(of_rough, 50), 0.02);
  EXPECT_LT(part(of_rough, 90), 0.05);
}

// Whatever a solve may spend, its answer is finite, no harder than the spring, and says what it lacks.
TEST(ExitPotential, LimitsAreToldAndTheWrenchStaysBounded) {
  drawing draw{std::mt19937_64(fresh_seed("ExitPotential.LimitsAreTold", "6 to 20 poses, 3 limits; 20, 5 at length"))};
  const field_body_ptr probe = waved_box(vec3(7, 6, 5) * mm, 0.04 * mm, 0.4 * mm);
  const field_body_ptr fixed = waved_box(vec3(12, 11, 6) * mm, 0.06 * mm, 0.7 * mm);
  for (const std::size_t most : {1000U, 2000U, 4000U, 8000U, 20'000U}) {
    if (!at_length() && (most == 2000 || most == 8000)) continue;
    exits::exit_rule rule;
    rule.most_readings = most;
    exit_lab lab(probe, {fixed}, rule, centre_a);
    int reported = 0;
    const int poses = most <= 2000 ? 20 : extent(6, 20);
    for (int n = 0; n < poses; ++n) {
      const exit_answer a = lab.at(pressed(lab, draw, draw.between(0.5, 4.0) * mm));
      EXPECT_TRUE(is_finite(a.on_probe_w));
      EXPECT_TRUE(is_finite(a.stiffness));
      EXPECT_LT(glm::length(a.on_probe_w.force), 2.0 * rule.stiffness_n_per_m * 0.02);
      EXPECT_LT(a.readings, most + most / 4 + 2000);
      reported += a.hit.any() ? 1 : 0;
    }
    if (most <= 2000) {
      EXPECT_GT(reported, 10) << most;
    }
  }
  exits::exit_rule few;
  few.most_marks = 64;
  exit_lab lab(probe, {fixed}, few, centre_a);
  const exit_answer flat = lab.at(pose{quat(1.0, 0.0, 0.0, 0.0), vec3(0.0, 0.0, 10.8 * mm)});
  EXPECT_TRUE(is_finite(flat.on_probe_w));
}

}  // namespace
}  // namespace asperity
