#include "workshop/mutation/trial.hpp"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <regex>
#include <sstream>
#include <sys/wait.h>

#include "workshop/mutation/plant.hpp"

namespace asperity::mutation {
namespace {

namespace fs = std::filesystem;

constexpr int timed_out = 124;  // of timeout(1)
constexpr int killed = 137;

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

std::string filled(std::string command, const workshop& where, const std::string& test) {
  const std::pair<const char*, std::string> names[] = {
      {"{source}", where.source.string()}, {"{build}", where.build.string()}, {"{test}", test}};
  for (const auto& [name, value] : names) {
    const std::string quoted = "'" + value + "'";
    for (std::size_t at = command.find(name); at != std::string::npos; at = command.find(name, at + quoted.size())) {
      command.replace(at, std::string(name).size(), quoted);
    }
  }
  return command;
}

struct run {
  int code = 0;
  std::string output;
};

run run_command(const std::string& command, const fs::path& log, int limit_s) {
  // A mutant may ask for all of the memory there is.
  const std::string line = "ulimit -v 12000000; timeout -k 5 " + std::to_string(limit_s) + " bash -c \"" + command +
                           "\" > '" + log.string() + "' 2>&1";
  const int ended = std::system(line.c_str());
  const result<std::string> output = read_text(log);
  return {WIFEXITED(ended) ? WEXITSTATUS(ended) : killed, output ? *output : std::string()};
}

run build(const workshop& where, const std::string& test) {
  return run_command(filled(where.build_command, where, test), where.build / "mutation-build.log", where.build_limit_s);
}

run run_test(const workshop& where, const std::string& test) {
  const auto own = where.run_limits.find(test);
  return run_command(filled(where.run_command, where, test), where.build / "mutation-run.log",
                     own == where.run_limits.end() ? where.run_limit_s : own->second);
}

// Of GoogleTest's and CTest's output.
std::string how_it_failed(const run& r) {
  std::smatch m;
  if (r.code == timed_out || r.code == killed || r.output.find("***Timeout") != std::string::npos) return "time-out";
  static const std::regex failed(R"(\[  FAILED  \] ([^\s,]+))");
  if (std::regex_search(r.output, m, failed)) return m[1];
  std::string last;
  static const std::regex began(R"(\[ RUN      \] (\S+))");
  for (std::sregex_iterator i(r.output.begin(), r.output.end(), began), end; i != end; ++i) last = (*i)[1];
  static const std::regex crash(R"(\*\*\*Exception: *(\w+))");
  const std::string end = std::regex_search(r.output, m, crash) ? m[1].str() : "exit " + std::to_string(r.code);
  return last.empty() ? end : last + " (" + end + ")";
}

// The compiler's first complaint, else the last line.
std::string why_not_built(const run& r) {
  std::istringstream lines(r.output);
  std::string line;
  std::string last;
  while (std::getline(lines, line)) {
    const std::size_t error = line.find("error: ");
    if (error != std::string::npos) return line.substr(error);
    last = line;
  }
  return last;
}

bool was_not_run(const run& r) {
  return r.output.find("***Not Run") != std::string::npos ||
         r.output.find("No tests were found") != std::string::npos || r.code == 126 || r.code == 127;
}

std::string last_lines(const std::string& text) {
  std::size_t at = text.size();
  for (int i = 0; i < 15 && at != std::string::npos && at > 0; ++i) at = text.rfind('\n', at - 1);
  return at == std::string::npos ? text : text.substr(at);
}

}  // namespace

const char* to_string(verdict v) {
  switch (v) {
    case verdict::caught:
      return "caught";
    case verdict::survived:
      return "SURVIVED";
    case verdict::not_built:
      return "NOT BUILT";
  }
  return "unknown";
}

result<std::string> read_text(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  if (!in) return error{error_code::io_failed, path.string() + ": cannot be read"};
  return text.str();
}

result<void> write_text(const fs::path& path, const std::string& text) {
  std::ofstream out(path, std::ios::binary);
  out << text;
  out.close();
  if (!out) return error{error_code::io_failed, path.string() + ": cannot be written"};
  return {};
}

result<outcome> try_bug(const workshop& where, const bug& what) {
  const fs::path file = where.source / what.file;
  const result<std::string> sound = read_text(file);
  if (!sound) return sound.error();
  const result<std::string> broken = plant(*sound, what);
  if (!broken) return broken.error();

  const double begin = now_s();
  const result<void> written = write_text(file, *broken);
  if (!written) return written.error();
  outcome answer;
  result<void> trouble;
  for (const std::string& test : what.tests) {
    const run built = build(where, test);
    if (built.code != 0) {
      answer = {verdict::not_built, test, why_not_built(built), 0.0};
      break;
    }
    const run r = run_test(where, test);
    if (r.code == 0) continue;
    if (was_not_run(r)) {
      trouble = error{error_code::io_failed, "the test '" + test + "' could not be run:\n" + last_lines(r.output)};
    } else {
      answer = {verdict::caught, test, how_it_failed(r), 0.0};
    }
    break;
  }
  answer.seconds = now_s() - begin;
  const result<void> restored = write_text(file, *sound);
  if (!restored) return restored.error();
  if (!trouble) return trouble.error();
  return answer;
}

result<double> try_sound(const workshop& where, const std::string& test) {
  const run built = build(where, test);
  if (built.code != 0) {
    return error{error_code::io_failed, "'" + test + "' cannot be built without a bug:\n" + last_lines(built.output)};
  }
  const double begin = now_s();
  const run r = run_test(where, test);
  if (r.code != 0) {
    return error{error_code::io_failed, "'" + test + "' fails without a bug:\n" + last_lines(r.output)};
  }
  return now_s() - begin;
}

}  // namespace asperity::mutation
