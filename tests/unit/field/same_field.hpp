// Whether two fields are the same to the bit.
#pragma once

#include <cstring>
#include <gtest/gtest.h>
#include <span>
#include <type_traits>
#include <vector>

#include "asperity/field/field_body.hpp"

namespace asperity::field_test {

template <class T>
[[nodiscard]] inline bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  static_assert(std::is_trivially_copyable_v<T>);
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

/// What a tree holds, ball by ball, as numbers.
[[nodiscard]] inline std::vector<double> numbers_of(const sample_tree& tree) {
  std::vector<double> out;
  tree.walk(
      [&](const sample_tree::branch& at) noexcept {
        const sample_ball b = at.ball();
        for (const vec3& v : {b.centre_b, b.axis_b, vec3(b.radius_m, b.half_m, at.right)}) {
          for (int k = 0; k < 3; ++k) out.push_back(v[k]);
        }
        for (const field_sample& s : at.samples()) {
          for (int k = 0; k < 3; ++k) out.push_back(static_cast<double>(s.position_b[k]));
          for (int k = 0; k < 3; ++k) out.push_back(static_cast<double>(s.axis_b[k]));
          out.push_back(static_cast<double>(s.cone_rad));
        }
        return sample_tree::branch_answer::open;
      },
      [](const sample_ball&, std::span<const field_sample>) noexcept {});
  return out;
}

/// Fields and samples with the same bits.
inline void expect_same(const field_body& one, const field_body& other) {
  const body_field &a = one.field, &b = other.field;
  EXPECT_EQ(a.smooth.low, b.smooth.low);
  EXPECT_EQ(a.smooth.pitch_m, b.smooth.pitch_m);
  EXPECT_EQ(a.smooth.nodes, b.smooth.nodes);
  EXPECT_TRUE(same_bytes(a.smooth.value, b.smooth.value));
  EXPECT_EQ(a.fine.low, b.fine.low);
  EXPECT_EQ(a.fine.pitch_m, b.fine.pitch_m);
  EXPECT_EQ(a.fine.bricks_along, b.fine.bricks_along);
  EXPECT_TRUE(same_bytes(a.fine.index, b.fine.index));
  EXPECT_TRUE(same_bytes(a.fine.bricks, b.fine.bricks));
  EXPECT_TRUE(a.most_third == b.most_third);
  EXPECT_TRUE(a.most_relief == b.most_relief);
  EXPECT_TRUE(a.slopes == b.slopes);
  EXPECT_EQ(a.lowest_relief_m, b.lowest_relief_m);
  EXPECT_EQ(a.highest_relief_m, b.highest_relief_m);
  EXPECT_EQ(a.thickness_m, b.thickness_m);
  EXPECT_EQ(a.thinnest_resolved_m, b.thinnest_resolved_m);
  EXPECT_TRUE(same_bytes(numbers_of(one.samples), numbers_of(other.samples)));
  EXPECT_TRUE(same_bytes(numbers_of(one.plain), numbers_of(other.plain)));
}

}  // namespace asperity::field_test
