// The twin of a serial line: every fault of a script, both ways.
#include "asperity/transport/virtual/virtual_bytes.hpp"

#include <array>
#include <bit>
#include <cstdint>
#include <gtest/gtest.h>
#include <random>
#include <string>
#include <string_view>

#include "support/counted_news.hpp"

namespace asperity::virtual_bytes_test {
namespace {

struct line_pair {
  explicit line_pair(link_direction direction, link_script script, std::size_t queue_bytes = 4096)
      : way(direction), line(std::move(script), queue_bytes) {}

  [[nodiscard]] io_status write(std::int64_t t, std::string_view text, std::size_t& done) {
    byte_link& from = way == link_direction::to_device ? line.host() : line.device();
    return from.write(t, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, done);
  }
  void put(std::int64_t t, std::string_view text) {
    std::size_t done = 0;
    EXPECT_EQ(write(t, text, done), io_status::ok);
    EXPECT_EQ(done, text.size());
  }
  [[nodiscard]] std::string got(std::int64_t t) {
    byte_link& to = way == link_direction::to_device ? line.device() : line.host();
    std::string all;
    std::array<std::uint8_t, 3> bytes{};
    std::size_t done = 0;
    while (to.read(t, bytes, done) == io_status::ok) {
      all.append(reinterpret_cast<const char*>(bytes.data()), done);
    }
    return all;
  }

  link_direction way;
  virtual_bytes line;
};

class virtual_bytes_faults : public testing::TestWithParam<link_direction> {
 protected:
  [[nodiscard]] line_pair make(link_event e) const {
    e.direction = GetParam();
    return line_pair(GetParam(), {.events = {e}});
  }
};

TEST_P(virtual_bytes_faults, lose_shorten_duplicate_meet_one_write) {
  line_pair lose = make({.kind = link_fault::lose, .from_ns = 1, .until_ns = 2});
  lose.put(0, "ab");
  lose.put(1, "cd");
  lose.put(2, "ef");
  EXPECT_EQ(lose.got(2), "abef");
  line_pair shorten = make({.kind = link_fault::shorten, .from_ns = 1, .until_ns = 2});
  shorten.put(0, "ab");
  shorten.put(1, "cd");
  shorten.put(2, "ef");
  EXPECT_EQ(shorten.got(2), "abcef");
  line_pair twice = make({.kind = link_fault::duplicate, .from_ns = 1, .until_ns = 2});
  twice.put(0, "ab");
  twice.put(1, "cd");
  twice.put(2, "ef");
  EXPECT_EQ(twice.got(2), "abcdcdef");
}

TEST_P(virtual_bytes_faults, a_delay_holds_up_what_comes_after) {
  line_pair p = make({.kind = link_fault::delay, .from_ns = 1, .until_ns = 2, .amount_ns = 10});
  p.put(0, "ab");
  p.put(1, "cd");
  p.put(2, "ef");
  EXPECT_EQ(p.got(10), "ab");
  EXPECT_EQ(p.got(11), "cdef");
}

TEST_P(virtual_bytes_faults, reorder_swaps_writes) {
  line_pair p = make({.kind = link_fault::reorder});
  p.put(0, "ab");
  p.put(0, "cd");
  p.put(0, "ef");
  EXPECT_EQ(p.got(0), "cdab");
  p.put(1, "gh");
  EXPECT_EQ(p.got(1), "ghef");
}

TEST_P(virtual_bytes_faults, flip_bit_flips_exactly_one) {
  line_pair p = make({.kind = link_fault::flip_bit});
  for (int i = 0; i < 30; ++i) {
    p.put(i, "abcd");
    const std::string s = p.got(i);
    ASSERT_EQ(s.size(), 4U);
    int flipped = 0;
    for (std::size_t k = 0; k < 4; ++k) flipped += std::popcount(static_cast<std::uint8_t>(s[k] ^ "abcd"[k]));
    EXPECT_EQ(flipped, 1);
  }
}

TEST_P(virtual_bytes_faults, answers_and_unplugging_are_of_the_hosts_end) {
  const bool writing = GetParam() == link_direction::to_device;
  std::array<std::uint8_t, 4> bytes{};
  std::size_t done = 7;
  line_pair p = make(fail_call(0, io_status::failed));
  EXPECT_EQ(writing ? p.line.host().write(0, bytes, done) : p.line.host().read(0, bytes, done), io_status::failed);
  EXPECT_EQ(done, 0U);
  p.put(0, "ab");
  EXPECT_EQ(p.got(0), "ab");

  line_pair u = make({.kind = link_fault::unplug, .from_call = 1, .until_call = 2});
  for (int call = 0; call < 4; ++call) {
    const io_status s = writing ? u.line.host().write(0, bytes, done) : u.line.host().read(0, bytes, done);
    EXPECT_EQ(s == io_status::gone, call > 0) << call;
  }
  EXPECT_EQ(u.line.device().read(0, bytes, done), io_status::gone);
  EXPECT_EQ(u.line.device().write(0, bytes, done), io_status::gone);
}

INSTANTIATE_TEST_SUITE_P(both_ways, virtual_bytes_faults,
                         testing::Values(link_direction::to_device, link_direction::from_device), [](const auto& p) {
                           return p.param == link_direction::to_device ? "to_device" : "from_device";
                         });

TEST(virtual_bytes, a_full_line_takes_what_fits_and_then_nothing) {
  line_pair p(link_direction::to_device, {.latency_ns = 5}, 4);
  std::size_t done = 0;
  EXPECT_EQ(p.write(0, "abc", done), io_status::ok);
  EXPECT_EQ(p.write(0, "def", done), io_status::too_short);
  EXPECT_EQ(done, 1U);
  EXPECT_EQ(p.write(0, "g", done), io_status::busy);
  EXPECT_EQ(done, 0U);
  EXPECT_EQ(p.got(4), "");
  EXPECT_EQ(p.got(5), "abcd");
  line_pair back(link_direction::from_device, {}, 4);
  back.put(0, "abcdef");
  EXPECT_EQ(back.got(0), "abcd");
  EXPECT_EQ(back.line.lost(), 2U);
}

TEST(virtual_bytes, takes_no_memory_and_keeps_order_whatever_goes_wrong) {
  link_script script;
  for (const link_fault kind : {link_fault::lose, link_fault::delay, link_fault::shorten}) {
    script.events.push_back({.kind = kind, .share = 0.2, .amount_ns = 7});
  }
  line_pair p(link_direction::from_device, std::move(script));
  const std::size_t before = test_support::news_in_this_thread();
  std::array<std::uint8_t, 2> bytes{};
  std::array<std::uint8_t, 8> in{};
  std::size_t done = 0;
  std::size_t read = 0;
  int last = 0;
  for (int t = 0; t < 120; ++t) {
    bytes = {static_cast<std::uint8_t>(2 * t), static_cast<std::uint8_t>(2 * t + 1)};
    static_cast<void>(p.line.device().write(t, bytes, done));
    while (p.line.host().read(t, in, done) == io_status::ok) {
      for (std::size_t i = 0; i < done; ++i, ++read) {
        EXPECT_GE(in[i], last);
        last = in[i];
      }
    }
  }
  EXPECT_EQ(test_support::news_in_this_thread(), before);
  EXPECT_GT(read, 120U);
}

}  // namespace
}  // namespace asperity::virtual_bytes_test
