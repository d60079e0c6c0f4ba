#include "proof/gate/tools.hpp"

#include <bit>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <regex>
#include <sstream>

namespace asperity::proof {
namespace {

std::string read_file(const std::filesystem::path& path) {
  std::ifstream in(path);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

void write_file(const std::filesystem::path& path, const std::string& text) { std::ofstream(path) << text; }

std::string quoted(const std::filesystem::path& path) { return '\'' + path.string() + '\''; }

bool run(const std::string& command) { return std::system(command.c_str()) == 0; }

std::string run_for_text(const std::string& command) {
  std::string text;
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return text;
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) text += static_cast<char>(c);
  pclose(pipe);
  return text;
}

std::string hex_of(std::uint64_t bits) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(bits));
  return text;
}

// A value as cvc5 writes it: (fp #b0 #b01 #b10), (_ NaN 11 53), (_ +oo 11 53), (_ -zero 11 53), true.
std::optional<std::string> value_of(const std::string& name, const std::string& text) {
  static const std::string bits = R"(\(fp #b([01]) #b([01]{11}) #b([01]{52})\))";
  std::smatch m;
  if (std::regex_search(text, m, std::regex("\\(" + name + ' ' + bits))) {
    return hex_of(std::stoull(m[1].str() + m[2].str() + m[3].str(), nullptr, 2));
  }
  if (std::regex_search(text, m, std::regex("\\(" + name + R"( \(_ (NaN|[+-]oo|[+-]zero) 11 53\))"))) {
    const std::string word = m[1];
    const std::uint64_t sign = word[0] == '-' ? 0x8000000000000000U : 0U;
    if (word == "NaN") return hex_of(0x7ff8000000000000U);
    return hex_of(sign | (word.substr(1) == "oo" ? 0x7ff0000000000000U : 0U));
  }
  if (std::regex_search(text, m, std::regex("\\(" + name + " (true|false)\\)"))) return m[1] == "true" ? "1" : "0";
  return std::nullopt;
}

}  // namespace

std::string hex(double x) { return hex_of(std::bit_cast<std::uint64_t>(x)); }

std::optional<std::string> find_tool(const std::vector<std::string>& names) {
  const char* const path = std::getenv("PATH");
  for (const std::string& name : names) {
    std::istringstream folders(path == nullptr ? "" : path);
    for (std::string folder; std::getline(folders, folder, ':');) {
      std::error_code ignored;
      if (std::filesystem::exists(std::filesystem::path(folder) / name, ignored)) return name;
    }
  }
  return std::nullopt;
}

result<compiled_gate> compile_gate(const std::string& clang, const std::filesystem::path& folder,
                                   const std::vector<change>& changes) {
  const std::filesystem::path source = ASPERITY_SOURCE_DIR;
  std::string header = read_file(source / "include/asperity/device/gate_function.hpp");
  for (const change& c : changes) {
    const std::size_t at = header.find(c.from);
    if (at == std::string::npos || header.find(c.from, at + 1) != std::string::npos) {
      return error{error_code::invalid_argument,
                   "'" + c.from + "' is not in gate_function.hpp exactly once; write the control anew"};
    }
    header.replace(at, c.from.size(), c.to);
  }
  std::filesystem::create_directories(folder / "asperity/device");
  write_file(folder / "asperity/device/gate_function.hpp", header);

  const std::string flags = " -std=c++20 -O1 -ffp-contract=off -fno-math-errno -fno-exceptions -I " + quoted(folder) +
                            " -I " + quoted(source / "include") + ' ' + ASPERITY_GLM_FLAG + ' ';
  const std::filesystem::path entry = source / "tests/proof/gate/gate_entry.cpp";
  if (!run(clang + flags + "-S -emit-llvm -o " + quoted(folder / "gate.ll") + ' ' + quoted(entry)) ||
      !run(clang + flags + "-o " + quoted(folder / "run_gate") + ' ' + quoted(entry) + ' ' +
           quoted(source / "tests/proof/gate/run_gate.cpp"))) {
    return error{error_code::invalid_argument, clang + " does not compile the gate's function; its words are above"};
  }
  return compiled_gate{read_file(folder / "gate.ll"), folder / "run_gate"};
}

verdict ask(const std::string& solver, const std::filesystem::path& folder, const std::string& smt,
            const std::vector<std::string>& inputs, int limit_s) {
  std::string names;
  for (const std::string& name : inputs) names += ' ' + name;
  const std::filesystem::path question = folder / "question.smt2";
  write_file(question, "(set-logic QF_UFFP)\n(set-option :produce-models true)\n" + smt + "(check-sat)\n(get-value (" +
                           names + "))\n");
  const auto begin = std::chrono::steady_clock::now();
  verdict v;
  // Of the processor's time, not of the wall's: a busy machine changes no answer.
  v.text = run_for_text("ulimit -t " + std::to_string(limit_s) + "; exec " + solver + ' ' + quoted(question) + " 2>&1");
  v.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  if (v.text.rfind("unsat", 0) == 0) v.said = answer::proved;
  if (v.text.rfind("sat", 0) == 0) {
    v.said = answer::refuted;
    for (const std::string& name : inputs) {
      if (const auto value = value_of(name, v.text)) v.inputs[name] = *value;
    }
  }
  return v;
}

std::optional<std::array<double, 5>> call(const compiled_gate& gate, const std::vector<std::string>& names,
                                          const std::map<std::string, std::string>& inputs) {
  std::string command = quoted(gate.program);
  for (const std::string& name : names) {
    const auto found = inputs.find(name);
    if (found == inputs.end()) return std::nullopt;
    command += ' ' + found->second;
  }
  std::istringstream lines(run_for_text(command));
  std::array<double, 5> out{};
  for (double& x : out) {
    std::string line;
    if (!std::getline(lines, line)) return std::nullopt;
    x = std::bit_cast<double>(static_cast<std::uint64_t>(std::stoull(line, nullptr, 16)));
  }
  return out;
}

}  // namespace asperity::proof
