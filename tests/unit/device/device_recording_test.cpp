#include <algorithm>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <asperity/control/virtual_session.hpp>
#include <asperity/device/device_recording.hpp>
#include <asperity/device/simulated/simulated_device.hpp>

#include "device/recording_bytes.hpp"
#include "unit/control/analytic_wall.hpp"

namespace {

using namespace asperity;
using test_support::analytic_wall;

constexpr std::int64_t ms = 1'000'000;

struct keep_all {
  std::vector<wrench>* to;
  void operator()(const session_record& r) noexcept { to->push_back(r.on_hand_d); }
};

simulated_settings hand_with_faults() {
  simulated_settings c;
  c.motion = {.T_dh = {quat(1, 0, 0, 0), {0, 0, 0.005}}, .depth_m = 0.015, .approach_s = 0.2};
  c.measurement = {.delay_ns = 2 * ms, .jitter_ns = 1 * ms, .loss = 0.2};
  c.faults = {{device_fault::nan_pose, 400 * ms, 403 * ms}, {device_fault::refuse_write, 600 * ms, 610 * ms}};
  return c;
}

// A whole session through the loop: opened, armed, 700 ticks, a NaN, a refused write, closed.
template <class Device>
std::vector<wrench> play(Device& dev, double stiffness_n_per_m = 2000.0) {
  std::vector<wrench> sent;
  EXPECT_TRUE(dev.open() && dev.arm());
  {
    analytic_wall wall;
    wall.stiffness_n_per_m = stiffness_n_per_m;
    virtual_session<analytic_wall, Device, keep_all> session(wall, {{pose{}}, vec3(0.0)}, dev, {}, {}, keep_all{&sent});
    static_cast<void>(session.run_until(700 * ms));
    EXPECT_EQ(session.device().gate().fault(), gate_fault::device_failed);
  }
  dev.close();
  return sent;
}

device_recording record(std::vector<wrench>* sent = nullptr) {
  simulated_device dev(hand_with_faults());
  call_ring ring(4096);
  recorded_device recorded(dev, ring);
  device_recording out{std::string(dev.capabilities().name), dev.capabilities(), dev.state(), {}};
  std::vector<wrench> reported = play(recorded);
  if (sent != nullptr) *sent = std::move(reported);
  for (call_record c; ring.pop(c);) out.calls.push_back(c);
  EXPECT_EQ(ring.lost(), 0U);
  return out;
}

bool same_bits(const std::vector<wrench>& a, const std::vector<wrench>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!asperity::same_bits({.on_hand = a[i]}, {.on_hand = b[i]})) return false;
  }
  return true;
}

TEST(device_recording, replays_a_session_to_the_bit) {
  std::vector<wrench> then;
  const device_recording recording = record(&then);
  const std::string bytes = encode(recording);
  const result<device_recording> read = decode(bytes);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(encode(*read), bytes);  // NaN poses included

  replay_device again(*read);
  EXPECT_EQ(again.capabilities().name, "simulated");
  EXPECT_EQ(again.capabilities().peak_force_n, simulated_capabilities().peak_force_n);
  EXPECT_TRUE(same_bits(play(again), then));
  EXPECT_EQ(again.differences(), 0U);
  EXPECT_TRUE(again.finished());
  EXPECT_EQ(again.state(), device_state::closed);
  ASSERT_GT(then.size(), 600U);
  EXPECT_GT(glm::length(then[350].force), 0.5);
}

// A device with a gripper writes a format of its own; one without, and every recording from before, is as ever.
TEST(device_recording, keeps_a_gripper_and_no_other_byte) {
  EXPECT_EQ(encode(record()).substr(0, 8), "ASPDEVR2");
  simulated_settings c = hand_with_faults();
  c.capabilities.gripper_low_m = 0.01;
  c.capabilities.gripper_high_m = 0.05;
  simulated_device dev(c);
  call_ring ring(4096);
  recorded_device recorded(dev, ring);
  device_recording out{std::string(dev.capabilities().name), dev.capabilities(), dev.state(), {}};
  const std::vector<wrench> then = play(recorded);
  for (call_record r; ring.pop(r);) out.calls.push_back(r);
  const std::string bytes = encode(out);
  EXPECT_EQ(bytes.substr(0, 8), "ASPDEVR3");
  const result<device_recording> read = decode(bytes);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(encode(*read), bytes);
  replay_device again(*read);
  EXPECT_EQ(again.capabilities().gripper_high_m, 0.05);
  double widest = 0.0;
  for (const call_record& r : read->calls) {
    if (r.call == device_call::read && r.answered == status::ok) widest = std::max(widest, r.sample.gripper_m);
  }
  EXPECT_GT(widest, 0.03);  // after 0.7 s of two
  EXPECT_LE(widest, 0.05);
  EXPECT_TRUE(same_bits(play(again), then));
  EXPECT_EQ(again.differences(), 0U);
  // What the hand does beside is felt as without a gripper.
  std::vector<wrench> without;
  static_cast<void>(record(&without));
  EXPECT_TRUE(same_bits(then, without));
}

void expect_every_damage_refused(const std::string& bytes) {
  for (std::size_t n = 0; n < bytes.size(); ++n) ASSERT_FALSE(decode(bytes.substr(0, n))) << n;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    std::string wrong = bytes;
    wrong[i] = static_cast<char>(wrong[i] ^ 0x10);
    ASSERT_FALSE(decode(wrong)) << i;
  }
}

TEST(device_recording, of_a_gripper_refuses_every_cut_and_every_flipped_byte) {
  device_recording r = record();
  r.calls.resize(20);
  r.capabilities.gripper_high_m = 0.05;
  const std::string bytes = encode(r);
  ASSERT_TRUE(decode(bytes));
  expect_every_damage_refused(bytes);
}

TEST(device_recording, tells_a_session_of_its_gripper) {
  struct watch {
    session_record last;
    void operator()(const session_record& seen) noexcept { last = seen; }
  };
  for (const bool has_one : {false, true}) {
    simulated_settings c;
    if (has_one) c.capabilities.gripper_high_m = 0.04;
    simulated_device dev(c);
    ASSERT_TRUE(dev.open() && dev.arm());
    virtual_session<analytic_wall, simulated_device, watch> session({}, {{pose{}}, vec3(0.0)}, dev, {});
    static_cast<void>(session.run_until(1001 * ms));
    const session_record& last = session.device().observer().last;
    EXPECT_EQ(last.gripper_told, has_one);
    EXPECT_NEAR(last.gripper_m, has_one ? 0.04 : 0.0, 1e-6);
  }
}

TEST(device_recording, notices_another_session) {
  replay_device other(record());
  static_cast<void>(play(other, 2001.0));  // a slightly harder wall
  EXPECT_GT(other.differences(), 0U);
  EXPECT_GT(other.first_difference(), 100U);  // not before the wall is touched

  replay_device wrong_turn(record());
  EXPECT_FALSE(wrong_turn.arm());
  device_sample in;
  EXPECT_EQ(wrong_turn.read(0, in), status::backend_failed);
  EXPECT_EQ(wrong_turn.state(), device_state::absent);
}

TEST(device_recording, a_full_ring_counts_what_it_loses_and_keeps_the_order) {
  call_ring ring(8);
  for (int i = 0; i < 20; ++i) ring.push({.call = device_call::read, .now_ns = i});
  EXPECT_EQ(ring.lost(), 12U);
  call_record c;
  for (int i = 0; i < 8; ++i) {
    ASSERT_TRUE(ring.pop(c));
    EXPECT_EQ(c.now_ns, i);
  }
  EXPECT_FALSE(ring.pop(c));
}

TEST(device_recording, refuses_every_cut_and_every_flipped_byte) {
  device_recording shorter = record();
  shorter.calls.resize(40);
  const std::string bytes = encode(shorter);
  ASSERT_TRUE(decode(bytes));
  expect_every_damage_refused(bytes);
  EXPECT_FALSE(decode(bytes + '\0'));
}

std::string with_sum(std::string bytes) {
  std::uint64_t sum = recording_detail::first_sum;
  for (const char b : bytes) sum = recording_detail::add_to_sum(sum, b);
  recording_detail::byte_writer w;
  w.number(sum);
  return bytes + w.take();
}

// As after a kill: the bytes end anywhere. The calls up to the last whole block are there, and no others.
TEST(device_recording, cut_anywhere_gives_its_whole_blocks) {
  device_recording whole = record();
  ASSERT_GT(whole.calls.size(), 900U);
  whole.calls.resize(900);
  recording_encoder e;
  device_capabilities c = whole.capabilities;
  c.name = whole.name;
  std::string bytes = e.begin(c, whole.before);
  std::vector<std::size_t> ends;  // of the first blocks of 256 calls
  for (std::size_t i = 0; i < whole.calls.size(); ++i) {
    bytes += e.call(whole.calls[i]);
    if ((i + 1) % 256 == 0) ends.push_back(bytes.size());
  }
  bytes += e.end(recorded_end::interrupted, 100);

  std::vector<std::size_t> cuts;
  for (const std::size_t end : ends) {
    for (std::size_t n = end - 20; n < end + 3; ++n) cuts.push_back(n);
  }
  for (std::size_t n = bytes.size() - 30; n < bytes.size(); ++n) cuts.push_back(n);
  std::mt19937_64 random(11);
  for (int i = 0; i < 60; ++i) cuts.push_back(random() % bytes.size());
  for (const std::size_t n : cuts) {
    const auto blocks =
        static_cast<std::size_t>(std::count_if(ends.begin(), ends.end(), [n](std::size_t end) { return end <= n; }));
    const result<device_recording> read = decode(bytes.substr(0, n));
    ASSERT_EQ(static_cast<bool>(read), blocks > 0) << n;
    if (!read) continue;
    EXPECT_TRUE(read->cut);
    EXPECT_EQ(read->end, recorded_end::not_reported);
    EXPECT_EQ(read->writes_before_end, 0U);
    ASSERT_EQ(read->calls.size(), 256 * blocks) << n;
    const std::string again = encode(*read);  // the same calls, and an end of their own
    EXPECT_TRUE(again.compare(0, ends[blocks - 1], bytes, 0, ends[blocks - 1]) == 0) << n;
  }
  const result<device_recording> all = decode(bytes);
  ASSERT_TRUE(all) << all.error().message;
  EXPECT_FALSE(all->cut);
  EXPECT_EQ(all->calls.size(), whole.calls.size());

  // A wrong byte in a whole block is no cut.
  for (int i = 0; i < 60; ++i) {
    std::string wrong = bytes.substr(0, ends[2] + random() % 200);
    const std::size_t at = random() % ends[2];
    wrong[at] = static_cast<char>(wrong[at] ^ (1 << random() % 8));
    ASSERT_FALSE(decode(wrong)) << at;
  }
}

TEST(device_recording, reads_the_first_format_too) {
  device_recording shorter = record();
  shorter.calls.resize(600);
  const std::string bytes = encode(shorter);
  // The same without the marks, which the first format did not have.
  std::string first;
  recording_encoder e;
  device_capabilities c = shorter.capabilities;
  c.name = shorter.name;
  first += e.begin(c, shorter.before);
  first[7] = '1';
  for (std::size_t i = 0; i < shorter.calls.size(); ++i) {
    std::string call = e.call(shorter.calls[i]);
    if ((i + 1) % 256 == 0) call.resize(call.size() - 17);
    first += call;
  }
  std::string end = e.end();
  end.resize(end.size() - 8);
  const result<device_recording> read = decode(with_sum(first + end));
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_TRUE(encode(*read) == bytes);
  EXPECT_FALSE(decode(first));
  std::string mixed = bytes;
  mixed[7] = '1';
  EXPECT_FALSE(decode(mixed));
}

TEST(device_recording, reports_where_the_session_was_told_to_end) {
  device_recording reported = record();
  reported.calls.resize(40);
  const auto writes = std::count_if(reported.calls.begin(), reported.calls.end(),
                                    [](const call_record& c) { return c.call == device_call::write; });
  reported.end = recorded_end::interrupted;
  reported.writes_before_end = static_cast<std::uint64_t>(writes);
  const result<device_recording> read = decode(encode(reported));
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->end, recorded_end::interrupted);
  EXPECT_EQ(read->writes_before_end, reported.writes_before_end);

  ++reported.writes_before_end;  // more than there are
  EXPECT_FALSE(decode(encode(reported)));
  reported.writes_before_end = 1;
  reported.end = recorded_end::not_reported;  // and yet some
  EXPECT_FALSE(decode(encode(reported)));
  reported.end = static_cast<recorded_end>(recorded_end_count);
  EXPECT_FALSE(decode(encode(reported)));
}

// With the check sum mended, so that what is behind it is reached.
TEST(device_recording, hostile_bytes_end_in_an_error_or_in_a_recording) {
  device_recording shorter = record();
  shorter.calls.resize(40);
  const std::string bytes = encode(shorter);
  std::mt19937_64 bits(3);
  int refused = 0;
  for (int i = 0; i < 3000; ++i) {
    std::string wrong = bytes.substr(0, bytes.size() - 8);
    for (std::uint64_t n = 1 + bits() % 3; n > 0; --n) wrong[bits() % wrong.size()] = static_cast<char>(bits());
    std::uint64_t sum = recording_detail::first_sum;
    for (const char b : wrong) sum = recording_detail::add_to_sum(sum, b);
    recording_detail::byte_writer w;
    w.number(sum);
    const result<device_recording> read = decode(wrong + w.take());
    if (!read) {
      ++refused;
      continue;
    }
    EXPECT_LE(read->calls.size(), bytes.size());
    EXPECT_LE(encode(*read).size(), bytes.size() + 200);
    for (const call_record& c : read->calls) EXPECT_STRNE(to_string(c.after), "unknown state");
  }
  EXPECT_GT(refused, 100);
}

TEST(device_recording, is_not_read_on_where_nobody_wants_it) {
  recording_encoder e;
  std::string bytes = e.begin({}, device_state::present);
  for (int i = 0; i < 200'000; ++i) bytes += e.call({.call = device_call::open});
  bytes += e.end();
  int asked = 0;
  ASSERT_TRUE(decode(bytes, [&] { return ++asked > 0; }));
  EXPECT_GE(asked, 4);  // once in 65,536 calls; the check sum goes along with them
  for (const int stop_at : {1, 3, asked - 1}) {
    int again = 0;
    const auto ended = decode(bytes, [&] { return ++again < stop_at; });
    ASSERT_FALSE(ended);
    EXPECT_EQ(ended.error().code, error_code::cancelled);
  }
}

TEST(device_recording, reads_files_and_says_what_is_wrong_with_them) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir());
  EXPECT_FALSE(load_device_recording(folder / "there_is_no_such_recording"));
  EXPECT_FALSE(load_device_recording(folder));
  const std::filesystem::path file = folder / "asperity_device_recording_test";
  const std::string bytes = encode(record());
  std::ofstream(file, std::ios::binary) << bytes;
  const result<device_recording> read = load_device_recording(file);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(encode(*read), bytes);
  std::filesystem::remove(file);
}

}  // namespace
