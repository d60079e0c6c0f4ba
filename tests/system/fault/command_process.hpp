// Runs the built command as a user does: a process, its streams, its exit status, its files.
#pragma once

#include <csignal>
#include <filesystem>
#include <functional>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <sys/types.h>
#include <utility>
#include <vector>

namespace fault {

using json = nlohmann::json;
using arguments = std::vector<std::string>;

struct outcome {
  int exit_status = -1;  ///< 128 + signal where a signal ended it
  std::string out;
  std::string err;
};

struct process_options {
  std::optional<unsigned long> file_size_limit;                    ///< bytes; a fuller disk than any real one
  std::optional<std::filesystem::path> stdout_to;                  ///< instead of outcome::out
  std::optional<double> interrupt_after_s;                         ///< SIGINT this long after the command can take one
  std::vector<std::pair<std::string, std::string>> environment{};  ///< variables set beside the test's own
};

/// Runs `asperity ARGS...` to its end.
[[nodiscard]] outcome run(const arguments& args, const process_options& options = {});

/// `asperity ARGS...` while it runs. What still runs when this goes is killed.
class running_command {
 public:
  explicit running_command(const arguments& args, const process_options& options = {});
  running_command(const running_command&) = delete;
  running_command& operator=(const running_command&) = delete;
  ~running_command();

  [[nodiscard]] pid_t process() const noexcept { return process_; }
  [[nodiscard]] bool ended() const;
  void send(int signal_number) const { kill(process_, signal_number); }
  /// Waits until something holds, looking every few milliseconds. @return false where the command ended before, or 30 s
  /// went by
  [[nodiscard]] bool wait_until(const std::function<bool()>& holds) const;
  /// Waits for the end, and kills what has not ended after that time: exit status 137.
  [[nodiscard]] outcome finish(double longest_s = 30.0);

 private:
  std::filesystem::path folder_;
  pid_t process_ = -1;
  bool reaped_ = false;
};

/// Lines on stderr but those that only note something, as of the machine's speed before a session.
[[nodiscard]] std::string without_notes(const std::string& err);

/// A folder of its own for every test, removed afterwards.
class command_test : public testing::Test {
 protected:
  command_test();
  ~command_test() override;

  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }
  void write(const std::string& name, const std::string& bytes) const;
  [[nodiscard]] std::string read(const std::string& name) const;
  /// Names of everything in the folder.
  [[nodiscard]] std::set<std::string> files() const;

  /// Runs the command, with and without --json, and expects: this exit status, one line on stderr, notes aside, that
  /// begins with "asperity: ", nothing else on stdout but (with --json) one error document of this code, and a folder
  /// that is as it was before. @return the message
  std::string expect_failure(const arguments& args, int exit_status, const std::string& code,
                             const process_options& options = {}) const;

  /// Runs the command with --json and expects success. @return the document
  [[nodiscard]] json expect_document(const arguments& args, const std::string& schema) const;

 private:
  std::filesystem::path folder_;
};

/// Folder with block.ply, block_coarse.ply and block.glb (a small texture), and pin.glb, of 3 mm x 3 mm x 20 mm, with
/// which a session begins six times as soon: made by the command itself once per test program.
[[nodiscard]] const std::filesystem::path& small_models();

}  // namespace fault
