/* The C interface for applications: models, renderers, a virtual tool for a loop of your own, sessions with a simulated
 * device. Plain C99; usable from C++ too. Link asperity_c (CMake: asperity::c; pkg-config: asperity_c).
 *
 *     asperity_error why = {sizeof why};
 *     asperity_model* probe;
 *     if (asperity_model_load("file.glb", &probe, &why) != ASPERITY_STATUS_OK) puts(why.message);
 *
 * Structs
 * - The first field of every struct is `size`, which the caller sets to sizeof the struct that it was compiled with.
 *   A later version appends fields and changes no offset, unit or meaning. Where the caller's struct is shorter, what it
 *   lacks is taken for zero, or is not written. Where it is longer, what is beyond must be zero, or is written as zero.
 * - In settings zero means "the usual" for every number and list, so {sizeof settings} is a whole struct of settings.
 *   NULL in place of settings is the same.
 *
 * Handles are opaque. Whoever made one frees it, in any order: what others still need lives on behind them. A handle of
 * another kind than a function wants is answered with ASPERITY_ERROR_INVALID_ARGUMENT, and so is NULL; freeing NULL
 * does nothing. A handle that was freed must not be used again.
 *
 * Answers: every function that returns int32_t returns 0 (ASPERITY_STATUS_OK) or says what was wrong, see answer.h. A
 * sentence comes in an asperity_error that the caller gives, or NULL where none is wanted. There is no "last error": a
 * sentence kept per thread would be lost where a managed runtime goes on on another thread, and the memory of a thread
 * that first touches a library is allocated at that moment, which may be a tick. No exception leaves the library.
 *
 * Threads: one handle at a time is used by one thread; different handles, by different threads at the same time. Models
 * do not change and may be used by all at the same time. Renderers and sessions of the same models share nothing else.
 *
 * Real time: a function that is marked "safe in a tick" does not allocate, lock, wait, print or read a clock, whatever it
 * is given. The others load, allocate and compute, some for fractions of a second.
 *
 * Units and frames: SI (m, rad, s, N, N m, kg), right-handed; w is the world. A pose is 7 doubles x y z qx qy qz qw and
 * maps coordinates in the body to coordinates in the world; a quaternion has unit length within 1e-6. A wrench is 6
 * doubles, force (N) then torque (N m); a twist is 6 doubles, linear (m/s) then angular (rad/s). axes.h converts for
 * left-handed engines and for centimetres. Strings are UTF-8.
 *
 * asperity.h can be included beside driver_abi.h, whose names are others. */
#ifndef ASPERITY_C_ASPERITY_H
#define ASPERITY_C_ASPERITY_H

#include "asperity/c/answer.h"
#include "asperity/c/axes.h"
#include "asperity/c/device.h"
#include "asperity/c/model.h"
#include "asperity/c/renderer.h"
#include "asperity/c/session.h"
#include "asperity/c/tool.h"

#endif
