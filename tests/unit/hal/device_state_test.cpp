#include <array>
#include <gtest/gtest.h>

#include <asperity/hal/device_state.hpp>

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
  for_every_cell([](S s, E e) {
    const auto next = next_state(s, e);
    if (!next || !may_put_out(*next) || may_put_out(s)) return;
    EXPECT_EQ(e, E::armed);
    EXPECT_EQ(s, S::ready);
  });
}

TEST(device_state, only_cleared_leaves_a_fault) {
  for_every_cell([](S s, E e) {
    if (s == S::fault && next_state(s, e)) {
      EXPECT_EQ(e, E::cleared);
    }
  });
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

}  // namespace
