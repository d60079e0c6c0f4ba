// Errors as values become exceptions of Python.
#pragma once

#include <string>
#include <utility>

#include "asperity/core/status.hpp"
#include "pybind.hpp"

namespace asperity::python {

/// Raises asperity.Error with this code and sentence. @pre the GIL is held
[[noreturn]] void raise(const std::string& code, const std::string& message);
[[noreturn]] inline void raise(const error& why) { raise(to_string(why.code), why.message); }

/// The value, or asperity.Error. @pre the GIL is held
template <class T>
[[nodiscard]] T unwrap(result<T> r) {
  if (!r) raise(r.error());
  return std::move(r).value();
}
inline void unwrap(const result<void>& r) {
  if (!r) raise(r.error());
}

}  // namespace asperity::python
