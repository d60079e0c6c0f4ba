// numpy arrays at the module's border: poses in, wrenches out, views of memory that a model owns.
#pragma once

#include <string>
#include <vector>

#include "asperity/core/pose.hpp"
#include "asperity/core/spatial.hpp"
#include "asperity/core/status.hpp"
#include "pybind.hpp"

namespace asperity::python {

using doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// "(3, 4)", as numpy writes a shape.
[[nodiscard]] std::string shape_text(const py::array& a);

/// Numbers of that shape; -1 stands for any extent.
/// @param what named in the message: argument, shape, meaning and unit
/// Raises ValueError for another shape, TypeError for what is not numbers.
[[nodiscard]] doubles numbers_of(py::handle given, const char* name, const std::vector<py::ssize_t>& shape,
                                 const char* what);

/// Seven numbers x y z qx qy qz qw as a pose, its rotation of length 1 to the last digit.
/// @return invalid_argument (not finite, or a quaternion that is not of unit length within 1e-6)
/// @param where which pose it is, for the message
[[nodiscard]] result<pose> pose_from(const double* seven, const std::string& where);

/// One pose, shape (7,). Raises ValueError or asperity.Error.
[[nodiscard]] pose pose_of(py::handle given, const char* name);
/// Poses, shape (N, 7). Raises ValueError or asperity.Error.
[[nodiscard]] std::vector<pose> poses_of(py::handle given, const char* name);

/// Writes a pose as seven numbers, x y z qx qy qz qw.
void put(const pose& T, double* seven) noexcept;

[[nodiscard]] py::array_t<double> to_array(const vec3& v);
[[nodiscard]] py::array_t<double> to_array(const wrench& w);
[[nodiscard]] py::array_t<double> to_array(const vec6& v);
[[nodiscard]] py::array_t<double> to_array(const pose& T);
[[nodiscard]] py::array_t<double> to_array(const mat3& m);
[[nodiscard]] py::array_t<double> to_array(const mat6& m);

/// A read-only array over memory that `owner` keeps alive; nothing is copied.
template <class T>
[[nodiscard]] py::array_t<T> view_of(const T* data, std::vector<py::ssize_t> shape, std::vector<py::ssize_t> strides,
                                     py::handle owner) {
  py::array_t<T> out(std::move(shape), std::move(strides), data, owner);
  py::detail::array_proxy(out.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return out;
}

}  // namespace asperity::python
