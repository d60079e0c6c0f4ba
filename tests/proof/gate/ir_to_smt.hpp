// Straight-line LLVM IR of doubles and truth values, written down for an SMT solver.
#pragma once

#include <string>
#include <vector>

#include "asperity/core/status.hpp"

namespace asperity::proof {

struct translation {
  std::string smt;        ///< declarations and definitions, SMT-LIB 2, logic QF_FP
  std::size_t lines = 0;  ///< of IR that were translated
  std::size_t cuts = 0;   ///< values that were cut
};

enum class cut {
  nothing,
  before_outputs,       ///< what a final select lets through; an output that is not a select is left as it is
  quotients_and_roots,  ///< the result of every division and square root
};

/// Translates the one function of `ir`: doubles and i1 in, results stored through its last argument, a double*.
/// Argument i is called inputs[i], what is stored at element i outputs[i]. Every operation becomes its IEEE 754
/// counterpart in binary64, rounded to nearest even, as LLVM defines it without fast-math flags.
///
/// What is cut is any double whatever: the solver has to prove the property for more behaviours than the function has,
/// and sees less of it.
/// @return an error for every instruction that is not understood: nothing is skipped
[[nodiscard]] result<translation> to_smt(const std::string& ir, const std::vector<std::string>& inputs,
                                         const std::vector<std::string>& outputs, cut what);

/// The literal of a double, bit for bit.
[[nodiscard]] std::string smt_literal(double x);

}  // namespace asperity::proof
