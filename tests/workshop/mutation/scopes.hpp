// The functions and classes that a source defines, and where they are.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "workshop/mutation/tokens.hpp"

namespace asperity::mutation {

struct scope {
  std::string name;  ///< qualified: "asperity::output_gate::pass", "asperity::(unnamed)::read_header"
  bool is_class = false;
  std::size_t head = 0;   ///< token that begins its declaration: parameters, initialisers and all
  std::size_t open = 0;   ///< its body's {
  std::size_t close = 0;  ///< its body's }
};

/// In the order of the source. What a function defines inside itself is part of it.
[[nodiscard]] std::vector<scope> scopes_of(const std::vector<token>& tokens);

/// Whether `wanted` is `name`, or its end after a "::".
[[nodiscard]] bool names(const std::string& wanted, const std::string& name);

}  // namespace asperity::mutation
