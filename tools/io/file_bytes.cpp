#include "file_bytes.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <fcntl.h>
#include <iterator>
#include <memory>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>
#include <utility>

#include "new_file.hpp"

namespace asperity::io {
namespace {

namespace fs = std::filesystem;

struct close_file {
  void operator()(std::FILE* f) const noexcept { std::fclose(f); }
};
using file_handle = std::unique_ptr<std::FILE, close_file>;

/// An open file, closed with its end.
class descriptor {
 public:
  explicit descriptor(int fd) noexcept : fd_(fd) {}
  descriptor(descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  descriptor& operator=(descriptor&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  ~descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  [[nodiscard]] int get() const noexcept { return fd_; }
  [[nodiscard]] explicit operator bool() const noexcept { return fd_ >= 0; }

 private:
  int fd_;
};

/// Should a pipe stand where a file was seen a moment ago, opening it does not wait.
constexpr int open_to_read = O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC;

std::string reason() { return std::generic_category().message(errno); }

error not_found(const fs::path& file) { return fault(error_code::io_failed, file, "cannot be found; check the path"); }

result<void> check_kind(const struct stat& about, const fs::path& file) {
  if (S_ISDIR(about.st_mode)) return fault(error_code::io_failed, file, "is a directory; name a file in it");
  if (!S_ISREG(about.st_mode)) {  // opening a pipe would wait for ever
    return fault(error_code::io_failed, file, "is not a regular file; save its contents to one first");
  }
  return {};
}

/// All bytes of a file that was just opened, if that worked.
result<std::string> read_open(const descriptor& in, const fs::path& file, std::uintmax_t limit,
                              const reading_watch& watch) {
  struct stat about {};
  if (!in || ::fstat(in.get(), &about) != 0) {
    return fault(error_code::io_failed, file, "cannot be opened: " + reason() + "; check its permissions");
  }
  if (const auto regular = check_kind(about, file); !regular) return regular.error();
  const auto size = static_cast<std::uintmax_t>(about.st_size);
  if (size == 0) return fault(error_code::bad_format, file, "is empty; export it again");
  if (size > limit) {
    return fault(error_code::limit_exceeded, file,
                 "has " + std::to_string(size) + " bytes, more than the limit of " + std::to_string(limit) +
                     "; reduce it first");
  }
  constexpr std::size_t at_a_time = std::size_t{8} << 20;
  std::string bytes;
  bytes.reserve(static_cast<std::size_t>(size));
  for (std::size_t done = 0; done < size;) {
    watch.ask();
    if (done == bytes.size()) bytes.resize(std::min(done + at_a_time, static_cast<std::size_t>(size)));
    const ssize_t n = ::read(in.get(), bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return fault(error_code::io_failed, file, "cannot be read to its end; check the disk");
    done += static_cast<std::size_t>(n);
  }
  return bytes;
}

}  // namespace

error fault(error_code code, const fs::path& file, std::string_view what) {
  return {code, file.string() + ": " + std::string(what)};
}

std::string with_mend(std::string what, std::string_view mend) {
  if (what.find("; ") == std::string::npos) what.append("; ").append(mend);
  return what;
}

std::string in_quotes(std::string_view word) {
  constexpr std::size_t longest = 40;
  std::string out(1, '\'');
  out += word.substr(0, longest);
  for (char& c : out) {
    if (c < ' ' || c > '~') c = '?';
  }
  out += word.size() > longest ? "...'" : "'";
  return out;
}

result<void> check_regular_file(const fs::path& file) {
  struct stat about {};
  if (::stat(file.c_str(), &about) != 0) return not_found(file);
  return check_kind(about, file);
}

result<std::string> read_file(const fs::path& file, std::uintmax_t limit, const reading_watch& watch) {
  if (const auto regular = check_regular_file(file); !regular) return regular.error();
  return read_open(descriptor(::open(file.c_str(), open_to_read)), file, limit, watch);
}

result<std::string> read_file_below(const fs::path& folder, const fs::path& name, std::uintmax_t limit,
                                    const reading_watch& watch) {
  const fs::path file = folder / name;
  descriptor at(::open(folder.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
  for (auto step = name.begin(); step != name.end(); ++step) {
    const bool last = std::next(step) == name.end();
    struct stat about {};
    if (!at || ::fstatat(at.get(), step->c_str(), &about, AT_SYMLINK_NOFOLLOW) != 0) return not_found(file);
    if (S_ISLNK(about.st_mode)) {
      return fault(error_code::io_failed, file, "is or lies behind a link, which is not followed; put the file there");
    }
    if (last) {
      if (const auto regular = check_kind(about, file); !regular) return regular.error();
    }
    const int how = last ? open_to_read : O_PATH | O_DIRECTORY | O_CLOEXEC;
    at = descriptor(::openat(at.get(), step->c_str(), how | O_NOFOLLOW));
  }
  return read_open(at, file, limit, watch);
}

result<void> write_file(const fs::path& file, std::initializer_list<std::string_view> parts) {
  std::error_code ec;
  const fs::path target = behind_links(file);  // a link keeps pointing at the file that it names
  const fs::file_status status = fs::status(target, ec);
  if (fs::is_directory(status)) {
    return fault(error_code::io_failed, file, "cannot be written: it is a directory; name a file in it");
  }
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    return fault(error_code::io_failed, file, "cannot be written: it is not a regular file; name another");
  }
  const new_file part = create_beside(target);
  file_handle out(part.descriptor < 0 ? nullptr : ::fdopen(part.descriptor, "wb"));
  if (!out) {
    return fault(error_code::io_failed, file,
                 "cannot be written: " + reason() + "; check that its folder exists and is writable");
  }
  bool whole = true;
  for (const std::string_view bytes : parts) {
    whole = whole && std::fwrite(bytes.data(), 1, bytes.size(), out.get()) == bytes.size();
  }
  whole = std::fclose(out.release()) == 0 && whole;
  const std::string why = whole ? std::string() : reason();
  if (whole) fs::rename(part.name, target, ec);
  if (!whole || ec) {
    std::error_code ignored;
    fs::remove(part.name, ignored);
    return fault(
        error_code::io_failed, file,
        "cannot be written: " + (whole ? ec.message() : why) + "; check the space and the permissions of its folder");
  }
  return {};
}

}  // namespace asperity::io
