// The list of bugs to plant, as it is written in tests/workshop/mutation/catalogue.
//
// A line each, in any order of files; what stands in front of a bug holds until it is said anew:
//
//   room device
//   file include/asperity/device/output_gate.hpp
//   tests hal_test control_test                  quick ones first
//
//   bug gate_forgets_its_torque_limit
//     in output_gate::sane                       a function; "class NAME" for all of a class
//     drop l.continuous_torque_n_m =             what the function has to hold, once
//
// `#` begins a comment where a line begins. See plant.hpp for what can be done to a function.
#pragma once

#include <string>
#include <vector>

#include "asperity/core/status.hpp"

namespace asperity::mutation {

struct edit {
  std::string in;  ///< function or class
  std::string operation;
};

struct bug {
  std::string name;
  std::string room;
  std::string file;  ///< below the root of the sources
  std::vector<std::string> tests;
  std::vector<edit> edits;
};

/// @param where for messages: "FILE:LINE"
/// @return the fault with its line where a line cannot be read, a bug is not whole or a name is taken
[[nodiscard]] result<std::vector<bug>> read_catalogue(const std::string& text, const std::string& where);

/// Every *.txt of a folder, in the order of their names.
[[nodiscard]] result<std::vector<bug>> read_catalogues(const std::string& folder);

}  // namespace asperity::mutation
