#include <array>
#include <cstdint>
#include <gtest/gtest.h>
#include <limits>
#include <vector>

#include <asperity/device/device_state.hpp>
#include <asperity/device/simulated/simulated_device.hpp>

namespace {

using namespace asperity;
using S = device_state;
using E = device_event;

constexpr std::optional<S> no = std::nullopt;

// The whole table, written a second time by hand. Rows: states. Columns: arrived, departed, opened, prepared, armed,
// engaged, released, disarmed, failed, cleared, closed.
constexpr std::array<std::array<std::optional<S>, device_event_count>, device_state_count> expected{{
    /* absent  */ {S::present, no, no, no, no, no, no, no, no, no, no},
    /* present */ {no, S::absent, S::open, no, no, no, no, no, no, no, no},
    /* open    */ {no, S::absent, no, S::ready, no, no, no, no, S::fault, no, S::closed},
    /* ready   */ {no, S::absent, no, no, S::armed, no, no, S::ready, S::fault, no, S::closed},
    /* armed   */ {no, S::fault, no, no, no, S::active, no, S::ready, S::fault, no, S::closed},
    /* active  */ {no, S::fault, no, no, no, no, S::armed, S::ready, S::fault, no, S::closed},
    /* fault   */ {no, no, no, no, no, no, no, no, no, S::closed, no},
    /* closed  */ {S::present, S::absent, no, no, no, no, no, no, no, no, no},
}};

template <class F>
void for_every_cell(F&& f) {
  for (int s = 0; s < device_state_count; ++s) {
    for (int e = 0; e < device_event_count; ++e) f(static_cast<S>(s), static_cast<E>(e));
  }
}

TEST(device_state, every_state_times_every_event) {
  int cells = 0;
  for_every_cell([&](S s, E e) {
    EXPECT_EQ(next_state(s, e), expected[static_cast<std::size_t>(s)][static_cast<std::size_t>(e)])
        << to_string(s) << " event " << static_cast<int>(e);
    ++cells;
  });
  EXPECT_EQ(cells, 88);
}

TEST(device_state, arming_is_the_only_way_to_output_and_ready_its_only_beginning) {
  int ways = 0;
  for_every_cell([&](S s, E e) {
    const auto next = next_state(s, e);
    if (!next || !may_put_out(*next) || may_put_out(s)) return;
    ++ways;
    EXPECT_EQ(e, E::armed);
    EXPECT_EQ(s, S::ready);
  });
  EXPECT_EQ(ways, 1);
}

TEST(device_state, only_cleared_leaves_a_fault) {
  int ways = 0;
  for_every_cell([&](S s, E e) {
    if (s == S::fault && next_state(s, e)) {
      EXPECT_EQ(e, E::cleared);
      ++ways;
    }
  });
  EXPECT_EQ(ways, 1);
}

// From any state, any sequence of events without `armed` never reaches output: a walk over the whole graph.
TEST(device_state, nothing_arms_by_itself) {
  std::array<bool, device_state_count> reached{};
  for (const S start : {S::absent, S::present, S::open, S::ready, S::fault, S::closed}) {
    reached[static_cast<std::size_t>(start)] = true;
  }
  for (int pass = 0; pass < device_state_count; ++pass) {
    for_every_cell([&](S s, E e) {
      if (e == E::armed || !reached[static_cast<std::size_t>(s)]) return;
      if (const auto next = next_state(s, e)) reached[static_cast<std::size_t>(*next)] = true;
    });
  }
  EXPECT_FALSE(reached[static_cast<std::size_t>(S::armed)]);
  EXPECT_FALSE(reached[static_cast<std::size_t>(S::active)]);
}

TEST(device_state, a_refused_event_changes_nothing) {
  device_state_machine m(S::ready);
  EXPECT_FALSE(m.apply(E::cleared));
  EXPECT_EQ(m.state(), S::ready);
  EXPECT_TRUE(m.apply(E::armed));
  EXPECT_EQ(m.state(), S::armed);
}

static_assert(next_state(S::ready, E::armed) == S::armed);  // the table is there at compile time

// Breadth first from a fault that was met while active: what a person has to do before anything is put out again.
TEST(device_state, the_shortest_way_from_a_fault_to_output_is_cleared_opened_prepared_armed) {
  struct place {
    S state;
    std::vector<E> way;
  };
  std::vector<place> open{{*next_state(S::active, E::failed), {}}};
  std::array<bool, device_state_count> seen{};
  std::vector<E> shortest;
  for (std::size_t i = 0; i < open.size() && shortest.empty(); ++i) {
    const place at = open[i];
    if (may_put_out(at.state)) shortest = at.way;
    if (seen[static_cast<std::size_t>(at.state)]) continue;
    seen[static_cast<std::size_t>(at.state)] = true;
    for (int e = 0; e < device_event_count; ++e) {
      if (const auto next = next_state(at.state, static_cast<E>(e))) {
        open.push_back({*next, at.way});
        open.back().way.push_back(static_cast<E>(e));
      }
    }
  }
  EXPECT_EQ(shortest, (std::vector<E>{E::cleared, E::arrived, E::opened, E::prepared, E::armed}));
}

// And no way at all without each of them: one event taken out of the table, output is out of reach.
TEST(device_state, no_way_from_a_fault_to_output_leaves_one_of_them_out) {
  for (const E missing : {E::cleared, E::opened, E::prepared, E::armed}) {
    std::array<bool, device_state_count> reached{};
    reached[static_cast<std::size_t>(S::fault)] = true;
    for (int pass = 0; pass < device_state_count; ++pass) {
      for_every_cell([&](S s, E e) {
        if (e == missing || !reached[static_cast<std::size_t>(s)]) return;
        if (const auto next = next_state(s, e)) reached[static_cast<std::size_t>(*next)] = true;
      });
    }
    EXPECT_FALSE(reached[static_cast<std::size_t>(S::armed)] || reached[static_cast<std::size_t>(S::active)])
        << static_cast<int>(missing);
  }
}

// Whoever becomes ready has lost what arming there was: every entry into ready is followed by `armed` before output.
TEST(device_state, every_ready_needs_an_arming_of_its_own) {
  int entries = 0, ways = 0;
  for_every_cell([&](S s, E e) {
    if (next_state(s, e) == S::ready) {
      ++entries;
      for (int f = 0; f < device_event_count; ++f) {
        const auto after = next_state(S::ready, static_cast<E>(f));
        EXPECT_TRUE(!after || !may_put_out(*after) || static_cast<E>(f) == E::armed);
        ways += after && may_put_out(*after) ? 1 : 0;
      }
    }
  });
  EXPECT_EQ(entries, 4);  // from open, ready, armed and active
  EXPECT_EQ(ways, entries);
}

// The operations of a device instead of events of a table: every sequence of five of them, on the device itself.
enum class act { open, arm, clear, disarm, close, push, push_nan, leave, plug_in };
constexpr int acts = 9;

TEST(device_state, no_sequence_of_five_operations_arms_the_simulated_device_but_by_arming) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::uint64_t sequences = 0, armed = 0, faults = 0, moves = 0;
  // Depth first on copies: the device before an operation is kept for its siblings.
  const auto walk = [&](const auto& self, const simulated_device& from, int left, std::int64_t now) -> void {
    if (left == 0) {
      ++sequences;
      return;
    }
    for (int a = 0; a < acts; ++a) {
      simulated_device dev = from;
      device_sample in;
      const std::int64_t leaves_ns = 1'000'000'000;
      switch (static_cast<act>(a)) {
        case act::open:
          static_cast<void>(dev.open());
          break;
        case act::arm:
          static_cast<void>(dev.arm());
          break;
        case act::clear:
          static_cast<void>(dev.clear_fault());
          break;
        case act::disarm:
          static_cast<void>(dev.disarm());
          break;
        case act::close:
          dev.close();
          break;
        case act::push:
          static_cast<void>(dev.write(now, {{{1, 0, 0}, {}}, wrench_frame::device_base, now + 1, 1}));
          break;
        case act::push_nan:
          static_cast<void>(dev.write(now, {{{nan, 0, 0}, {}}, wrench_frame::device_base, now + 1, 1}));
          break;
        case act::leave:
          static_cast<void>(dev.read(leaves_ns, in));
          break;
        case act::plug_in:
          dev.plug_in();
          break;
      }
      const S before = from.state(), after = dev.state();
      moves += before != after ? 1U : 0U;
      if (may_put_out(after) && !may_put_out(before)) {
        ++armed;
        ASSERT_TRUE(static_cast<act>(a) == act::arm && before == S::ready);
      }
      if (before == S::fault && after != S::fault) {
        ASSERT_EQ(static_cast<act>(a), act::clear);
        ASSERT_EQ(after, S::closed);
      }
      faults += before != S::fault && after == S::fault ? 1U : 0U;
      if (!may_put_out(after)) {
        ASSERT_EQ(dev.put_out().force, vec3(0.0));
      }
      self(self, dev, left - 1, now);
      if (testing::Test::HasFatalFailure()) return;
    }
  };
  simulated_settings settings;
  settings.faults = {{device_fault::depart, 1'000'000'000, 1'000'000'001}};
  // A plant that nobody steps: the operations count, not the motion.
  settings.hand.tremor_m = 0.0;
  simulated_device fresh(settings);
  device_sample in;
  static_cast<void>(fresh.read(999'999'999, in));  // the plant's clock begins here
  walk(walk, fresh, 5, 999'999'999);
  EXPECT_EQ(sequences, 59049U);
  EXPECT_GT(armed, 100U);
  EXPECT_GT(faults, 100U);
  EXPECT_GT(moves, 1000U);
}

}  // namespace
