// Triangle meshes: from arrays, from files, from formulas.
#include "arrays.hpp"
#include "asperity/io/mesh_file.hpp"
#include "errors.hpp"
#include "long_work.hpp"
#include "model_handle.hpp"
#include "models/benchmark_models.hpp"
#include "parts.hpp"

namespace asperity::python {
namespace {

using indices = py::array_t<std::uint32_t, py::array::c_style | py::array::forcecast>;

// Negative numbers and fractions must not become large indices by a cast.
indices indices_of(py::handle given) {
  constexpr const char* what = "the three vertices of each triangle, counter-clockwise seen from outside";
  const doubles numbers = numbers_of(given, "triangles", {-1, 3}, what);
  indices out({numbers.shape(0), py::ssize_t{3}});
  for (py::ssize_t i = 0; i < numbers.size(); ++i) {
    const double x = numbers.data()[i];
    if (!(x >= 0.0 && x <= 4294967295.0 && x == static_cast<double>(static_cast<std::uint32_t>(x)))) {
      throw py::value_error("triangles holds " + std::string(py::repr(py::float_(x))) +
                            ": give whole numbers from 0, the rows of vertices");
    }
    out.mutable_data()[i] = static_cast<std::uint32_t>(x);
  }
  return out;
}

mesh_handle mesh_of_arrays(const py::object& vertices, const py::object& triangles) {
  const doubles points = numbers_of(vertices, "vertices", {-1, 3}, "x y z of each vertex in metres");
  const indices corners = indices_of(triangles);
  triangle_mesh mesh;
  for (py::ssize_t i = 0; i < points.shape(0); ++i) {
    mesh.positions.emplace_back(points.at(i, 0), points.at(i, 1), points.at(i, 2));
  }
  for (py::ssize_t i = 0; i < corners.shape(0); ++i) {
    mesh.triangles.push_back({corners.at(i, 0), corners.at(i, 1), corners.at(i, 2)});
    for (const std::uint32_t v : mesh.triangles.back()) {
      if (v >= mesh.positions.size()) {
        throw py::value_error("triangle " + std::to_string(i) + " names vertex " + std::to_string(v) +
                              ", and there are " + std::to_string(mesh.positions.size()));
      }
    }
  }
  return mesh_handle::of(std::move(mesh));
}

mesh_handle load(const std::filesystem::path& file, double scale) {
  if (!(scale > 0.0 && std::isfinite(scale)))
    throw py::value_error("scale has to be metres per unit of the file, above 0");
  const auto read = [file, scale](work_monitor& monitor) -> result<mesh_handle> {
    result<triangle_mesh> mesh = io::load_mesh(file, [&] { return monitor.wanted(); });
    if (!mesh) return mesh.error();
    if (scale != 1.0) {
      for (vec3& p : mesh->positions) p *= scale;
    }
    return mesh_handle::of(std::move(*mesh));
  };
  return run_interruptibly<mesh_handle>(read, py::none());
}

models::benchmark benchmark_of(const std::string& name) {
  if (const auto which = models::parse_benchmark(name)) return *which;
  std::string names;
  for (const models::benchmark b : models::all_benchmarks) {
    names += (names.empty() ? "" : ", ") + std::string(models::to_string(b));
  }
  throw py::value_error("there is no benchmark mesh '" + name + "': there are " + names);
}

mesh_handle benchmark_mesh(const std::string& name) {
  const models::benchmark which = benchmark_of(name);
  const py::gil_scoped_release others_may_run;
  return mesh_handle::of(models::make_full(which));
}

py::object benchmark_coarse_mesh(const std::string& name) {
  std::optional<triangle_mesh> mesh = models::make_coarse(benchmark_of(name));
  if (!mesh) return py::none();
  return py::cast(mesh_handle::of(std::move(*mesh)));
}

}  // namespace

void add_meshes(py::module_& m) {
  py::class_<mesh_handle>(m, "Mesh",
                          "A triangle mesh in metres: what a bake begins with. Immutable.\n\n"
                          ">>> corners = [[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]]\n"
                          ">>> asperity.Mesh(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])\n"
                          "Mesh(4 vertices, 4 triangles)\n")
      .def(py::init(&mesh_of_arrays), py::arg("vertices"), py::arg("triangles"),
           "A mesh of arrays, which are copied: vertices (V, 3) in metres, triangles (T, 3) of rows of vertices, "
           "counter-clockwise seen from outside. Raises ValueError for another shape or a row that is not there.")
      .def_property_readonly(
          "vertices",
          [](const py::object& self) {
            const auto& p = self.cast<const mesh_handle&>().inside->positions;
            return view_of(reinterpret_cast<const double*>(p.data()), {static_cast<py::ssize_t>(p.size()), 3},
                           {sizeof(vec3), sizeof(double)}, self);
          },
          "Positions (V, 3) float64, m: a read-only view, nothing is copied.")
      .def_property_readonly(
          "triangles",
          [](const py::object& self) {
            const auto& t = self.cast<const mesh_handle&>().inside->triangles;
            return view_of(reinterpret_cast<const std::uint32_t*>(t.data()), {static_cast<py::ssize_t>(t.size()), 3},
                           {sizeof t[0], sizeof(std::uint32_t)}, self);
          },
          "Vertices of each triangle (T, 3) uint32: a read-only view, nothing is copied.")
      .def("__repr__", [](const mesh_handle& self) {
        return "Mesh(" + std::to_string(self.inside->positions.size()) + " vertices, " +
               std::to_string(self.inside->triangles.size()) + " triangles)";
      });
  m.def("load_mesh", &load, py::arg("file"), py::kw_only(), py::arg("scale") = 1.0,
        "The mesh of a .ply, .obj, .stl, .gltf or .glb file. scale: metres per unit of the file, 0.001 for "
        "millimetres. Raises Error.");
  m.def("benchmark_mesh", &benchmark_mesh, py::arg("name"),
        "A model of the paper's benchmark at full resolution, m: block, gear, hammer, cad_part, file or torus.\n\n"
        ">>> asperity.benchmark_mesh('block').vertices.shape\n"
        "(32770, 3)\n");
  m.def("benchmark_coarse_mesh", &benchmark_coarse_mesh, py::arg("name"),
        "The coarse partner of a benchmark mesh, for block and gear; None for the others.");
}

}  // namespace asperity::python
