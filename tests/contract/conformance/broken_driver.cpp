// The sample driver with one thing broken in it. The environment variable ASPERITY_BROKEN says which, so that one
// module is every broken driver; "nothing" is the sample itself.
#include <array>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fcntl.h>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <string_view>
#include <unistd.h>
#include <vector>

#include "asperity/device/driver_export.hpp"
#include "spring_handle.hpp"

namespace {

using namespace asperity;

// Looked at once, outside a tick.
bool is_broken(std::string_view what) {
  const char* chosen = std::getenv("ASPERITY_BROKEN");
  return chosen != nullptr && what == chosen;
}

std::mutex a_lock;

[[noreturn]] void hang() {
  for (;;) ::pause();
}
[[noreturn]] void print_for_ever() {
  for (;;) std::puts("and another thing"), std::fflush(stdout);
}

// One line for a test that looks from outside, with the time on CLOCK_MONOTONIC in ms.
void tell(const char* what, double value = 0.0) noexcept {
  const char* file = std::getenv("ASPERITY_BROKEN_LOG");
  if (file == nullptr) return;
  const int fd = ::open(file, O_WRONLY | O_APPEND | O_CREAT, 0600);
  timespec t{};
  ::clock_gettime(CLOCK_MONOTONIC, &t);
  ::dprintf(fd, "%s %.6g %ld %d\n", what, value, t.tv_sec * 1000 + t.tv_nsec / 1'000'000, ::getpid());
  ::close(fd);
}

// What runs before anybody has asked the driver for anything.
__attribute__((constructor)) void when_loaded() {
  if (is_broken("tells")) tell("loaded");
  if (is_broken("throws_when_loaded")) throw std::runtime_error("thrown while it was loaded");
  if (is_broken("exits_when_loaded")) ::_exit(7);
  if (is_broken("crashes_when_loaded")) std::raise(SIGSEGV);
  if (is_broken("hangs_when_loaded")) hang();
  if (is_broken("prints_when_loaded")) print_for_ever();
}

class broken_handle {
 public:
  using policy_tag = device_tag;

  broken_handle() {
    limits_ = inner_.capabilities();
    if (is_broken("limits_below_saturation")) limits_.peak_force_n = 3.0;
    if (is_broken("workspace_in_mm")) {
      limits_.workspace_low_d *= 1000.0;
      limits_.workspace_high_d *= 1000.0;
    }
    if (is_broken("no_slew")) limits_.force_slew_n_per_s = 0.0;
    if (is_broken("negative_limit")) limits_.moving_mass_kg = -1.0;
    if (is_broken("nominal_below_minimum")) limits_.minimum_rate_hz = 5000.0;
  }

  [[nodiscard]] const device_capabilities& capabilities() const noexcept { return limits_; }
  [[nodiscard]] device_state state() const noexcept { return lie_ ? lied_ : inner_.state(); }

  [[nodiscard]] result<void> open() {
    if (hangs_) ::sleep(3600);
    if (crashes_in_open_) std::raise(SIGSEGV);
    if (prints_) std::puts("printed in open()");
    if (throws_in_open_) throw std::runtime_error("thrown in open()");
    result<void> done = inner_.open();
    if (done && open_arms_) done = inner_.arm();
    return done;
  }
  [[nodiscard]] result<void> arm() {
    if (hangs_in_arm_) hang();
    if (moves_limits_) limits_.peak_force_n = 3.9;
    if (arms_when_armed_ && may_put_out(inner_.state())) return {};
    return inner_.arm();
  }
  [[nodiscard]] result<void> clear_fault() {
    result<void> done = inner_.clear_fault();
    if (done && rearms_) {
      done = inner_.open();
      if (done) done = inner_.arm();
    }
    return done;
  }
  status disarm() noexcept {
    if (tells_) tell("disarm");
    if (hangs_in_disarm_) hang();
    static_cast<void>(inner_.applied(last_write_ns_, left_over_));
    return inner_.disarm();
  }
  void close() noexcept {
    if (tells_) tell("close");
    if (hangs_in_close_) hang();
    if (crashes_in_close_) std::raise(SIGSEGV);
    static_cast<void>(inner_.applied(last_write_ns_, left_over_));
    inner_.close();
  }

  [[nodiscard]] status read(std::int64_t now_ns, device_sample& in) noexcept {
    if (crashes_) std::raise(SIGSEGV);
    if (exits_) ::_exit(0);
    if (aborts_) std::abort();
    if (hangs_in_read_ && reads_ == 20) hang();
    if (crashes_later_ && reads_ == 20) std::raise(SIGSEGV);
    if (allocates_) {
      void* volatile p = std::malloc(16);
      std::free(p);
    }
    if (locks_) {
      const std::lock_guard<std::mutex> held(a_lock);
      ++reads_;
    }
    if (reads_clock_) {
      timespec t{};
      ::clock_gettime(CLOCK_MONOTONIC, &t);
    }
    if (throws_inside_) {
      try {
        throw 1;
      } catch (int) {
        ++reads_;
      }
    }
    if (vanishes_ && reads_ == 20) static_cast<void>(inner_.provoke(provocation::departure));
    const status s = inner_.read(now_ns, in);
    if (s != status::ok) return s;
    ++reads_;
    if (arms_in_read_ && reads_ == 20) {
      lie_ = true;
      lied_ = device_state::armed;
    }
    if (echoes_) in.T_dh.position = 0.001 * commanded_;
    if (nan_) in.T_dh.position.x = std::nan("");
    if (millimetres_) in.T_dh.position *= 1000.0;
    if (long_quaternion_) in.T_dh.rotation *= 2.0;
    if (claims_rotation_) in.valid = in.valid | sample_field::rotation;
    if (stale_as_new_) {
      if (reads_ == 50) frozen_ = in;
      if (reads_ > 50) {
        const std::uint64_t sequence = in.sequence;
        in = frozen_;
        in.sequence = sequence;
        in.host_time_ns = now_ns;
      }
    }
    if (stops_measuring_) {
      if (reads_ == 50) frozen_ = in;
      if (reads_ > 50) in = frozen_;
    }
    if (times_go_back_ && in.sequence % 2 == 0) in.host_time_ns -= 1'500'000;
    if (device_time_goes_back_ && in.sequence % 2 == 0) in.device_time_ns -= 2'500'000;
    if (from_the_future_) in.host_time_ns = now_ns + 1;
    if (repeats_sequence_) in.sequence /= 2;
    return s;
  }

  [[nodiscard]] status write(std::int64_t now_ns, const device_command& out) noexcept {
    last_write_ns_ = now_ns;
    ++writes_;
    if (tells_) tell("write", out.on_hand.force.x);
    if (hangs_in_write_ && writes_ == 20) hang();
    if (crashes_in_write_ && writes_ == 20) std::raise(SIGSEGV);
    if (sleeps_) {
      const timespec t{.tv_sec = 0, .tv_nsec = 1000};
      ::nanosleep(&t, nullptr);
    }
    if (is_slow_) {
      const std::clock_t begin = std::clock();
      while (std::clock() - begin < CLOCKS_PER_SEC / 1500) {
      }
    }
    if (prints_) std::fputs("printed in write()\n", stdout);
    if (is_real_ && (out.on_hand.force != vec3(0.0) || out.on_hand.torque != vec3(0.0))) std::raise(SIGABRT);
    commanded_ = out.on_hand.force;
    device_command c = out;
    if (ignores_valid_until_) c.valid_until_ns = now_ns + 10'000'000'000;
    if (takes_any_frame_) c.frame = wrench_frame::device_base;
    if (takes_nan_ && !is_finite(c.on_hand)) return status::ok;
    const status s = inner_.write(now_ns, c);
    if (inner_.state() == device_state::active) static_cast<void>(inner_.applied(now_ns, left_over_));
    if (wraps_) wrapped_ = c.on_hand.force;
    return hides_failure_ ? status::ok : s;
  }

  [[nodiscard]] status applied(std::int64_t now_ns, wrench& out) const noexcept {
    static_cast<void>(inner_.applied(now_ns, out));
    const device_state s = inner_.state();
    if (keeps_after_disarm_ && s == device_state::ready) out = left_over_;
    if (keeps_after_close_ && s == device_state::closed) out = left_over_;
    if (pushes_in_ready_ && s == device_state::ready) out.force.x = 0.3;
    if (weak_) out = 0.5 * out;
    if (wraps_ && may_put_out(s)) {
      for (int i = 0; i < 3; ++i) {
        const double counts = std::fmin(std::fmax(1000.0 * wrapped_[i], -9e18), 9e18);
        out.force[i] = 0.001 * static_cast<std::int16_t>(static_cast<std::uint64_t>(static_cast<std::int64_t>(counts)));
      }
    }
    return status::ok;
  }

  [[nodiscard]] std::string fault_text() const { return inner_.fault_text(); }

  [[nodiscard]] bool provoke(provocation what) {
    const bool done = inner_.provoke(what);
    if (what == provocation::comeback && returns_armed_) {
      lie_ = true;
      lied_ = device_state::armed;
    }
    return done;
  }

 private:
  sample::spring_handle inner_{};
  device_capabilities limits_{};
  bool lie_ = false;
  device_state lied_ = device_state::absent;
  std::uint64_t reads_ = 0;
  std::uint64_t writes_ = 0;
  device_sample frozen_{};
  wrench left_over_{};
  vec3 wrapped_{0.0};
  vec3 commanded_{0.0};
  std::int64_t last_write_ns_ = 0;

  // Stands for hardware that nobody holds: a command other than zero ends it.
  const bool is_real_ = is_broken("real");
  // Measures what it was told, so that a test sees what reaches a driver: one metre for a kilonewton.
  const bool echoes_ = is_broken("echoes");
  const bool vanishes_ = is_broken("vanishes");
  const bool arms_in_read_ = is_broken("arms_in_read");
  const bool hangs_ = is_broken("hangs_in_open");
  const bool throws_in_open_ = is_broken("throws_in_open");
  const bool open_arms_ = is_broken("open_arms");
  const bool moves_limits_ = is_broken("moves_limits");
  const bool arms_when_armed_ = is_broken("arms_when_armed");
  const bool rearms_ = is_broken("rearms_after_clear_fault");
  const bool crashes_ = is_broken("crashes");
  const bool exits_ = is_broken("exits");
  const bool aborts_ = is_broken("aborts");
  const bool crashes_later_ = is_broken("crashes_later");
  const bool crashes_in_open_ = is_broken("crashes_in_open");
  const bool crashes_in_write_ = is_broken("crashes_in_write");
  const bool crashes_in_close_ = is_broken("crashes_in_close");
  const bool hangs_in_arm_ = is_broken("hangs_in_arm");
  const bool hangs_in_read_ = is_broken("hangs_in_read");
  const bool hangs_in_write_ = is_broken("hangs_in_write");
  const bool hangs_in_disarm_ = is_broken("hangs_in_disarm");
  const bool hangs_in_close_ = is_broken("hangs_in_close");
  const bool tells_ = is_broken("tells");
  const bool allocates_ = is_broken("allocates_in_read");
  const bool locks_ = is_broken("locks");
  const bool reads_clock_ = is_broken("reads_clock");
  const bool throws_inside_ = is_broken("throws_inside_read");
  const bool nan_ = is_broken("nan");
  const bool millimetres_ = is_broken("millimetres");
  const bool long_quaternion_ = is_broken("long_quaternion");
  const bool claims_rotation_ = is_broken("claims_rotation");
  const bool stale_as_new_ = is_broken("stale_as_new");
  const bool stops_measuring_ = is_broken("stops_measuring");
  const bool times_go_back_ = is_broken("times_go_back");
  const bool device_time_goes_back_ = is_broken("device_time_goes_back");
  const bool from_the_future_ = is_broken("from_the_future");
  const bool repeats_sequence_ = is_broken("repeats_sequence");
  const bool sleeps_ = is_broken("sleeps_in_write");
  const bool is_slow_ = is_broken("slow_write");
  const bool prints_ = is_broken("prints");
  const bool ignores_valid_until_ = is_broken("ignores_valid_until");
  const bool takes_any_frame_ = is_broken("takes_any_frame");
  const bool takes_nan_ = is_broken("takes_nan");
  const bool hides_failure_ = is_broken("hides_write_failure");
  const bool keeps_after_disarm_ = is_broken("keeps_output_after_disarm");
  const bool keeps_after_close_ = is_broken("keeps_output_after_close");
  const bool pushes_in_ready_ = is_broken("pushes_in_ready");
  const bool weak_ = is_broken("weak");
  const bool wraps_ = is_broken("wraps_round");
  const bool returns_armed_ = is_broken("returns_armed");
};

struct broken_driver {
  static constexpr driver_description description{.name = "broken",
                                                  .version = "0",
                                                  .licence = "Apache-2.0",
                                                  .vendor = "the tests",
                                                  .maturity = driver_maturity::simulated};

  static result<std::vector<device_listing>> list() {
    std::vector<device_listing> out;
    if (is_broken("fails_to_list")) return error{error_code::io_failed, "the bus is on fire"};
    if (is_broken("nothing_plugged_in")) return out;
    if (is_broken("crashes_in_list")) std::raise(SIGSEGV);
    if (is_broken("exits_in_list")) ::_exit(0);
    if (is_broken("hangs_in_list")) hang();
    if (is_broken("prints_in_list")) print_for_ever();
    out.push_back({.driver = description.name,
                   .identity = "broken:1",
                   .path = "here",
                   .name = "broken handle",
                   .maturity = is_broken("real") || is_broken("real_and_held") ? driver_maturity::protocol_tested
                                                                               : description.maturity,
                   .capabilities = sample::spring_handle_capabilities()});
    return out;
  }
  static result<std::unique_ptr<broken_handle>> make(const device_listing& /*which*/) {
    return std::make_unique<broken_handle>();
  }
};

// What only the C interface can do wrong.
std::int32_t list_without_end(void* context, std::int32_t (*found)(void*, const asperity_listing*), char*,
                              std::uint32_t) {
  auto l = abi::blank<asperity_listing>();
  std::memset(l.identity, 'x', sizeof l.identity);
  abi::put_text(l.name, "endless");
  static_cast<void>(found(context, &l));
  return ASPERITY_OK;
}
std::int32_t list_without_number(void* context, std::int32_t (*found)(void*, const asperity_listing*), char*,
                                 std::uint32_t) {
  auto l = abi::blank<asperity_listing>();
  abi::put_text(l.name, "one of many");
  for (int i = 0; i < 1'000'000; ++i) {
    abi::put_text(l.identity, std::to_string(i));
    static_cast<void>(found(context, &l));
  }
  return ASPERITY_OK;
}
std::int32_t throwing_list(void*, std::int32_t (*)(void*, const asperity_listing*), char*, std::uint32_t) {
  throw std::runtime_error("in list()");
}
std::int32_t throwing_read(asperity_device*, std::int64_t, asperity_sample*) { throw std::runtime_error("in read()"); }
std::int32_t unknown_state(const asperity_device*) { return 77; }
std::int32_t wide_read(asperity_device* d, std::int64_t now_ns, asperity_sample* out) {
  const std::int32_t code = driver_table<broken_driver>.read(d, now_ns, out);
  std::memset(static_cast<void*>(reinterpret_cast<char*>(out) + sizeof *out), 0, 8);
  return code;
}
std::int32_t careless_read(asperity_device* d, std::int64_t now_ns, asperity_sample* out) {
  const std::uint32_t size = out->struct_size;
  *out = {};
  out->struct_size = size;
  return driver_table<broken_driver>.read(d, now_ns, out);
}
// Ends a table that is older than this host's, and one that is newer.
struct long_table {
  asperity_driver known;
  void* unknown[16];
};

const asperity_driver* table() {
  static long_table t{};
  t.known = driver_table<broken_driver>;
  asperity_driver& k = t.known;
  if (is_broken("no_table")) return nullptr;
  if (is_broken("wrong_struct_size")) k.struct_size = 64;
  if (is_broken("wrong_abi_major")) k.abi_major = ASPERITY_ABI_MAJOR + 1;
  if (is_broken("no_disarm")) k.disarm = nullptr;
  if (is_broken("no_name")) k.name = "";
  if (is_broken("list_without_end")) k.list = list_without_end;
  if (is_broken("list_without_number")) k.list = list_without_number;
  if (is_broken("throws_in_list")) k.list = throwing_list;
  // An address that nobody has, as from memory that was never set.
  const auto nowhere = static_cast<std::uintptr_t>(0x10);
  if (is_broken("garbage_table")) return reinterpret_cast<const asperity_driver*>(nowhere);
  if (is_broken("wild_name")) k.name = reinterpret_cast<const char*>(nowhere);
  if (is_broken("throws_in_read")) k.read = throwing_read;
  if (is_broken("unknown_state")) k.state = unknown_state;
  if (is_broken("writes_beyond")) k.read = wide_read;
  if (is_broken("spoils_sample")) k.read = careless_read;
  if (is_broken("nothing_optional")) k.applied = nullptr, k.fault_text = nullptr, k.provoke = nullptr;
  if (is_broken("older")) k.struct_size = offsetof(asperity_driver, attach);
  if (is_broken("newer")) {
    k.struct_size = sizeof t;
    k.abi_minor = 9;
  }
  return &t.known;
}

}  // namespace

extern "C" __attribute__((visibility("default"))) const asperity_driver* asperity_driver_entry(std::uint32_t) {
  return table();
}
