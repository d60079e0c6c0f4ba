// Inertia of an arm: at its joints, and at its handle.
#pragma once

#include <array>
#include <cstddef>

#include "asperity/core/export.hpp"
#include "asperity/drivers/articulated/serial_chain.hpp"

namespace asperity {

/// Symmetric matrix of joints by joints; entries beyond the chain's size are zero.
using joint_matrix = std::array<joint_vector, most_joints>;

/// Joint-space inertia, kg m^2.
/// @param reflected_kg_m2 inertia of each motor's rotor, seen from the joint
/// @rt safe
[[nodiscard]] ASPERITY_API joint_matrix inertia_of(const serial_chain& chain, const chain_pose& at,
                                                   const joint_vector& reflected_kg_m2 = {}) noexcept;

/// x with M x = b, by Cholesky; false (x untouched) where M is not positive definite.
/// @rt safe: fixed cost
[[nodiscard]] ASPERITY_API bool solve(const joint_matrix& m, std::size_t n, const joint_vector& b,
                                      joint_vector& x) noexcept;

/// Apparent mass and inertia at the handle, no larger than what is felt in any direction at these angles.
struct apparent_inertia {
  double mass_kg = 0.0;
  double inertia_kg_m2 = 0.0;
};
/// Zero where the joint-space inertia is not positive definite (no masses are known).
/// The mass felt along u is 1 / (u^T A u) with A = Jv M^-1 Jv^T, and no eigenvalue of A is larger than its trace.
[[nodiscard]] ASPERITY_API apparent_inertia felt_at_handle(const serial_chain& chain, const chain_pose& at,
                                                           const joint_vector& reflected_kg_m2 = {}) noexcept;

}  // namespace asperity
