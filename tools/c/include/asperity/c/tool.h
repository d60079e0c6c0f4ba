/* A virtual tool for programs that have a loop and a clock of their own, as game engines do: a hand's pose in, the
 * wrench on the hand out. */
#ifndef ASPERITY_C_TOOL_H
#define ASPERITY_C_TOOL_H

#include "asperity/c/renderer.h"

#ifdef __cplusplus
extern "C" {
#endif
/* NOLINTBEGIN(modernize-use-using): C */

/* Probe, virtual coupling, contact and friction behind a hand. Support planes hold the probe at the surface, also where
 * the hand is inside a body. */
typedef struct asperity_tool asperity_tool;

/* In brackets what 0 stands for. */
typedef struct asperity_tool_settings {
  uint32_t size;           /* sizeof this */
  uint32_t substeps;       /* of the probe in one call of 1 ms or longer, fewer in a shorter one (8) */
  double period_s;         /* usual time between two calls, 0.0001 to 0.1 (1 ms): how far ahead planes are looked for */
  double mass_kg;          /* of the probe (0.01) */
  double coupling_n_per_m; /* spring from the hand to the probe (500) */
  double coupling_n_m_per_rad; /* the same of rotations (3) */
  double stiffness_n_per_m;    /* of every touch (what the models' materials say; 2e5 where they say nothing) */
  double dissipation_s_per_m;  /* of every touch (the same; 5) */
  double static_friction;      /* of every touch; where both are 0, what the models' materials say */
  double dynamic_friction;     /* at most static_friction */
  double most_force_n;         /* the force on the hand is shortened to this (no limit) */
  double most_torque_n_m;      /* the same of the torque */
  double probe_on_hand[7];     /* pose of the probe's body frame on the hand (the identity) */
  uint32_t threads;            /* that share the contact of a call, 1 to 16, with the same bits for any number (1) */
  uint32_t reserved;           /* 0 */
} asperity_tool_settings;

/* What a hand feels. World axes. */
typedef struct asperity_felt {
  uint32_t size;          /* sizeof this */
  uint32_t flags;         /* ASPERITY_FLAG_... of this tick */
  int32_t contact_answer; /* the renderer's own, ASPERITY_STATUS_... */
  uint32_t contacts;      /* that overlap */
  double on_hand[6];      /* wrench on the hand, torque about the hand's origin */
  double on_probe[6];     /* wrench of the contact on the probe, about its centre of mass */
  double probe_pose[7];   /* where the probe's body frame is: draw the probe here */
  double deepest_m;       /* of the contact */
} asperity_felt;

/* Makes a tool. Not for a tick: fractions of a second. As asperity_renderer_make(). */
ASPERITY_C_API int32_t asperity_tool_make(const asperity_model* probe, const asperity_model* const* fixed,
                                          uint32_t fixed_count, const asperity_tool_settings* settings,
                                          asperity_tool** out, asperity_error* why);
/* Not for a tick. */
ASPERITY_C_API int32_t asperity_tool_free(asperity_tool* tool);

/* Puts the probe where the hand is, at rest; before the first follow(), and where a hand takes it up anew. Safe in a
 * tick. */
ASPERITY_C_API int32_t asperity_tool_place(asperity_tool* tool, const double hand_pose[7]);
/* A fixed body is there now, and goes on at this velocity (of its frame's origin; NULL: at rest) until it is told anew.
 * Safe in a tick. Answers: STATUS_INVALID_POSE, STATUS_CAPACITY_REACHED where 32 other bodies move already; it stays. */
ASPERITY_C_API int32_t asperity_tool_move_body(asperity_tool* tool, uint32_t body, const double pose[7],
                                               const double twist[6]);
/* Lets the probe follow the hand for dt_s seconds. Safe in a tick. A longer pause than 0.02 s moves it by that much only:
 * call it several times where a frame takes longer.
 * Answers: OK, INVALID_POSE, NOT_FINITE; NOT_READY before the first place(); ERROR_INVALID_ARGUMENT for a dt_s that is
 * not above 0. on_hand is zero where the answer is not OK. */
ASPERITY_C_API int32_t asperity_tool_follow(asperity_tool* tool, const double hand_pose[7], double dt_s,
                                            asperity_felt* out);

/* NOLINTEND(modernize-use-using) */
#ifdef __cplusplus
}
#endif
#endif
