#include "command_process.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <sys/resource.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace fault {
namespace {

namespace fs = std::filesystem;

std::string contents(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

fs::path make_folder() {
  std::string name = (fs::temp_directory_path() / "asperity-fault-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder: " + name);
  return name;
}

// A folder that goes with the program.
struct scratch_folder {
  fs::path path = make_folder();
  ~scratch_folder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
};

[[noreturn]] void become_command(const arguments& args, const process_options& options, const fs::path& out,
                                 const fs::path& err) {
  const fs::path target = options.stdout_to.value_or(out);
  const int out_fd = open(target.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  const int err_fd = open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  if (out_fd < 0 || err_fd < 0) _exit(125);
  dup2(out_fd, STDOUT_FILENO);
  dup2(err_fd, STDERR_FILENO);
  if (options.file_size_limit) {
    const rlimit limit{*options.file_size_limit, *options.file_size_limit};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  for (const auto& [name, value] : options.environment) setenv(name.c_str(), value.c_str(), 1);
  std::vector<char*> argv;
  std::string command = ASPERITY_COMMAND;
  argv.push_back(command.data());
  for (const std::string& a : args) argv.push_back(const_cast<char*>(a.c_str()));
  argv.push_back(nullptr);
  execv(ASPERITY_COMMAND, argv.data());
  _exit(126);
}

// True where the process has a handler for SIGINT; before that, SIGINT would end it by default.
bool handles_interrupts(pid_t process) {
  std::ifstream status("/proc/" + std::to_string(process) + "/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("SigCgt:", 0) == 0) return (std::stoull(line.substr(7), nullptr, 16) >> (SIGINT - 1) & 1) != 0;
  }
  return false;
}

bool ended(pid_t process) {
  siginfo_t info{};
  return waitid(P_PID, static_cast<id_t>(process), &info, WEXITED | WNOHANG | WNOWAIT) != 0 || info.si_pid != 0;
}

void interrupt(pid_t process, double after_s) {
  while (!handles_interrupts(process) && !ended(process)) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  std::this_thread::sleep_for(std::chrono::duration<double>(after_s));
  kill(process, SIGINT);
}

}  // namespace

outcome run(const arguments& args, const process_options& options) {
  const scratch_folder scratch;
  const fs::path out = scratch.path / "out", err = scratch.path / "err";
  const pid_t child = fork();
  if (child == 0) become_command(args, options, out, err);
  if (options.interrupt_after_s) interrupt(child, *options.interrupt_after_s);
  int status = 0;
  waitpid(child, &status, 0);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), contents(out), contents(err)};
}

running_command::running_command(const arguments& args, const process_options& options) : folder_(make_folder()) {
  process_ = fork();
  if (process_ == 0) become_command(args, options, folder_ / "out", folder_ / "err");
}

running_command::~running_command() {
  if (!reaped_) {
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
  }
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

bool running_command::ended() const { return reaped_ || fault::ended(process_); }

bool running_command::wait_until(const std::function<bool()>& holds) const {
  for (int i = 0; i < 15000; ++i) {
    if (holds()) return true;
    if (ended()) return holds();
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return false;
}

outcome running_command::finish(double longest_s) {
  const auto begin = std::chrono::steady_clock::now();
  while (!ended() && std::chrono::steady_clock::now() - begin < std::chrono::duration<double>(longest_s)) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  if (!ended()) kill(process_, SIGKILL);
  int status = 0;
  waitpid(process_, &status, 0);
  reaped_ = true;
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), contents(folder_ / "out"),
          contents(folder_ / "err")};
}

command_test::command_test() : folder_(make_folder()) {}

command_test::~command_test() {
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

void command_test::write(const std::string& name, const std::string& bytes) const {
  std::ofstream(folder_ / name, std::ios::binary) << bytes;
}

std::string command_test::read(const std::string& name) const { return contents(folder_ / name); }

std::set<std::string> command_test::files() const {
  std::set<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder_)) {
    names.insert(fs::relative(entry.path(), folder_).string());
  }
  return names;
}

std::string without_notes(const std::string& err) {
  std::istringstream lines(err);
  std::string out;
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("asperity: note: ", 0) != 0) out += line + (lines.eof() ? "" : "\n");
  }
  return out;
}

std::string command_test::expect_failure(const arguments& args, int exit_status, const std::string& code,
                                         const process_options& options) const {
  const std::set<std::string> before = files();
  const outcome plain = run(args, options);
  EXPECT_EQ(plain.exit_status, exit_status) << plain.err;
  EXPECT_EQ(plain.out, "");
  const std::string complaint = without_notes(plain.err);
  EXPECT_EQ(complaint.rfind("asperity: ", 0), 0U) << plain.err;
  EXPECT_EQ(std::count(complaint.begin(), complaint.end(), '\n'), 1) << plain.err;
  EXPECT_EQ(files(), before);

  arguments with_json = args;
  with_json.emplace_back("--json");
  const outcome documented = run(with_json, options);
  EXPECT_EQ(documented.exit_status, exit_status);
  EXPECT_EQ(documented.err, complaint);
  const json document = json::parse(documented.out, nullptr, false);
  EXPECT_TRUE(document.is_object() && document.contains("error")) << documented.out.substr(0, 200);
  if (!document.is_object() || !document.contains("error")) return {};
  EXPECT_EQ(document.value("schema", ""), "asperity.error/1");
  EXPECT_EQ(document.at("error").value("code", ""), code);
  EXPECT_EQ("asperity: " + document.at("error").value("message", "") + "\n", documented.err);
  EXPECT_EQ(files(), before);
  return document.at("error").value("message", "");
}

json command_test::expect_document(const arguments& args, const std::string& schema) const {
  arguments with_json = args;
  with_json.emplace_back("--json");
  const outcome done = run(with_json);
  const json document = json::parse(done.out, nullptr, false);
  // Thrown, not expected: a test that goes on without its document could only crash.
  if (done.exit_status != 0 || !document.is_object()) throw std::runtime_error("no document: " + done.err);
  EXPECT_EQ(done.err, "");
  EXPECT_EQ(document.value("schema", ""), schema);
  return document;
}

const fs::path& small_models() {
  static const scratch_folder folder;
  static const bool made = [] {
    const auto at = [](const char* name) { return (folder.path / name).string(); };
    const outcome models = run({"models", "--only", "block", "-o", folder.path.string()});
    EXPECT_EQ(models.exit_status, 0) << models.err;
    const outcome baked =
        run({"bake", at("block.ply"), "--coarse", at("block_coarse.ply"), "--texture", "128", "-o", at("block.glb")});
    EXPECT_EQ(baked.exit_status, 0) << baked.err;
    // For tests that write and read it a hundred times: a field is thirty times the rest of it.
    const outcome bare = run({"bake", at("block.ply"), "--coarse", at("block_coarse.ply"), "--texture", "128",
                              "--without-field", "-o", at("block_bare.glb")});
    EXPECT_EQ(bare.exit_status, 0) << bare.err;
    std::ofstream(folder.path / "pin.obj")
        << "v -.0015 -.0015 -.01\nv -.0015 -.0015 .01\nv -.0015 .0015 -.01\nv -.0015 .0015 .01\n"
           "v .0015 -.0015 -.01\nv .0015 -.0015 .01\nv .0015 .0015 -.01\nv .0015 .0015 .01\n"
           "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n";
    const outcome pin = run({"bake", at("pin.obj"), "--coarse", at("pin.obj"), "--texture", "32", "-o", at("pin.glb")});
    EXPECT_EQ(pin.exit_status, 0) << pin.err;
    return true;
  }();
  static_cast<void>(made);
  return folder.path;
}

}  // namespace fault
