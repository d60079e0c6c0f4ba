#include "call_watch.hpp"

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define ASPERITY_SANITIZED
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define ASPERITY_SANITIZED
#endif

#if defined(ASPERITY_SANITIZED) || !defined(__GLIBC__)

namespace asperity::conformance {

std::string call_watch::missing() {
#if defined(ASPERITY_SANITIZED)
  return "the sanitizer of this build stands at the same symbols";
#else
  return "only the symbols of glibc are known";
#endif
}
void call_watch::begin() noexcept {}
watched call_watch::end() noexcept { return {}; }

}  // namespace asperity::conformance

#else

#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <ctime>
#include <dlfcn.h>
#include <poll.h>
#include <pthread.h>
#include <sched.h>
#include <semaphore.h>
#include <sys/epoll.h>
#include <sys/select.h>
#include <sys/time.h>
#include <typeinfo>
#include <unistd.h>

namespace {

using asperity::conformance::forbidden;

thread_local bool watching = false;
thread_local asperity::conformance::watched seen;

void count(forbidden kind, const char* name) noexcept {
  if (!watching) return;
  const auto k = static_cast<std::size_t>(kind);
  if (seen.times[k]++ == 0) seen.first[k] = name;
}

// The function behind ours, looked up at its first use.
template <class Function>
Function* behind(std::atomic<void*>& found, const char* name) noexcept {
  void* f = found.load(std::memory_order_relaxed);
  if (f == nullptr) {
    const bool was = watching;
    watching = false;
    found.store(f = ::dlsym(RTLD_NEXT, name), std::memory_order_relaxed);
    watching = was;
  }
  return reinterpret_cast<Function*>(f);
}

}  // namespace

namespace asperity::conformance {

std::string call_watch::missing() { return {}; }

void call_watch::begin() noexcept {
  seen = {};
  watching = true;
}

watched call_watch::end() noexcept {
  watching = false;
  return seen;
}

}  // namespace asperity::conformance

// NOLINTBEGIN(bugprone-macro-parentheses, bugprone-reserved-identifier, readability-identifier-naming): the names are
// those of the C library, and a list of parameters takes no further parentheses.

// Ours has its name for the linker only: headers declare some of these inline, with exception specifications of their
// own.
#define ASPERITY_WATCH(kind, result, name, parameters, arguments)                                    \
  extern "C" __attribute__((visibility("default"))) result watched_##name parameters __asm__(#name); \
  result watched_##name parameters {                                                                 \
    count(forbidden::kind, #name);                                                                   \
    static constinit std::atomic<void*> found{nullptr};                                              \
    return behind<result parameters>(found, #name) arguments;                                        \
  }

// Memory. glibc's own names behind, because dlsym() may allocate; operator new and delete end here.
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);

void* malloc(std::size_t size) noexcept {
  count(forbidden::allocation, "malloc");
  return __libc_malloc(size);
}
void* calloc(std::size_t n, std::size_t size) noexcept {
  count(forbidden::allocation, "calloc");
  return __libc_calloc(n, size);
}
void* realloc(void* p, std::size_t size) noexcept {
  count(forbidden::allocation, "realloc");
  return __libc_realloc(p, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  count(forbidden::allocation, "aligned_alloc");
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** p, std::size_t alignment, std::size_t size) noexcept {
  count(forbidden::allocation, "posix_memalign");
  *p = __libc_memalign(alignment, size);
  return *p != nullptr ? 0 : ENOMEM;
}
void free(void* p) noexcept {
  if (p != nullptr) count(forbidden::allocation, "free");
  __libc_free(p);
}
}

ASPERITY_WATCH(lock, int, pthread_mutex_lock, (pthread_mutex_t * m), (m))
ASPERITY_WATCH(lock, int, pthread_mutex_trylock, (pthread_mutex_t * m), (m))
ASPERITY_WATCH(lock, int, pthread_rwlock_rdlock, (pthread_rwlock_t * l), (l))
ASPERITY_WATCH(lock, int, pthread_rwlock_wrlock, (pthread_rwlock_t * l), (l))
ASPERITY_WATCH(lock, int, pthread_spin_lock, (pthread_spinlock_t * l), (l))
ASPERITY_WATCH(lock, int, sem_wait, (sem_t * s), (s))
ASPERITY_WATCH(lock, int, __cxa_guard_acquire, (void* guard), (guard))

ASPERITY_WATCH(wait, int, nanosleep, (const timespec* t, timespec* left), (t, left))
ASPERITY_WATCH(wait, int, clock_nanosleep, (clockid_t c, int flags, const timespec* t, timespec* left),
               (c, flags, t, left))
ASPERITY_WATCH(wait, int, usleep, (useconds_t us), (us))
ASPERITY_WATCH(wait, unsigned, sleep, (unsigned s), (s))
ASPERITY_WATCH(wait, int, sched_yield, (), ())
ASPERITY_WATCH(wait, int, pthread_cond_wait, (pthread_cond_t * c, pthread_mutex_t* m), (c, m))
ASPERITY_WATCH(wait, int, pthread_cond_timedwait, (pthread_cond_t * c, pthread_mutex_t* m, const timespec* t),
               (c, m, t))

// Asking whether there is something is no waiting; asking with a time is.
extern "C" __attribute__((visibility("default"))) int watched_poll(pollfd* p, nfds_t n, int ms) __asm__("poll");
int watched_poll(pollfd* p, nfds_t n, int ms) {
  if (ms != 0) count(forbidden::wait, "poll");
  static constinit std::atomic<void*> found{nullptr};
  return behind<int(pollfd*, nfds_t, int)>(found, "poll")(p, n, ms);
}
extern "C" __attribute__((visibility("default"))) int watched_epoll(int e, epoll_event* v, int n,
                                                                    int ms) __asm__("epoll_wait");
int watched_epoll(int e, epoll_event* v, int n, int ms) {
  if (ms != 0) count(forbidden::wait, "epoll_wait");
  static constinit std::atomic<void*> found{nullptr};
  return behind<int(int, epoll_event*, int, int)>(found, "epoll_wait")(e, v, n, ms);
}
extern "C" __attribute__((visibility("default"))) int watched_select(int n, fd_set* r, fd_set* w, fd_set* x,
                                                                     timeval* t) __asm__("select");
int watched_select(int n, fd_set* r, fd_set* w, fd_set* x, timeval* t) {
  if (t == nullptr || t->tv_sec != 0 || t->tv_usec != 0) count(forbidden::wait, "select");
  static constinit std::atomic<void*> found{nullptr};
  return behind<int(int, fd_set*, fd_set*, fd_set*, timeval*)>(found, "select")(n, r, w, x, t);
}

ASPERITY_WATCH(clock, int, clock_gettime, (clockid_t c, timespec* t), (c, t))
ASPERITY_WATCH(clock, int, gettimeofday, (timeval * t, void* zone), (t, zone))
ASPERITY_WATCH(clock, std::time_t, time, (std::time_t * t), (t))

ASPERITY_WATCH(print, int, vfprintf, (FILE * f, const char* s, va_list a), (f, s, a))
ASPERITY_WATCH(print, int, puts, (const char* s), (s))
ASPERITY_WATCH(print, int, fputs, (const char* s, FILE* f), (s, f))
ASPERITY_WATCH(print, int, putchar, (int c), (c))
ASPERITY_WATCH(print, int, fputc, (int c, FILE* f), (c, f))
ASPERITY_WATCH(print, std::size_t, fwrite, (const void* p, std::size_t a, std::size_t b, FILE* f), (p, a, b, f))

extern "C" __attribute__((visibility("default"))) int watched_printf(const char* format, ...) __asm__("printf");
int watched_printf(const char* format, ...) {
  count(forbidden::print, "printf");
  va_list list;
  va_start(list, format);
  const int written = std::vfprintf(stdout, format, list);
  va_end(list);
  return written;
}
extern "C" __attribute__((visibility("default"))) int watched_fprintf(FILE* file, const char* format,
                                                                      ...) __asm__("fprintf");
int watched_fprintf(FILE* file, const char* format, ...) {
  count(forbidden::print, "fprintf");
  va_list list;
  va_start(list, format);
  const int written = std::vfprintf(file, format, list);
  va_end(list);
  return written;
}

// The first thing that a throw-expression does is to take memory for its object.
ASPERITY_WATCH(thrown, void*, __cxa_allocate_exception, (std::size_t size), (size))
ASPERITY_WATCH(thrown, void, __cxa_rethrow, (), ())

// NOLINTEND(bugprone-macro-parentheses, bugprone-reserved-identifier, readability-identifier-naming)

#endif
