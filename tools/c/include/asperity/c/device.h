/* A haptic device. In this version a simulated one: numbers on the caller's clock, with a hand that holds it. */
#ifndef ASPERITY_C_DEVICE_H
#define ASPERITY_C_DEVICE_H

#include "asperity/c/answer.h"

#ifdef __cplusplus
extern "C" {
#endif
/* NOLINTBEGIN(modernize-use-using): C */

typedef struct asperity_haptic_device asperity_haptic_device;

/* What the simulated hand means to do: 1 and the numbers of asperity::motion_kind. */
#define ASPERITY_MOTION_USUAL 0u /* scrub */
#define ASPERITY_MOTION_PRESS 1u /* approach along a direction, then hold */
#define ASPERITY_MOTION_SCRUB 2u /* approach, then to and fro sideways */
#define ASPERITY_MOTION_TWIST 3u /* approach, then turn to and fro */
#define ASPERITY_MOTION_TAP 4u   /* approach, then lift off and come down again and again */
#define ASPERITY_MOTION_FREE 5u  /* wander in a box */

/* How it holds the device. */
#define ASPERITY_HAND_USUAL 0u
#define ASPERITY_HAND_SOFT 1u
#define ASPERITY_HAND_FIRM 2u

/* States of a device: numbers of asperity::device_state. Output other than zero in ARMED and ACTIVE only. */
#define ASPERITY_DEVICE_ABSENT 0u
#define ASPERITY_DEVICE_PRESENT 1u
#define ASPERITY_DEVICE_OPEN 2u
#define ASPERITY_DEVICE_READY 3u
#define ASPERITY_DEVICE_ARMED 4u
#define ASPERITY_DEVICE_ACTIVE 5u
#define ASPERITY_DEVICE_FAULT 6u
#define ASPERITY_DEVICE_CLOSED 7u

/* In brackets what 0 stands for. d is the device's base frame. */
typedef struct asperity_simulated_settings {
  uint32_t size;        /* sizeof this */
  uint32_t motion;      /* ASPERITY_MOTION_... */
  uint64_t seed;        /* of tremor, jitter and losses (1) */
  double approach_m;    /* how far the hand means to go along `direction` (0.01) */
  double approach_s;    /* in which time (0.5) */
  double amplitude_m;   /* of scrub, tap and free (0.01) */
  double amplitude_rad; /* of twist and free (0.2) */
  double frequency_hz;  /* of the motion (1) */
  double direction[3];  /* of the approach, unit (0 0 -1) */
  double sideways[3];   /* of scrub, unit (1 0 0) */
  double start_pose[7]; /* of the handle in d (the identity) */
  uint32_t hand;        /* ASPERITY_HAND_... */
  uint32_t reserved;    /* 0 */
  int64_t delay_ns;     /* age of a measurement, with jitter_ns at most 20 ms */
  int64_t jitter_ns;
  double loss; /* share of measurements that are lost, 0 to 1 */
} asperity_simulated_settings;

/* What a device can do. */
typedef struct asperity_device_limits {
  uint32_t size;     /* sizeof this */
  uint32_t sensed;   /* axes that are measured: bits 0-2 translation x y z, 3-5 rotation */
  uint32_t actuated; /* axes that can put out an effort */
  uint32_t reserved;
  double continuous_force_n;
  double peak_force_n;
  double continuous_torque_n_m;
  double peak_torque_n_m;
  double max_stiffness_n_per_m; /* largest stable one at max_stiffness_rate_hz */
  double max_stiffness_rate_hz;
  double nominal_rate_hz;
} asperity_device_limits;

/* One measurement. Axes of d. */
typedef struct asperity_measurement {
  uint32_t size;        /* sizeof this */
  uint32_t buttons;     /* held down, one bit each */
  int64_t host_time_ns; /* when it was received, on the clock that is given to read() */
  uint64_t sequence;    /* grows with every new one */
  double pose[7];       /* of the handle */
  double twist[6];      /* of the handle's origin */
} asperity_measurement;

/* Not for a tick. Answers: INVALID_ARGUMENT. */
ASPERITY_C_API int32_t asperity_device_make_simulated(const asperity_simulated_settings* settings,
                                                      asperity_haptic_device** out, asperity_error* why);
/* Disarms and closes it, where a session has it once that is freed. Not for a tick. */
ASPERITY_C_API int32_t asperity_device_free(asperity_haptic_device* device);

/* Takes the device. Not for a tick. While a session has the device, this and the four functions below answer ERROR_BUSY. */
ASPERITY_C_API int32_t asperity_device_open(asperity_haptic_device* device, asperity_error* why);
/* Allows it to put out a wrench. Not for a tick. */
ASPERITY_C_API int32_t asperity_device_arm(asperity_haptic_device* device, asperity_error* why);
/* Forbids it. Safe in a tick. */
ASPERITY_C_API int32_t asperity_device_disarm(asperity_haptic_device* device);
/* Newest measurement. now_ns: your clock, which never goes back. Safe in a tick. */
ASPERITY_C_API int32_t asperity_device_read(asperity_haptic_device* device, int64_t now_ns, asperity_measurement* out);
/* The wrench on the hand until valid_until_ns: axes of d, torque about the handle's origin. Safe in a tick. It is not
 * limited here: the device's own limits are in asperity_device_get_limits(). Answers: STATUS_NOT_FINITE, and zero is put
 * out. */
ASPERITY_C_API int32_t asperity_device_write(asperity_haptic_device* device, int64_t now_ns, const double on_hand[6],
                                             int64_t valid_until_ns);
/* Safe in a tick, also while a session has the device. */
ASPERITY_C_API int32_t asperity_device_get_limits(const asperity_haptic_device* device, asperity_device_limits* out);
/* ASPERITY_DEVICE_..., as the last call left it; ABSENT for what is no device. Safe in a tick, also while a session has
 * the device. */
ASPERITY_C_API uint32_t asperity_device_state(const asperity_haptic_device* device);

/* NOLINTEND(modernize-use-using) */
#ifdef __cplusplus
}
#endif
#endif
