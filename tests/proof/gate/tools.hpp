// The compiler and the solver behind prove_gate, each a process of its own.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "asperity/core/status.hpp"

namespace asperity::proof {

/// The first of `names` that PATH holds.
[[nodiscard]] std::optional<std::string> find_tool(const std::vector<std::string>& names);

/// One line of the header that is changed for a negative control.
struct change {
  std::string from;
  std::string to;
};

/// The gate's function as compiled: its IR for the solver, and a program that calls it.
struct compiled_gate {
  std::string ir;
  std::filesystem::path program;
};

/// Compiles the library's function, with `changes` made to a copy of its header, in `folder`.
/// @return an error where a change does not fit its line exactly once, or the compiler fails
[[nodiscard]] result<compiled_gate> compile_gate(const std::string& clang, const std::filesystem::path& folder,
                                                 const std::vector<change>& changes);

enum class answer { proved, refuted, undecided };

/// What the solver said to a question; the values of the inputs where it refuted.
struct verdict {
  answer said = answer::undecided;
  double seconds = 0.0;
  std::map<std::string, std::string> inputs;  ///< 16 hex digits, or 0 or 1
  std::string text;                           ///< all that the solver printed
};

/// Asks whether all that `smt` asserts can be true at once, for at most `limit_s` of processor time. Proved: it cannot.
[[nodiscard]] verdict ask(const std::string& solver, const std::filesystem::path& folder, const std::string& smt,
                          const std::vector<std::string>& inputs, int limit_s);

/// The 64 bits of a double, 16 hex digits.
[[nodiscard]] std::string hex(double x);

/// Calls the compiled function with the inputs that a solver found.
[[nodiscard]] std::optional<std::array<double, 5>> call(const compiled_gate& gate,
                                                        const std::vector<std::string>& names,
                                                        const std::map<std::string, std::string>& inputs);

}  // namespace asperity::proof
