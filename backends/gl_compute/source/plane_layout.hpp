// Where things stand in the buffers that plane_batch and its shaders share. The shaders learn these numbers as definitions.
#pragma once

#include <cstddef>
#include <string>
#include <utility>

#include "asperity/field/body_field.hpp"
#include "planes/facing.hpp"

namespace asperity::gl::planes {

inline constexpr int group_size = 64;
inline constexpr int most_directions = 16;  ///< of a pose

// Integers of a meeting: samples of one body in the field of another. Of each fixed body there are two, the probe's
// samples first.
inline constexpr int leaves = 0;          ///< how many
inline constexpr int first_leaf = 1;      ///< in the table
inline constexpr int first_ball = 2;      ///< of the leaves, in the nodes
inline constexpr int first_sample = 3;    ///< in the nodes
inline constexpr int field_numbers = 4;   ///< of the other body
inline constexpr int field_integers = 5;  ///< of the other body
inline constexpr int meeting_integers = 6;

inline constexpr int leaf_integers = 2;   ///< first sample, count
inline constexpr int ball_numbers = 4;    ///< centre, radius
inline constexpr int sample_numbers = 8;  ///< position, axis, cosines: full, none

// Integers of a body.
inline constexpr int nodes = 0;
inline constexpr int first_node = 3;
inline constexpr int bricks = 4;
inline constexpr int first_index = 7;
inline constexpr int first_brick = 8;
inline constexpr int body_integers = 9;

// Numbers of the scene, which come first, and of a body.
inline constexpr int above = 0;
inline constexpr int shallow = 1;
inline constexpr int same_direction = 2;
inline constexpr int scene_numbers = 3;
inline constexpr int low = 0;
inline constexpr int pitch = 3;
inline constexpr int relief_low = 4;
inline constexpr int relief_pitch = 7;
inline constexpr int highest_relief = 8;
inline constexpr int body_numbers = 9;

// Numbers of a meeting at a pose: T_yx by columns, shift, and the rotation from Y to the world by columns, its sign that
// of a depth by the probe's motion.
inline constexpr int place_numbers = 21;

inline constexpr int plane_numbers = 4;   ///< depth, slope by the probe's position
inline constexpr int plane_integers = 2;  ///< meeting, sample

// Integers of a pose's answer.
inline constexpr int told_count = 0;
inline constexpr int told_left_out = 1;
inline constexpr int told_planes = 2;
inline constexpr int told_integers = told_planes + most_directions * plane_integers;

/// The list above as definitions of a shader.
[[nodiscard]] inline std::string definitions() {
  std::string text;
  for (const auto& [name, value] : {
           std::pair{"GROUP_SIZE", group_size},
           {"MOST_DIRECTIONS", most_directions},
           {"MEETING_LEAVES", leaves},
           {"MEETING_FIRST_LEAF", first_leaf},
           {"MEETING_FIRST_BALL", first_ball},
           {"MEETING_FIRST_SAMPLE", first_sample},
           {"MEETING_FIELD_NUMBERS", field_numbers},
           {"MEETING_FIELD_INTEGERS", field_integers},
           {"MEETING_INTEGERS", meeting_integers},
           {"LEAF_INTEGERS", leaf_integers},
           {"BALL_NUMBERS", ball_numbers},
           {"SAMPLE_NUMBERS", sample_numbers},
           {"BODY_NODES", nodes},
           {"BODY_FIRST_NODE", first_node},
           {"BODY_BRICKS", bricks},
           {"BODY_FIRST_INDEX", first_index},
           {"BODY_FIRST_BRICK", first_brick},
           {"SCENE_ABOVE", above},
           {"SCENE_SHALLOW", shallow},
           {"SCENE_SAME_DIRECTION", same_direction},
           {"BODY_LOW", low},
           {"BODY_PITCH", pitch},
           {"BODY_RELIEF_LOW", relief_low},
           {"BODY_RELIEF_PITCH", relief_pitch},
           {"BODY_HIGHEST_RELIEF", highest_relief},
           {"PLACE_NUMBERS", place_numbers},
           {"PLANE_NUMBERS", plane_numbers},
           {"PLANE_INTEGERS", plane_integers},
           {"TOLD_COUNT", told_count},
           {"TOLD_LEFT_OUT", told_left_out},
           {"TOLD_PLANES", told_planes},
           {"TOLD_INTEGERS", told_integers},
           {"BRICK_SIDE", static_cast<int>(detail::relief_bricks::side)},
       }) {
    text += std::string("#define ") + name + " " + std::to_string(value) + "\n";
  }
  for (const auto& [name, value] : {std::pair{"FADE_FULL", body_field::fade_full},
                                    {"FADE_NONE", body_field::fade_none},
                                    {"DISTANCE_SLACK", body_field::distance_slack},
                                    {"LEAST_SLOPE", facing::least_slope},
                                    {"LEAST_SHARE", facing::least_share}}) {
    text += std::string("#define ") + name + " " + std::to_string(value) + "\n";
  }
  return text;
}

}  // namespace asperity::gl::planes
