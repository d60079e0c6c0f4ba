// Several bodies and the planes between them in one implicit step: contact_solver's problem for more than one body.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "asperity/core/spatial.hpp"

namespace asperity::detail {

/// The place of a body that nothing moves.
inline constexpr std::uint32_t unmoved = std::numeric_limits<std::uint32_t>::max();

/// A plane between the body at place a and that at place b.
struct joint_plane {
  std::uint32_t a = 0, b = unmoved;
  vec6 gradient_a{}, gradient_b{};  ///< of the depth by the motion of each about its centre of mass, world axes
  double depth_m = 0.0;             ///< at the beginning of the step
  double stiffness_n_per_m = 0.0;
  double horizon_s = 0.0;  ///< as in solve_contact(): the step and what the contact dissipates
  double lambda_n = 0.0;   ///< of the solution
};

/// A spring between the motions of two bodies, as that of a bristle: on a it does -matrix (stretch + horizon_s slide) about
/// a's centre, slide being the velocity of a at the step's end less that of the point of b which is there. Either may be
/// unmoved.
struct joint_spring {
  std::uint32_t a = 0, b = unmoved;
  mat6 matrix{};
  vec6 stretch{};
  double horizon_s = 0.0;
  vec3 arm_w{0.0};  ///< from b's centre to a's, m
};

/// Velocity of the point of a body that is `arm_w` from its centre, and of the body. @rt safe
[[nodiscard]] inline vec6 seen_from(const vec6& velocity, const vec3& arm_w) noexcept {
  return {velocity.linear + glm::cross(velocity.angular, arm_w), velocity.angular};
}

struct joint_answer {
  bool solved = false;      ///< false: the matrix is not positive definite, and velocities mean nothing
  int passes = 0;           ///< of Newton's method
  double residual_n = 0.0;  ///< largest force that is out of balance in a plane, N
};

/// Velocities v and forces lambda at the end of a step, with
///   A_i (v_i - v0_i) = load_i - sum lambda g - springs,   lambda = k max(0, d + h (g_a . v_a + g_b . v_b)).
/// They are where a convex function of all velocities is least; Newton's method with an exact line search finds it, as
/// in solve_contact(). The matrix is factorised within its profile, so bodies that touch should have places close to
/// each other.
class joint_solver {
 public:
  /// Takes the memory. @param bodies, planes that a step may have at most
  joint_solver(std::size_t bodies, std::size_t planes);

  /// @param a      of each body, symmetric positive definite
  /// @param planes their lambda is set
  /// @param v      the answer
  /// @pre as many bodies and planes as there is memory for
  /// @rt safe
  [[nodiscard]] joint_answer solve(std::span<const mat6> a, std::span<const vec6> load, std::span<const vec6> v0,
                                   std::span<joint_plane> planes, std::span<const joint_spring> springs,
                                   std::span<vec6> v) noexcept;

  [[nodiscard]] std::size_t heap_bytes() const noexcept;

 private:
  struct turn {
    double at = 0.0;
    double slope = 0.0, rate = 0.0;  // what the plane adds from there on
  };

  // Where the rows of each body begin.
  void find_profile(std::span<const joint_plane> planes, std::span<const joint_spring> springs) noexcept;
  void add_block(std::vector<double>& to, std::uint32_t row, std::uint32_t col, const mat6& m) const noexcept;
  void add_plane(const joint_plane& p, double s) noexcept;
  [[nodiscard]] bool factorise() noexcept;
  void back_substitute() noexcept;
  // Where along the step the potential is least.
  [[nodiscard]] double least_along(std::span<const joint_plane> planes, double slope, double rate) noexcept;

  std::size_t bodies_ = 0, rows_ = 0;
  std::vector<std::uint32_t> first_;        // of each body: the place of the first that its rows meet
  std::vector<double> base_, factors_;      // lower triangles, rows_ x rows_
  std::vector<double> step_;                // rows_
  std::vector<double> imbalance_;           // A (v - v0) - load, springs included ...
  std::vector<double> change_of_;           // ... and what the step changes of it
  std::vector<double> depth_m_, change_m_;  // of each plane
  std::vector<turn> turns_;
};

}  // namespace asperity::detail
