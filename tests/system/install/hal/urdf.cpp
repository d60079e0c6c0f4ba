// A program of a consumer of asperity::urdf: an arm with one joint.
#include <cstdio>

#include <asperity/urdf/read_urdf.hpp>

int main() {
  const auto arm = asperity::parse_urdf(R"(<robot name="one">
      <link name="base"/> <link name="handle"/>
      <joint name="turn" type="revolute">
        <parent link="base"/> <child link="handle"/> <axis xyz="0 0 1"/>
        <limit lower="-1" upper="1" effort="2" velocity="3"/>
      </joint>
    </robot>)",
                                        {.base_link = "base", .handle_link = "handle"});
  if (!arm) return std::puts(arm.error().message.c_str()), 1;
  std::printf("%s: %g rad/s\n", arm->joint_names[0].c_str(), arm->max_speed_rad_per_s[0]);
  return arm->joint_names.size() == 1 && arm->max_speed_rad_per_s[0] == 3.0 ? 0 : 1;
}
