#include "output_file.hpp"

#include <cerrno>
#include <chrono>
#include <fcntl.h>
#include <optional>
#include <poll.h>
#include <string>
#include <system_error>
#include <thread>
#include <unistd.h>
#include <utility>

#include "interrupt.hpp"
#include "io/new_file.hpp"

namespace asperity::command {
namespace {

namespace fs = std::filesystem;

error cannot_write(const fs::path& file, int reason) {
  const char* const mend =
      reason == EPIPE ? "nobody reads it any more" : "give a path in an existing, writable folder with free space";
  return {error_code::io_failed,
          "cannot write " + file.string() + ": " + std::generic_category().message(reason) + "; " + mend};
}

// How long a pipe may take nothing once this program was asked to stop.
constexpr std::chrono::milliseconds patience(1000);
constexpr std::chrono::milliseconds look_again(20);

error stopped_waiting(const fs::path& file, const char* who) {
  return {error_code::cancelled, "interrupted while " + file.string() + " had no " + who + ": it is not whole"};
}

// A pipe without a reader is waited for, as a shell does, but not beyond a wish to stop.
result<int> open_in_place(const fs::path& file) {
  while (true) {
    const int descriptor = open(file.c_str(), O_WRONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    if (descriptor >= 0) return descriptor;
    std::error_code ignored;
    const bool waits = errno == ENXIO && fs::is_fifo(file, ignored);
    if (!waits && errno != EINTR) return cannot_write(file, errno);
    if (interrupted()) return stopped_waiting(file, "reader");
    std::this_thread::sleep_for(look_again);
  }
}

}  // namespace

output_file::output_file(int descriptor, fs::path destination, fs::path temporary)
    : descriptor_(descriptor), destination_(std::move(destination)), temporary_(std::move(temporary)) {}

output_file::output_file(output_file&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)),
      destination_(std::move(other.destination_)),
      temporary_(std::exchange(other.temporary_, {})) {}

output_file::~output_file() {
  if (descriptor_ >= 0) close(descriptor_);
  if (!temporary_.empty()) unlink(temporary_.c_str());
}

result<output_file> output_file::create(const fs::path& destination) {
  std::error_code ignored;
  const fs::file_status existing = fs::status(destination, ignored);
  if (fs::is_directory(existing)) return cannot_write(destination, EISDIR);
  if (fs::exists(existing) && !fs::is_regular_file(existing)) {
    const result<int> opened = open_in_place(destination);
    if (!opened) return opened.error();
    return output_file(*opened, destination, {});
  }
  const fs::path target = io::behind_links(destination);  // a link keeps pointing where it points
  const io::new_file made = io::create_beside(target);
  if (made.descriptor < 0) return cannot_write(destination, errno);
  return output_file(made.descriptor, target, made.name);
}

result<void> output_file::write(std::string_view bytes) {
  std::optional<std::chrono::steady_clock::time_point> asked_to_stop;
  while (!bytes.empty()) {
    const ssize_t n = ::write(descriptor_, bytes.data(), bytes.size());
    if (n >= 0) {
      bytes.remove_prefix(static_cast<std::size_t>(n));
    } else if (errno == EAGAIN) {  // a pipe that is full
      const auto now = std::chrono::steady_clock::now();
      if (interrupted() && !asked_to_stop) asked_to_stop = now;
      if (asked_to_stop && now - *asked_to_stop > patience) return stopped_waiting(destination_, "room for a second");
      pollfd room{.fd = descriptor_, .events = POLLOUT, .revents = 0};
      poll(&room, 1, static_cast<int>(look_again.count()));
    } else if (errno != EINTR) {
      return cannot_write(destination_, errno);
    }
  }
  return {};
}

result<void> output_file::start_anew() {
  if (!is_replaceable()) return {};
  if (ftruncate(descriptor_, 0) != 0 || lseek(descriptor_, 0, SEEK_SET) != 0) return cannot_write(destination_, errno);
  return {};
}

result<void> output_file::commit() {
  // Some file systems report a failed write only here.
  if (close(std::exchange(descriptor_, -1)) != 0) return cannot_write(destination_, errno);
  if (temporary_.empty()) return {};
  if (rename(temporary_.c_str(), destination_.c_str()) != 0) return cannot_write(destination_, errno);
  temporary_.clear();
  return {};
}

result<void> check_writable(const fs::path& destination) {
  std::error_code ignored;
  const fs::file_status existing = fs::status(destination, ignored);
  if (fs::exists(existing) && !fs::is_regular_file(existing)) {
    return error{error_code::io_failed, "cannot write " + destination.string() +
                                            ": it exists and is not a regular file; give the name of a file"};
  }
  const result<output_file> trial = output_file::create(destination);
  if (!trial) return trial.error();
  return {};
}

result<void> make_folder(const fs::path& folder) {
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (!failed && fs::is_directory(folder, failed)) return {};
  return error{error_code::io_failed, "cannot make the folder " + folder.string() +
                                          (failed ? ": " + failed.message() : "") +
                                          "; give a folder, or a name in an existing, writable one"};
}

}  // namespace asperity::command
