/* The two-rate control loop with a device, on the virtual clock: as fast as the machine can, the same bits every time. */
#ifndef ASPERITY_C_SESSION_H
#define ASPERITY_C_SESSION_H

#include "asperity/c/device.h"
#include "asperity/c/renderer.h"

#ifdef __cplusplus
extern "C" {
#endif
/* NOLINTBEGIN(modernize-use-using): C */

typedef struct asperity_session asperity_session;

/* In brackets what 0 stands for. */
typedef struct asperity_session_settings {
  uint32_t size;               /* sizeof this */
  uint32_t formulation;        /* ASPERITY_FORMULATION_... (planes) */
  double device_rate_hz;       /* 100 to 10000 (1000) */
  double contact_rate_hz;      /* 100 to 10000 (1000) */
  double scale;                /* metres in the world for a metre of the device (1) */
  double coupling_n_per_m;     /* spring from the handle to the probe (what the device bears on planes; 500) */
  double coupling_n_m_per_rad; /* the same of rotations (the same; 3) */
  double stiffness_n_per_m;    /* of every touch (what the materials or the formulation say) */
  double dissipation_s_per_m;  /* planes: of every touch (what the materials say) */
  double static_friction;      /* planes: of every touch; where both are 0, what the materials say */
  double dynamic_friction;     /* at most static_friction */
  double mass_kg;              /* of the probe (0.01) */
  double most_force_n;         /* the gate lets no more through (the device's own limit) */
  double most_torque_n_m;      /* the same of the torque */
  double start_pose[7];        /* of the probe, where the handle is at d's origin (3 mm above its first touch) */
  uint32_t threads;            /* planes: that share a contact tick, 1 to 16, with the same bits for any number (1) */
  uint32_t reserved;           /* 0 */
} asperity_session_settings;

/* The last of the device ticks that a call ran. World axes unless said otherwise. */
typedef struct asperity_session_tick {
  uint32_t size;         /* sizeof this */
  uint32_t flags;        /* ASPERITY_FLAG_..., held for 50 ms */
  int64_t time_ns;       /* of the tick, from 0 */
  double device_pose[7]; /* handle in the device's frame */
  double probe_pose[7];
  double on_hand[6];  /* what left the gate: axes of the device, torque about the handle's origin */
  double on_probe[6]; /* of the contact, about the probe's centre of mass */
  double deepest_m;
  double delivered_j; /* energy delivered to the hand since the start */
  uint32_t contacts;  /* that overlap */
  uint32_t planes;    /* of the contact in use */
  uint32_t sample;    /* why a sample was not believed; 0: it was (asperity::sample_verdict) */
  uint32_t device;    /* ASPERITY_DEVICE_... */
  uint32_t fault;     /* what shut the gate; 0: nothing (asperity::gate_fault) */
  uint32_t ticks;     /* that this call ran: fewer than asked for where the gate shut */
} asperity_session_tick;

/* Makes a session, and opens and arms the device, which nobody else may use until the session is freed. Not for a tick.
 * fixed_poses: 7 doubles for each fixed body, or NULL: all at the world's origin
 * Answers: INVALID_ARGUMENT, BAD_MESH, BAD_TEXTURE; BUSY where another session has the device; what the device answers. */
ASPERITY_C_API int32_t asperity_session_make(const asperity_model* probe, const asperity_model* const* fixed,
                                             const double* fixed_poses, uint32_t fixed_count,
                                             asperity_haptic_device* device, const asperity_session_settings* settings,
                                             asperity_session** out, asperity_error* why);
/* Disarms the device and lets go of it. Not for a tick. */
ASPERITY_C_API int32_t asperity_session_free(asperity_session* session);

/* Runs device ticks, with the contact ticks that fall between them. Safe in a tick, as long as its cost is: every tick
 * renders. Answers: that of the last device tick, STATUS_GATE_SHUT once the gate is shut. out may be NULL. */
ASPERITY_C_API int32_t asperity_session_step(asperity_session* session, uint32_t ticks, asperity_session_tick* out);
/* Shuts the gate, runs ticks until the wrench is zero, disarms. Safe in a tick in the same sense; a stopped session
 * answers step() with STATUS_GATE_SHUT. */
ASPERITY_C_API int32_t asperity_session_stop(asperity_session* session);

/* NOLINTEND(modernize-use-using) */
#ifdef __cplusplus
}
#endif
#endif
