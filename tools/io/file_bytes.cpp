#include "file_bytes.hpp"

#include <cerrno>
#include <cstdio>
#include <memory>
#include <system_error>

namespace asperity::io {
namespace {

namespace fs = std::filesystem;

struct close_file {
  void operator()(std::FILE* f) const noexcept { std::fclose(f); }
};
using file_handle = std::unique_ptr<std::FILE, close_file>;

std::string reason() { return std::generic_category().message(errno); }

/// The path that a chain of links ends in, whether a file is there or not.
fs::path behind_links(fs::path path) {
  std::error_code ec;
  for (int link = 0; link < 40 && fs::is_symlink(fs::symlink_status(path, ec)); ++link) {
    path = path.parent_path() / fs::read_symlink(path, ec);  // an absolute one replaces the parent
  }
  return path;
}

/// A new file beside the target, so that renaming it stays within one file system.
file_handle create_beside(const fs::path& target, fs::path& name) {
  for (int attempt = 0; attempt < 100; ++attempt) {
    name = target;
    name += ".part" + std::to_string(attempt);
    file_handle file(std::fopen(name.c_str(), "wbx"));  // x: never somebody else's file
    if (file || errno != EEXIST) return file;
  }
  return nullptr;
}

}  // namespace

error fault(error_code code, const fs::path& file, std::string_view what) {
  return {code, file.string() + ": " + std::string(what)};
}

result<void> check_regular_file(const fs::path& file) {
  std::error_code ec;
  const fs::file_status status = fs::status(file, ec);
  if (!fs::exists(status)) return fault(error_code::io_failed, file, "cannot be found; check the path");
  if (fs::is_directory(status)) return fault(error_code::io_failed, file, "is a directory; name a file in it");
  if (!fs::is_regular_file(status)) {  // opening a pipe would wait for ever
    return fault(error_code::io_failed, file, "is not a regular file; save its contents to one first");
  }
  return {};
}

result<std::string> read_file(const fs::path& file, std::uintmax_t limit) {
  if (const auto regular = check_regular_file(file); !regular) return regular.error();
  std::error_code ec;
  const std::uintmax_t size = fs::file_size(file, ec);
  if (ec) return fault(error_code::io_failed, file, "has no size: " + ec.message() + "; check the path");
  if (size == 0) return fault(error_code::bad_format, file, "is empty; export it again");
  if (size > limit) {
    return fault(error_code::limit_exceeded, file,
                 "has " + std::to_string(size) + " bytes, more than the limit of " + std::to_string(limit) +
                     "; reduce it first");
  }
  const file_handle in(std::fopen(file.c_str(), "rb"));
  if (!in) return fault(error_code::io_failed, file, "cannot be opened: " + reason() + "; check its permissions");
  std::string bytes(static_cast<std::size_t>(size), '\0');
  if (std::fread(bytes.data(), 1, bytes.size(), in.get()) != bytes.size()) {
    return fault(error_code::io_failed, file, "cannot be read to its end; check the disk");
  }
  return bytes;
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
  fs::path part;
  file_handle out = create_beside(target, part);
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
  if (whole) fs::rename(part, target, ec);
  if (!whole || ec) {
    std::error_code ignored;
    fs::remove(part, ignored);
    return fault(
        error_code::io_failed, file,
        "cannot be written: " + (whole ? ec.message() : why) + "; check the space and the permissions of its folder");
  }
  return {};
}

}  // namespace asperity::io
