// Marks the names that a shared build of the library exports; all others are hidden.
#pragma once

#if defined(__GNUC__)
#define ASPERITY_API __attribute__((visibility("default")))
#else
#define ASPERITY_API
#endif
