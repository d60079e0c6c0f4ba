// Bytes of files that tests write themselves.
#pragma once

#include <cstddef>
#include <string>

namespace asperity::test_support {

/// `what`, one after the other `times` times.
[[nodiscard]] inline std::string repeated(const std::string& what, std::size_t times) {
  std::string out;
  out.reserve(what.size() * times);
  for (std::size_t i = 0; i < times; ++i) out += what;
  return out;
}

/// Appends the bytes of a number as this machine has them.
template <class T>
void put(std::string& to, T value) {
  to.append(reinterpret_cast<const char*>(&value), sizeof value);
}

}  // namespace asperity::test_support
