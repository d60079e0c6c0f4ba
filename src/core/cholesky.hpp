// Cholesky factors of a symmetric positive definite 6x6 matrix.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "asperity/core/spatial.hpp"

namespace asperity {

/// A = L L^T, for one matrix and many right-hand sides. Only the lower triangle of A is read.
/// @rt safe: fixed cost
class cholesky6 {
 public:
  explicit cholesky6(const mat6& a) noexcept {
    for (std::size_t i = 0; i < 6; ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        double s = a(i, j);
        for (std::size_t k = 0; k < j; ++k) s -= l_[i][k] * l_[j][k];
        l_[i][j] = s * inverse_[j];
      }
      double s = a(i, i);
      for (std::size_t k = 0; k < i; ++k) s -= l_[i][k] * l_[i][k];
      if (!(s > 0.0)) return;  // zero, negative or NaN
      inverse_[i] = 1.0 / std::sqrt(s);
    }
    positive_ = true;
  }

  /// Whether A was positive definite. Where it was not, solve() means nothing.
  [[nodiscard]] bool positive() const noexcept { return positive_; }

  /// x with A x = b.
  [[nodiscard]] vec6 solve(const vec6& b) const noexcept {
    std::array<double, 6> y{};
    for (std::size_t i = 0; i < 6; ++i) {
      double s = b[i];
      for (std::size_t k = 0; k < i; ++k) s -= l_[i][k] * y[k];
      y[i] = s * inverse_[i];
    }
    for (std::size_t i = 6; i-- > 0;) {
      double s = y[i];
      for (std::size_t k = i + 1; k < 6; ++k) s -= l_[k][i] * y[k];
      y[i] = s * inverse_[i];
    }
    return {{y[0], y[1], y[2]}, {y[3], y[4], y[5]}};
  }

 private:
  std::array<std::array<double, 6>, 6> l_{};  // below the diagonal
  std::array<double, 6> inverse_{};           // of the diagonal
  bool positive_ = false;
};

}  // namespace asperity
