// asperity::serial on pseudo terminals and sockets of this machine's kernel, and on a kernel in which every call fails.
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <string_view>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>
#include <vector>

#include "asperity/serial/serial_port.hpp"
#include "asperity/serial/stream_link.hpp"
#include "support/counted_news.hpp"

namespace asperity::serial_test {
namespace {

/// The other side of a serial line: the master of a pseudo terminal.
class terminal {
 public:
  terminal() : master_(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {
    std::array<char, 64> name{};
    if (master_ >= 0 && ::grantpt(master_) == 0 && ::unlockpt(master_) == 0 &&
        ::ptsname_r(master_, name.data(), name.size()) == 0) {
      path_ = name.data();
    }
  }
  ~terminal() { hang_up(); }
  terminal(const terminal&) = delete;
  terminal& operator=(const terminal&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] int master() const { return master_; }
  void hang_up() {
    if (master_ >= 0) ::close(master_);
    master_ = -1;
  }

 private:
  int master_;
  std::string path_;
};

std::unique_ptr<byte_link> open(const terminal& t) {
  auto opened = serial::open_serial(t.path());
  EXPECT_TRUE(opened) << (opened ? "" : opened.error().message);
  return opened ? std::move(opened).value() : nullptr;
}

// Reads until as many bytes are there; the kernel may hand them over in pieces.
std::vector<std::uint8_t> read_all(byte_link& link, std::size_t wanted) {
  std::vector<std::uint8_t> out;
  std::array<std::uint8_t, 64> bytes{};
  for (int i = 0; i < 2000 && out.size() < wanted; ++i) {
    std::size_t done = 0;
    const io_status s = link.read(0, bytes, done);
    if (s == io_status::ok) out.insert(out.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(done));
    if (s == io_status::nothing) ::usleep(1000);
    if (s != io_status::ok && s != io_status::nothing) break;
  }
  return out;
}

class serial_line : public testing::Test {
 protected:
  void SetUp() override {
    if (far.path().empty()) GTEST_SKIP() << "this machine gives no pseudo terminals";
  }
  terminal far;
};

TEST_F(serial_line, carries_every_byte_untouched_both_ways) {
  const auto link = open(far);
  ASSERT_TRUE(link);
  std::vector<std::uint8_t> all(256);
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::uint8_t>(i);
  ASSERT_EQ(::write(far.master(), all.data(), all.size()), 256);
  EXPECT_EQ(read_all(*link, 256), all) << "^C, ^D, CR, NL, XON and XOFF are bytes like any other";
  std::size_t done = 0;
  ASSERT_EQ(link->write(0, all, done), io_status::ok);
  EXPECT_EQ(done, 256U);
  std::vector<std::uint8_t> back(512);
  std::size_t got = 0;
  for (int i = 0; i < 2000 && got < 256; ++i) {
    const ssize_t n = ::read(far.master(), &back[got], back.size() - got);
    if (n > 0) got += static_cast<std::size_t>(n);
    if (n <= 0) ::usleep(1000);
  }
  back.resize(got);
  EXPECT_EQ(back, all) << "nothing is echoed or translated either";
}

TEST_F(serial_line, says_at_once_that_nothing_is_there) {
  const auto link = open(far);
  ASSERT_TRUE(link);
  std::array<std::uint8_t, 8> bytes{};
  std::size_t done = 5;
  EXPECT_EQ(link->read(0, bytes, done), io_status::nothing);
  EXPECT_EQ(done, 0U);
  EXPECT_EQ(link->read(0, {}, done), io_status::nothing);
  EXPECT_EQ(link->write(0, {}, done), io_status::ok);
}

TEST_F(serial_line, a_full_line_takes_part_then_nothing_then_more) {
  const auto link = open(far);
  ASSERT_TRUE(link);
  const std::vector<std::uint8_t> block(3000, 0x55);
  std::size_t taken = 0;
  std::size_t done = 0;
  io_status s = io_status::ok;
  bool part = false;
  for (int i = 0; i < 1000 && s != io_status::busy; ++i) {
    s = link->write(0, block, done);
    ASSERT_TRUE(s == io_status::ok || s == io_status::too_short || s == io_status::busy) << to_string(s);
    EXPECT_EQ(s == io_status::ok, done == block.size());
    part = part || s == io_status::too_short;
    taken += done;
  }
  EXPECT_EQ(s, io_status::busy);
  EXPECT_TRUE(part);
  std::vector<std::uint8_t> drained(taken + 1);
  std::size_t got = 0;
  for (int i = 0; i < 2000 && got < taken; ++i) {
    const ssize_t n = ::read(far.master(), &drained[got], drained.size() - got);
    if (n > 0) got += static_cast<std::size_t>(n);
    if (n <= 0) ::usleep(1000);
  }
  EXPECT_EQ(got, taken) << "exactly what was said to be taken arrived";
  for (int i = 0; i < 2000 && s == io_status::busy; ++i) {
    s = link->write(0, std::span(block).first(1), done);
    if (s == io_status::busy) ::usleep(1000);
  }
  EXPECT_EQ(s, io_status::ok);
}

TEST_F(serial_line, is_gone_for_ever_when_the_other_side_hangs_up) {
  const auto reader = open(far);
  ASSERT_TRUE(reader);
  far.hang_up();
  std::array<std::uint8_t, 8> bytes{};
  std::size_t done = 0;
  EXPECT_EQ(reader->read(0, bytes, done), io_status::gone);
  EXPECT_EQ(reader->write(0, bytes, done), io_status::gone);
  terminal other;
  const auto writer = open(other);
  ASSERT_TRUE(writer);
  other.hang_up();
  EXPECT_EQ(writer->write(0, bytes, done), io_status::gone);
  EXPECT_EQ(writer->read(0, bytes, done), io_status::gone);
}

TEST_F(serial_line, throws_away_what_came_before_and_takes_any_rate) {
  ASSERT_EQ(::write(far.master(), "old", 3), 3);
  for (const std::uint32_t rate : {9600U, 115'200U, 140'000U, 250'000U, 3'000'000U}) {
    const auto opened = serial::open_serial(far.path(), {.bits_per_s = rate});
    ASSERT_TRUE(opened) << opened.error().message;
    std::array<std::uint8_t, 8> bytes{};
    std::size_t done = 0;
    EXPECT_EQ((*opened)->read(0, bytes, done), io_status::nothing) << rate;
  }
}

TEST_F(serial_line, says_why_it_cannot_be_opened) {
  const auto message = [](const std::string& path, std::uint32_t rate = 9600) {
    const auto opened = serial::open_serial(path, {.bits_per_s = rate});
    return opened ? std::string("opened") : opened.error().message;
  };
  EXPECT_NE(message("/dev/absent-line").find("There is no serial line /dev/absent-line"), std::string::npos);
  EXPECT_NE(message("/dev/null").find("/dev/null is not a serial line"), std::string::npos);
  EXPECT_NE(message(far.path(), 0).find("0 bits per second"), std::string::npos);
  const auto first = open(far);
  ASSERT_TRUE(first);
  if (::geteuid() == 0) {  // root may open what is in use, and can only look
    const int second = ::open(far.path().c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
    int exclusive = 0;
    EXPECT_EQ(::ioctl(second, TIOCGEXCL, &exclusive), 0);
    EXPECT_EQ(exclusive, 1);
    ::close(second);
    return;
  }
  EXPECT_NE(message(far.path()).find("in use"), std::string::npos) << message(far.path());
}

TEST_F(serial_line, a_tick_takes_no_memory) {
  const auto link = open(far);
  ASSERT_TRUE(link);
  std::array<std::uint8_t, 16> bytes{};
  const std::size_t before = test_support::news_in_this_thread();
  std::size_t done = 0;
  int carried = 0;
  for (int i = 0; i < 200; ++i) {
    if (link->write(0, bytes, done) == io_status::ok) ++carried;
    static_cast<void>(!::read(far.master(), bytes.data(), bytes.size()));
    static_cast<void>(link->read(0, bytes, done));
  }
  EXPECT_EQ(test_support::news_in_this_thread(), before);
  EXPECT_EQ(carried, 200);
}

TEST(adopted_descriptor, a_socket_whose_peer_closed_is_gone_and_ends_no_process) {
  std::array<int, 2> ends{};
  ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()), 0);
  auto link = serial::adopt_descriptor(ends[0]);
  ASSERT_TRUE(link);
  std::array<std::uint8_t, 4> bytes{1, 2, 3, 4};
  std::size_t done = 0;
  EXPECT_EQ((*link)->read(0, bytes, done), io_status::nothing) << "it blocks no more";
  ASSERT_EQ(::write(ends[1], "xyz", 3), 3);
  ASSERT_EQ((*link)->read(0, bytes, done), io_status::ok);
  EXPECT_EQ(done, 3U);
  ::close(ends[1]);
  // SIGPIPE is what it is by default here: it would end this test program.
  ASSERT_EQ(std::signal(SIGPIPE, SIG_DFL), SIG_DFL);
  EXPECT_EQ((*link)->write(0, bytes, done), io_status::gone);
  EXPECT_EQ((*link)->read(0, bytes, done), io_status::gone);
}

TEST(adopted_descriptor, a_terminal_blocks_no_more) {
  const terminal far;
  if (far.path().empty()) GTEST_SKIP() << "this machine gives no pseudo terminals";
  const int fd = ::open(far.path().c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  ASSERT_GE(fd, 0);
  const auto link = serial::adopt_descriptor(fd);
  ASSERT_TRUE(link);
  std::array<std::uint8_t, 4> bytes{};
  std::size_t done = 0;
  EXPECT_EQ((*link)->read(0, bytes, done), io_status::nothing);
}

TEST(adopted_descriptor, pipes_files_and_closed_ones_are_refused_and_stay_open) {
  std::array<int, 2> pipe_ends{};
  ASSERT_EQ(::pipe2(pipe_ends.data(), O_CLOEXEC), 0);
  for (const int end : pipe_ends) EXPECT_FALSE(serial::adopt_descriptor(end));
  EXPECT_EQ(::write(pipe_ends[1], "x", 1), 1) << "it stays the caller's";
  for (const int end : pipe_ends) ::close(end);
  const auto closed = serial::adopt_descriptor(-1);
  ASSERT_FALSE(closed);
  EXPECT_NE(closed.error().message.find("Descriptor -1 is not open"), std::string::npos);
}

/// A kernel that answers what it is told to.
class scripted_calls final : public serial::stream_calls {
 public:
  std::int64_t answer = 0;
  int closed = 0;
  [[nodiscard]] std::int64_t read(int, void*, std::size_t) noexcept override { return answer; }
  [[nodiscard]] std::int64_t write(int, const void*, std::size_t) noexcept override { return answer; }
  void close(int) noexcept override { ++closed; }
};

TEST(stream_link, every_errno_has_its_answer) {
  const auto gone = [](int e) { return e == EIO || e == ENODEV || e == ENXIO || e == EPIPE || e == ECONNRESET; };
  const auto later = [](int e) { return e == EAGAIN || e == EINTR || e == ENOBUFS; };
  std::array<std::uint8_t, 8> bytes{};
  for (int wrong = 1; wrong < 134; ++wrong) {
    for (const bool reading : {true, false}) {
      scripted_calls kernel;
      {
        serial::stream_link link(kernel, 3);
        kernel.answer = -wrong;
        std::size_t done = 5;
        const io_status s = reading ? link.read(0, bytes, done) : link.write(0, bytes, done);
        const io_status not_now = reading ? io_status::nothing : io_status::busy;
        EXPECT_EQ(s, gone(wrong) ? io_status::gone : later(wrong) ? not_now : io_status::failed) << wrong;
        EXPECT_EQ(done, 0U);
        EXPECT_EQ(link.errno_value(), wrong);
        kernel.answer = 8;
        EXPECT_EQ(link.read(0, bytes, done), gone(wrong) ? io_status::gone : io_status::ok) << "gone is for ever";
      }
      EXPECT_EQ(kernel.closed, 1);
    }
  }
  scripted_calls kernel;
  serial::stream_link link(kernel, 3);
  std::size_t done = 0;
  kernel.answer = 3;
  EXPECT_EQ(link.write(0, bytes, done), io_status::too_short);
  EXPECT_EQ(done, 3U);
  kernel.answer = 0;
  EXPECT_EQ(link.write(0, bytes, done), io_status::busy);
  EXPECT_EQ(link.read(0, bytes, done), io_status::gone) << "the end of a stream";
  kernel.answer = 3;
  EXPECT_EQ(link.read(0, bytes, done), io_status::gone);
}

}  // namespace
}  // namespace asperity::serial_test
