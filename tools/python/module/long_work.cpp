#include "long_work.hpp"

namespace asperity::python {

std::optional<py::error_already_set> look_after(work_monitor& monitor, const py::object& progress) {
  try {
    for (const auto& [stage, done] : monitor.take()) {
      if (progress.is_none()) break;
      const py::object answer = progress(stage, done);
      if (answer.ptr() == Py_False) monitor.stop();
    }
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  } catch (const py::error_already_set& e) {
    return e;
  }
  return std::nullopt;
}

}  // namespace asperity::python
