#include "arrays.hpp"

#include <algorithm>
#include <cmath>

#include "errors.hpp"

namespace asperity::python {
namespace {

constexpr const char* pose_words = "x y z in metres, then qx qy qz qw of a unit quaternion";

py::array_t<double> six(const vec3& a, const vec3& b) {
  py::array_t<double> out(6);
  double* const to = out.mutable_data();
  for (int i = 0; i < 3; ++i) {
    to[i] = a[i];
    to[i + 3] = b[i];
  }
  return out;
}

std::string shape_text(const std::vector<py::ssize_t>& shape) {
  std::string out = "(";
  for (std::size_t i = 0; i < shape.size(); ++i) {
    out += (i > 0 ? ", " : "") + (shape[i] < 0 ? std::string("N") : std::to_string(shape[i]));
  }
  return out + (shape.size() == 1 ? ",)" : ")");
}

bool fits(const py::array& a, const std::vector<py::ssize_t>& shape) {
  if (static_cast<std::size_t>(a.ndim()) != shape.size()) return false;
  for (std::size_t i = 0; i < shape.size(); ++i) {
    if (shape[i] >= 0 && a.shape(static_cast<py::ssize_t>(i)) != shape[i]) return false;
  }
  return true;
}

}  // namespace

std::string shape_text(const py::array& a) {
  return shape_text(std::vector<py::ssize_t>(a.shape(), a.shape() + a.ndim()));
}

doubles numbers_of(py::handle given, const char* name, const std::vector<py::ssize_t>& shape, const char* what) {
  doubles out = doubles::ensure(given);
  if (!out) {
    PyErr_Clear();
    throw py::type_error(std::string(name) + " is no array of numbers (" + Py_TYPE(given.ptr())->tp_name +
                         "): give shape " + shape_text(shape) + ", " + what);
  }
  if (!fits(out, shape)) {
    throw py::value_error(std::string(name) + " has shape " + shape_text(out) + ": give shape " + shape_text(shape) +
                          ", " + what);
  }
  return out;
}

result<pose> pose_from(const double* seven, const std::string& where) {
  if (!std::all_of(seven, seven + 7, [](double x) { return std::isfinite(x); })) {
    return error{error_code::invalid_argument, where + " holds NaN or infinity: every number of a pose must be finite"};
  }
  pose T{quat_from_xyzw({seven[3], seven[4], seven[5], seven[6]}), {seven[0], seven[1], seven[2]}};
  if (!is_valid(T)) {
    return error{error_code::invalid_argument, where + " has a quaternion of length " +
                                                   std::to_string(glm::length(T.rotation)) +
                                                   " where 1 is needed (order x y z w): divide it by its length"};
  }
  T.rotation = glm::normalize(T.rotation);
  return T;
}

pose pose_of(py::handle given, const char* name) {
  static const std::vector<py::ssize_t> shape{7};
  return unwrap(pose_from(numbers_of(given, name, shape, pose_words).data(), name));
}

std::vector<pose> poses_of(py::handle given, const char* name) {
  const doubles rows = numbers_of(given, name, {-1, 7}, pose_words);
  std::vector<pose> out;
  out.reserve(static_cast<std::size_t>(rows.shape(0)));
  for (py::ssize_t i = 0; i < rows.shape(0); ++i) {
    result<pose> T = pose_from(rows.data() + 7 * i, name);
    if (!T) raise(to_string(T.error().code), "row " + std::to_string(i) + " of " + T.error().message);
    out.push_back(*T);
  }
  return out;
}

py::array_t<double> to_array(const vec3& v) {
  py::array_t<double> out(3);
  for (int i = 0; i < 3; ++i) out.mutable_data()[i] = v[i];
  return out;
}

py::array_t<double> to_array(const wrench& w) { return six(w.force, w.torque); }
py::array_t<double> to_array(const vec6& v) { return six(v.linear, v.angular); }

void put(const pose& T, double* seven) noexcept {
  const auto q = to_xyzw(T.rotation);
  for (int i = 0; i < 3; ++i) seven[i] = T.position[i];
  std::copy(q.begin(), q.end(), seven + 3);
}

py::array_t<double> to_array(const pose& T) {
  py::array_t<double> out(7);
  put(T, out.mutable_data());
  return out;
}

py::array_t<double> to_array(const mat3& m) {
  py::array_t<double> out({3, 3});
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) out.mutable_at(i, j) = m[j][i];
  }
  return out;
}

py::array_t<double> to_array(const mat6& m) {
  py::array_t<double> out({6, 6});
  std::copy(m.m.begin(), m.m.end(), out.mutable_data());
  return out;
}

}  // namespace asperity::python
