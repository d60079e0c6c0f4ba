#include "errors.hpp"

namespace asperity::python {

void raise(const std::string& code, const std::string& message) {
  const py::object type = py::module_::import("asperity._errors").attr("Error");
  const py::object made = type(code, message);
  PyErr_SetObject(type.ptr(), made.ptr());
  throw py::error_already_set();
}

}  // namespace asperity::python
