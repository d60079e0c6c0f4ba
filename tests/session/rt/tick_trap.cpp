#include "session/rt/tick_trap.hpp"

#include <sys/resource.h>

#include "support/sanitizers.hpp"

#define ASPERITY_SANITIZED (ASPERITY_ADDRESS_SANITIZER || ASPERITY_THREAD_SANITIZER)

namespace asperity::test_support {

std::uint64_t tick_trap::thread_page_faults() noexcept {
  rusage used{};
  getrusage(RUSAGE_THREAD, &used);
  return static_cast<std::uint64_t>(used.ru_minflt + used.ru_majflt);
}

}  // namespace asperity::test_support

#if ASPERITY_SANITIZED || !defined(__GLIBC__)

namespace asperity::test_support {

std::string tick_trap::missing() {
#if ASPERITY_SANITIZED
  return "the sanitizer of this build stands at the same symbols as the tick trap; builds without one run it";
#else
  return "the tick trap knows the symbols of glibc only";
#endif
}
std::string tick_trap::missing_system_calls() { return missing(); }
void tick_trap::enter() noexcept {}
void tick_trap::leave() noexcept {}

}  // namespace asperity::test_support

#else

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <dlfcn.h>
#include <new>
#include <pthread.h>
#include <semaphore.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <typeinfo>
#include <unistd.h>

namespace {

using asperity::test_support::tick_trap;

// <linux/prctl.h> of older distributions lacks these.
constexpr int set_syscall_user_dispatch = 59;
constexpr unsigned long dispatch_off = 0;
constexpr unsigned long dispatch_on = 1;
// What the kernel reads at each system call of the thread.
constexpr char let_pass = 0;
constexpr char send_signal = 1;

thread_local volatile char selector = let_pass;
thread_local volatile bool in_tick = false;

[[noreturn]] void end_process(const char* text) noexcept {
  selector = let_pass;
  in_tick = false;
  char line[160];
  const int length = std::snprintf(line, sizeof line, "tick trap: %s inside a tick\n", text);
  static_cast<void>(!::write(STDERR_FILENO, line, static_cast<std::size_t>(length)));
  ::_exit(tick_trap::exit_status);
}

inline void forbid(const char* name) noexcept {
  if (in_tick) end_process(name);
}

// The names of those that a stray line is likely to make; any other is told by its number.
const char* name_of(int system_call) noexcept {
  switch (system_call) {
    case SYS_read:
      return "read";
    case SYS_write:
      return "write";
    case SYS_writev:
      return "writev";
    case SYS_openat:
      return "openat";
    case SYS_brk:
      return "brk";
    case SYS_mmap:
      return "mmap";
    case SYS_futex:
      return "futex";
    case SYS_clock_nanosleep:
      return "clock_nanosleep";
    case SYS_nanosleep:
      return "nanosleep";
    case SYS_sched_yield:
      return "sched_yield";
    default:
      return "see the kernel's table";
  }
}

void on_system_call(int, siginfo_t* info, void*) {
  selector = let_pass;  // before anything here calls the kernel
  char text[80];
  std::snprintf(text, sizeof text, "system call %d (%s)", info->si_syscall, name_of(info->si_syscall));
  end_process(text);
}

bool set_dispatch(unsigned long mode) noexcept {
  return ::prctl(set_syscall_user_dispatch, mode, 0UL, 0UL, mode == dispatch_on ? &selector : nullptr) == 0;
}

void catch_system_calls() noexcept {
  static constinit std::atomic<bool> caught{false};
  if (caught.exchange(true)) return;
  struct sigaction action {};
  action.sa_sigaction = on_system_call;
  action.sa_flags = SA_SIGINFO;
  ::sigaction(SIGSYS, &action, nullptr);
}

// The function behind ours. Looked up at its first use, which is outside a tick: inside, forbid() comes first.
template <class Function>
Function* behind(std::atomic<void*>& found, const char* name) noexcept {
  void* f = found.load(std::memory_order_relaxed);
  if (f == nullptr) found.store(f = ::dlsym(RTLD_NEXT, name), std::memory_order_relaxed);
  return reinterpret_cast<Function*>(f);
}

}  // namespace

namespace asperity::test_support {

std::string tick_trap::missing() { return {}; }

std::string tick_trap::missing_system_calls() {
  if (set_dispatch(dispatch_on)) {
    set_dispatch(dispatch_off);
    return {};
  }
  return std::string("the kernel refuses syscall user dispatch, which Linux has since 5.11: ") + std::strerror(errno);
}

// Dispatch is switched on for each tick anew, because a forked child does not inherit it and a thread that ends must
// not leave the kernel with the address of its selector.
void tick_trap::enter() noexcept {
  catch_system_calls();
  static_cast<void>(set_dispatch(dispatch_on));
  in_tick = true;
  selector = send_signal;
}

void tick_trap::leave() noexcept {
  selector = let_pass;
  in_tick = false;
  static_cast<void>(set_dispatch(dispatch_off));
}

}  // namespace asperity::test_support

// A function of the C or C++ library, with the trap in front of it. It has its name for the linker only: headers
// declare some of these inline, and with exception specifications of their own.
#define ASPERITY_TRAP_AS(violation, result, name, parameters, arguments) \
  extern "C" result trapped_##name parameters __asm__(#name);            \
  result trapped_##name parameters {                                     \
    forbid(violation);                                                   \
    static constinit std::atomic<void*> found{nullptr};                  \
    return behind<result parameters>(found, #name) arguments;            \
  }
#define ASPERITY_TRAP(result, name, parameters, arguments) ASPERITY_TRAP_AS(#name, result, name, parameters, arguments)

// Allocation. glibc's own names, because dlsym() may allocate.
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);

void* malloc(std::size_t size) noexcept {
  forbid("malloc");
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) noexcept {
  forbid("calloc");
  return __libc_calloc(count, size);
}
void* realloc(void* p, std::size_t size) noexcept {
  forbid("realloc");
  return __libc_realloc(p, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  forbid("aligned_alloc");
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** p, std::size_t alignment, std::size_t size) noexcept {
  forbid("posix_memalign");
  *p = __libc_memalign(alignment, size);
  return *p != nullptr ? 0 : ENOMEM;
}
void free(void* p) noexcept {
  forbid("free");
  __libc_free(p);
}
}

// The other forms of new and delete end in these three, or in aligned_alloc() and free().
void* operator new(std::size_t size) {
  forbid("operator new");
  if (void* p = __libc_malloc(std::max<std::size_t>(size, 1))) return p;
  throw std::bad_alloc();
}
void operator delete(void* p) noexcept {
  forbid("operator delete");
  __libc_free(p);
}
void operator delete(void* p, std::size_t) noexcept {
  forbid("operator delete");
  __libc_free(p);
}

// Locks. Signalling a condition that nobody waits for, and the guard of a static local, stay out of the kernel too.
ASPERITY_TRAP(int, pthread_mutex_lock, (pthread_mutex_t * m), (m))
ASPERITY_TRAP(int, pthread_mutex_trylock, (pthread_mutex_t * m), (m))
ASPERITY_TRAP(int, pthread_mutex_timedlock, (pthread_mutex_t * m, const timespec* t), (m, t))
ASPERITY_TRAP(int, pthread_mutex_unlock, (pthread_mutex_t * m), (m))
ASPERITY_TRAP(int, pthread_rwlock_rdlock, (pthread_rwlock_t * l), (l))
ASPERITY_TRAP(int, pthread_rwlock_wrlock, (pthread_rwlock_t * l), (l))
ASPERITY_TRAP(int, pthread_rwlock_unlock, (pthread_rwlock_t * l), (l))
ASPERITY_TRAP(int, pthread_spin_lock, (pthread_spinlock_t * l), (l))
ASPERITY_TRAP(int, pthread_cond_signal, (pthread_cond_t * c), (c))
ASPERITY_TRAP(int, pthread_cond_broadcast, (pthread_cond_t * c), (c))
ASPERITY_TRAP(int, pthread_once, (pthread_once_t * o, void (*f)()), (o, f))
ASPERITY_TRAP(int, sem_wait, (sem_t * s), (s))
ASPERITY_TRAP(int, sem_trywait, (sem_t * s), (s))
ASPERITY_TRAP(int, sem_post, (sem_t * s), (s))
ASPERITY_TRAP_AS("initialisation of a static local", int, __cxa_guard_acquire, (void* guard), (guard))

// Clocks.
ASPERITY_TRAP(int, clock_gettime, (clockid_t c, timespec* t), (c, t))
ASPERITY_TRAP(int, gettimeofday, (timeval * t, void* zone), (t, zone))
ASPERITY_TRAP(int, timespec_get, (timespec * t, int base), (t, base))
ASPERITY_TRAP(std::time_t, time, (std::time_t * t), (t))

// Printing. Streams of C++ end in these; what fills a buffer of its own is caught when it is written.
ASPERITY_TRAP(int, vfprintf, (FILE * f, const char* s, va_list a), (f, s, a))
ASPERITY_TRAP(int, puts, (const char* s), (s))
ASPERITY_TRAP(int, fputs, (const char* s, FILE* f), (s, f))
ASPERITY_TRAP(int, putchar, (int c), (c))
ASPERITY_TRAP(int, fputc, (int c, FILE* f), (c, f))
ASPERITY_TRAP(int, putc, (int c, FILE* f), (c, f))
ASPERITY_TRAP(int, fflush, (FILE * f), (f))
ASPERITY_TRAP(std::size_t, fwrite, (const void* p, std::size_t a, std::size_t b, FILE* f), (p, a, b, f))

extern "C" int trapped_printf(const char* format, ...) __asm__("printf");
int trapped_printf(const char* format, ...) {
  forbid("printf");
  va_list list;
  va_start(list, format);
  const int written = std::vfprintf(stdout, format, list);
  va_end(list);
  return written;
}

extern "C" int trapped_fprintf(FILE* file, const char* format, ...) __asm__("fprintf");
int trapped_fprintf(FILE* file, const char* format, ...) {
  forbid("fprintf");
  va_list list;
  va_start(list, format);
  const int written = std::vfprintf(file, format, list);
  va_end(list);
  return written;
}

// Throwing. The first thing that a throw-expression does is to take memory for its object.
ASPERITY_TRAP_AS("throw", void*, __cxa_allocate_exception, (std::size_t size), (size))
ASPERITY_TRAP_AS("throw", void, __cxa_rethrow, (), ())

#endif
