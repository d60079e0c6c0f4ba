/* From a pose to a wrench: one tick, one answer, without a memory of how the probe came there. */
#ifndef ASPERITY_C_RENDERER_H
#define ASPERITY_C_RENDERER_H

#include "asperity/c/model.h"

#ifdef __cplusplus
extern "C" {
#endif
/* NOLINTBEGIN(modernize-use-using): C */

/* A scene of a probe and fixed bodies, and the formulation that feels it. */
typedef struct asperity_renderer asperity_renderer;

/* Which formulation. */
#define ASPERITY_FORMULATION_USUAL 0u        /* LEAST_MOTION for a renderer, PLANES for a session */
#define ASPERITY_FORMULATION_LEAST_MOTION 1u /* one potential: the wrench is a function of the pose alone */
#define ASPERITY_FORMULATION_PLANES 2u       /* support planes, which hold a probe in a control loop */
#define ASPERITY_FORMULATION_WINDOW 3u       /* the paper's windows, a spring for each contact */

/* Flags of a tick: numbers of asperity::tick_flag. */
#define ASPERITY_FLAG_BEYOND_FIELD 1u       /* deeper than a depth field can answer */
#define ASPERITY_FLAG_PASSED 2u             /* a point that touched has gone past half way through a body */
#define ASPERITY_FLAG_NOT_HELD 4u           /* the overlap is larger than planes hold */
#define ASPERITY_FLAG_PLANES_LEFT_OUT 8u    /* more touched than fits into a list */
#define ASPERITY_FLAG_UNBALANCED 16u        /* the contact solver found no solution */
#define ASPERITY_FLAG_FRICTION_LEFT_OUT 32u /* more bodies rubbed than are kept */
#define ASPERITY_FLAG_BODY_LOST 64u         /* a moving body was told of no more */
#define ASPERITY_FLAG_STANDS_BACK 128u      /* a body came where the probe is */

typedef struct asperity_renderer_settings {
  uint32_t size;            /* sizeof this */
  uint32_t formulation;     /* ASPERITY_FORMULATION_... */
  double stiffness_n_per_m; /* of a contact; 0: the formulation's own, 2000 for least motion */
  double period_s;          /* least motion: of the loop that asks; 0: 1 ms */
  double reach_m;           /* planes: gaps up to this are told; 0: what fits the bodies and 1 kHz */
  double softness_m;        /* least motion: depth over which the stiffness grows; 0: what fits the period */
  double sharpness;         /* least motion: how fast the force turns on a ridge; 0: what fits the period */
  uint32_t grid;            /* window: samples per side; 0: 64 */
  uint32_t threads;         /* planes: that share a tick, 1 to 16, with the same bits for any number; 0: 1 */
} asperity_renderer_settings;

/* What one tick found. World axes. */
typedef struct asperity_touch {
  uint32_t size;              /* sizeof this */
  uint32_t flags;             /* ASPERITY_FLAG_... */
  double on_probe[6];         /* wrench on the probe, torque about centre_of_mass_m */
  double centre_of_mass_m[3]; /* of the probe, in the world */
  double deepest_m;           /* deepest contact; 0 where nothing touches */
  uint32_t contacts;          /* how many there are, gaps that a formulation reports included */
  uint32_t dropped_contacts;  /* that did not fit */
} asperity_touch;

/* One contact of a tick. World axes. */
typedef struct asperity_contact {
  uint32_t size;     /* sizeof this */
  uint32_t body;     /* number of the fixed body */
  double depth_m;    /* directional penetration depth; below 0 a gap */
  double point_m[3]; /* deepest point of the probe's fine surface */
  double n_ab[3];    /* unit, from the probe to the body */
} asperity_contact;

/* Makes a renderer. Bodies stand at the world's origin until they are placed. Not for a tick: least motion may take seconds.
 * fixed: fixed_count models, 1 to 65535; the array is not kept
 * Answers: INVALID_ARGUMENT, BAD_MESH, BAD_TEXTURE; *out is then NULL. */
ASPERITY_C_API int32_t asperity_renderer_make(const asperity_model* probe, const asperity_model* const* fixed,
                                              uint32_t fixed_count, const asperity_renderer_settings* settings,
                                              asperity_renderer** out, asperity_error* why);
/* Not for a tick. */
ASPERITY_C_API int32_t asperity_renderer_free(asperity_renderer* renderer);

/* Puts a fixed body there, for the ticks that follow. Safe in a tick. Answers: STATUS_INVALID_POSE, and it stays. */
ASPERITY_C_API int32_t asperity_renderer_place_body(asperity_renderer* renderer, uint32_t body, const double pose[7]);
/* One tick with the probe at this pose. Safe in a tick. */
ASPERITY_C_API int32_t asperity_renderer_step(asperity_renderer* renderer, const double pose[7], asperity_touch* out);
/* What a fixed body felt in the last tick, about its own centre of mass. Safe in a tick.
 * Answers: STATUS_NOT_READY before a tick that answered, or where the formulation does not tell. */
ASPERITY_C_API int32_t asperity_renderer_body_wrench(asperity_renderer* renderer, uint32_t body, double out[6]);
/* A contact of the last tick, from 0 on. Safe in a tick. Answers: STATUS_NOT_READY where there is none of that number. */
ASPERITY_C_API int32_t asperity_renderer_contact(asperity_renderer* renderer, uint32_t number, asperity_contact* out);
/* Where the probe, held in this rotation (x y z w), first touches when it comes straight down along -z, centred over the
 * first body. Not for a tick. Answers: INVALID_ARGUMENT where it meets nothing. */
ASPERITY_C_API int32_t asperity_renderer_find_touch(asperity_renderer* renderer, const double rotation[4],
                                                    double pose[7], asperity_error* why);

/* NOLINTEND(modernize-use-using) */
#ifdef __cplusplus
}
#endif
#endif
