// The device concept accepts the least that keeps its contract, and rejects what only looks like it.

#include <asperity/device/any_device.hpp>

namespace {

using namespace asperity;

// One part of the contract per base, so that a near miss is the archetype with a single part exchanged.
struct good_tag {
  using policy_tag = device_tag;
};
struct no_tag {};
struct wrong_tag {
  struct policy_tag {};
};

struct good_life {
  [[nodiscard]] const device_capabilities& capabilities() const noexcept { return capabilities_; }
  [[nodiscard]] device_state state() const noexcept { return device_state::closed; }
  result<void> open() { return {}; }
  result<void> arm() { return {}; }
  result<void> clear_fault() { return {}; }
  status disarm() noexcept { return status::ok; }
  void close() noexcept {}

 private:
  device_capabilities capabilities_{};
};
struct disarm_may_throw : good_life {
  status disarm() { return status::ok; }
};
struct open_says_nothing : good_life {
  void open() {}
};
struct cannot_clear_a_fault : good_life {
  result<void> clear_fault() = delete;
};

struct good_tick {
  status read(std::int64_t, device_sample&) noexcept { return status::ok; }
  status write(std::int64_t, const device_command&) noexcept { return status::ok; }
};
struct read_may_throw {
  status read(std::int64_t, device_sample&) { return status::ok; }
  status write(std::int64_t, const device_command&) noexcept { return status::ok; }
};
struct write_answers_bool {
  status read(std::int64_t, device_sample&) noexcept { return status::ok; }
  bool write(std::int64_t, const device_command&) noexcept { return true; }
};
struct read_takes_no_time {
  status read(device_sample&) noexcept { return status::ok; }
  status write(std::int64_t, const device_command&) noexcept { return status::ok; }
};

template <class Tag, class Life, class Tick>
struct device : Tag, Life, Tick {};

static_assert(haptic_device<device<good_tag, good_life, good_tick>>);
static_assert(!haptic_device<device<no_tag, good_life, good_tick>>);
static_assert(!haptic_device<device<wrong_tag, good_life, good_tick>>);
static_assert(!haptic_device<device<good_tag, disarm_may_throw, good_tick>>);
static_assert(!haptic_device<device<good_tag, open_says_nothing, good_tick>>);
static_assert(!haptic_device<device<good_tag, cannot_clear_a_fault, good_tick>>);
static_assert(!haptic_device<device<good_tag, good_life, read_may_throw>>);
static_assert(!haptic_device<device<good_tag, good_life, write_answers_bool>>);
static_assert(!haptic_device<device<good_tag, good_life, read_takes_no_time>>);

// Erasure keeps the contract, takes any device and nothing else, and does not wrap itself.
static_assert(haptic_device<any_device>);
static_assert(std::constructible_from<any_device, device<good_tag, good_life, good_tick>>);
static_assert(!std::constructible_from<any_device, device<no_tag, good_life, good_tick>>);
static_assert(!std::constructible_from<any_device, device<good_tag, good_life, read_may_throw>>);
static_assert(!std::copy_constructible<any_device>);

}  // namespace
