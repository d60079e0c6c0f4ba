/* What functions answer, and which version of the library they are of. */
#ifndef ASPERITY_C_ANSWER_H
#define ASPERITY_C_ANSWER_H

#include <stdint.h>

#if defined(__GNUC__)
#define ASPERITY_C_API __attribute__((visibility("default")))
#else
#define ASPERITY_C_API
#endif

#ifdef __cplusplus
extern "C" {
#endif
/* NOLINTBEGIN(modernize-use-using): C */

/* Answers of what may run in a tick: the numbers of asperity::status. Anything but OK and CAPACITY_REACHED leaves a zero
 * wrench behind. */
#define ASPERITY_STATUS_OK 0
#define ASPERITY_STATUS_CAPACITY_REACHED 1 /* the result is usable, but something did not fit */
#define ASPERITY_STATUS_INVALID_POSE 2     /* NaN, infinity or a quaternion that is not of unit length */
#define ASPERITY_STATUS_NOT_FINITE 3       /* a stage produced NaN or infinity; its output was zeroed */
#define ASPERITY_STATUS_STALE_INPUT 4      /* the newest input is older than its limit */
#define ASPERITY_STATUS_NOT_READY 5        /* not set up, not open, or closed */
#define ASPERITY_STATUS_BACKEND_FAILED 6   /* a device or depth backend could not answer */
#define ASPERITY_STATUS_GATE_SHUT 7        /* the output gate is shut: the wrench is zero */

/* Faults: 64 and the number of asperity::error_code. */
#define ASPERITY_ERROR_INVALID_ARGUMENT 64 /* NULL, a handle of another kind, a size or a number out of range */
#define ASPERITY_ERROR_IO_FAILED 65
#define ASPERITY_ERROR_BAD_FORMAT 66
#define ASPERITY_ERROR_UNSUPPORTED 67
#define ASPERITY_ERROR_BAD_MESH 68
#define ASPERITY_ERROR_BAD_TEXTURE 69
#define ASPERITY_ERROR_LIMIT_EXCEEDED 70
#define ASPERITY_ERROR_CANCELLED 71
#define ASPERITY_ERROR_BUSY 72 /* the same is still in use; try again later */
/* Faults of this interface alone. */
#define ASPERITY_ERROR_OUT_OF_MEMORY 126
#define ASPERITY_ERROR_UNEXPECTED 127 /* an exception that nobody foresaw was caught; the sentence has its text */

/* One sentence: what is wrong, where, and how to mend it. Written where a function fails, and only then. */
typedef struct asperity_error {
  uint32_t size; /* sizeof this */
  int32_t code;  /* what the function returned */
  char message[504];
} asperity_error;

/* Version of the library that is linked, such as "0.1.0". Safe in a tick. */
ASPERITY_C_API const char* asperity_version(void);
/* The same as a number: major * 10000 + minor * 100 + patch. Safe in a tick. */
ASPERITY_C_API uint32_t asperity_version_number(void);
/* An answer in a few words. Safe in a tick; the string lives for ever. */
ASPERITY_C_API const char* asperity_describe(int32_t answer);

/* NOLINTEND(modernize-use-using) */
#ifdef __cplusplus
}
#endif
#endif
