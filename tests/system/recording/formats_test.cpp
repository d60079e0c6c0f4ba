// Recordings in every format hold what the table holds, to the bit: read back by a reader of its own in Python.
#include <array>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <string>
#include <sys/wait.h>
#include <vector>

#include "recording.hpp"
#include "support/fresh_seed.hpp"
#include "unit/io/scratch_folder.hpp"

namespace {

using namespace asperity;
using namespace asperity::command;
using test_support::scratch_folder;

// The system's, which has the system's numpy; another one may come first in PATH.
std::string python() { return std::filesystem::exists("/usr/bin/python3") ? "/usr/bin/python3" : "python3"; }
bool has_python() { return std::system((python() + " -c pass > /dev/null 2>&1").c_str()) == 0; }

/// What the reader says, and whether it was content.
struct read_back {
  bool same = false;
  std::string said;
};
read_back read_with_python(const scratch_folder& folder, const std::string& arguments) {
  const std::string out = folder.file("said.txt").string();
  const int status = std::system(("cd '" + folder.path().string() + "' && " + python() + " '" ASPERITY_READER "' " +
                                  arguments + " > '" + out + "' 2>&1")
                                     .c_str());
  return {WIFEXITED(status) && WEXITSTATUS(status) == 0, test_support::read_all(out)};
}

void put_file(const scratch_folder& folder, const char* name, std::string_view bytes) {
  std::ofstream(folder.file(name), std::ios::binary) << bytes;
}

/// Rows of numbers of any size, with what is no number among them.
class drawn_rows {
 public:
  explicit drawn_rows(std::uint64_t seed) : bits_(seed) {}

  session_record next() {
    session_record r;
    time_ns_ += 1 + static_cast<std::int64_t>(bits_() % 3'000'000);
    if (bits_() % 500 == 0) time_ns_ += 1'999'999'999;
    r.time_ns = time_ns_;
    r.T_dh = {{number(), number(), number(), number()}, {number(), number(), number()}};
    r.T_wa = {{number(), number(), number(), number()}, {number(), number(), number()}};
    r.on_probe_w = {{number(), number(), number()}, {number(), number(), number()}};
    r.on_hand_d = {{number(), number(), number()}, {number(), number(), number()}};
    r.max_depth_m = number();
    r.contacts = static_cast<std::uint32_t>(bits_());
    r.contact_age_ns = static_cast<std::int64_t>(bits_() % 50'000'000);
    r.delivered_j = number();
    r.surplus_j = number();
    r.guard_alpha_per_s = number();
    r.guard_scale = number();
    r.sample = static_cast<sample_verdict>(bits_() % 7);
    r.device = static_cast<device_state>(bits_() % device_state_count);
    r.fault = static_cast<gate_fault>(bits_() % gate_fault_count);
    return r;
  }

 private:
  double number() {
    constexpr std::array<double, 6> odd{0.0,
                                        -0.0,
                                        std::numeric_limits<double>::quiet_NaN(),
                                        -std::numeric_limits<double>::infinity(),
                                        std::numeric_limits<double>::denorm_min(),
                                        std::numeric_limits<double>::max()};
    if (bits_() % 50 == 0) return odd[bits_() % odd.size()];
    return std::uniform_real_distribution<double>(-20.0, 20.0)(bits_);
  }

  std::mt19937_64 bits_;
  std::int64_t time_ns_ = -1;
};

void write_all(const scratch_folder& folder, const std::vector<session_record>& rows) {
  for (const char* const name : {"s.csv", "s.npz", "s.mcap"}) {
    result<recording> to = recording::create(folder.file(name));
    ASSERT_TRUE(to) << to.error().message;
    for (const session_record& r : rows) ASSERT_TRUE(to->add(r));
    const result<void> closed = to->close();
    ASSERT_TRUE(closed) << closed.error().message;
  }
}

TEST(recording_formats, hold_the_same_bits) {
  if (!has_python()) GTEST_SKIP() << "there is no python3 here";
  const std::uint64_t seed = test_support::fresh_seed("recording_formats", "recordings of 0, 1, 2, 150 and 1,200 rows");
  for (const int count : {0, 1, 2, 150, 1200}) {
    SCOPED_TRACE(count);
    const scratch_folder folder;
    drawn_rows draw(test_support::seed_of(seed, "recording_formats", static_cast<std::uint64_t>(count)));
    std::vector<session_record> rows;
    for (int i = 0; i < count; ++i) rows.push_back(draw.next());
    write_all(folder, rows);
    const read_back told = read_with_python(folder, "s.csv s.npz s.mcap");
    EXPECT_TRUE(told.same) << told.said;
  }
}

// A control: the reader does see one bit of each file that is another one.
TEST(recording_formats, a_changed_byte_is_seen) {
  if (!has_python()) GTEST_SKIP() << "there is no python3 here";
  const scratch_folder folder;
  drawn_rows draw(test_support::seed_of(test_support::fresh_seed("recording_formats.byte", "7 bytes"), "byte"));
  std::vector<session_record> rows;
  for (int i = 0; i < 20; ++i) rows.push_back(draw.next());
  write_all(folder, rows);
  const auto is_seen = [&](const char* name, std::string bytes, std::size_t at) {
    bytes[at] ^= 1;
    put_file(folder, name, bytes);
    const read_back told = read_with_python(folder, std::string("s.csv ") + name);
    EXPECT_FALSE(told.same) << name << ", byte " << at << ": " << told.said;
  };
  const std::string mcap = test_support::read_all(folder.file("s.mcap"));
  for (std::size_t part = 1; part <= 4; ++part) is_seen("s.mcap", mcap, mcap.size() * part / 5);
  // In the numbers of a column, in its words, and in a number's header.
  const std::string npz = test_support::read_all(folder.file("s.npz"));
  constexpr std::size_t npy_header = 128;
  std::size_t at = npz.find("NUMPY");
  is_seen("s.npz", npz, at + 8);
  is_seen("s.npz", npz, at + npy_header + 40);
  at = npz.rfind("NUMPY");
  is_seen("s.npz", npz, at + npy_header + 200);
}

// What a kill leaves: the beginning, under the name that the file had while it was written.
TEST(recording_formats, a_cut_recording_keeps_its_whole_chunks) {
  if (!has_python()) GTEST_SKIP() << "there is no python3 here";
  const scratch_folder folder;
  drawn_rows draw(test_support::seed_of(test_support::fresh_seed("recording_formats.cut", "1,200 rows"), "cut"));
  std::vector<session_record> rows;
  for (int i = 0; i < 1200; ++i) rows.push_back(draw.next());
  const auto beginning_of = [&](const char* name) {
    result<recording> to = recording::create(folder.file(name));
    EXPECT_TRUE(to);
    for (const session_record& r : rows) EXPECT_TRUE(to->add(r));
    for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
      if (entry.path().filename().string().starts_with(std::string(name) + ".partial-"))
        return test_support::read_all(entry.path());
    }
    ADD_FAILURE() << "there is nothing beside " << name;
    return std::string();
  };
  const std::string mcap = beginning_of("s.mcap"), npz = beginning_of("s.npz");
  EXPECT_EQ(folder.files(), 0U);
  write_all(folder, rows);
  const std::string table = test_support::read_all(folder.file("s.csv"));

  // A fifth of a second at 1 kHz is on its way at the most.
  put_file(folder, "cut.mcap", mcap);
  read_back told = read_with_python(folder, "--cut cut.mcap s.csv");
  ASSERT_TRUE(told.same) << told.said;
  EXPECT_GE(std::stoi(told.said), 1000) << told.said;
  EXPECT_LE(std::stoi(told.said), 1200) << told.said;
  put_file(folder, "cut.mcap", mcap.substr(0, mcap.size() / 2));
  told = read_with_python(folder, "--cut cut.mcap s.csv");
  ASSERT_TRUE(told.same) << told.said;
  EXPECT_GE(std::stoi(told.said), 350) << told.said;
  EXPECT_LE(std::stoi(told.said), 600) << told.said;
  // One for numpy is a table until it is closed.
  ASSERT_GT(npz.size(), table.size() * 4 / 5);
  EXPECT_EQ(npz, table.substr(0, npz.size()));
}

TEST(recording_formats, refuse_another_recordings_description) {
  const scratch_folder folder;
  write_all(folder, {});
  EXPECT_TRUE(recording::create(folder.file("s.mcap")));
  const result<recording> other = recording::create(folder.file("other.mcap"));
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().code, error_code::invalid_argument);
  EXPECT_NE(other.error().message.find("metadata.yaml"), std::string::npos) << other.error().message;
  EXPECT_TRUE(recording::create(folder.file("other.npz")));
}

TEST(recording_formats, extensions_of_any_case) {
  const scratch_folder folder;
  const auto first_bytes = [&](const char* name) {
    result<recording> to = recording::create(folder.file(name));
    EXPECT_TRUE(to && to->close());
    return test_support::read_all(folder.file(name)).substr(0, 6);
  };
  EXPECT_EQ(first_bytes("A.NPZ").substr(0, 4), "PK\x03\x04");
  EXPECT_EQ(first_bytes("b.Mcap").substr(1, 5), "MCAP0");
  EXPECT_EQ(first_bytes("c.txt"), "time_s");
}

// The words of a table have room in an array of numpy.
TEST(recording_formats, words_are_not_cut) {
  session_record r;
  for (int i = 0; i < gate_fault_count; ++i) {
    r.fault = static_cast<gate_fault>(i);
    for (const char* const word : words_of(r)) EXPECT_LE(std::string(word).size(), 32U);
  }
}

}  // namespace
