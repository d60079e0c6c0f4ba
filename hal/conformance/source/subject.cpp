#include "subject.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <utility>

namespace asperity::conformance {
namespace {

constexpr std::int32_t threw = INT32_MIN;
constexpr double rounding = 1e-6;

// A struct with a fence behind it: nobody may write beyond the size that he was given.
template <class Struct>
struct fenced {
  Struct it;
  std::uint64_t fence[8];

  fenced() noexcept {
    std::memset(static_cast<void*>(&it), 0xa5, sizeof it);
    it.struct_size = sizeof(Struct);
    std::fill_n(fence, 8, std::uint64_t{0xa5a5a5a5a5a5a5a5});
  }
  [[nodiscard]] bool intact() const noexcept {
    return it.struct_size == sizeof(Struct) &&
           std::all_of(fence, fence + 8, [](std::uint64_t x) { return x == 0xa5a5a5a5a5a5a5a5; });
  }
  [[nodiscard]] bool untouched() const noexcept {
    const auto* first = reinterpret_cast<const unsigned char*>(&it) + sizeof(std::uint32_t);
    const auto* last = reinterpret_cast<const unsigned char*>(&it) + sizeof(Struct);
    return std::all_of(first, last, [](unsigned char b) { return b == 0xa5; });
  }
};

template <std::size_t N>
bool all_finite(const double (&x)[N]) noexcept {
  return std::all_of(x, x + N, [](double v) { return std::isfinite(v); });
}

// Bytes and not values: a NaN that stands still is the same, and -0 is not 0. Nothing between the members is left
// unset.
template <class T>
bool same_bytes(const T& a, const T& b) noexcept {
  return std::memcmp(&a, &b, sizeof a) == 0;  // NOLINT(bugprone-suspicious-memory-comparison)
}

std::string newton(double v, const char* unit) { return std::to_string(v) + " " + unit; }

}  // namespace

subject::subject(const asperity_driver& table, const asperity_listing& which, kit_clock& clock, ledger& found,
                 progress& shared)
    : t_(table), which_(which), clock_(clock), found_(found), shared_(shared) {
  pair_times_ns_.reserve(100'000);
}

subject::~subject() { destroy(); }

template <class Call>
std::int32_t subject::set_up_call(const char* name, Call&& call) {
  shared_.enter(name, found_.stage());
  char text[ASPERITY_TEXT_SIZE + 16];
  std::memset(text, 0x5a, sizeof text);
  text[0] = '\0';
  std::int32_t code = threw;
  try {
    code = call(text, static_cast<std::uint32_t>(ASPERITY_TEXT_SIZE));
  } catch (...) {
  }
  found_.look("border.nothing_thrown", code != threw, [&] { return std::string(name) + "() threw an exception"; });
  found_.look("border.sizes_respected",
              std::all_of(text + ASPERITY_TEXT_SIZE, text + sizeof text, [](char c) { return c == 0x5a; }),
              [&] { return std::string(name) + "() wrote beyond the buffer for its error"; });
  text[ASPERITY_TEXT_SIZE - 1] = '\0';
  last_error_ = text;
  return code;
}

template <class Call>
std::int32_t subject::tick_call(const char* name, Call&& call) {
  shared_.enter(name, found_.stage());
  std::int32_t code = threw;
  call_watch::begin();
  try {
    code = call();
  } catch (...) {
  }
  const watched w = call_watch::end();
  found_.look("border.nothing_thrown", code != threw, [&] { return std::string(name) + "() threw an exception"; });
  look_at_watch(name, w);
  return code;
}

void subject::look_at_watch(const char* name, const watched& w) {
  if (!call_watch::missing().empty()) return;
  static constexpr const char* checks[forbidden_count] = {"rt.no_allocation", "rt.no_lock",  "rt.no_wait",
                                                          "rt.no_clock",      "rt.no_print", "rt.no_throw"};
  const bool thrown = w.times[static_cast<std::size_t>(forbidden::thrown)] > 0;
  for (std::size_t k = 0; k < forbidden_count; ++k) {
    // What throwing does on its way is not told twice.
    if (thrown && k != static_cast<std::size_t>(forbidden::thrown)) continue;
    found_.look(checks[k], w.times[k] == 0, [&] {
      return std::string(name) + "() called " + w.first[k] + (w.times[k] > 1 ? ", and more of its kind" : "");
    });
  }
}

bool subject::make_anew() {
  destroy();
  const std::int32_t code =
      set_up_call("make", [this](char* e, std::uint32_t n) { return t_.make(&which_, &handle_, e, n); });
  if (code != ASPERITY_OK || handle_ == nullptr) {
    handle_ = nullptr;
    return false;
  }
  has_sample_ = false;
  state_ = device_state::present;
  observe("make");
  return true;
}

void subject::destroy() {
  if (handle_ == nullptr) return;
  static_cast<void>(set_up_call("destroy", [this](char*, std::uint32_t) {
    t_.destroy(handle_);
    return ASPERITY_OK;
  }));
  handle_ = nullptr;
}

std::int32_t subject::open() {
  const device_state before = state_;
  has_sample_ = false;
  const std::int32_t code = set_up_call("open", [this](char* e, std::uint32_t n) { return t_.open(handle_, e, n); });
  if (code == ASPERITY_OK && !may_put_out(before)) {
    auto c = abi::blank<asperity_capabilities>();
    static_cast<void>(set_up_call("capabilities", [&](char*, std::uint32_t) { return t_.capabilities(handle_, &c); }));
    // What a later open() states is a new statement: a device may come back with another tool. What may not move is
    // what was stated in between.
    capabilities_ = c;
    opened_once_ = true;
    ++times_opened_;
  }
  observe("open");
  return code;
}

std::int32_t subject::arm() {
  const device_state before = state_;
  const std::int32_t code = set_up_call("arm", [this](char* e, std::uint32_t n) { return t_.arm(handle_, e, n); });
  observe(before == device_state::ready ? "arm" : "arm in another state than ready");
  return code;
}

std::int32_t subject::clear_fault() {
  const std::int32_t code =
      set_up_call("clear_fault", [this](char* e, std::uint32_t n) { return t_.clear_fault(handle_, e, n); });
  observe("clear_fault");
  return code;
}

std::int32_t subject::disarm() {
  const std::int32_t code = tick_call("disarm", [this] { return t_.disarm(handle_); });
  if (const std::optional<wrench> w = applied()) {
    found_.look("output.zero_after_disarm", is_zero(*w), [&] {
      return "disarm() left " + newton(glm::length(w->force), "N") + " and " + newton(glm::length(w->torque), "N m");
    });
  }
  observe("disarm");
  return code;
}

void subject::close() {
  static_cast<void>(set_up_call("close", [this](char*, std::uint32_t) {
    t_.close(handle_);
    return ASPERITY_OK;
  }));
  if (const std::optional<wrench> w = applied()) {
    found_.look("output.zero_after_close", is_zero(*w), [&] {
      return "close() left " + newton(glm::length(w->force), "N") + " and " + newton(glm::length(w->torque), "N m");
    });
  }
  observe("close");
}

std::int32_t subject::read() {
  const std::int64_t now = clock_.now_ns();
  fenced<asperity_sample> s;
  const std::int32_t code = tick_call("read", [&] { return t_.read(handle_, now, &s.it); });
  found_.look("border.sizes_respected", s.intact(), [] { return "read() wrote beyond struct_size, or over it"; });
  if (code == ASPERITY_OK) {
    look_at_sample(now, s.it);
  } else {
    found_.look("samples.untouched_on_failure", s.untouched(),
                [] { return "read() failed and wrote into the sample"; });
  }
  observe("read");
  return code;
}

std::int32_t subject::write(const asperity_command& c) {
  const std::int64_t now = clock_.now_ns();
  const std::int32_t code = tick_call("write", [&] { return t_.write(handle_, now, &c); });
  observe("write");
  return code;
}

std::int32_t subject::provoke(std::uint32_t what) {
  if (t_.provoke == nullptr) return ASPERITY_UNSUPPORTED;
  const std::int32_t code = set_up_call("provoke", [&](char*, std::uint32_t) { return t_.provoke(handle_, what); });
  observe("provoke");
  return code;
}

asperity_command subject::command(const wrench& on_hand) {
  device_command c{.on_hand = on_hand,
                   .frame = wrench_frame::device_base,
                   .valid_until_ns = clock_.now_ns() + 20'000'000,
                   .sequence = ++command_sequence_};
  return abi::to_abi(c);
}

std::int32_t subject::tick(const wrench& on_hand) {
  clock_.wait_ns(period_ns());
  const std::int64_t begin = kit_clock::monotonic_ns();
  static_cast<void>(read());
  const std::int32_t code = write(on_hand);
  if (measure_pairs_ && pair_times_ns_.size() < pair_times_ns_.capacity()) {
    pair_times_ns_.push_back(kit_clock::monotonic_ns() - begin);
  }
  return code;
}

std::int64_t subject::period_ns() const noexcept {
  const double rate = capabilities_.nominal_rate_hz;
  return rate >= 10.0 && rate <= 1e5 ? static_cast<std::int64_t>(1e9 / rate) : 1'000'000;
}

wrench subject::small_wrench() const noexcept {
  wrench w;
  const double force = 0.25 * capabilities_.continuous_force_n;
  const double torque = 0.25 * capabilities_.continuous_torque_n_m;
  for (int i = 0; i < 3; ++i) {
    if ((capabilities_.actuated >> i & 1U) != 0 && force > 0.0) {
      w.force[i] = force;
      return w;
    }
  }
  for (int i = 0; i < 3; ++i) {
    if ((capabilities_.actuated >> (i + 3) & 1U) != 0 && torque > 0.0) {
      w.torque[i] = torque;
      return w;
    }
  }
  return w;
}

std::optional<wrench> subject::applied() {
  if (t_.applied == nullptr || handle_ == nullptr) return std::nullopt;
  fenced<asperity_applied> a;
  const std::int64_t now = clock_.now_ns();
  const std::int32_t code = tick_call("applied", [&] { return t_.applied(handle_, now, &a.it); });
  found_.look("border.sizes_respected", a.intact(), [] { return "applied() wrote beyond struct_size, or over it"; });
  if (code != ASPERITY_OK) return std::nullopt;
  return abi::from_abi(a.it);
}

void subject::observe(const char* name) {
  if (handle_ == nullptr) return;
  const std::int32_t number = tick_call("state", [this] { return t_.state(handle_); });
  const std::optional<device_state> now = abi::to_state(number);
  if (!found_.look("states.known", now.has_value(),
                   [&] { return "state() is " + std::to_string(number) + " after " + name + "()"; })) {
    return;
  }
  const bool armed_here = may_put_out(*now) && !may_put_out(state_);
  found_.look("arming.only_by_arm", !armed_here || std::strcmp(name, "arm") == 0,
              [&] { return std::string(name) + "() led from " + to_string(state_) + " to " + to_string(*now); });
  state_ = *now;
  look_at_output(name);
}

void subject::look_at_output(const char* name) {
  const std::optional<wrench> w = applied();
  if (!w) return;
  const double force = glm::length(w->force);
  const double torque = glm::length(w->torque);
  if (!may_put_out(state_)) {
    found_.look("output.zero_unless_armed", force == 0.0 && torque == 0.0, [&] {
      return newton(force, "N") + " and " + newton(torque, "N m") + " are put out in " + to_string(state_) + " after " +
             name + "()";
    });
  }
  if (!opened_once_) return;
  const bool within = force <= capabilities_.peak_force_n * (1.0 + rounding) &&
                      torque <= capabilities_.peak_torque_n_m * (1.0 + rounding);
  found_.look("output.within_limits", within, [&] {
    return newton(force, "N") + " and " + newton(torque, "N m") + " are put out; the peak limits are " +
           newton(capabilities_.peak_force_n, "N") + " and " + newton(capabilities_.peak_torque_n_m, "N m");
  });
}

void subject::look_at_capabilities() {
  if (handle_ == nullptr || !opened_once_) return;
  auto c = abi::blank<asperity_capabilities>();
  const std::int32_t code =
      set_up_call("capabilities", [&](char*, std::uint32_t) { return t_.capabilities(handle_, &c); });
  found_.look("capabilities.constant", code == ASPERITY_OK && same_bytes(c, capabilities_), [&] {
    return code != ASPERITY_OK
               ? std::string("capabilities() fails after open()")
               : "they differ from what was said after open(), in the state " + std::string(to_string(state_));
  });
}

void subject::look_at_sample(std::int64_t now_ns, const asperity_sample& s) {
  const bool finite = all_finite(s.position_d_m) && all_finite(s.rotation_dh_xyzw) &&
                      all_finite(s.linear_velocity_d_m_per_s) && all_finite(s.angular_velocity_d_rad_per_s) &&
                      std::isfinite(s.gripper_m);
  found_.look("samples.finite", finite, [] { return "a sample has a NaN or an infinity in it"; });
  if (finite) {
    const auto& q = s.rotation_dh_xyzw;
    const double n2 = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    found_.look("samples.unit_quaternion", std::fabs(n2 - 1.0) <= 2e-6,
                [&] { return "the quaternion's squared length is " + std::to_string(n2); });
  }
  const bool position = (capabilities_.sensed & ASPERITY_AXES_TRANSLATION) != 0;
  const bool rotation = (capabilities_.sensed & ASPERITY_AXES_ROTATION) != 0;
  found_.look(
      "samples.validity",
      ((s.valid & ASPERITY_VALID_POSITION) != 0) == position &&
          ((s.valid & ASPERITY_VALID_ROTATION) != 0) == rotation &&
          ((s.valid & ASPERITY_VALID_GRIPPER) == 0 || capabilities_.gripper_high_m > capabilities_.gripper_low_m) &&
          (s.valid & ~0x3fU) == 0,
      [&] { return "valid is " + std::to_string(s.valid) + ", sensed is " + std::to_string(capabilities_.sensed); });
  if (finite && position) {
    for (int i = 0; i < 3; ++i) {
      if ((capabilities_.sensed >> i & 1U) == 0) continue;
      const double low = capabilities_.workspace_low_d_m[i];
      const double high = capabilities_.workspace_high_d_m[i];
      const double room = 0.25 * (high - low) + 0.001;
      const double x = s.position_d_m[i];
      found_.look("units.positions", x >= low - room && x <= high + room, [&] {
        return "the handle is at " + std::to_string(x) + " m, in a workspace from " + std::to_string(low) + " to " +
               std::to_string(high) + " m" + (std::fabs(x) > 10.0 * (high - low) ? "; are these millimetres?" : "");
      });
    }
  }
  found_.look("samples.host_time", s.host_time_ns <= now_ns, [] { return "a sample was received in the future"; });
  if (capabilities_.worst_latency_ns > 0 && capabilities_.minimum_rate_hz > 0.0) {
    const auto periods = static_cast<std::int64_t>(2e9 / capabilities_.minimum_rate_hz);
    const std::int64_t age = now_ns - s.host_time_ns;
    found_.look("timing.age", age <= capabilities_.worst_latency_ns + periods,
                [&] { return "a sample is " + std::to_string(age) + " ns old"; });
  }
  if (has_sample_) {
    found_.look("samples.host_time", s.host_time_ns >= newest_.host_time_ns,
                [] { return "the host time of a sample is before that of the one before"; });
    found_.look("samples.device_time", s.device_time_ns >= newest_.device_time_ns,
                [] { return "the device time of a sample is before that of the one before"; });
    found_.look("samples.sequence", s.sequence >= newest_.sequence,
                [] { return "the sequence number of a sample is below that of the one before"; });
    if (s.sequence == newest_.sequence) {
      found_.look("samples.same_sequence_same_sample", same_bytes(s, newest_),
                  [&] { return "sequence number " + std::to_string(s.sequence) + " came with two samples"; });
    } else if (s.device_time_ns != 0) {
      found_.look("samples.new_is_new", s.device_time_ns > newest_.device_time_ns, [&] {
        return "sequence number " + std::to_string(s.sequence) + " was measured at the same device time as " +
               std::to_string(newest_.sequence);
      });
    }
  }
  newest_ = s;
  has_sample_ = true;
}

bool subject::provoke_a_fault() {
  if (!reach(device_state::armed)) return false;
  if (may_push) static_cast<void>(tick(small_wrench()));
  if (provoke(ASPERITY_PROVOKE_WRITE_FAILURE) == ASPERITY_OK) {
    for (int i = 0; i < 5 && state_ != device_state::fault; ++i) static_cast<void>(tick({}));
    if (state_ == device_state::fault) return true;
  }
  if (reach(device_state::armed) && provoke(ASPERITY_PROVOKE_DEPARTURE) == ASPERITY_OK) {
    for (int i = 0; i < 5 && state_ != device_state::fault; ++i) static_cast<void>(tick({}));
    static_cast<void>(provoke(ASPERITY_PROVOKE_RETURN));
    if (state_ == device_state::fault) return true;
  }
  if (may_push && reach(device_state::armed)) {
    wrench bad;
    bad.force.x = std::nan("");
    static_cast<void>(tick(bad));
  }
  return state_ == device_state::fault;
}

bool subject::reach(device_state wanted) {
  if (handle_ == nullptr && !make_anew()) return false;
  if (state_ == wanted) return true;
  switch (wanted) {
    case device_state::present:
      return make_anew() && (state_ == device_state::present || state_ == device_state::absent);
    case device_state::closed:
      if (state_ == device_state::fault) static_cast<void>(clear_fault());
      if (state_ == device_state::present || state_ == device_state::absent) static_cast<void>(open());
      close();
      return state_ == device_state::closed;
    case device_state::ready:
      if (may_put_out(state_)) static_cast<void>(disarm());
      if (state_ == device_state::fault) static_cast<void>(clear_fault());
      if (state_ != device_state::ready) static_cast<void>(open());
      // A device that is stuck may still be had anew.
      if (state_ != device_state::ready && make_anew()) static_cast<void>(open());
      if (state_ == device_state::ready) static_cast<void>(tick({}));
      return state_ == device_state::ready;
    case device_state::armed:
      if (state_ == device_state::active) {
        static_cast<void>(tick({}));
      } else if (reach(device_state::ready)) {
        static_cast<void>(arm());
      }
      return state_ == device_state::armed;
    case device_state::active:
      if (!may_push || !reach(device_state::armed)) return false;
      static_cast<void>(tick(small_wrench()));
      return state_ == device_state::active;
    case device_state::fault:
      return provoke_a_fault();
    case device_state::absent:
    case device_state::open:
      break;
  }
  return false;
}

}  // namespace asperity::conformance
