/* Where every field of driver_abi.h lies in version 1.0, on a machine with 64-bit pointers. A driver that was built
 * years ago believes these numbers: a line of this file changes with a new major version only. A minor version adds
 * lines, and changes the sizes of the structs that it appends to. */
#include <stddef.h>

#include "asperity/device/driver_abi.h"

#ifdef __cplusplus
#define HOLDS(name, condition) static_assert(condition, #name)
#else /* C99 has no static_assert */
#define HOLDS(name, condition) typedef char name[(condition) ? 1 : -1]
#endif
#define AT(type, field, offset, size) \
  HOLDS(type##_##field##_has_moved,   \
        offsetof(struct type, field) == (offset) && sizeof(((struct type*)NULL)->field) == (size))
#define SIZE(type, size) HOLDS(type##_has_another_size, sizeof(struct type) == (size))
#define IS(constant, value) HOLDS(constant##_has_another_value, (constant) == (value))

/* clang-format off */
AT(asperity_capabilities, struct_size, 0, 4);
AT(asperity_capabilities, maturity, 4, 4);
AT(asperity_capabilities, sensed, 8, 4);
AT(asperity_capabilities, actuated, 12, 4);
AT(asperity_capabilities, flags, 16, 4);
AT(asperity_capabilities, reserved_0, 20, 4);
AT(asperity_capabilities, continuous_force_n, 24, 8);
AT(asperity_capabilities, peak_force_n, 32, 8);
AT(asperity_capabilities, continuous_torque_n_m, 40, 8);
AT(asperity_capabilities, peak_torque_n_m, 48, 8);
AT(asperity_capabilities, force_slew_n_per_s, 56, 8);
AT(asperity_capabilities, torque_slew_n_m_per_s, 64, 8);
AT(asperity_capabilities, max_stiffness_n_per_m, 72, 8);
AT(asperity_capabilities, max_stiffness_n_m_per_rad, 80, 8);
AT(asperity_capabilities, max_stiffness_rate_hz, 88, 8);
AT(asperity_capabilities, workspace_low_d_m, 96, 24);
AT(asperity_capabilities, workspace_high_d_m, 120, 24);
AT(asperity_capabilities, position_resolution_m, 144, 8);
AT(asperity_capabilities, rotation_resolution_rad, 152, 8);
AT(asperity_capabilities, nominal_rate_hz, 160, 8);
AT(asperity_capabilities, minimum_rate_hz, 168, 8);
AT(asperity_capabilities, worst_latency_ns, 176, 8);
AT(asperity_capabilities, moving_mass_kg, 184, 8);
AT(asperity_capabilities, moving_inertia_kg_m2, 192, 8);
AT(asperity_capabilities, name, 200, 64);
AT(asperity_capabilities, reserved, 264, 64);
AT(asperity_capabilities, gripper_low_m, 328, 8);  /* 1.1 */
AT(asperity_capabilities, gripper_high_m, 336, 8); /* 1.1 */
AT(asperity_listing, struct_size, 0, 4);
AT(asperity_listing, maturity, 4, 4);
AT(asperity_listing, identity, 8, 128);
AT(asperity_listing, path, 136, 256);
AT(asperity_listing, name, 392, 64);
AT(asperity_listing, not_openable, 456, 512);
AT(asperity_listing, capabilities, 968, 8);
AT(asperity_listing, reserved, 976, 32);
AT(asperity_sample, struct_size, 0, 4);
AT(asperity_sample, valid, 4, 4);
AT(asperity_sample, host_time_ns, 8, 8);
AT(asperity_sample, device_time_ns, 16, 8);
AT(asperity_sample, sequence, 24, 8);
AT(asperity_sample, lost, 32, 8);
AT(asperity_sample, position_d_m, 40, 24);
AT(asperity_sample, rotation_dh_xyzw, 64, 32);
AT(asperity_sample, linear_velocity_d_m_per_s, 96, 24);
AT(asperity_sample, angular_velocity_d_rad_per_s, 120, 24);
AT(asperity_sample, buttons, 144, 4);
AT(asperity_sample, reserved_0, 148, 4);
AT(asperity_sample, reserved, 152, 32);
AT(asperity_sample, gripper_m, 184, 8); /* 1.1 */
AT(asperity_command, struct_size, 0, 4);
AT(asperity_command, frame, 4, 4);
AT(asperity_command, force_d_n, 8, 24);
AT(asperity_command, torque_d_n_m, 32, 24);
AT(asperity_command, valid_until_ns, 56, 8);
AT(asperity_command, sequence, 64, 8);
AT(asperity_command, reserved, 72, 32);
AT(asperity_applied, struct_size, 0, 4);
AT(asperity_applied, reserved_0, 4, 4);
AT(asperity_applied, force_d_n, 8, 24);
AT(asperity_applied, torque_d_n_m, 32, 24);
AT(asperity_applied, reserved, 56, 32);
AT(asperity_host, struct_size, 0, 4);
AT(asperity_host, abi_version, 4, 4);
AT(asperity_host, context, 8, 8);
AT(asperity_host, log, 16, 8);
AT(asperity_host, reserved, 24, 32);
AT(asperity_driver, struct_size, 0, 4);
AT(asperity_driver, abi_major, 4, 4);
AT(asperity_driver, abi_minor, 8, 4);
AT(asperity_driver, maturity, 12, 4);
AT(asperity_driver, name, 16, 8);
AT(asperity_driver, version, 24, 8);
AT(asperity_driver, licence, 32, 8);
AT(asperity_driver, vendor, 40, 8);
AT(asperity_driver, reserved, 48, 32);
AT(asperity_driver, list, 80, 8);
AT(asperity_driver, make, 88, 8);
AT(asperity_driver, destroy, 96, 8);
AT(asperity_driver, capabilities, 104, 8);
AT(asperity_driver, state, 112, 8);
AT(asperity_driver, open, 120, 8);
AT(asperity_driver, arm, 128, 8);
AT(asperity_driver, clear_fault, 136, 8);
AT(asperity_driver, disarm, 144, 8);
AT(asperity_driver, close, 152, 8);
AT(asperity_driver, read, 160, 8);
AT(asperity_driver, write, 168, 8);
AT(asperity_driver, attach, 176, 8);
AT(asperity_driver, detach, 184, 8);
AT(asperity_driver, applied, 192, 8);
AT(asperity_driver, fault_text, 200, 8);
AT(asperity_driver, provoke, 208, 8);
AT(asperity_driver, reserved_functions, 216, 64);
SIZE(asperity_capabilities, 344);
SIZE(asperity_listing, 1008);
SIZE(asperity_sample, 192);
SIZE(asperity_command, 104);
SIZE(asperity_applied, 88);
SIZE(asperity_host, 56);
SIZE(asperity_driver, 280);
IS(ASPERITY_ABI_MAJOR, 1);
IS(ASPERITY_OK, 0);
IS(ASPERITY_NOT_READY, 1);
IS(ASPERITY_FAILED, 2);
IS(ASPERITY_NOT_FINITE, 3);
IS(ASPERITY_STALE, 4);
IS(ASPERITY_INVALID, 5);
IS(ASPERITY_UNSUPPORTED, 6);
IS(ASPERITY_STATE_ABSENT, 0);
IS(ASPERITY_STATE_PRESENT, 1);
IS(ASPERITY_STATE_OPEN, 2);
IS(ASPERITY_STATE_READY, 3);
IS(ASPERITY_STATE_ARMED, 4);
IS(ASPERITY_STATE_ACTIVE, 5);
IS(ASPERITY_STATE_FAULT, 6);
IS(ASPERITY_STATE_CLOSED, 7);
IS(ASPERITY_MATURITY_SIMULATED, 0);
IS(ASPERITY_MATURITY_PROTOCOL_TESTED, 1);
IS(ASPERITY_MATURITY_HARDWARE_VERIFIED, 2);
IS(ASPERITY_AXES_TRANSLATION, 7);
IS(ASPERITY_AXES_ROTATION, 56);
IS(ASPERITY_AXES_ALL, 63);
IS(ASPERITY_NEEDS_HOMING, 1);
IS(ASPERITY_DEVICE_SIDE_WATCHDOG, 2);
IS(ASPERITY_VALID_POSITION, 1);
IS(ASPERITY_VALID_ROTATION, 2);
IS(ASPERITY_VALID_LINEAR_VELOCITY, 4);
IS(ASPERITY_VALID_ANGULAR_VELOCITY, 8);
IS(ASPERITY_VALID_BUTTONS, 16);
IS(ASPERITY_VALID_GRIPPER, 32); /* 1.1 */
IS(ASPERITY_FRAME_BASE, 1);
IS(ASPERITY_LOG_DEBUG, 0);
IS(ASPERITY_LOG_INFO, 1);
IS(ASPERITY_LOG_WARNING, 2);
IS(ASPERITY_LOG_ERROR, 3);
IS(ASPERITY_PROVOKE_DEPARTURE, 1);
IS(ASPERITY_PROVOKE_RETURN, 2);
IS(ASPERITY_PROVOKE_WRITE_FAILURE, 3);
IS(ASPERITY_NAME_SIZE, 64);
IS(ASPERITY_IDENTITY_SIZE, 128);
IS(ASPERITY_PATH_SIZE, 256);
IS(ASPERITY_TEXT_SIZE, 512);
/* clang-format on */
