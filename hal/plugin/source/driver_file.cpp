#include "asperity/plugin/driver_file.hpp"

#include <cerrno>
#include <climits>
#include <cstring>
#include <deque>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "asperity/plugin/elf_check.hpp"

namespace asperity::plugin {
namespace {

constexpr int most_links = 16;

class owned_descriptor {
 public:
  explicit owned_descriptor(int fd) noexcept : fd_(fd) {}
  owned_descriptor(const owned_descriptor&) = delete;
  owned_descriptor& operator=(const owned_descriptor&) = delete;
  ~owned_descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  void reset(int fd) noexcept {
    if (fd_ >= 0) ::close(fd_);
    fd_ = fd;
  }
  [[nodiscard]] int get() const noexcept { return fd_; }
  [[nodiscard]] int release() noexcept { return std::exchange(fd_, -1); }

 private:
  int fd_;
};

std::string system_says() { return std::strerror(errno); }  // NOLINT(concurrency-mt-unsafe): a text of the C library

// Why others than root and this user decide what lies here; empty where they do not.
std::string others_may_change(const struct stat& s, const std::filesystem::path& what) {
  const std::string name = what.string();
  if (s.st_uid != 0 && s.st_uid != ::geteuid()) {
    return name + " belongs to another user (" + std::to_string(s.st_uid) +
           "), who could put any code there: install the driver in a folder of root or of your own";
  }
  // An access list that lets others write shows in the bits of the group.
  if (!S_ISLNK(s.st_mode) && (s.st_mode & (S_IWGRP | S_IWOTH)) != 0) {
    return name + " can be written by " + ((s.st_mode & S_IWOTH) != 0 ? "everybody" : "its group") +
           ", who could put any code there: chmod go-w " + name + ", or install the driver elsewhere";
  }
  return {};
}

// Goes to a file from the root, one name at a time, and looks at who may change each step before it is taken.
class careful_walk {
 public:
  // @return a descriptor of the file, or -1 where problem() says why
  int to(const std::filesystem::path& file) {
    std::error_code failed;
    const std::filesystem::path whole = std::filesystem::absolute(file, failed);
    if (failed) return fail(file.string() + ": " + failed.message());
    for (const std::filesystem::path& name : whole.relative_path()) names_.push_back(name);
    if (!enter_root()) return -1;
    while (!names_.empty()) {
      const std::filesystem::path name = std::move(names_.front());
      names_.pop_front();
      if (name.empty() || name == ".") continue;
      if (const int opened = step(name); opened != going_on) return opened;
    }
    return fail(file.string() + ": is a folder, not a driver");
  }
  [[nodiscard]] const std::string& problem() const noexcept { return problem_; }

 private:
  static constexpr int going_on = -2;

  int fail(std::string why) {
    problem_ = std::move(why);
    return -1;
  }

  bool enter_root() {
    here_.reset(::open("/", O_PATH | O_DIRECTORY | O_CLOEXEC));
    where_ = "/";
    return look(here_.get());
  }
  bool look(int fd) {
    struct stat s {};
    if (::fstat(fd, &s) != 0) return fail(where_.string() + ": " + system_says()) != -1;
    problem_ = others_may_change(s, where_);
    return problem_.empty();
  }

  int step(const std::filesystem::path& name) {
    struct stat s {};
    const std::filesystem::path there = where_ / name;
    if (::fstatat(here_.get(), name.c_str(), &s, AT_SYMLINK_NOFOLLOW) != 0) {
      return fail(there.string() + ": cannot be opened: " + system_says());
    }
    const bool last = names_.empty();
    if (S_ISLNK(s.st_mode)) {
      if (last) return fail(there.string() + ": is a link; put the driver itself there, or name the file it leads to");
      return follow(there, name, s);
    }
    if (last) return open_file(there, name);
    here_.reset(::openat(here_.get(), name.c_str(), O_PATH | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
    if (here_.get() < 0) return fail(there.string() + ": cannot be opened: " + system_says());
    where_ = name == ".." ? where_.parent_path() : there;
    return look(here_.get()) ? going_on : -1;
  }

  // The folder that the link lies in was looked at: only root and this user could have made it.
  int follow(const std::filesystem::path& there, const std::filesystem::path& name, const struct stat& s) {
    if (std::string why = others_may_change(s, there); !why.empty()) return fail(std::move(why));
    char target[PATH_MAX];
    const ssize_t length = ::readlinkat(here_.get(), name.c_str(), target, sizeof target);
    if (length <= 0 || static_cast<std::size_t>(length) >= sizeof target) {
      return fail(there.string() + ": a link that cannot be read");
    }
    if (++links_ > most_links) return fail(there.string() + ": too many links, or a ring of them");
    const std::filesystem::path to(std::string(target, static_cast<std::size_t>(length)));
    const std::filesystem::path names = to.relative_path();
    names_.insert(names_.begin(), names.begin(), names.end());
    if (to.is_absolute() && !enter_root()) return -1;
    return going_on;
  }

  int open_file(const std::filesystem::path& there, const std::filesystem::path& name) {
    // Without O_NONBLOCK a pipe would keep the program waiting for somebody who writes.
    owned_descriptor file(::openat(here_.get(), name.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
    if (file.get() < 0) return fail(there.string() + ": cannot be opened: " + system_says());
    where_ = there;
    if (!look(file.get())) return -1;
    return file.release();
  }

  std::deque<std::filesystem::path> names_{};
  owned_descriptor here_{-1};
  std::filesystem::path where_{};
  std::string problem_{};
  int links_ = 0;
};

bool read_all(int fd, std::uint64_t offset, std::span<std::byte> into) {
  while (!into.empty()) {
    if (offset > static_cast<std::uint64_t>(INT64_MAX)) return false;
    const ssize_t n = ::pread(fd, into.data(), into.size(), static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    into = into.subspan(static_cast<std::size_t>(n));
    offset += static_cast<std::uint64_t>(n);
  }
  return true;
}

}  // namespace

driver_file::~driver_file() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

std::optional<driver_file> driver_file::open(const std::filesystem::path& file, file_trust trust,
                                             load_failure& failure) {
  const auto refuse = [&](table_fault fault, error_code code, std::string why) {
    failure = {fault, {code, std::move(why)}};
    return std::nullopt;
  };
  careful_walk walk;
  owned_descriptor opened(trust == file_trust::owner_only ? walk.to(file)
                                                          : ::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
  if (opened.get() < 0) {
    return refuse(table_fault::not_loadable, error_code::io_failed,
                  "the driver is not loaded: " +
                      (walk.problem().empty() ? file.string() + ": " + system_says() : walk.problem()));
  }
  struct stat s {};
  if (::fstat(opened.get(), &s) != 0 || !S_ISREG(s.st_mode)) {
    return refuse(table_fault::not_loadable, error_code::bad_format, file.string() + ": is not a file");
  }
  const std::optional<elf_problem> problem = find_elf_problem(
      [&](std::uint64_t offset, std::span<std::byte> into) { return read_all(opened.get(), offset, into); });
  if (problem) {
    return refuse(problem->no_entry ? table_fault::no_entry : table_fault::not_loadable, error_code::bad_format,
                  file.string() + ": " + problem->message);
  }
  return driver_file(opened.release(), file);
}

result<driver_file> driver_file::open(const std::filesystem::path& file, file_trust trust) {
  load_failure failure{};
  std::optional<driver_file> opened = open(file, trust, failure);
  if (!opened) return failure.why;
  return std::move(*opened);
}

}  // namespace asperity::plugin
