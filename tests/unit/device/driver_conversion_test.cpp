// Between a driver's structs and the library's types: each number where the C header says it is, and nothing beyond
// what the other side has room for.
#include <array>
#include <cstring>
#include <gtest/gtest.h>
#include <string>

#include <asperity/device/driver_conversion.hpp>
#include <asperity/device/simulated/simulated_settings.hpp>

namespace {

using namespace asperity;

TEST(driver_conversion, a_command_says_what_it_says) {
  const device_command c{{{1, -2, 3}, {0.25, 0.5, -0.75}}, wrench_frame::device_base, 12'345'678'901, 77};
  const asperity_command bits = asperity::abi::to_abi(c);
  EXPECT_EQ(bits.struct_size, sizeof bits);
  EXPECT_EQ(bits.frame, static_cast<std::uint32_t>(ASPERITY_FRAME_BASE));
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(bits.force_d_n[i], c.on_hand.force[static_cast<int>(i)]);
    EXPECT_EQ(bits.torque_d_n_m[i], c.on_hand.torque[static_cast<int>(i)]);
  }
  EXPECT_EQ(bits.valid_until_ns, 12'345'678'901);
  EXPECT_EQ(bits.sequence, 77U);
  const device_command back = asperity::abi::from_abi(bits);
  EXPECT_EQ(back.on_hand.force, c.on_hand.force);
  EXPECT_EQ(back.on_hand.torque, c.on_hand.torque);
  EXPECT_EQ(back.frame, wrench_frame::device_base);
  EXPECT_EQ(back.valid_until_ns, c.valid_until_ns);
  // Any other frame arrives as none: a driver refuses it.
  for (const wrench_frame other : {wrench_frame::unset, wrench_frame::world, wrench_frame::handle}) {
    device_command wrong = c;
    wrong.frame = other;
    EXPECT_NE(asperity::abi::to_abi(wrong).frame, static_cast<std::uint32_t>(ASPERITY_FRAME_BASE));
    EXPECT_EQ(asperity::abi::from_abi(asperity::abi::to_abi(wrong)).frame, wrench_frame::unset);
  }
}

TEST(driver_conversion, a_sample_keeps_its_axes_and_its_turn) {
  device_sample s;
  s.host_time_ns = 11;
  s.device_time_ns = 12;
  s.sequence = 13;
  s.lost = 14;
  s.T_dh = {quat(0.5, -0.5, 0.5, 0.5), {1, 2, 3}};
  s.velocity_d = {{4, 5, 6}, {7, 8, 9}};
  s.buttons = 0x80000001U;
  s.valid = sample_field::position | sample_field::rotation | sample_field::buttons;
  asperity_sample bits = asperity::abi::to_abi(s);
  const std::array<double, 4> xyzw{-0.5, 0.5, 0.5, 0.5};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(bits.rotation_dh_xyzw[i], xyzw[i]);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto n = static_cast<double>(i);
    EXPECT_EQ(bits.position_d_m[i], 1.0 + n);
    EXPECT_EQ(bits.linear_velocity_d_m_per_s[i], 4.0 + n);
    EXPECT_EQ(bits.angular_velocity_d_rad_per_s[i], 7.0 + n);
  }
  EXPECT_EQ(bits.host_time_ns, 11);
  EXPECT_EQ(bits.device_time_ns, 12);
  EXPECT_EQ(bits.sequence, 13U);
  EXPECT_EQ(bits.lost, 14U);
  EXPECT_EQ(bits.buttons, 0x80000001U);
  bits.valid |= 0xffffff00U;  // of a newer driver: not known, not kept
  const device_sample back = asperity::abi::from_abi(bits);
  EXPECT_EQ(back.T_dh.position, s.T_dh.position);
  EXPECT_EQ(back.T_dh.rotation, s.T_dh.rotation);
  EXPECT_EQ(back.velocity_d.linear, s.velocity_d.linear);
  EXPECT_EQ(back.velocity_d.angular, s.velocity_d.angular);
  EXPECT_EQ(back.valid, s.valid);
}

TEST(driver_conversion, a_gripper_is_the_seventh_value) {
  device_sample s;
  s.valid = sample_field::position | sample_field::gripper;
  s.gripper_m = 0.03;
  const asperity_sample bits = asperity::abi::to_abi(s);
  EXPECT_EQ(bits.gripper_m, 0.03);
  EXPECT_EQ(bits.valid, ASPERITY_VALID_POSITION | ASPERITY_VALID_GRIPPER);
  EXPECT_EQ(asperity::abi::from_abi(bits).gripper_m, 0.03);
  EXPECT_TRUE(has_all(asperity::abi::from_abi(bits).valid, sample_field::gripper));
  device_capabilities c = simulated_capabilities();
  EXPECT_FALSE(c.has_gripper());
  c.gripper_low_m = 0.01;
  c.gripper_high_m = 0.05;
  const device_capabilities back = asperity::abi::from_abi(asperity::abi::to_abi(c));
  EXPECT_EQ(back.gripper_low_m, 0.01);
  EXPECT_EQ(back.gripper_high_m, 0.05);
  EXPECT_TRUE(back.has_gripper());
}

// Version 1.0 ends before the gripper: what it has there is somebody else's memory.
TEST(driver_conversion, an_older_side_has_no_gripper) {
  constexpr std::uint32_t sample_of_1_0 = 184, capabilities_of_1_0 = 328;
  device_sample s;
  s.gripper_m = 0.03;
  asperity_sample older = asperity::abi::to_abi(s);
  older.struct_size = sample_of_1_0;
  EXPECT_EQ(asperity::abi::copy_in(older).gripper_m, 0.0);
  older.gripper_m = 0.7;
  asperity::abi::copy_out(asperity::abi::to_abi(s), older);
  EXPECT_EQ(older.gripper_m, 0.7);
  auto limits = asperity::abi::blank<asperity_capabilities>();
  limits.gripper_high_m = 0.05;
  limits.struct_size = capabilities_of_1_0;
  EXPECT_FALSE(asperity::abi::from_abi(asperity::abi::copy_in(limits)).has_gripper());
}

TEST(driver_conversion, a_drivers_limits_arrive_each_as_itself) {
  auto bits = asperity::abi::blank<asperity_capabilities>();
  double n = 1.0;
  for (double* x : {&bits.continuous_force_n, &bits.peak_force_n, &bits.continuous_torque_n_m, &bits.peak_torque_n_m,
                    &bits.force_slew_n_per_s, &bits.torque_slew_n_m_per_s, &bits.moving_mass_kg,
                    &bits.moving_inertia_kg_m2, &bits.minimum_rate_hz, &bits.nominal_rate_hz}) {
    *x = n++;
  }
  bits.flags = ASPERITY_DEVICE_SIDE_WATCHDOG;
  asperity::abi::put_text(bits.name, "a handle");
  const device_capabilities c = asperity::abi::from_abi(bits);
  n = 1.0;
  for (const double x :
       {c.continuous_force_n, c.peak_force_n, c.continuous_torque_n_m, c.peak_torque_n_m, c.force_slew_n_per_s,
        c.torque_slew_n_m_per_s, c.moving_mass_kg, c.moving_inertia_kg_m2, c.minimum_rate_hz, c.nominal_rate_hz}) {
    EXPECT_EQ(x, n++);
  }
  EXPECT_TRUE(c.device_side_watchdog);
  EXPECT_FALSE(c.needs_homing);
  EXPECT_EQ(c.name, "a handle");
  const asperity_capabilities again = asperity::abi::to_abi(c);
  EXPECT_EQ(std::memcmp(&again, &bits, sizeof bits), 0);
}

TEST(driver_conversion, writes_no_more_than_the_other_side_has) {
  const asperity_applied whole = asperity::abi::to_abi(wrench{{1, 2, 3}, {4, 5, 6}});
  for (std::uint32_t size = 0; size <= sizeof whole; ++size) {
    asperity_applied older;
    std::memset(&older, 0xa5, sizeof older);
    older.struct_size = size;
    asperity::abi::copy_out(whole, older);
    EXPECT_EQ(older.struct_size, size);
    for (std::size_t i = sizeof older.struct_size; i < sizeof older; ++i) {
      const auto byte = reinterpret_cast<const unsigned char*>(&older)[i];
      const auto sent = reinterpret_cast<const unsigned char*>(&whole)[i];
      ASSERT_EQ(byte, i < size ? sent : 0xa5) << "struct_size " << size << ", byte " << i;
    }
  }
}

TEST(driver_conversion, a_text_without_an_end_is_none) {
  std::array<char, 4> field{'a', 'b', 'c', 'd'};
  EXPECT_FALSE(asperity::abi::get_text(field));
  field[3] = '\0';
  ASSERT_TRUE(asperity::abi::get_text(field));
  EXPECT_EQ(*asperity::abi::get_text(field), "abc");
  EXPECT_FALSE(asperity::abi::get_text({}));
}

TEST(driver_conversion, no_failure_passes_for_a_success) {
  for (const status s :
       {status::invalid_pose, status::not_finite, status::stale_input, status::not_ready, status::backend_failed}) {
    EXPECT_NE(asperity::abi::to_code(s), ASPERITY_OK) << to_string(s);
  }
  EXPECT_EQ(asperity::abi::to_code(status::ok), ASPERITY_OK);
  EXPECT_EQ(asperity::abi::to_status(ASPERITY_OK), status::ok);
  for (const std::int32_t unknown : {-1, 99, 1 << 30})
    EXPECT_EQ(asperity::abi::to_status(unknown), status::backend_failed);
  for (const std::int32_t none : {-1, device_state_count, 1 << 30}) EXPECT_FALSE(asperity::abi::to_state(none));
}

}  // namespace
