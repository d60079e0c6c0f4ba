// Planes that are read again elsewhere: they are what a tick there would tell.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <span>
#include <vector>

#include "asperity/field/field_body.hpp"
#include "asperity/planes/plane_renderer.hpp"
#include "planes/facing.hpp"
#include "support/extent.hpp"
#include "support/fresh_seed.hpp"
#include "unit/planes/ridged_scene.hpp"

namespace asperity {
namespace {

using namespace test_support;

pose centre_frame(const pose& T_wa) {
  return T_wa * pose{quat(1.0, 0.0, 0.0, 0.0), ridged().of.probe->mass.centre_of_mass};
}

std::vector<support_plane> kept(std::span<const support_plane> planes) { return {planes.begin(), planes.end()}; }

const support_plane* same_point(std::span<const support_plane> in, const support_plane& as) {
  const auto found = std::find_if(in.begin(), in.end(),
                                  [&](const support_plane& p) { return p.body == as.body && p.sample == as.sample; });
  return found == in.end() ? nullptr : &*found;
}

struct touched {
  std::vector<pose> T_wb;
  pose T_wa;
  tick t;  // of the renderer, until its next step
};

// The probe laid down on two bodies that are turned anyhow, with about this depth.
touched touch(draws& draw, plane_renderer& feel, double depth_m) {
  touched out;
  out.T_wb = {{draw.rotation(), vec3(0.0)}, {draw.rotation(), {0.0, 0.02, 0.02}}};
  out.T_wa = laid_down(draw, feel, out.T_wb, depth_m);
  EXPECT_EQ(feel.step({out.T_wa, out.T_wb}, out.t), status::ok);
  return out;
}

// Probe and bodies have moved since the tick. Another renderer's tick there tells the same points, and the planes of the
// earlier tick, read again, are theirs. As they were, they would be off.
TEST(SurfaceReader, TellsWhatATickThereWouldTell) {
  draws draw{std::mt19937_64(fresh_seed("SurfaceReader.TellsWhatATickThereWouldTell", "40 poses, 400 at length"))};
  plane_renderer feel = make_ridged(), there = make_ridged();
  int compared = 0, far_off = 0;
  for (int n = 0; n < extent(40, 400); ++n) {
    const auto [T_wb, T_wa, t] = touch(draw, feel, 1e-4 * draw.unit());
    ASSERT_NE(t.reader, nullptr);
    const double far_m = std::pow(10.0, -4.0 + draw.unit());
    const auto nudged = [&](const pose& T) {
      return pose{glm::normalize(exp_rotation(30.0 * far_m * draw.vector()) * T.rotation),
                  T.position + far_m * draw.vector()};
    };
    const pose now_T_wa = nudged(T_wa);
    const std::vector<pose> now_T_wb{nudged(T_wb[0]), nudged(T_wb[1])};
    std::vector<support_plane> read = kept(t.planes);
    const std::vector<support_plane> before = read;
    for (std::uint32_t b = 0; b < 2; ++b) t.reader->read(centre_frame(now_T_wa), now_T_wb[b], b, read);
    tick now;
    ASSERT_EQ(there.step({now_T_wa, now_T_wb}, now), status::ok);
    for (std::size_t i = 0; i < read.size(); ++i) {
      const support_plane* const told = same_point(now.planes, read[i]);
      if (told == nullptr) continue;
      const bool other_wall = told->depth_m > 0.0 && glm::dot(told->n_ab_w, before[i].n_ab_w) <= 0.0;
      if (other_wall) continue;
      ++compared;
      EXPECT_NEAR(read[i].depth_m, told->depth_m, 1e-12) << n;
      EXPECT_LT(glm::length(read[i].n_ab_w - told->n_ab_w), 1e-9);
      EXPECT_LT(glm::length(read[i].gradient.linear - told->gradient.linear), 1e-9);
      EXPECT_LT(glm::length(read[i].gradient.angular - told->gradient.angular), 1e-10);
      EXPECT_LT(glm::length(read[i].r_w - told->r_w), 1e-12);
      EXPECT_LT(glm::length(glm::cross(read[i].r_w, read[i].gradient.linear) - read[i].gradient.angular), 1e-12);
      if (std::fabs(before[i].depth_m - told->depth_m) > 2e-5) ++far_off;
    }
  }
  EXPECT_GT(compared, extent(300, 3000));
  EXPECT_GT(far_off, compared / 4) << "planes that were not read again are as good: this proves nothing";
}

// A sample that turns about its own point keeps its depth and looks further and further away. What it counts of that
// depth goes down without a step and with it the slope; of a sample that is far in, all but what is shallow stays.
TEST(SurfaceReader, CountsByItsShareWhatLooksAway) {
  draws draw{std::mt19937_64(fresh_seed("SurfaceReader.CountsByItsShareWhatLooksAway", "40 poses, 200 at length"))};
  constexpr double read_within_m = 1e-7, step_rad = 2e-3;  // single precision; a step of 0.1 degrees
  plane_renderer feel = make_ridged();
  const std::span<const field_sample> samples = ridged().fields->probe->samples.samples();
  const double shallow_m = facing::shallow_m(feel.scene());
  int gone = 0, held = 0;
  for (int n = 0; n < extent(40, 200); ++n) {
    const auto [T_wb, T_wa, t] = touch(draw, feel, 3e-5);
    for (const support_plane& told : kept(t.planes)) {
      if (told.sample % 2 != 1 || !(told.depth_m > 1e-5)) continue;  // of the probe's samples, those that press
      const vec3 point_a(samples[(told.sample - 1) / 2].position_b);
      for (const double further_m : {0.0, 1.5 * shallow_m}) {
        const vec3 point_w = T_wa * point_a + further_m * told.n_ab_w;
        const field_reading whole = ridged().fields->fixed[told.body]->field.read(inverse(T_wb[told.body]) * point_w);
        const double steep = glm::length(whole.slope);
        if (!(whole.value_m > 0.0) || !(steep > 0.1)) continue;
        support_plane p = told;
        p.n_ab_w = T_wb[told.body].rotation * whole.slope / steep;
        const vec3 axis = glm::normalize(glm::cross(p.n_ab_w, draw.vector()));
        double before_m = 0.0;
        for (int step = 0; step <= 600; ++step) {
          const quat turned = glm::normalize(exp_rotation(step * step_rad * axis) * T_wa.rotation);
          std::vector<support_plane> read{p};
          t.reader->read(centre_frame({turned, point_w - turned * point_a}), T_wb[told.body], told.body, read);
          const double now_m = read[0].depth_m, steep_now = glm::length(read[0].gradient.linear);
          ASSERT_LE(now_m, whole.value_m + read_within_m) << n;
          ASSERT_GE(now_m, std::max(0.0, whole.value_m - shallow_m) - read_within_m) << n;
          if (step > 0) {
            ASSERT_LE(std::fabs(now_m - before_m), 0.04 * std::min(whole.value_m, shallow_m) + read_within_m) << n;
          }
          if (whole.value_m < shallow_m) {
            ASSERT_NEAR(steep_now, steep * now_m / whole.value_m, 0.02 * steep) << n;
          } else {
            ASSERT_NEAR(steep_now, steep, 0.02 * steep) << n;
          }
          before_m = now_m;
        }
        gone += before_m < 0.01 * whole.value_m ? 1 : 0;
        held += whole.value_m > 1.01 * shallow_m ? 1 : 0;
      }
    }
  }
  EXPECT_GT(gone, 10);
  EXPECT_GT(held, 10);
}

// What cannot be read, or is another wall, stays as it was told, and so does what belongs to others.
TEST(SurfaceReader, LeavesAloneWhatItDoesNotKnow) {
  draws draw{std::mt19937_64(fresh_seed("SurfaceReader.LeavesAloneWhatItDoesNotKnow", "20 poses"))};
  plane_renderer feel = make_ridged();
  int turned = 0, freed = 0;
  for (int n = 0; n < 20; ++n) {
    const auto [T_wb, T_wa, t] = touch(draw, feel, 1e-4);
    const std::vector<support_plane> told = kept(t.planes);
    const pose near_T_wc = centre_frame({T_wa.rotation, T_wa.position + 5e-5 * draw.vector()});
    const auto expect_as_told = [&](const support_plane& p, std::size_t i) {
      EXPECT_EQ(p.depth_m, told[i].depth_m) << n;
      EXPECT_EQ(p.gradient.linear, told[i].gradient.linear);
    };

    std::vector<support_plane> read = told;
    t.reader->read(near_T_wc, T_wb[0], 0, read);
    for (std::size_t i = 0; i < told.size(); ++i) {
      if (told[i].body != 0) expect_as_told(read[i], i);
    }
    read = told;
    for (support_plane& p : read) p.sample = 0;
    for (std::uint32_t b = 0; b < 2; ++b) t.reader->read(near_T_wc, T_wb[b], b, read);
    for (std::size_t i = 0; i < told.size(); ++i) expect_as_told(read[i], i);

    // As of the far side of a thin part: it would press the other way. What presses nobody may turn.
    read = told;
    for (support_plane& p : read) p.n_ab_w = -p.n_ab_w;
    for (std::uint32_t b = 0; b < 2; ++b) t.reader->read(centre_frame(T_wa), T_wb[b], b, read);
    for (std::size_t i = 0; i < told.size(); ++i) {
      const bool presses = told[i].depth_m > 0.0;
      EXPECT_EQ(read[i].n_ab_w, (presses ? -1.0 : 1.0) * told[i].n_ab_w) << n;
      ++(presses ? turned : freed);
    }
  }
  EXPECT_GT(turned, 10);
  EXPECT_GT(freed, 10);
}

// By how much a surface is felt further in stays as the contact had it.
TEST(SurfaceReader, KeepsHowFarASurfaceStandsBack) {
  draws draw{std::mt19937_64(fresh_seed("SurfaceReader.KeepsHowFarASurfaceStandsBack", "10 poses"))};
  plane_renderer feel = make_ridged();
  for (int n = 0; n < 10; ++n) {
    const auto [T_wb, T_wa, t] = touch(draw, feel, 1e-4);
    std::vector<support_plane> read = kept(t.planes), back = read;
    for (support_plane& p : back) p.back_m = 3e-4;
    const pose T_wc = centre_frame({T_wa.rotation, T_wa.position + 1e-4 * draw.vector()});
    for (std::uint32_t b = 0; b < 2; ++b) {
      t.reader->read(T_wc, T_wb[b], b, read);
      t.reader->read(T_wc, T_wb[b], b, back);
    }
    int moved = 0;
    for (std::size_t i = 0; i < read.size(); ++i) {
      if (read[i].depth_m == t.planes[i].depth_m) continue;
      EXPECT_NEAR(back[i].depth_m, read[i].depth_m - 3e-4, 1e-15);
      ++moved;
    }
    EXPECT_GT(moved, 0);
  }
}

}  // namespace
}  // namespace asperity
