// Drivers in a process of their own: the same bits as here, and whatever they break, this program goes on.
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <fstream>
#include <future>
#include <gtest/gtest.h>
#include <limits>
#include <memory>
#include <random>
#include <sstream>
#include <string>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include "asperity/hal/device_directory.hpp"
#include "asperity/hal/driver_conversion.hpp"
#include "asperity/hal/simulated/simulated_device.hpp"
#include "asperity/plugin/child_driver.hpp"
#include "asperity/plugin/plugin_driver.hpp"
#include "command/patient_driver.hpp"
#include "module_files.hpp"
#include "support/counted_news.hpp"

namespace asperity::plugin {
namespace {

using test_support::broken_way;
using namespace std::chrono_literals;

constexpr std::int64_t tick_ns = 1'000'000;

std::int64_t clock_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}
double seconds_since(std::int64_t begin_ns) { return 1e-9 * static_cast<double>(clock_ns() - begin_ns); }

// Patient on a busy machine, but with what is known to hang.
child_options options_for(const std::string& way, child_pace pace = child_pace::lockstep) {
  const bool hangs = way.starts_with("hangs") || way.starts_with("prints");
  child_options o;
  o.pace = pace;
  o.list_patience_ns = 10'000'000'000;
  o.call_patience_ns = o.open_patience_ns = hangs ? 200'000'000 : 10'000'000'000;
  o.silence_ns = 300'000'000;
  o.host_program = ASPERITY_DRIVER_HOST;
  return o;
}

result<std::unique_ptr<child_driver>> load(const std::filesystem::path& file,
                                           child_options o = options_for("nothing")) {
  return child_driver::load(file, std::move(o), file_trust::as_named);
}

// A device of the broken driver, made, opened and armed, and the driver that it came from.
struct broken_device {
  std::unique_ptr<child_driver> driver{};
  std::optional<plugin_device> device{};

  broken_device(const std::string& way, child_options o, bool armed = true) {
    const broken_way chosen(way);
    result<std::unique_ptr<child_driver>> loaded = load(test_support::broken_driver, std::move(o));
    EXPECT_TRUE(loaded) << loaded.error().message;
    if (!loaded) return;
    driver = std::move(loaded).value();
    const result<std::vector<device_listing>> listed = driver->list();
    EXPECT_TRUE(listed && listed->size() == 1);
    if (!listed) return;
    result<plugin_device> made = driver->make_plugin(listed->at(0));
    EXPECT_TRUE(made) << made.error().message;
    if (!made) return;
    device.emplace(std::move(made).value());
    if (!armed) return;
    const result<void> opened = device->open();
    EXPECT_TRUE(opened) << opened.error().message;
    const result<void> up = device->arm();
    EXPECT_TRUE(up) << up.error().message;
  }
};

device_command push(std::int64_t now_ns, const vec3& force) {
  return {.on_hand = {force, vec3(0.0)},
          .frame = wrench_frame::device_base,
          .valid_until_ns = now_ns + 20 * tick_ns,
          .sequence = 1};
}

bool same_bits(const device_sample& a, const device_sample& b) {
  const asperity_sample bits_a = abi::to_abi(a);
  const asperity_sample bits_b = abi::to_abi(b);
  return std::memcmp(&bits_a, &bits_b, sizeof bits_a) == 0;
}

TEST(child, a_simulated_driver_has_the_same_bits_in_a_process_of_its_own) {
  result<std::unique_ptr<child_driver>> far = load(test_support::simulated_driver);
  ASSERT_TRUE(far) << far.error().message;
  result<std::unique_ptr<plugin_driver>> near =
      plugin_driver::load(test_support::simulated_driver, {}, file_trust::as_named);
  ASSERT_TRUE(near);
  EXPECT_EQ((*far)->name(), (*near)->name());
  EXPECT_EQ((*far)->maturity(), (*near)->maturity());
  const result<std::vector<device_listing>> listed_far = (*far)->list();
  const result<std::vector<device_listing>> listed_near = (*near)->list();
  ASSERT_TRUE(listed_far && listed_near);
  ASSERT_EQ(listed_far->size(), 1U);
  EXPECT_EQ(listed_far->at(0).identity, listed_near->at(0).identity);
  EXPECT_EQ(listed_far->at(0).capabilities.name, listed_near->at(0).capabilities.name);
  EXPECT_EQ(listed_far->at(0).capabilities.peak_force_n, listed_near->at(0).capabilities.peak_force_n);

  result<plugin_device> a = (*far)->make_plugin(listed_far->at(0));
  result<plugin_device> b = (*near)->make_plugin(listed_near->at(0));
  ASSERT_TRUE(a && b);
  EXPECT_FALSE(a->arm());
  ASSERT_TRUE(a->open() && b->open());
  ASSERT_TRUE(a->arm() && b->arm());
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::int64_t now_ns = 0;
  for (int tick = 0; tick < 3000; ++tick) {
    now_ns += tick_ns + static_cast<std::int64_t>(random() % 1000);
    device_sample from_far;
    device_sample from_near;
    ASSERT_EQ(a->read(now_ns, from_far), b->read(now_ns, from_near));
    ASSERT_TRUE(same_bits(from_far, from_near)) << tick;
    // Zero, small, at the limit, far beyond it, and expired.
    const double strength[] = {0.0, 1e-3, 1.0, 20.0, 1e6};
    device_command c = push(now_ns, strength[tick / 100 % 5] * vec3(unit(random), unit(random), unit(random)));
    if (tick % 97 == 0) c.valid_until_ns = now_ns - 1;
    ASSERT_EQ(a->write(now_ns, c), b->write(now_ns, c)) << tick;
    ASSERT_EQ(a->state(), b->state()) << tick;
    if (tick % 1000 == 999) {
      ASSERT_EQ(a->disarm(), b->disarm());
      ASSERT_EQ(a->state(), device_state::ready);
      ASSERT_TRUE(a->arm() && b->arm());
    }
  }
  const device_command nan = push(now_ns, {std::nan(""), 0.0, 0.0});
  EXPECT_EQ(a->write(now_ns, nan), b->write(now_ns, nan));
  EXPECT_EQ(a->state(), device_state::fault);
  EXPECT_EQ(a->fault_text(), b->fault_text());
  a->close();
  EXPECT_EQ((*far)->what_happened(), "");
}

TEST(child, each_way_to_fail_before_there_is_a_device_is_one_clear_line) {
  struct bad_driver {
    const char* way;
    const char* says;
  };
  const bad_driver ways[] = {{"throws_when_loaded", "while it was loaded"},
                             {"exits_when_loaded", "ended itself with status 7 while it was loaded"},
                             {"crashes_when_loaded", "while it was loaded"},
                             {"hangs_when_loaded", "did not come back: it was while it was loaded"},
                             {"prints_when_loaded", "did not come back"},
                             {"no_table", "no table"},
                             {"garbage_table", "while it was loaded"},
                             {"wild_name", "while it was loaded"},
                             {"no_name", "name is empty"},
                             {"throws_in_list", "threw an exception"},
                             {"crashes_in_list", "in list()"},
                             {"exits_in_list", "ended itself with status 0 in list()"},
                             {"hangs_in_list", "did not come back: it was in list()"},
                             {"prints_in_list", "did not come back: it was in list()"},
                             {"list_without_end", "zero byte"},
                             {"list_without_number", "more than 64"},
                             {"fails_to_list", "the bus is on fire"}};
  for (const bad_driver& bad : ways) {
    SCOPED_TRACE(bad.way);
    const broken_way chosen(bad.way);
    const std::int64_t begin_ns = clock_ns();
    std::string message;
    {
      child_options o = options_for(bad.way);
      if (o.call_patience_ns < o.list_patience_ns) o.list_patience_ns = 300'000'000;
      result<std::unique_ptr<child_driver>> loaded = load(test_support::broken_driver, o);
      if (loaded) {
        const result<std::vector<device_listing>> listed = (*loaded)->list();
        ASSERT_FALSE(listed);
        message = listed.error().message;
      } else {
        message = loaded.error().message;
      }
    }
    EXPECT_LT(seconds_since(begin_ns), 5.0);
    EXPECT_NE(message.find(bad.says), std::string::npos) << message;
    EXPECT_NE(message.find("broken_driver.so"), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

TEST(child, what_a_driver_does_outside_a_tick_ends_in_an_error_and_not_here) {
  {
    broken_device b("crashes_in_open", options_for("crashes_in_open"), false);
    const result<void> opened = b.device->open();
    ASSERT_FALSE(opened);
    EXPECT_NE(opened.error().message.find("in open()"), std::string::npos) << opened.error().message;
    EXPECT_FALSE(may_put_out(b.device->state()));
  }
  {
    broken_device b("hangs_in_open", options_for("hangs_in_open"), false);
    EXPECT_FALSE(b.device->open());
  }
  {
    // A person gives up before the driver does.
    child_options o = options_for("hangs_in_open");
    o.open_patience_ns = 3'600'000'000'000;
    const std::int64_t begin_ns = clock_ns();
    o.cancelled = [begin_ns] { return seconds_since(begin_ns) > 0.3; };
    broken_device b("hangs_in_open", std::move(o), false);
    const result<void> opened = b.device->open();
    ASSERT_FALSE(opened);
    EXPECT_NE(opened.error().message.find("given up"), std::string::npos) << opened.error().message;
    EXPECT_LT(seconds_since(begin_ns), 10.0);
  }
  {
    broken_device b("hangs_in_arm", options_for("hangs_in_arm"), false);
    ASSERT_TRUE(b.device->open());
    EXPECT_FALSE(b.device->arm());
    EXPECT_FALSE(may_put_out(b.device->state()));
    EXPECT_NE(b.driver->what_happened().find("in arm()"), std::string::npos) << b.driver->what_happened();
  }
  for (const char* way : {"hangs_in_close", "crashes_in_close"}) {
    SCOPED_TRACE(way);
    broken_device b(way, options_for(way));
    const std::int64_t begin_ns = clock_ns();
    b.device->close();
    b.device.reset();
    EXPECT_LT(seconds_since(begin_ns), 5.0);
    EXPECT_NE(b.driver->what_happened().find("in close()"), std::string::npos) << b.driver->what_happened();
  }
}

bool wait_until(std::chrono::milliseconds longest, const std::function<bool()>& done) {
  const auto until = std::chrono::steady_clock::now() + longest;
  while (!done()) {
    if (std::chrono::steady_clock::now() > until) return false;
    std::this_thread::sleep_for(5ms);
  }
  return true;
}

// Ticks in real time until the device is in its fault, two seconds at the most. @return ticks
int run_to_fault(plugin_device& device, device_sample& last) {
  for (int tick = 1; tick < 2000; ++tick) {
    const std::int64_t now_ns = clock_ns();
    const status got = device.read(now_ns, last);
    if (device.state() == device_state::fault) {
      EXPECT_NE(got, status::ok);
      EXPECT_NE(device.write(now_ns, push(now_ns, {0.5, 0.0, 0.0})), status::ok);
      return tick;
    }
    static_cast<void>(device.write(now_ns, push(now_ns, {0.5, 0.0, 0.0})));
    if (device.state() == device_state::fault) return tick;
    std::this_thread::sleep_for(1ms);
  }
  return 2000;
}

TEST(child, what_a_driver_does_in_a_tick_is_a_fault_of_its_device) {
  struct bad_driver {
    const char* way;
    const char* says;
    child_pace pace;
  };
  constexpr child_pace paced = child_pace::paced;
  constexpr child_pace lockstep = child_pace::lockstep;
  const bad_driver ways[] = {
      {"crashes_later", "in read()", paced},     {"crashes_later", "in read()", lockstep},
      {"aborts", "in read()", lockstep},         {"exits", "ended itself with status 0 in read()", paced},
      {"crashes_in_write", "in write()", paced}, {"crashes_in_write", "in write()", lockstep},
      {"hangs_in_read", "in read()", paced},     {"hangs_in_write", "in write()", paced},
      {"throws_in_read", "exception", lockstep}};
  for (const bad_driver& bad : ways) {
    SCOPED_TRACE(std::string(bad.way) + (bad.pace == paced ? ", paced" : ", lockstep"));
    broken_device b(bad.way, options_for(bad.way, bad.pace));
    ASSERT_TRUE(b.device);
    device_sample last;
    EXPECT_LT(run_to_fault(*b.device, last), 2000);
    EXPECT_EQ(b.device->state(), device_state::fault);
    EXPECT_EQ(b.device->fault(), plugin_fault::device_fault);
    EXPECT_NE(b.device->fault_text().find(bad.says), std::string::npos) << b.device->fault_text();
    EXPECT_FALSE(b.device->arm());
    const std::int64_t begin_ns = clock_ns();
    static_cast<void>(b.device->disarm());
    b.device->close();
    b.device.reset();
    EXPECT_LT(seconds_since(begin_ns), 5.0);
  }
}

TEST(child, a_hang_is_a_fault_within_the_stated_time_of_the_session) {
  child_options o = options_for("hangs_in_read", child_pace::paced);
  o.silence_ns = child_options{}.silence_ns;
  broken_device b("hangs_in_read", std::move(o));
  ASSERT_TRUE(b.device);
  const std::int64_t begin_ns = clock_ns();
  device_sample in;
  std::uint64_t newest = 0;
  std::int64_t newest_ns = begin_ns;
  std::int64_t longest_ns = 0;
  while (b.device->state() != device_state::fault && seconds_since(begin_ns) < 5.0) {
    const std::int64_t now_ns = clock_ns();
    static_cast<void>(b.device->read(now_ns, in));
    longest_ns = std::max(longest_ns, clock_ns() - now_ns);
    if (in.sequence != newest) newest_ns = now_ns;
    newest = in.sequence;
    static_cast<void>(b.device->write(now_ns, push(now_ns, vec3(0.0))));
    std::this_thread::sleep_for(1ms);
  }
  ASSERT_EQ(b.device->state(), device_state::fault);
  // 20 ms and two ticks are stated; a busy machine makes the ticks themselves late.
  EXPECT_LT(clock_ns() - newest_ns, 1'000'000'000);
  EXPECT_LT(longest_ns, 500'000'000) << "a read() waited for the driver";
}

TEST(child, a_driver_that_is_slow_is_not_one_that_is_silent) {
  // It takes two thirds of a millisecond for each command and is asked more often than that: no answer is in time.
  broken_device b("slow_write", options_for("slow_write", child_pace::paced));
  ASSERT_TRUE(b.device);
  device_sample in;
  const std::int64_t begin_ns = clock_ns();
  std::uint64_t first = 0;
  while (seconds_since(begin_ns) < 0.6) {
    const std::int64_t now_ns = clock_ns();
    static_cast<void>(b.device->read(now_ns, in));
    static_cast<void>(b.device->write(now_ns, push(now_ns, {0.5, 0.0, 0.0})));
    if (first == 0) first = in.sequence;
  }
  EXPECT_TRUE(may_put_out(b.device->state())) << b.device->fault_text();
  EXPECT_GT(in.sequence, first + 10);
  EXPECT_EQ(b.driver->what_happened(), "");
}

TEST(child, a_program_that_takes_its_time_before_the_first_command_is_not_silent) {
  broken_device b("nothing", options_for("nothing", child_pace::paced));
  std::this_thread::sleep_for(200ms);
  device_sample in;
  EXPECT_TRUE(wait_until(5s, [&] { return b.device->read(clock_ns(), in) == status::ok; }));
  EXPECT_EQ(b.device->state(), device_state::armed) << b.device->fault_text();
}

TEST(child, a_cleared_fault_starts_the_driver_anew_and_arms_nothing) {
  for (const char* way : {"crashes_later", "hangs_in_read"}) {
    SCOPED_TRACE(way);
    broken_device b(way, options_for(way, child_pace::paced));
    device_sample last;
    ASSERT_LT(run_to_fault(*b.device, last), 2000);
    EXPECT_FALSE(b.device->open());
    {
      const broken_way mended("nothing");
      const result<void> cleared = b.device->clear_fault();
      ASSERT_TRUE(cleared) << cleared.error().message;
    }
    EXPECT_EQ(b.device->state(), device_state::closed);
    EXPECT_FALSE(b.device->arm());
    ASSERT_TRUE(b.device->open());
    EXPECT_EQ(b.device->state(), device_state::ready);
    ASSERT_TRUE(b.device->arm());
    for (int tick = 0; tick < 50; ++tick) {
      const std::int64_t now_ns = clock_ns();
      static_cast<void>(b.device->read(now_ns, last));
      static_cast<void>(b.device->write(now_ns, push(now_ns, {0.5, 0.0, 0.0})));
      std::this_thread::sleep_for(1ms);
    }
    EXPECT_GT(last.T_dh.position.x, 1e-3) << "it measures and pushes again";
  }
}

// What the driver wrote down: a word, a value, ms on the clock, its process.
struct line_of_driver {
  std::string what;
  double value = 0.0;
  std::int64_t at_ms = 0;
  pid_t process = 0;
};
std::vector<line_of_driver> told(const std::filesystem::path& log) {
  std::vector<line_of_driver> out;
  std::ifstream in(log);
  for (line_of_driver l; in >> l.what >> l.value >> l.at_ms >> l.process;) out.push_back(l);
  return out;
}

// Another program: it pushes with half a newton through a driver of its own until a signal ends or stops it.
// @return its process; `log` is what its driver is told
pid_t start_program(const std::filesystem::path& log, int exit_in_fault) {
  std::filesystem::remove(log);
  const pid_t program = ::fork();
  if (program != 0) return program;
  ::setenv("ASPERITY_BROKEN_LOG", log.c_str(), 1);
  broken_device b("tells", options_for("tells", child_pace::paced));
  if (!b.device) ::_exit(90);
  device_sample in;
  for (;;) {
    const std::int64_t now_ns = clock_ns();
    static_cast<void>(b.device->read(now_ns, in));
    static_cast<void>(b.device->write(now_ns, push(now_ns, {0.5, 0.0, 0.0})));
    if (b.device->state() == device_state::fault) {
      const bool silent = b.device->fault_text().find("silent for too long") != std::string::npos;
      b.device.reset();
      ::_exit(silent ? exit_in_fault : 91);
    }
    std::this_thread::sleep_for(1ms);
  }
}

bool pushes(const std::filesystem::path& log) {
  const std::vector<line_of_driver> lines = told(log);
  return std::count_if(lines.begin(), lines.end(),
                       [](const line_of_driver& l) { return l.what == "write" && l.value == 0.5; }) > 20;
}
bool ends_with(const std::filesystem::path& log, const std::string& what) {
  const std::vector<line_of_driver> lines = told(log);
  return !lines.empty() && lines.back().what == what;
}

// Gone, or over and not yet taken note of by whoever has to.
bool is_over(pid_t process) {
  std::ifstream in("/proc/" + std::to_string(process) + "/stat");
  std::string line;
  if (!std::getline(in, line)) return true;
  const std::size_t end = line.rfind(')');
  return end == std::string::npos || line.compare(end, 3, ") Z") == 0;
}

// From the last push on: zero, then disarmed. @return how long after the last push, ms
void look_at_silence(const std::vector<line_of_driver>& lines, std::int64_t& zero_ms, std::int64_t& disarmed_ms) {
  zero_ms = disarmed_ms = -1;
  std::int64_t last_push_ms = 0;
  for (const line_of_driver& l : lines) {
    if (l.what == "write" && l.value != 0.0) {
      last_push_ms = l.at_ms;
      zero_ms = disarmed_ms = -1;
    }
    if (l.what == "write" && l.value == 0.0 && zero_ms < 0) zero_ms = l.at_ms - last_push_ms;
    if (l.what == "disarm" && disarmed_ms < 0) disarmed_ms = l.at_ms - last_push_ms;
  }
}

TEST(child, a_program_that_is_killed_leaves_no_force_and_no_process_behind) {
  const std::filesystem::path log = test_support::driver_folder("killed") / "log";
  const pid_t program = start_program(log, 0);
  ASSERT_GT(program, 0);
  const bool pushed = wait_until(20s, [&] { return pushes(log); });
  ::kill(program, SIGKILL);
  ::waitpid(program, nullptr, 0);
  ASSERT_TRUE(pushed);
  EXPECT_TRUE(wait_until(10s, [&] { return ends_with(log, "close"); }));
  const std::vector<line_of_driver> lines = told(log);
  std::int64_t zero_ms = 0;
  std::int64_t disarmed_ms = 0;
  look_at_silence(lines, zero_ms, disarmed_ms);
  EXPECT_GE(zero_ms, 0);
  EXPECT_GE(disarmed_ms, 0);
  std::printf("zero %ld ms and disarmed %ld ms after the last push of a program that was killed\n",
              static_cast<long>(zero_ms), static_cast<long>(disarmed_ms));
  EXPECT_LT(zero_ms, 2000);
  EXPECT_TRUE(wait_until(10s, [&] { return is_over(lines.back().process); })) << "the driver's process lives on";
}

TEST(child, a_program_that_is_stopped_is_disarmed_and_finds_its_device_in_fault) {
  const std::filesystem::path log = test_support::driver_folder("stopped") / "log";
  const pid_t program = start_program(log, 42);
  ASSERT_GT(program, 0);
  const bool pushed = wait_until(20s, [&] { return pushes(log); });
  ::kill(program, SIGSTOP);
  EXPECT_TRUE(pushed);
  EXPECT_TRUE(wait_until(10s, [&] { return ends_with(log, "disarm"); }));
  std::int64_t zero_ms = 0;
  std::int64_t disarmed_ms = 0;
  look_at_silence(told(log), zero_ms, disarmed_ms);
  std::printf("zero %ld ms and disarmed %ld ms after the last push of a program that was stopped\n",
              static_cast<long>(zero_ms), static_cast<long>(disarmed_ms));
  EXPECT_GE(zero_ms, 15) << "its last command was good for 20 ms";
  EXPECT_LT(zero_ms, 2000);
  EXPECT_GE(disarmed_ms, zero_ms + 50);
  EXPECT_LT(disarmed_ms, 4000);
  ::kill(program, SIGCONT);
  int how = 0;
  ASSERT_TRUE(wait_until(10s, [&] { return ::waitpid(program, &how, WNOHANG) == program; }));
  EXPECT_TRUE(WIFEXITED(how));
  EXPECT_EQ(WEXITSTATUS(how), 42) << "91: the device was not in fault for its program's silence";
}

TEST(child, a_hostile_process_can_say_nothing_that_is_believed) {
  // Instead of the helper a program that writes noise over everything that is shared, and rings all the time.
  child_options o = options_for("hangs", child_pace::paced);
  o.host_program = ASPERITY_HOSTILE_HOST;
  o.list_patience_ns = o.call_patience_ns = o.open_patience_ns = 80'000'000;
  int armed = 0;
  int measured = 0;
  for (const int seed : {0, 2, 4, 6, 7, 8, 9}) {  // armed with the seventh call
    SCOPED_TRACE(seed);
    ::setenv("ASPERITY_HOSTILE_SEED", std::to_string(seed).c_str(), 1);
    const std::int64_t begin_ns = clock_ns();
    result<std::unique_ptr<child_driver>> loaded = load(test_support::broken_driver, o);
    if (loaded) {
      const result<std::vector<device_listing>> listed = (*loaded)->list();
      result<plugin_device> device =
          (*loaded)->make_plugin({.driver = "broken", .identity = "broken:1", .path = "here", .name = "broken handle"});
      if (device) {
        EXPECT_TRUE(std::isfinite(device->capabilities().peak_force_n));
        if (device->open()) armed += device->arm() ? 1 : 0;
        device_sample in;
        for (int tick = 0; tick < 50; ++tick) {
          const std::int64_t now_ns = clock_ns();
          if (device->read(now_ns, in) == status::ok) {
            ++measured;
            EXPECT_TRUE(is_finite(in.T_dh.position) && is_valid(in.T_dh));
          }
          static_cast<void>(device->write(now_ns, push(now_ns, {0.5, 0.0, 0.0})));
        }
        static_cast<void>(device->disarm());
        EXPECT_FALSE(may_put_out(device->state()));
        EXPECT_FALSE(device->fault_text().empty());
      }
    }
    EXPECT_LT(seconds_since(begin_ns), 10.0);
  }
  ::unsetenv("ASPERITY_HOSTILE_SEED");
  EXPECT_GT(armed, 0) << "the noise began too early to be looked at in a tick";
  std::printf("hostile: armed %d times, %d samples\n", armed, measured);
}

TEST(child, a_tick_allocates_nothing_on_this_side) {
  for (const child_pace pace : {child_pace::paced, child_pace::lockstep}) {
    broken_device b("crashes_later", options_for("crashes_later", pace));
    ASSERT_TRUE(b.device);
    device_sample in;
    const std::size_t before = test_support::news_in_this_thread();
    const std::int64_t begin_ns = clock_ns();
    for (int after = 0; after < 50 && seconds_since(begin_ns) < 10.0;) {
      const std::int64_t now_ns = clock_ns();
      static_cast<void>(b.device->read(now_ns, in));
      static_cast<void>(b.device->write(now_ns, push(now_ns, {0.5, 0.0, 0.0})));
      if (b.device->state() == device_state::fault) ++after;
    }
    static_cast<void>(b.device->disarm());
    EXPECT_EQ(test_support::news_in_this_thread(), before) << "healthy ticks, the crash, and those in fault";
    EXPECT_EQ(b.device->state(), device_state::fault);
  }
}

// A driver of the build whose bus does not answer until it is told to.
class waiting_driver final : public device_driver {
 public:
  explicit waiting_driver(std::shared_future<void> answer) : answer_(std::move(answer)) {}
  [[nodiscard]] std::string_view name() const noexcept override { return "waiting"; }
  [[nodiscard]] driver_maturity maturity() const noexcept override { return driver_maturity::simulated; }
  [[nodiscard]] result<std::vector<device_listing>> list() override {
    answer_.wait();
    return std::vector<device_listing>(1);
  }
  [[nodiscard]] result<any_device> make(const device_listing&) override {
    return error{error_code::unsupported, "it makes none"};
  }

 private:
  std::shared_future<void> answer_;
};

TEST(drivers_of_the_build, one_that_hangs_is_left_behind_and_the_others_are_listed) {
  std::promise<void> answers;
  auto uses = std::make_shared<int>(1);
  const std::weak_ptr<int> used = uses;
  const auto waiting = std::make_shared<waiting_driver>(answers.get_future().share());
  std::vector<std::unique_ptr<device_driver>> all;
  all.push_back(std::make_unique<command::patient_driver>(waiting, std::move(uses), 50ms));
  std::promise<void> at_once;
  at_once.set_value();
  all.push_back(std::make_unique<command::patient_driver>(
      std::make_shared<waiting_driver>(at_once.get_future().share()), nullptr, 10s));
  {
    device_directory directory(std::move(all));
    const std::int64_t begin_ns = clock_ns();
    static_cast<void>(directory.refresh());
    static_cast<void>(directory.refresh());
    EXPECT_LT(seconds_since(begin_ns), 5.0);
    EXPECT_EQ(directory.devices().size(), 1U);
    ASSERT_EQ(directory.problems().size(), 1U);
    EXPECT_NE(directory.problems()[0].why.message.find("50 ms"), std::string::npos)
        << directory.problems()[0].why.message;
  }
  EXPECT_FALSE(used.expired()) << "what it uses stays until it is out of there";
  answers.set_value();
  EXPECT_TRUE(wait_until(10s, [&] { return used.expired(); }));
}

TEST(child, a_program_without_the_helper_is_told_what_is_missing) {
  child_options o = options_for("nothing");
  o.host_program = "/nowhere/asperity-driver-host";
  const result<std::unique_ptr<child_driver>> loaded = load(test_support::sample_driver, o);
  ASSERT_FALSE(loaded);
  EXPECT_NE(loaded.error().message.find("/nowhere/asperity-driver-host"), std::string::npos) << loaded.error().message;
}

// Information, for docs/explanation/plugin-threats.md: one tick's read() and write(), in process and beside it, in
// turns.
TEST(child, DISABLED_cost_of_a_tick) {
  result<std::unique_ptr<child_driver>> far =
      load(test_support::simulated_driver, options_for("nothing", child_pace::paced));
  result<std::unique_ptr<plugin_driver>> near =
      plugin_driver::load(test_support::simulated_driver, {}, file_trust::as_named);
  ASSERT_TRUE(far && near);
  const device_listing which = (*near)->list()->at(0);
  result<plugin_device> devices[] = {(*near)->make_plugin(which), (*far)->make_plugin(which)};
  std::vector<double> times_us[2];
  int fresh[2] = {0, 0};
  std::uint64_t newest[2] = {0, 0};
  for (auto& d : devices) ASSERT_TRUE(d && d->open() && d->arm());
  constexpr int ticks = 10'000;
  for (int tick = 0; tick < ticks; ++tick) {
    for (std::size_t i = 0; i < 2; ++i) {
      const std::int64_t begin_ns = clock_ns();
      device_sample in;
      if (devices[i]->read(begin_ns, in) == status::ok && in.sequence != newest[i]) ++fresh[i];
      newest[i] = in.sequence;
      static_cast<void>(devices[i]->write(begin_ns, push(begin_ns, {0.5, 0.0, 0.0})));
      times_us[i].push_back(1e-3 * static_cast<double>(clock_ns() - begin_ns));
    }
    std::this_thread::sleep_for(1ms);
  }
  const auto at = [&](std::size_t i, double part) {
    std::sort(times_us[i].begin(), times_us[i].end());
    return times_us[i][static_cast<std::size_t>(part * (ticks - 1))];
  };
  for (const double part : {0.5, 0.99, 1.0}) {
    std::printf("p%g: in process %.2f us, beside it %.2f us, ratio %.1f\n", 100.0 * part, at(0, part), at(1, part),
                at(1, part) / at(0, part));
  }
  std::printf("new samples: in process %d, beside it %d of %d\n", fresh[0], fresh[1], ticks);
}

}  // namespace
}  // namespace asperity::plugin
