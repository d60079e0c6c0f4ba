// Random choices of a mutator: the same on every machine, whatever the standard library.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>

namespace asperity::hostile {

class random_source {
 public:
  explicit random_source(std::uint64_t seed) : engine_(seed) {}

  /// A number below `count`. @pre count > 0
  [[nodiscard]] std::size_t below(std::size_t count) { return static_cast<std::size_t>(engine_() % count); }
  /// True once in `n` times.
  [[nodiscard]] bool once_in(std::size_t n) { return below(n) == 0; }
  [[nodiscard]] std::uint64_t bits() { return engine_(); }
  template <class List>
  [[nodiscard]] const auto& one_of(const List& list) {
    return list[below(list.size())];
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace asperity::hostile
