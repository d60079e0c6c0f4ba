#include "output_file.hpp"

#include <cerrno>
#include <fcntl.h>
#include <string>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace asperity::command {
namespace {

namespace fs = std::filesystem;

error cannot_write(const fs::path& file, int reason) {
  return {error_code::io_failed, "cannot write " + file.string() + ": " + std::generic_category().message(reason) +
                                     "; give a path in an existing, writable folder with free space"};
}

// A symbolic link keeps pointing where it points: the file behind it is replaced, not the link.
fs::path behind_links(const fs::path& file) {
  std::error_code ignored;
  const fs::path target = fs::is_symlink(file, ignored) ? fs::weakly_canonical(file, ignored) : file;
  return target.empty() ? file : target;
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
  const fs::path target = behind_links(destination);
  std::error_code ignored;
  const fs::file_status existing = fs::status(target, ignored);
  if (fs::is_directory(existing)) return cannot_write(destination, EISDIR);
  const bool direct = fs::exists(existing) && !fs::is_regular_file(existing);

  fs::path opened = target;
  if (!direct) opened += ".partial-" + std::to_string(getpid());
  const int flags = O_WRONLY | O_CLOEXEC | (direct ? 0 : O_CREAT | O_EXCL);
  const int descriptor = open(opened.c_str(), flags, 0666);
  if (descriptor < 0) return cannot_write(destination, errno);
  return output_file(descriptor, target, direct ? fs::path() : opened);
}

result<void> output_file::write(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(descriptor_, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return cannot_write(destination_, errno);
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
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
