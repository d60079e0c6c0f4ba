#include "asperity/drivers/articulated/chain_inertia.hpp"

#include <cmath>
#include <cstddef>

namespace asperity {

joint_matrix inertia_of(const serial_chain& chain, const chain_pose& at, const joint_vector& reflected_kg_m2) noexcept {
  joint_matrix m{};
  const std::size_t n = chain.joints.size();
  for (std::size_t k = 0; k < n; ++k) {
    const link_mass& l = chain.joints[k].link;
    const vec3 centre_d = at.T_dl[k] * l.centre;
    const mat3 r = glm::mat3_cast(at.T_dl[k].rotation);
    const mat3 inertia_d = r * l.inertia_kg_m2 * glm::transpose(r);
    for (std::size_t i = 0; i <= k; ++i) {
      const vec3 vi = glm::cross(at.axis_d[i], centre_d - at.T_dl[i].position);
      for (std::size_t j = 0; j <= i; ++j) {
        const vec3 vj = glm::cross(at.axis_d[j], centre_d - at.T_dl[j].position);
        m[i][j] += l.mass_kg * glm::dot(vi, vj) + glm::dot(at.axis_d[i], inertia_d * at.axis_d[j]);
      }
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    m[i][i] += reflected_kg_m2[i];
    for (std::size_t j = 0; j < i; ++j) m[j][i] = m[i][j];
  }
  return m;
}

bool solve(const joint_matrix& m, std::size_t n, const joint_vector& b, joint_vector& x) noexcept {
  joint_matrix l{};
  for (std::size_t j = 0; j < n; ++j) {
    double d = m[j][j];
    for (std::size_t k = 0; k < j; ++k) d -= l[j][k] * l[j][k];
    if (!(d > 0.0)) return false;
    l[j][j] = std::sqrt(d);
    for (std::size_t i = j + 1; i < n; ++i) {
      double s = m[i][j];
      for (std::size_t k = 0; k < j; ++k) s -= l[i][k] * l[j][k];
      l[i][j] = s / l[j][j];
    }
  }
  joint_vector y{};
  for (std::size_t i = 0; i < n; ++i) {
    double s = b[i];
    for (std::size_t k = 0; k < i; ++k) s -= l[i][k] * y[k];
    y[i] = s / l[i][i];
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t k = i + 1; k < n; ++k) y[i] -= l[k][i] * y[k];
    y[i] /= l[i][i];
  }
  x = y;
  return true;
}

apparent_inertia felt_at_handle(const serial_chain& chain, const chain_pose& at,
                                const joint_vector& reflected_kg_m2) noexcept {
  const std::size_t n = chain.joints.size();
  const joint_matrix m = inertia_of(chain, at, reflected_kg_m2);
  double linear = 0.0;
  double angular = 0.0;
  for (std::size_t axis = 0; axis < 6; ++axis) {
    joint_vector row{};
    for (std::size_t i = 0; i < n; ++i) row[i] = jacobian_column(at, i)[axis];
    joint_vector x{};
    if (!solve(m, n, row, x)) return {};
    double a = 0.0;
    for (std::size_t i = 0; i < n; ++i) a += row[i] * x[i];
    (axis < 3 ? linear : angular) += a;
  }
  return {linear > 0.0 ? 1.0 / linear : 0.0, angular > 0.0 ? 1.0 / angular : 0.0};
}

}  // namespace asperity
