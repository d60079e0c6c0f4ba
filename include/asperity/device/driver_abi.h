/* The driver interface: what a device driver in a shared object and its host promise each other. Plain C99.
 *
 * A driver exports one function, asperity_driver_entry(), which answers with a table of functions. Everything else is
 * said in structs of fixed layout. Vendors who write C++ include driver_export.hpp, which makes the table; nobody needs
 * more than this header.
 *
 * Sizes and versions
 * - The first field of every struct is struct_size, the size in bytes that its writer knows. Who reads a struct reads
 *   no field that lies beyond struct_size and takes it for zero (a function: not there). Who fills in a struct of the
 *   other side writes nothing beyond the struct_size that he found in it, and leaves that field as it is.
 * - A minor version may append fields to a struct, give a meaning to a reserved field, and append functions to the
 *   table; zero always means what it meant before. It changes no offset, size, meaning or unit of what is there. A
 *   driver and a host of different minor versions work together, with what both know.
 * - Anything else is a new major version. A driver of another major version is refused.
 * - Reserved fields are written as zero and not read.
 *
 * Memory: nobody frees what the other side made. Strings are UTF-8, end in a zero byte and are copied by their reader
 * before the call returns; the table is static in the driver and lives until it is unloaded. The one thing that is
 * made and given back is a device handle: make() to destroy().
 *
 * Units and frames: SI (m, rad, s, N, N m, Hz, kg), nanoseconds for times. d is the device's base frame, right-handed;
 * h is the frame of the handle. Quaternions are x y z w. Rotation velocities and torques are in the axes of d.
 *
 * Time: now_ns is the host's session clock, which never decreases. read() and write() never read a clock.
 *
 * Threads: calls for one handle come one at a time, not always from the same thread. Calls for different handles, and
 * list() and make(), may come at the same time.
 *
 * Real time: state(), read(), write(), disarm() and applied() are called in a tick. They do not allocate, lock, wait,
 * throw, print or read a clock; they may enter the kernel where the transport needs it. No other function is called in
 * a tick. No function throws.
 */
#ifndef ASPERITY_HAL_DRIVER_ABI_H
#define ASPERITY_HAL_DRIVER_ABI_H

#include <stdint.h>

#define ASPERITY_ABI_MAJOR 1u
#define ASPERITY_ABI_MINOR 1u
/* What a host passes to the entry: major in the upper half, minor in the lower. */
#define ASPERITY_ABI_VERSION ((ASPERITY_ABI_MAJOR << 16) | ASPERITY_ABI_MINOR)
/* Name of the one exported function. */
#define ASPERITY_ENTRY_NAME "asperity_driver_entry"

#ifdef __cplusplus
extern "C" {
#endif

/* Answers of every function that returns int32_t. Any other value is taken for ASPERITY_FAILED. */
#define ASPERITY_OK 0
#define ASPERITY_NOT_READY 1   /* not possible in this state; nothing was done */
#define ASPERITY_FAILED 2      /* the device or its link could not do it */
#define ASPERITY_NOT_FINITE 3  /* the command was not a wrench in base frame of ordinary numbers; zero was put out */
#define ASPERITY_STALE 4       /* the command had expired; zero was put out */
#define ASPERITY_INVALID 5     /* an argument that cannot be */
#define ASPERITY_UNSUPPORTED 6 /* well-formed, but not with this device */

/* States, as in device_state.hpp. Output other than zero in ARMED and ACTIVE only. */
#define ASPERITY_STATE_ABSENT 0
#define ASPERITY_STATE_PRESENT 1
#define ASPERITY_STATE_OPEN 2
#define ASPERITY_STATE_READY 3
#define ASPERITY_STATE_ARMED 4
#define ASPERITY_STATE_ACTIVE 5
#define ASPERITY_STATE_FAULT 6
#define ASPERITY_STATE_CLOSED 7

/* How much of the driver has been seen to work. */
#define ASPERITY_MATURITY_SIMULATED 0u
#define ASPERITY_MATURITY_PROTOCOL_TESTED 1u
#define ASPERITY_MATURITY_HARDWARE_VERIFIED 2u

/* Sets of axes: translation x y z, rotation x y z, in d. */
#define ASPERITY_AXES_TRANSLATION 0x07u
#define ASPERITY_AXES_ROTATION 0x38u
#define ASPERITY_AXES_ALL 0x3fu

/* asperity_capabilities.flags */
#define ASPERITY_NEEDS_HOMING 1u
#define ASPERITY_DEVICE_SIDE_WATCHDOG 2u /* the device goes to zero by itself when the host falls silent */

/* asperity_sample.valid: which fields were measured. */
#define ASPERITY_VALID_POSITION 1u
#define ASPERITY_VALID_ROTATION 2u
#define ASPERITY_VALID_LINEAR_VELOCITY 4u
#define ASPERITY_VALID_ANGULAR_VELOCITY 8u
#define ASPERITY_VALID_BUTTONS 16u
#define ASPERITY_VALID_GRIPPER 32u /* since 1.1 */

/* asperity_command.frame. BASE is the only one that a device takes; 0 and all others are refused. */
#define ASPERITY_FRAME_BASE 1u

/* asperity_host.log */
#define ASPERITY_LOG_DEBUG 0u
#define ASPERITY_LOG_INFO 1u
#define ASPERITY_LOG_WARNING 2u
#define ASPERITY_LOG_ERROR 3u

/* asperity_driver.provoke */
#define ASPERITY_PROVOKE_DEPARTURE 1u     /* the device vanishes from its bus */
#define ASPERITY_PROVOKE_RETURN 2u        /* it is back, possibly under another path */
#define ASPERITY_PROVOKE_WRITE_FAILURE 3u /* the next write() fails as a broken link would make it fail */

#define ASPERITY_NAME_SIZE 64
#define ASPERITY_IDENTITY_SIZE 128
#define ASPERITY_PATH_SIZE 256
#define ASPERITY_TEXT_SIZE 512

/* What a device can do. A number that is not known is zero, and a limit of zero allows nothing. */
struct asperity_capabilities {
  uint32_t struct_size;
  uint32_t maturity; /* ASPERITY_MATURITY_... of this device */
  uint32_t sensed;   /* axes that are measured */
  uint32_t actuated; /* axes that can put out an effort */
  uint32_t flags;
  uint32_t reserved_0;
  double continuous_force_n; /* can be held for ever */
  double peak_force_n;       /* largest that ever leaves */
  double continuous_torque_n_m;
  double peak_torque_n_m;
  double force_slew_n_per_s; /* fastest change that the device follows */
  double torque_slew_n_m_per_s;
  double max_stiffness_n_per_m; /* largest stable stiffness at max_stiffness_rate_hz */
  double max_stiffness_n_m_per_rad;
  double max_stiffness_rate_hz;
  double workspace_low_d_m[3]; /* box of the handle's origin, frame d */
  double workspace_high_d_m[3];
  double position_resolution_m;
  double rotation_resolution_rad;
  double nominal_rate_hz;   /* rate of measurements and commands that the device is made for */
  double minimum_rate_hz;   /* below it the device disarms itself or cannot be controlled */
  int64_t worst_latency_ns; /* from measurement to host */
  double moving_mass_kg;    /* apparent mass at the handle */
  double moving_inertia_kg_m2;
  char name[ASPERITY_NAME_SIZE]; /* for people */
  uint64_t reserved[8];
  /* since 1.1 */
  double gripper_low_m;  /* opening of a gripper on the handle when it is shut ... */
  double gripper_high_m; /* ... and wide open; equal: there is none */
};

/* A device that is plugged in. */
struct asperity_listing {
  uint32_t struct_size;
  uint32_t maturity;                     /* ASPERITY_MATURITY_... */
  char identity[ASPERITY_IDENTITY_SIZE]; /* the same whatever it is plugged into: vendor, product, serial number */
  char path[ASPERITY_PATH_SIZE];         /* where it is now; changes when it returns */
  char name[ASPERITY_NAME_SIZE];         /* for people */
  char not_openable[ASPERITY_TEXT_SIZE]; /* why it cannot be opened and how to mend it; empty where it can */
  /* As far as it is known before opening; may be NULL. The callee's until the call returns. */
  const struct asperity_capabilities* capabilities;
  uint64_t reserved[4];
};

/* One measurement. An axis that is not measured has a constant value, and its bit in `valid` is unset. */
struct asperity_sample {
  uint32_t struct_size;
  uint32_t valid;             /* ASPERITY_VALID_... */
  int64_t host_time_ns;       /* when the host received it, session clock, never after now_ns */
  int64_t device_time_ns;     /* when the device measured it, the device's own clock; 0 throughout where it has none */
  uint64_t sequence;          /* grows by one with every new measurement; equal means nothing new came */
  uint64_t lost;              /* measurements that the transport is known to have lost so far */
  double position_d_m[3];     /* origin of h in d */
  double rotation_dh_xyzw[4]; /* turns coordinates in h into coordinates in d; unit length within 1e-6 */
  double linear_velocity_d_m_per_s[3];
  double angular_velocity_d_rad_per_s[3];
  uint32_t buttons; /* one bit per button, pressed = 1 */
  uint32_t reserved_0;
  uint64_t reserved[4];
  double gripper_m; /* since 1.1: opening of the gripper */
};

/* The wrench on the hand that a device shall put out. */
struct asperity_command {
  uint32_t struct_size;
  uint32_t frame;         /* ASPERITY_FRAME_BASE */
  double force_d_n[3];    /* on the hand */
  double torque_d_n_m[3]; /* about the origin of h */
  int64_t valid_until_ns; /* session clock; zero is put out after this time */
  uint64_t sequence;      /* grows by one with every command */
  uint64_t reserved[4];
};

/* The wrench that a device puts out, after every limit of its own. */
struct asperity_applied {
  uint32_t struct_size;
  uint32_t reserved_0;
  double force_d_n[3];
  double torque_d_n_m[3];
  uint64_t reserved[4];
};

/* What the host offers a driver. The host's, valid from attach() until detach() returns. */
struct asperity_host {
  uint32_t struct_size;
  uint32_t abi_version;
  void* context; /* the driver passes it on and does not look at it */
  /* Tells the application something, one line without a line end. From any thread, at any time but in a tick. */
  void (*log)(void* context, uint32_t level, const char* text);
  uint64_t reserved[4];
};

/* An open or closed device of a driver; only the driver knows what is in it. */
struct asperity_device;

/* The table. Mandatory functions first; an optional function that is NULL or beyond struct_size is not supported.
 *
 * Functions outside a tick that can fail take a buffer for one sentence that says what is wrong and how to mend it:
 * error has room for error_size bytes (never 0) with the closing zero byte, and holds an empty string when the call
 * begins. */
struct asperity_driver {
  uint32_t struct_size;
  uint32_t abi_major;
  uint32_t abi_minor;
  uint32_t maturity;   /* ASPERITY_MATURITY_... of the driver */
  const char* name;    /* a short word without spaces */
  const char* version; /* of the driver */
  const char* licence; /* an SPDX expression, or "proprietary" */
  const char* vendor;  /* who answers for it */
  uint64_t reserved[4];

  /* ---- mandatory ---- */

  /* Calls found() once for each device that is plugged in, before it returns. Stops where found() returns other than 0.
   * Nothing found is not an error. */
  int32_t (*list)(void* context, int32_t (*found)(void* context, const struct asperity_listing* listing), char* error,
                  uint32_t error_size);
  /* Makes a handle of a listed device, by identity, and by path where identities are equal. Takes no hold of the
   * device: state PRESENT (ABSENT where it has left). *device is untouched on failure. */
  int32_t (*make)(const struct asperity_listing* which, struct asperity_device** device, char* error,
                  uint32_t error_size);
  /* Puts out zero, closes, frees. In every state. */
  void (*destroy)(struct asperity_device* device);
  /* In every state; constant after open(). */
  int32_t (*capabilities)(const struct asperity_device* device, struct asperity_capabilities* out);
  /* ASPERITY_STATE_... In a tick. */
  int32_t (*state)(const struct asperity_device* device);
  /* Takes the device, reads its limits, homes it where needed; output zero. PRESENT or CLOSED to READY. */
  int32_t (*open)(struct asperity_device* device, char* error, uint32_t error_size);
  /* Allows output: READY to ARMED. Refused in any other state, and nothing else ever arms. */
  int32_t (*arm)(struct asperity_device* device, char* error, uint32_t error_size);
  /* A person has seen the fault: FAULT to CLOSED. Refused in any other state. */
  int32_t (*clear_fault)(struct asperity_device* device, char* error, uint32_t error_size);
  /* Output to zero, also where it fails; ARMED or ACTIVE to READY. In a tick. */
  int32_t (*disarm)(struct asperity_device* device);
  /* Output to zero, also where it fails; the device is given back. To CLOSED, but a fault stays a fault. */
  void (*close)(struct asperity_device* device);
  /* The newest measurement that there is at now_ns; the last one, unchanged, where nothing new came. Where the device
   * cannot answer, *out is untouched and the answer is not ASPERITY_OK. In a tick. */
  int32_t (*read)(struct asperity_device* device, int64_t now_ns, struct asperity_sample* out);
  /* Puts a wrench on the hand: within the peak limits, and zero where the state does not allow output, the command is
   * not finite, not in ASPERITY_FRAME_BASE or has expired. In a tick. */
  int32_t (*write)(struct asperity_device* device, int64_t now_ns, const struct asperity_command* command);

  /* ---- optional ---- */

  /* Called once before any other function, and once after the last. `host` stays valid in between. */
  int32_t (*attach)(const struct asperity_host* host, char* error, uint32_t error_size);
  void (*detach)(const struct asperity_host* host);
  /* What the device puts out at now_ns, as near to the motor as the driver can tell: without it much of the conformance
   * kit has nothing to look at. In every state; in a tick. */
  int32_t (*applied)(const struct asperity_device* device, int64_t now_ns, struct asperity_applied* out);
  /* Why the device is in FAULT, one sentence. Outside a tick. */
  int32_t (*fault_text)(const struct asperity_device* device, char* text, uint32_t text_size);
  /* Makes something go wrong, for tests: ASPERITY_PROVOKE_... A driver of hardware leaves it NULL, or has it act on a
   * simulated link only. Outside a tick. */
  int32_t (*provoke)(struct asperity_device* device, uint32_t what);

  void* reserved_functions[8];
};

/* The exported function. @param host_abi ASPERITY_ABI_VERSION of the host
 * @return the driver's table, or NULL where it cannot serve this host. The same table at every call. */
const struct asperity_driver* asperity_driver_entry(uint32_t host_abi);

#ifdef __cplusplus
}
#endif

#endif
