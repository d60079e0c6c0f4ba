// pybind11 as every file of the module includes it. Functions are documented in the .pyi file's terms: no signatures of
// C++ in docstrings.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

namespace py = pybind11;
