// What a shared build of the library shows of itself: the library is compiled with hidden names, and these are not.
#pragma once

#if defined(__GNUC__)
#define ASPERITY_API __attribute__((visibility("default")))
#else
#define ASPERITY_API
#endif
