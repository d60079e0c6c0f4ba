// The C++ part of the Python package asperity. Its users import the package.
#include "asperity/version.hpp"
#include "parts.hpp"

PYBIND11_MODULE(_asperity, m) {
  py::options without_signatures;
  without_signatures.disable_function_signatures();
  m.doc() = "The C++ part of asperity: import asperity, which has all of it.";
  m.attr("__version__") = ASPERITY_VERSION_STRING;
  asperity::python::add_materials(m);
  asperity::python::add_meshes(m);
  asperity::python::add_models(m);
  asperity::python::add_baking(m);
  asperity::python::add_touches(m);
  asperity::python::add_renderers(m);
  asperity::python::add_scenes(m);
  asperity::python::add_sessions(m);
}
