// The messages of an MCAP recording in ROS 2's words.
#pragma once

#include <string>

namespace asperity::command {

inline constexpr const char* separator =
    "================================================================================\n";

/// std_msgs/Header and what it is made of, as a schema lists them behind the message itself.
[[nodiscard]] inline std::string header_definition() {
  return std::string(separator) +
         "MSG: std_msgs/Header\n"
         "builtin_interfaces/Time stamp\n"
         "string frame_id\n" +
         separator +
         "MSG: builtin_interfaces/Time\n"
         "int32 sec\n"
         "uint32 nanosec\n";
}

[[nodiscard]] inline std::string wrench_definition() {
  return "std_msgs/Header header\n"
         "Wrench wrench\n" +
         std::string(separator) +
         "MSG: geometry_msgs/Wrench\n"
         "Vector3 force\n"
         "Vector3 torque\n" +
         separator +
         "MSG: geometry_msgs/Vector3\n"
         "float64 x\n"
         "float64 y\n"
         "float64 z\n" +
         header_definition();
}

[[nodiscard]] inline std::string pose_definition() {
  return "std_msgs/Header header\n"
         "Pose pose\n" +
         std::string(separator) +
         "MSG: geometry_msgs/Pose\n"
         "Point position\n"
         "Quaternion orientation\n" +
         separator +
         "MSG: geometry_msgs/Point\n"
         "float64 x\n"
         "float64 y\n"
         "float64 z\n" +
         separator +
         "MSG: geometry_msgs/Quaternion\n"
         "float64 x\n"
         "float64 y\n"
         "float64 z\n"
         "float64 w\n" +
         header_definition();
}

/// What ROS has no message for, under the names of the columns of a table.
[[nodiscard]] inline std::string tick_definition() {
  return "std_msgs/Header header\n"
         "float64 depth_m\n"
         "float64 contacts\n"
         "float64 contact_age_s\n"
         "float64 delivered_j\n"
         "float64 surplus_j\n"
         "float64 guard_alpha_per_s\n"
         "float64 guard_scale\n"
         "string sample\n"
         "string device\n"
         "string fault\n" +
         header_definition();
}

}  // namespace asperity::command
