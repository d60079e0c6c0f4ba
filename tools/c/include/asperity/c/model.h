/* Textured models, and what their surfaces are like to touch. */
#ifndef ASPERITY_C_MODEL_H
#define ASPERITY_C_MODEL_H

#include "asperity/c/answer.h"

#ifdef __cplusplus
extern "C" {
#endif
/* NOLINTBEGIN(modernize-use-using): C */

/* A textured model. It never changes; renderers, tools and sessions that were made of it keep what they need. */
typedef struct asperity_model asperity_model;

/* How the coefficients of friction of two surfaces become one: numbers of asperity::friction_combine. */
#define ASPERITY_COMBINE_AVERAGE 0u
#define ASPERITY_COMBINE_MINIMUM 1u
#define ASPERITY_COMBINE_MAXIMUM 2u
#define ASPERITY_COMBINE_MULTIPLY 3u

/* What a surface is like to touch. Felt by tools, and by sessions on support planes. */
typedef struct asperity_material {
  uint32_t size;              /* sizeof this */
  uint32_t combine;           /* ASPERITY_COMBINE_... */
  double stiffness_n_per_m;   /* of each point that presses, were the other body rigid; 0: the usual 4e5 */
  double dissipation_s_per_m; /* Hunt and Crossley: a slow blow of speed v comes back with 1 - this v */
  double static_friction;     /* largest force along the surface, by what presses, of a contact that sticks */
  double dynamic_friction;    /* the same of one that slips; at most the static one */
} asperity_material;

/* What is known of a model: body frame, SI. */
typedef struct asperity_model_facts {
  uint32_t size;             /* sizeof this */
  uint32_t materials;        /* how many it has; 0 where nobody said */
  uint64_t full_triangles;   /* of the mesh that was baked */
  uint32_t coarse_triangles; /* of the mesh that stands for it */
  uint32_t pieces;           /* convex ones */
  uint32_t texture_width;    /* of the haptic texture, texels */
  uint32_t texture_height;
  double low_m[3]; /* its box */
  double high_m[3];
  double volume_m3;
  double centre_of_mass_m[3];
  double inertia_per_mass_m2[9]; /* about the centre of mass, row by row; times the mass */
} asperity_model_facts;

/* Loads a textured model, a .glb that `asperity bake` wrote, and checks it. Not for a tick.
 * Answers: IO_FAILED, BAD_FORMAT, BAD_MESH, BAD_TEXTURE, UNSUPPORTED, LIMIT_EXCEEDED; *out is then NULL. */
ASPERITY_C_API int32_t asperity_model_load(const char* file, asperity_model** out, asperity_error* why);
/* Not for a tick. */
ASPERITY_C_API int32_t asperity_model_free(asperity_model* model);

/* Safe in a tick. */
ASPERITY_C_API int32_t asperity_model_get_facts(const asperity_model* model, asperity_model_facts* out);
/* Its name, for people; NULL for no model. It lives as long as the model. Safe in a tick. */
ASPERITY_C_API const char* asperity_model_name(const asperity_model* model);

/* The material of that name: steel, wood, rubber or ice. Not for a tick. Answers: INVALID_ARGUMENT, with the names. */
ASPERITY_C_API int32_t asperity_material_preset(const char* name, asperity_material* out, asperity_error* why);
/* Name of a preset, from 0 on; NULL after the last one. The string lives for ever. Not for a tick. */
ASPERITY_C_API const char* asperity_material_preset_name(uint32_t number);
/* The same model with this material all over, a handle of its own. NULL: without a material. Not for a tick.
 * Answers: INVALID_ARGUMENT for a number out of range. */
ASPERITY_C_API int32_t asperity_model_with_material(const asperity_model* model, const asperity_material* material,
                                                    asperity_model** out, asperity_error* why);

/* NOLINTEND(modernize-use-using) */
#ifdef __cplusplus
}
#endif
#endif
