// Where things stand in the buffers that host and shader share. A job is one contact in one configuration of the probe;
// the shader learns these numbers as definitions, so that there is one list of them.
#pragma once

#include <string>
#include <utility>

namespace asperity::gl::job {

// Samples of a job are divided into groups of a fixed size, whatever the batch: a sum has one order.
inline constexpr int group_size = 64;
inline constexpr int group_samples = 512;
inline constexpr int no_owner = 0xffff;

// Integers of a job.
inline constexpr int header = 0;               ///< its numbers
inline constexpr int triangles_a = 1;          ///< numbers of the probe's triangles
inline constexpr int triangle_integers_a = 2;  ///< integers of the same
inline constexpr int triangles_b = 3;
inline constexpr int triangle_integers_b = 4;
inline constexpr int owners_a = 5;  ///< which triangle is seen by each sample, two to an integer
inline constexpr int owners_b = 6;
inline constexpr int edges = 7;  ///< of the probe, then of the fixed body
inline constexpr int edge_count_a = 8;
inline constexpr int edge_count_b = 9;
inline constexpr int all_of_b = 10;  ///< 1: look the fixed body up where the probe is not, too, for its bad texels
inline constexpr int integers = 11;

// Numbers of a job.
inline constexpr int map_a = 0;
inline constexpr int map_b = 15;
inline constexpr int tau = 30;
inline constexpr int taper = 31;
inline constexpr int header_numbers = 32;

// A projected triangle: numbers, and integers (base texel x, y; next triangle across each edge, or -1).
inline constexpr int texel_x = 0;
inline constexpr int texel_y = 3;
inline constexpr int height = 6;
inline constexpr int outside = 9;  ///< distance from each edge, texels, as affine functions of the texel
inline constexpr int altitudes = 18;
inline constexpr int corners = 21;
inline constexpr int facing = 27;
inline constexpr int facing_turn = 28;  ///< of the logarithm of `facing`
inline constexpr int triangle_numbers = 31;
inline constexpr int triangle_integers = 5;

// An edge at which samples fade out.
inline constexpr int from = 0;
inline constexpr int to = 3;
inline constexpr int strength = 6;
inline constexpr int turn = 7;
inline constexpr int edge_numbers = 10;

// What a group leaves.
inline constexpr int depth = 0;
inline constexpr int index = 1;
inline constexpr int texel = 2;
inline constexpr int base = 4;
inline constexpr int samples = 6;
inline constexpr int inner_samples = 7;
inline constexpr int inner_depth = 8;
inline constexpr int bad = 9;
inline constexpr int top = 10;
inline constexpr int sums = 11;
inline constexpr int soft_sums = 21;  ///< weight, first moments (5), second moments (15)
inline constexpr int result_numbers = 32;

/// The list above as definitions of a shader.
[[nodiscard]] inline std::string definitions() {
  std::string text;
  for (const auto& [name, value] : {
           std::pair{"GROUP_SIZE", group_size},
           {"GROUP_SAMPLES", group_samples},
           {"NO_OWNER", no_owner},
           {"JOB_HEADER", header},
           {"JOB_TRIANGLES_A", triangles_a},
           {"JOB_TRIANGLE_INTEGERS_A", triangle_integers_a},
           {"JOB_TRIANGLES_B", triangles_b},
           {"JOB_TRIANGLE_INTEGERS_B", triangle_integers_b},
           {"JOB_OWNERS_A", owners_a},
           {"JOB_OWNERS_B", owners_b},
           {"JOB_EDGES", edges},
           {"JOB_EDGE_COUNT_A", edge_count_a},
           {"JOB_EDGE_COUNT_B", edge_count_b},
           {"JOB_ALL_OF_B", all_of_b},
           {"JOB_INTEGERS", integers},
           {"HEADER_MAP_A", map_a},
           {"HEADER_MAP_B", map_b},
           {"HEADER_TAU", tau},
           {"HEADER_TAPER", taper},
           {"TRIANGLE_TEXEL_X", texel_x},
           {"TRIANGLE_TEXEL_Y", texel_y},
           {"TRIANGLE_HEIGHT", height},
           {"TRIANGLE_OUTSIDE", outside},
           {"TRIANGLE_ALTITUDES", altitudes},
           {"TRIANGLE_CORNERS", corners},
           {"TRIANGLE_FACING", facing},
           {"TRIANGLE_FACING_TURN", facing_turn},
           {"TRIANGLE_NUMBERS", triangle_numbers},
           {"TRIANGLE_INTEGERS", triangle_integers},
           {"EDGE_FROM", from},
           {"EDGE_TO", to},
           {"EDGE_STRENGTH", strength},
           {"EDGE_TURN", turn},
           {"EDGE_NUMBERS", edge_numbers},
           {"RESULT_DEPTH", depth},
           {"RESULT_INDEX", index},
           {"RESULT_TEXEL", texel},
           {"RESULT_BASE", base},
           {"RESULT_SAMPLES", samples},
           {"RESULT_INNER_SAMPLES", inner_samples},
           {"RESULT_INNER_DEPTH", inner_depth},
           {"RESULT_BAD", bad},
           {"RESULT_TOP", top},
           {"RESULT_SUMS", sums},
           {"SOFT_SUMS", soft_sums},
           {"RESULT_NUMBERS", result_numbers},
       }) {
    text += std::string("#define ") + name + " " + std::to_string(value) + "\n";
  }
  return text;
}

}  // namespace asperity::gl::job
