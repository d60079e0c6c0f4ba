// Textured models: files, views, what is known of them.
#include "arrays.hpp"
#include "asperity/field/field_body.hpp"
#include "asperity/io/textured_model_file.hpp"
#include "errors.hpp"
#include "long_work.hpp"
#include "model_handle.hpp"
#include "parts.hpp"

namespace asperity::python {
namespace {

model_handle load_model(const std::filesystem::path& file) {
  const auto read = [file](work_monitor& monitor) -> result<model_handle> {
    result<textured_model> model = io::load_textured_model(file, [&] { return monitor.wanted(); });
    if (!model) return model.error();
    return model_handle::of(std::move(*model));
  };
  return run_interruptibly<model_handle>(read, py::none());
}

void save_model(const model_handle& self, const std::filesystem::path& file) {
  result<void> saved;
  {
    const py::gil_scoped_release others_may_run;
    saved = io::save_textured_model(*self.inside, file);
  }
  unwrap(saved);
}

model_handle with_material(const model_handle& self, const std::optional<material>& surface) {
  textured_model copy = *self.inside;
  copy.surface = surface;
  copy.surface_map = {};
  return model_handle::of(std::move(copy));
}

py::ssize_t size_of(const auto& list) { return static_cast<py::ssize_t>(list.size()); }

py::object vertices(const py::object& self) {
  const auto& p = self.cast<const model_handle&>().inside->mesh.positions;
  return view_of(reinterpret_cast<const double*>(p.data()), {size_of(p), 3}, {sizeof(vec3), sizeof(double)}, self);
}

py::object triangles(const py::object& self) {
  const auto& t = self.cast<const model_handle&>().inside->mesh.triangles;
  return view_of(t.empty() ? nullptr : t.front().vertex.data(), {size_of(t), 3},
                 {sizeof(coarse_triangle), sizeof(std::uint32_t)}, self);
}

py::object uvs(const py::object& self) {
  const auto& t = self.cast<const model_handle&>().inside->mesh.triangles;
  return view_of(t.empty() ? nullptr : &t.front().uv.front().x, {size_of(t), 3, 2},
                 {sizeof(coarse_triangle), sizeof(vec2), sizeof(double)}, self);
}

py::object texels(const py::object& self) {
  const haptic_texture& t = self.cast<const model_handle&>().inside->texture;
  constexpr auto texel = static_cast<py::ssize_t>(sizeof(glm::vec3));
  return view_of(t.texels.empty() ? nullptr : &t.texels.front().x, {t.height, t.width, 3},
                 {texel * t.width, texel, sizeof(float)}, self);
}

py::dict spread(const length_spread& s) {
  return py::dict(py::arg("p50") = s.median_m, py::arg("p99") = s.p99_m, py::arg("max") = s.max_m);
}

py::dict spread(const length_spread& s, double rms_m) {
  py::dict out = spread(s);
  out["rms"] = rms_m;
  return out;
}

// The numbers of `asperity inspect --json`, under its keys.
py::dict inspect(const model_handle& self) {
  const textured_model& model = *self.inside;
  const bake_report& r = model.report;
  std::size_t flat = 0;
  for (const convex_piece& p : model.pieces) flat += p.flat ? 1U : 0U;
  py::dict bake(py::arg("rms_error") = r.rms_error_m, py::arg("max_error") = r.max_error_m,
                py::arg("peak_to_valley") = r.peak_to_valley_m, py::arg("max_displacement") = r.max_displacement_m);
  py::dict texture(py::arg("width") = model.texture.width, py::arg("height") = model.texture.height,
                   py::arg("texels") = r.texels, py::arg("fallback_texels") = r.fallback_texels);
  py::dict pieces(py::arg("count") = model.pieces.size(), py::arg("flat") = flat);
  if (r.quality) {
    bake["to_original"] = spread(r.quality->to_original, r.quality->to_original_rms_m);
    bake["to_textured"] = spread(r.quality->to_textured, r.quality->to_textured_rms_m);
    bake["crack"] = r.quality->crack_max_m;
    texture["texel"] = r.quality->texel_m;
    texture["utilisation"] = r.quality->atlas_utilisation;
    texture["spacing"] = spread(r.quality->texel_spacing);
    pieces["surface_to_hull"] = r.quality->surface_to_hull_max_m;
    pieces["bridged_air"] = r.quality->bridged_air_max_m;
  }
  const auto list = [](const vec3& v) { return std::vector<double>{v.x, v.y, v.z}; };
  py::dict out;
  out["name"] = model.name;
  out["full_triangles"] = r.full_triangles;
  out["coarse"] =
      py::dict(py::arg("vertices") = model.mesh.positions.size(), py::arg("triangles") = model.mesh.triangles.size());
  out["pieces"] = pieces;
  out["texture"] = texture;
  out["size"] = py::dict(py::arg("low") = list(model.box.low), py::arg("high") = list(model.box.high),
                         py::arg("diagonal") = model.box.diagonal());
  std::vector<double> inertia;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) inertia.push_back(model.mass.inertia_per_mass[j][i]);
  }
  out["mass_properties"] =
      py::dict(py::arg("volume") = model.mass.volume_m3, py::arg("centre_of_mass") = list(model.mass.centre_of_mass),
               py::arg("inertia_per_mass") = inertia);
  out["bake"] = bake;
  out["memory"] = memory_bytes(model);
  return out;
}

}  // namespace

void add_models(py::module_& m) {
  py::class_<model_handle>(m, "Model",
                           "A textured model: coarse mesh, haptic texture, convex pieces. Immutable; renderers and "
                           "arrays share it and keep it alive. Body frame, metres.\n\n"
                           ">>> probe\n"
                           "Model('block', 16 triangles, texture 256 x 256)\n"
                           ">>> probe.high, probe.texels.shape\n"
                           "(array([0.02 , 0.019, 0.01 ]), (256, 256, 3))\n")
      .def("save", &save_model, py::arg("file"), "Writes a .glb, which appears whole or not at all. Raises Error.")
      .def("inspect", &inspect,
           "What is known of the model, SI: size, mass properties, and what the bake measured, under the keys of "
           "`asperity inspect --json`.")
      .def("with_material", &with_material, py::arg("material"),
           "The same model with another Material all over, or None.\n\n"
           ">>> probe.with_material(asperity.Material.preset('steel')).material.name\n"
           "'steel'\n")
      .def_property_readonly(
          "name", [](const model_handle& self) { return self.inside->name; }, "Its name.")
      .def_property_readonly(
          "material", [](const model_handle& self) { return self.inside->surface; },
          "Its Material, of a model with several the first; None where nobody said.")
      .def_property_readonly("vertices", &vertices,
                             "Vertices of the coarse mesh (V, 3) float64, m: a read-only view, nothing is copied.")
      .def_property_readonly("triangles", &triangles,
                             "Coarse triangles (T, 3) uint32, rows of vertices: a read-only view, nothing is copied.")
      .def_property_readonly(
          "uvs", &uvs,
          "Texture coordinates of the triangles' corners (T, 3, 2) float64, from 0 to 1: a read-only view.")
      .def_property_readonly("texels", &texels,
                             "The haptic texture (H, W, 3) float32: points of the fine surface, m, NaN where there is "
                             "none; the row of v = 0 first. A read-only view, nothing is copied.")
      .def_property_readonly(
          "low", [](const model_handle& self) { return to_array(self.inside->box.low); },
          "Lower corner of the coarse mesh's box (3,), m.")
      .def_property_readonly(
          "high", [](const model_handle& self) { return to_array(self.inside->box.high); },
          "Upper corner of the coarse mesh's box (3,), m.")
      .def_property_readonly(
          "diagonal_m", [](const model_handle& self) { return self.inside->box.diagonal(); },
          "Diagonal of the coarse mesh's box, m.")
      .def_property_readonly(
          "volume_m3", [](const model_handle& self) { return self.inside->mass.volume_m3; },
          "Volume of the coarse mesh, m^3.")
      .def_property_readonly(
          "centre_of_mass", [](const model_handle& self) { return to_array(self.inside->mass.centre_of_mass); },
          "Centre of mass of a body of uniform density (3,), m.")
      .def_property_readonly(
          "inertia_per_mass_m2", [](const model_handle& self) { return to_array(self.inside->mass.inertia_per_mass); },
          "Inertia about the centre of mass by the mass (3, 3), m^2.")
      .def_property_readonly(
          "peak_to_valley_m", [](const model_handle& self) { return self.inside->report.peak_to_valley_m; },
          "Height of the relief along the coarse mesh's normals, m.")
      .def_property_readonly(
          "has_field", [](const model_handle& self) { return self.inside->field != nullptr; },
          "Whether the model keeps its depth field; without one each renderer makes it.")
      .def("__repr__", [](const model_handle& self) {
        return "Model('" + self.inside->name + "', " + std::to_string(self.inside->mesh.triangles.size()) +
               " triangles, texture " + std::to_string(self.inside->texture.width) + " x " +
               std::to_string(self.inside->texture.height) + ")";
      });
  m.def("load", &load_model, py::arg("file"),
        "The textured model of a .glb file. Raises Error.\n\n"
        ">>> asperity.load('gear.glb').name\n"
        "'gear'\n");
}

}  // namespace asperity::python
