// What surfaces are like to touch.
#include "asperity/model/material.hpp"
#include "errors.hpp"
#include "parts.hpp"

namespace asperity::python {
namespace {

friction_combine combine_of(const std::string& name) {
  for (const auto mode :
       {friction_combine::average, friction_combine::minimum, friction_combine::maximum, friction_combine::multiply}) {
    if (name == to_string(mode)) return mode;
  }
  throw py::value_error("combine is '" + name + "': give average, minimum, maximum or multiply");
}

material made_material(const std::string& name, double stiffness_n_per_m, double dissipation_s_per_m,
                       double static_friction, double dynamic_friction, const std::string& combine) {
  material m{name, stiffness_n_per_m, dissipation_s_per_m, static_friction, dynamic_friction, combine_of(combine)};
  unwrap(check(m));
  return m;
}

std::string repr(const material& m) {
  return "Material('" + m.name + "', stiffness_n_per_m=" + std::string(py::repr(py::float_(m.stiffness_n_per_m))) +
         ", static_friction=" + std::string(py::repr(py::float_(m.static_friction))) + ")";
}

}  // namespace

void add_materials(py::module_& m) {
  py::class_<material>(
      m, "Material",
      "What a surface is like to touch. Immutable. Felt through support planes: "
      "Renderer(formulation='planes') and sessions.\n\n"
      ">>> asperity.Material('felt', stiffness_n_per_m=2e4, static_friction=0.6, dynamic_friction=0.4)\n"
      "Material('felt', stiffness_n_per_m=20000.0, static_friction=0.6)\n")
      .def(py::init(&made_material), py::arg("name") = "", py::kw_only(), py::arg("stiffness_n_per_m") = 4e5,
           py::arg("dissipation_s_per_m") = 5.0, py::arg("static_friction") = 0.0, py::arg("dynamic_friction") = 0.0,
           py::arg("combine") = "average",
           "A material: stiffness of each point that presses (N/m), Hunt and Crossley's dissipation (s/m), and "
           "coefficients of friction, the dynamic one at most the static one. Raises Error for one out of range.")
      .def_static(
          "preset", [](const std::string& name) { return unwrap(preset_material(name)); }, py::arg("name"),
          "The material of that name: steel, wood, rubber or ice. Raises Error for another name.\n\n"
          ">>> asperity.Material.preset('rubber').stiffness_n_per_m\n"
          "3000.0\n")
      .def_readonly("name", &material::name, "Its name, for people.")
      .def_readonly("stiffness_n_per_m", &material::stiffness_n_per_m,
                    "Stiffness of each point that presses, were the other body rigid, N/m.")
      .def_readonly("dissipation_s_per_m", &material::dissipation_s_per_m,
                    "Dissipation of Hunt and Crossley, s/m: a slow blow of speed v comes back with 1 - alpha v.")
      .def_readonly("static_friction", &material::static_friction, "Coefficient of friction of a contact that sticks.")
      .def_readonly("dynamic_friction", &material::dynamic_friction, "Coefficient of friction of a contact that slips.")
      .def_property_readonly(
          "combine", [](const material& self) { return to_string(self.combine); },
          "How the coefficients of two surfaces become one: average, minimum, maximum or multiply.")
      .def("__repr__", &repr);
}

}  // namespace asperity::python
