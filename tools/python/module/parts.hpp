// The parts of the module, each in the file of its name.
#pragma once

#include "pybind.hpp"

namespace asperity::python {

void add_materials(py::module_& m);
void add_meshes(py::module_& m);
void add_models(py::module_& m);
void add_baking(py::module_& m);
void add_touches(py::module_& m);
void add_renderers(py::module_& m);
void add_scenes(py::module_& m);
void add_sessions(py::module_& m);

}  // namespace asperity::python
