// Files that may be drivers, judged before anything in them runs.
#include <cstdlib>
#include <cstring>
#include <elf.h>
#include <fcntl.h>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <random>
#include <string>
#include <sys/stat.h>
#include <unistd.h>
#include <vector>

#include "asperity/plugin/driver_file.hpp"
#include "asperity/plugin/driver_module.hpp"
#include "asperity/plugin/driver_search.hpp"
#include "asperity/plugin/elf_check.hpp"
#include "module_files.hpp"

namespace asperity::plugin {
namespace {

using test_support::broken_way;
using test_support::driver_folder;

std::vector<std::byte> bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  std::vector<std::byte> out(text.size());
  std::memcpy(out.data(), text.data(), text.size());
  return out;
}

// As a file of these bytes would be judged. Counts what is read, and never hands out more than there is.
struct judged {
  std::optional<elf_problem> problem;
  std::size_t reads = 0;
};
judged judge(std::span<const std::byte> bytes) {
  judged out;
  out.problem = find_elf_problem([&](std::uint64_t offset, std::span<std::byte> into) {
    ++out.reads;
    if (offset > bytes.size() || bytes.size() - offset < into.size()) return false;
    std::memcpy(into.data(), bytes.data() + offset, into.size());
    return true;
  });
  return out;
}

std::string why(const result<driver_file>& opened) { return opened ? "" : opened.error().message; }

// The folders above the build may be open to others, then nothing in it is trusted and there is nothing to compare
// with.
#define NEEDS_A_TRUSTED_FOLDER(folder)                                                 \
  std::filesystem::copy(test_support::simulated_driver, (folder) / "good.so");         \
  if (const result<driver_file> good = driver_file::open((folder) / "good.so"); !good) \
  GTEST_SKIP() << "the build folder is not this user's alone: " << good.error().message

TEST(driver_files, a_good_driver_is_judged_good_and_others_are_not) {
  for (const auto& file : {test_support::simulated_driver, test_support::broken_driver, test_support::sample_driver}) {
    const judged j = judge(bytes_of(file));
    EXPECT_FALSE(j.problem) << file << ": " << j.problem->message;
  }
  EXPECT_TRUE(judge({}).problem);
  const std::vector<std::byte> program = bytes_of("/proc/self/exe");
  ASSERT_TRUE(judge(program).problem);

  std::vector<std::byte> other = bytes_of(test_support::simulated_driver);
  other[EI_CLASS] = std::byte{ELFCLASS32};
  EXPECT_NE(judge(other).problem->message.find("another processor"), std::string::npos);
  other = bytes_of(test_support::simulated_driver);
  other[18] = std::byte{EM_SPARC};
  EXPECT_NE(judge(other).problem->message.find("another processor"), std::string::npos);
  other = bytes_of(test_support::simulated_driver);
  other[16] = std::byte{ET_EXEC};
  EXPECT_NE(judge(other).problem->message.find("not a shared object"), std::string::npos);
}

TEST(driver_files, the_one_name_is_found_and_no_other_and_no_part_of_it) {
  const std::vector<std::byte> good = bytes_of(test_support::simulated_driver);
  const std::string name = "asperity_driver_entry";
  const auto text = reinterpret_cast<const char*>(good.data());
  std::size_t places = 0;
  for (std::size_t i = 0; i + name.size() < good.size(); ++i) {
    if (std::memcmp(text + i, name.c_str(), name.size()) != 0) continue;
    ++places;
    std::vector<std::byte> renamed = good;
    renamed[i + name.size() - 1] = std::byte{'x'};
    // The table of debug symbols has the name too; the dynamic one decides.
    const judged j = judge(renamed);
    if (j.problem) {
      EXPECT_TRUE(j.problem->no_entry) << j.problem->message;
      return;
    }
  }
  ADD_FAILURE() << "renamed in " << places << " places, and nobody noticed";
}

TEST(driver_files, no_damage_to_a_file_is_more_than_a_refusal) {
  const std::vector<std::byte> good = bytes_of(test_support::simulated_driver);
  const std::size_t usual = judge(good).reads;
  for (std::size_t n = 0; n < good.size(); n += n < 2048 ? 1 : 997) {
    EXPECT_LE(judge(std::span(good).first(n)).reads, usual) << n;
  }
  std::mt19937_64 random(20261122);
  std::size_t refused = 0;
  std::size_t most_reads = 0;
  constexpr std::size_t rounds = 20'000;
  for (std::size_t round = 0; round < rounds; ++round) {
    std::vector<std::byte> bad(good.begin(), good.begin() + std::min<std::ptrdiff_t>(16'384, std::ssize(good)));
    for (std::uint64_t n = 1 + random() % 8; n > 0; --n) {
      // Mostly in the headers, and mostly numbers that are near a border.
      const std::size_t at = random() % (random() % 4 == 0 ? bad.size() : 1024);
      const std::uint64_t values[] = {0, 1, 0x7fffffffffffffff, 0xffffffffffffffff, 0xfffffffffffffff8, random()};
      const std::uint64_t value = values[random() % std::size(values)];
      const std::size_t width = std::size_t{1} << (random() % 4);
      std::memcpy(bad.data() + at, &value, std::min(width, bad.size() - at));
    }
    const judged j = judge(bad);
    refused += j.problem ? 1U : 0U;
    most_reads = std::max(most_reads, j.reads);
  }
  EXPECT_GT(refused, rounds / 4);
  EXPECT_LT(most_reads, 300'000U);
}

TEST(driver_files, what_others_may_write_is_refused) {
  const std::filesystem::path folder = driver_folder("trust");
  NEEDS_A_TRUSTED_FOLDER(folder);
  const std::filesystem::path file = folder / "good.so";
  const auto refused_for = [&](const std::filesystem::path& what, mode_t mode, const char* word) {
    struct stat before {};
    ASSERT_EQ(::stat(what.c_str(), &before), 0);
    ASSERT_EQ(::chmod(what.c_str(), mode), 0);
    const result<driver_file> opened = driver_file::open(file);
    EXPECT_FALSE(opened) << what << " with mode " << std::oct << mode;
    EXPECT_NE(why(opened).find(word), std::string::npos) << why(opened);
    EXPECT_NE(why(opened).find(what.string() + " "), std::string::npos) << why(opened);
    ::chmod(what.c_str(), before.st_mode & 07777U);
  };
  refused_for(file, 0664, "its group");
  refused_for(file, 0646, "everybody");
  refused_for(folder, 0775, "its group");
  refused_for(folder, 0757, "everybody");
  refused_for(folder, 01777, "everybody");  // the sticky bit keeps names from being taken away, not from being added
  EXPECT_TRUE(driver_file::open(file)) << "as it was";

  std::filesystem::create_directories(folder / "open" / "closed");
  std::filesystem::copy(file, folder / "open" / "closed" / "good.so");
  ASSERT_EQ(::chmod((folder / "open").c_str(), 0777), 0);
  EXPECT_FALSE(driver_file::open(folder / "open" / "closed" / "good.so")) << "a folder above it is open";
  EXPECT_TRUE(driver_file::open(folder / "open" / "closed" / "good.so", file_trust::as_named));

  const std::filesystem::path in_tmp =
      std::filesystem::path("/tmp") / ("asperity_" + std::to_string(::getpid()) + ".so");
  std::filesystem::copy(file, in_tmp);
  EXPECT_NE(why(driver_file::open(in_tmp)).find("/tmp can be written by everybody"), std::string::npos);
  std::filesystem::remove(in_tmp);
}

TEST(driver_files, what_belongs_to_another_user_is_refused) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root can give a file away";
  const std::filesystem::path folder = driver_folder("owner");
  NEEDS_A_TRUSTED_FOLDER(folder);
  ASSERT_EQ(::chown((folder / "good.so").c_str(), 4711, 0), 0);
  EXPECT_NE(why(driver_file::open(folder / "good.so")).find("another user (4711)"), std::string::npos);
  ASSERT_EQ(::chown((folder / "good.so").c_str(), 0, 0), 0);
  EXPECT_TRUE(driver_file::open(folder / "good.so"));
  ASSERT_EQ(::chown(folder.c_str(), 4711, 0), 0);
  EXPECT_FALSE(driver_file::open(folder / "good.so"));
  ASSERT_EQ(::chown(folder.c_str(), 0, 0), 0);
  std::filesystem::create_directory_symlink(folder, folder / "round");
  EXPECT_TRUE(driver_file::open(folder / "round" / "good.so")) << "a link that root made";
  ASSERT_EQ(::lchown((folder / "round").c_str(), 4711, 0), 0);
  EXPECT_FALSE(driver_file::open(folder / "round" / "good.so"));
}

TEST(driver_files, links_pipes_and_folders_are_no_drivers_and_keep_nobody_waiting) {
  const std::filesystem::path folder = driver_folder("links");
  NEEDS_A_TRUSTED_FOLDER(folder);
  std::filesystem::create_symlink(folder / "good.so", folder / "link.so");
  EXPECT_NE(why(driver_file::open(folder / "link.so")).find("is a link"), std::string::npos);
  std::filesystem::create_directory_symlink(folder / "ring", folder / "ring");
  EXPECT_NE(why(driver_file::open(folder / "ring" / "good.so")).find("too many links"), std::string::npos);
  ASSERT_EQ(::mkfifo((folder / "pipe.so").c_str(), 0600), 0);
  EXPECT_FALSE(driver_file::open(folder / "pipe.so"));
  EXPECT_FALSE(driver_file::open(folder / "pipe.so", file_trust::as_named));
  std::filesystem::create_directory(folder / "folder.so");
  EXPECT_FALSE(driver_file::open(folder / "folder.so"));
  EXPECT_FALSE(driver_file::open(folder / "nothing.so"));
  // A link to a folder elsewhere, where what it leads to is open to others.
  std::filesystem::create_directories(folder / "open");
  std::filesystem::copy(folder / "good.so", folder / "open" / "good.so");
  std::filesystem::create_directory_symlink("open", folder / "to_open");
  EXPECT_TRUE(driver_file::open(folder / "to_open" / "good.so"));
  ASSERT_EQ(::chmod((folder / "open").c_str(), 0777), 0);
  EXPECT_FALSE(driver_file::open(folder / "to_open" / "good.so"));
}

TEST(driver_files, what_was_judged_is_what_is_loaded) {
  const std::filesystem::path folder = driver_folder("exchange");
  std::filesystem::copy(test_support::sample_driver, folder / "one.so");
  result<driver_file> opened = driver_file::open(folder / "one.so", file_trust::as_named);
  ASSERT_TRUE(opened) << why(opened);
  // Another driver takes its name between the look and the loading.
  std::filesystem::copy(test_support::simulated_driver, folder / "two.so");
  std::filesystem::rename(folder / "two.so", folder / "one.so");
  load_failure failure{};
  const auto first = driver_module::load(std::move(opened).value(), {}, failure);
  ASSERT_NE(first, nullptr) << failure.why.message;
  EXPECT_STREQ(first->table().name, "spring_handle");
  // The descriptor's number is free again, and means another file to the linker now.
  const auto second = driver_module::load(folder / "one.so", {}, failure, file_trust::as_named);
  ASSERT_NE(second, nullptr) << failure.why.message;
  EXPECT_STREQ(second->table().name, "simulated");
}

TEST(driver_files, are_found_in_folders_and_none_is_run) {
  const std::filesystem::path folder = driver_folder("search");
  for (const char* sub : {"first", "second"}) {
    std::filesystem::create_directories(folder / sub);
    std::filesystem::copy(test_support::broken_driver, folder / sub / "telling.so");
  }
  std::filesystem::copy(test_support::simulated_driver, folder / "good.so");
  std::ofstream(folder / "first" / "rubbish.so") << "rubbish";
  std::ofstream(folder / "first" / "readme.txt") << "not looked at";

  const std::string variable = "relative:" + (folder / "first").string() + "::" + (folder / "second").string();
  ::setenv("ASPERITY_DRIVER_PATH", variable.c_str(), 1);
  std::vector<std::filesystem::path> folders = search_path();
  ::unsetenv("ASPERITY_DRIVER_PATH");
  ASSERT_EQ(folders.size(), 3U);
  EXPECT_EQ(folders[0], folder / "first");
  EXPECT_EQ(folders[1], folder / "second");
  EXPECT_TRUE(folders[2].is_absolute());
  EXPECT_EQ(folders[2].filename(), "drivers");

  const std::filesystem::path log = folder / "log";
  ::setenv("ASPERITY_BROKEN_LOG", log.c_str(), 1);
  const broken_way telling("tells");
  folders[2] = folder / "not there";
  const std::vector<found_file> found = find_driver_files(folders);
  EXPECT_FALSE(std::filesystem::exists(log)) << "code of a driver ran while it was looked for";
  load_failure failure{};
  ASSERT_NE(driver_module::load(test_support::broken_driver, {}, failure, file_trust::as_named), nullptr);
  EXPECT_TRUE(std::filesystem::exists(log)) << "and this is how it would have been seen";
  ::unsetenv("ASPERITY_BROKEN_LOG");

  ASSERT_EQ(found.size(), 3U);
  EXPECT_EQ(found[0].name, "rubbish");
  EXPECT_TRUE(found[0].refused);
  EXPECT_EQ(found[1].name, "telling");
  EXPECT_EQ(found[1].file, folder / "first" / "telling.so");
  ASSERT_TRUE(found[2].refused);
  EXPECT_NE(found[2].refused->message.find("already found"), std::string::npos);
  if (const result<driver_file> good = driver_file::open(folder / "good.so"); !good) {
    GTEST_SKIP() << "the build folder is not this user's alone: " << good.error().message;
  }
  EXPECT_FALSE(found[1].refused) << found[1].refused->message;
  EXPECT_NE(found[0].refused->message.find("not a shared object"), std::string::npos) << found[0].refused->message;
}

}  // namespace
}  // namespace asperity::plugin
