// The ring of rows between a session and its pages: whatever is read is whole, in order and counted.
#include "view/trace.hpp"

#include <atomic>
#include <chrono>
#include <gtest/gtest.h>
#include <memory>
#include <thread>
#include <vector>

#include "support/sanitizers.hpp"

namespace asperity::view {
namespace {

trace_row row_of(std::uint64_t number) {
  trace_row row;
  row.time_s = static_cast<double>(number);
  row.values.fill(static_cast<float>(number % 4096));
  return row;
}

/// Reads as a page does: from where it ended, at most so many. Counts what it was given and what it missed.
struct reading {
  std::uint64_t next = 0, given = 0, missed = 0, faults = 0;

  void from(const trace_ring& ring, std::size_t most) {
    std::vector<trace_row> rows;
    const std::uint64_t first = ring.read(next, most, rows);
    faults += first < next ? 1U : 0U;
    missed += first - next;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const trace_row expected = row_of(first + i);
      faults += rows[i].time_s != expected.time_s || rows[i].values != expected.values ? 1U : 0U;
    }
    given += rows.size();
    next = first + rows.size();
  }
};

TEST(trace_ring, tells_a_slow_reader_what_it_missed) {
  const auto ring = std::make_unique<trace_ring>();
  reading page;
  for (std::uint64_t i = 0; i < 100; ++i) ring->add(row_of(i));
  page.from(*ring, trace_ring::capacity);
  EXPECT_EQ(page.given, 100U);
  EXPECT_EQ(page.missed, 0U);
  const std::uint64_t end = 100 + 3 * trace_ring::capacity;
  for (std::uint64_t i = 100; i < end; ++i) ring->add(row_of(i));
  page.from(*ring, trace_ring::capacity);
  EXPECT_EQ(page.given + page.missed, end);
  EXPECT_GE(page.missed, 2 * trace_ring::capacity);
  EXPECT_LE(page.missed, 2 * trace_ring::capacity + 1);
  EXPECT_EQ(page.faults, 0U);
  page.from(*ring, trace_ring::capacity);
  EXPECT_EQ(page.next, end) << "nothing new";
  for (std::uint64_t i = end; i < end + 50; ++i) ring->add(row_of(i));
  page.from(*ring, 10);
  EXPECT_EQ(page.next, end + 50) << "of more than asked for the newest";
  EXPECT_EQ(page.faults, 0U);
}

TEST(trace_ring, hands_out_no_torn_row) {
  const auto ring = std::make_unique<trace_ring>();
  constexpr std::uint64_t rows = ASPERITY_THREAD_SANITIZER ? 200'000 : 2'000'000;
  std::atomic<bool> over{false};
  std::vector<reading> pages(3);
  std::vector<std::thread> readers;
  for (std::size_t p = 0; p < pages.size(); ++p) {
    readers.emplace_back([&, p] {
      // One keeps up, one asks for the whole ring, whose oldest rows are being overwritten, one naps.
      while (!over) {
        pages[p].from(*ring, p == 0 ? 256 : trace_ring::capacity);
        if (p == 2) std::this_thread::sleep_for(std::chrono::milliseconds(3));
      }
      pages[p].from(*ring, trace_ring::capacity);
    });
  }
  for (std::uint64_t i = 0; i < rows; ++i) ring->add(row_of(i));
  over = true;
  for (std::thread& t : readers) t.join();
  std::uint64_t missed = 0;
  for (const reading& page : pages) {
    EXPECT_EQ(page.faults, 0U);
    EXPECT_EQ(page.given + page.missed, rows);
    EXPECT_GT(page.given, 0U);
    missed += page.missed;
  }
  EXPECT_GT(missed, 0U) << "the control: nobody was overtaken";
}

}  // namespace
}  // namespace asperity::view
