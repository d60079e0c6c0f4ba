/* Poses and wrenches of left-handed engines. Every function is safe in a tick and may write where it reads.
 *
 * asperity's world is taken as x forward, y left, z up, right-handed, metres.
 * - Unity: x right, y up, z forward, left-handed, metres. A vector (x, y, z) is (-y, z, x) there.
 * - Unreal: x forward, y right, z up, left-handed, centimetres. A vector (x, y, z) is (100 x, -100 y, 100 z) there.
 *   Its forces are in kg cm/s^2 (100 of them are 1 N), its torques in kg cm^2/s^2 (10000 of them are 1 N m).
 *
 * A mirror image turns the other way. So what says how something turns (the axis of a quaternion, an angular velocity, a
 * torque) gets the other sign than a vector: in both, torque = lever x force, with that engine's own cross product. */
#ifndef ASPERITY_C_AXES_H
#define ASPERITY_C_AXES_H

#include "asperity/c/answer.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Poses x y z qx qy qz qw. A pose is only converted, not checked. Answers: ERROR_INVALID_ARGUMENT for NULL. */
ASPERITY_C_API int32_t asperity_pose_from_unity(const double unity[7], double pose[7]);
ASPERITY_C_API int32_t asperity_pose_to_unity(const double pose[7], double unity[7]);
ASPERITY_C_API int32_t asperity_pose_from_unreal(const double unreal[7], double pose[7]);
ASPERITY_C_API int32_t asperity_pose_to_unreal(const double pose[7], double unreal[7]);

/* Wrenches, force then torque. */
ASPERITY_C_API int32_t asperity_wrench_from_unity(const double unity[6], double wrench[6]);
ASPERITY_C_API int32_t asperity_wrench_to_unity(const double wrench[6], double unity[6]);
ASPERITY_C_API int32_t asperity_wrench_from_unreal(const double unreal[6], double wrench[6]);
ASPERITY_C_API int32_t asperity_wrench_to_unreal(const double wrench[6], double unreal[6]);

/* Twists, linear then angular (rad/s in both engines' names; Unity's own is rad/s, Unreal's often degrees/s). */
ASPERITY_C_API int32_t asperity_twist_from_unity(const double unity[6], double twist[6]);
ASPERITY_C_API int32_t asperity_twist_to_unity(const double twist[6], double unity[6]);
ASPERITY_C_API int32_t asperity_twist_from_unreal(const double unreal[6], double twist[6]);
ASPERITY_C_API int32_t asperity_twist_to_unreal(const double twist[6], double unreal[6]);

#ifdef __cplusplus
}
#endif
#endif
