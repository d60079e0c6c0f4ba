// Which sanitizers this build has, true or false; GCC and Clang tell it each in a way of its own.
#pragma once

#if defined(__has_feature)
#define ASPERITY_ADDRESS_SANITIZER __has_feature(address_sanitizer)
#define ASPERITY_THREAD_SANITIZER __has_feature(thread_sanitizer)
#else
#if defined(__SANITIZE_ADDRESS__)
#define ASPERITY_ADDRESS_SANITIZER true
#else
#define ASPERITY_ADDRESS_SANITIZER false
#endif
#if defined(__SANITIZE_THREAD__)
#define ASPERITY_THREAD_SANITIZER true
#else
#define ASPERITY_THREAD_SANITIZER false
#endif
#endif
