// What a query answers: contacts, planes, the wrench and its parts, copied out of a tick.
#include "touches.hpp"

#include "arrays.hpp"
#include "parts.hpp"

namespace asperity::python {

touch touch_of(const tick& found, status answered) {
  touch out;
  out.on_probe_w = found.force.on_probe_w;
  out.stiffness = found.force.stiffness;
  out.centre_of_mass_w = found.centre_of_mass_w;
  out.on_body.assign(found.on_body.begin(), found.on_body.end());
  out.planes.assign(found.planes.begin(), found.planes.end());
  out.dropped_contacts = found.dropped_contacts;
  out.answered = answered;
  for (std::size_t i = 0; i < found.contacts.size(); ++i) {
    touch_contact c{found.contacts[i], found.depths[i], std::nullopt};
    if (i < found.by_contact.size()) c.on_probe_w = found.by_contact[i];
    out.contacts.push_back(c);
  }
  return out;
}

namespace {

py::object bodies_of(const touch& self) {
  if (self.on_body.empty()) return py::none();
  py::array_t<double> out({static_cast<py::ssize_t>(self.on_body.size()), py::ssize_t{6}});
  for (std::size_t i = 0; i < self.on_body.size(); ++i) {
    const vec6 w = to_vec6(self.on_body[i]);
    for (std::size_t k = 0; k < 6; ++k) out.mutable_at(i, k) = w[k];
  }
  return out;
}

void add_contact(py::module_& m) {
  py::class_<touch_contact>(m, "Contact", "One contact of a Touch, world axes, SI.")
      .def_property_readonly(
          "body", [](const touch_contact& c) { return c.where.body; }, "Number of the fixed body that is touched.")
      .def_property_readonly(
          "depth_m", [](const touch_contact& c) { return c.deep.depth_m; },
          "Directional penetration depth, m; below 0 a gap.")
      .def_property_readonly(
          "separation_m", [](const touch_contact& c) { return c.where.separation_m; },
          "Distance of the coarse surfaces along the normal, m; below 0 where they overlap.")
      .def_property_readonly(
          "normal", [](const touch_contact& c) { return to_array(c.where.window.n_ab_w); },
          "Direction n_ab of the contact (3,): unit, from the probe to the body.")
      .def_property_readonly(
          "point", [](const touch_contact& c) { return to_array(c.deep.witness_w); },
          "The deepest point of the probe's fine surface (3,), m.")
      .def_property_readonly(
          "on_probe", [](const touch_contact& c) { return to_array(c.where.p_a_w); },
          "Witness point on the probe's coarse surface (3,), m.")
      .def_property_readonly(
          "on_fixed", [](const touch_contact& c) { return to_array(c.where.p_b_w); },
          "Witness point on the fixed body's coarse surface (3,), m.")
      .def_property_readonly(
          "gradient", [](const touch_contact& c) { return to_array(c.deep.gradient); },
          "Gradient of the depth by the probe's motion about its centre of mass (6,), m/m and m/rad.")
      .def_property_readonly(
          "half_size_m", [](const touch_contact& c) { return c.where.window.half_size_m; },
          "Half the side of the contact's window, m; 0 for formulations without windows.")
      .def_property_readonly(
          "wrench",
          [](const touch_contact& c) { return c.on_probe_w ? py::object(to_array(*c.on_probe_w)) : py::none(); },
          "What this contact does to the probe (6,), N and N m, about its centre of mass; None where not known.")
      .def("__repr__", [](const touch_contact& c) {
        return "Contact(body=" + std::to_string(c.where.body) +
               ", depth_m=" + std::string(py::repr(py::float_(c.deep.depth_m))) + ")";
      });
}

void add_plane(py::module_& m) {
  py::class_<support_plane>(m, "Plane",
                            "A support plane of a Touch: the body's surface near the probe. World axes, SI.")
      .def_readonly("body", &support_plane::body, "Number of the fixed body.")
      .def_readonly("depth_m", &support_plane::depth_m, "Directional penetration depth, m; below 0 a gap.")
      .def_property_readonly(
          "normal", [](const support_plane& p) { return to_array(p.n_ab_w); },
          "Direction n_ab (3,): unit, from the probe to the body.")
      .def_property_readonly(
          "arm", [](const support_plane& p) { return to_array(p.r_w); },
          "From the probe's centre of mass to the point that the plane stands for (3,), m.")
      .def_property_readonly(
          "gradient", [](const support_plane& p) { return to_array(p.gradient); },
          "Gradient of the depth by the probe's motion about its centre of mass (6,), m/m and m/rad.")
      .def("__repr__", [](const support_plane& p) {
        return "Plane(body=" + std::to_string(p.body) + ", depth_m=" + std::string(py::repr(py::float_(p.depth_m))) +
               ")";
      });
}

}  // namespace

void add_touches(py::module_& m) {
  add_contact(m);
  add_plane(m);
  py::class_<touch>(m, "Touch",
                    "What a renderer found at one pose of the probe. World axes, SI.\n\n"
                    ">>> touch = renderer.query([0, 0, z, 0, 0, 0, 1])\n"
                    ">>> len(touch.contacts), touch.contacts[0].body, touch.complete\n"
                    "(1, 0, True)\n"
                    ">>> print(touch.contacts[0].normal)  # n_ab: down, from the block to the gear\n"
                    "[-8.50318294e-05 -5.32151847e-02 -9.98583065e-01]\n")
      .def_property_readonly(
          "wrench", [](const touch& t) { return to_array(t.on_probe_w); },
          "On the probe (6,): force (N) and torque (N m) about its centre of mass.")
      .def_property_readonly(
          "force", [](const touch& t) { return to_array(t.on_probe_w.force); }, "Force on the probe (3,), N.")
      .def_property_readonly(
          "torque", [](const touch& t) { return to_array(t.on_probe_w.torque); },
          "Torque on the probe about its centre of mass (3,), N m.")
      .def_property_readonly(
          "centre_of_mass", [](const touch& t) { return to_array(t.centre_of_mass_w); },
          "The probe's centre of mass (3,), m: the point that the torque is about.")
      .def_property_readonly(
          "stiffness", [](const touch& t) { return to_array(t.stiffness); },
          "How the wrench changes with the probe's motion (6, 6): N/m, N/rad, N, N m/rad by block.")
      .def_property_readonly("bodies", &bodies_of,
                             "On each fixed body about its own centre of mass (M, 6), N and N m; None where not known.")
      .def_readonly("contacts", &touch::contacts, "The contacts that make up the wrench, as a list of Contact.")
      .def_readonly("planes", &touch::planes,
                    "Support planes, gaps included, as a list of Plane; empty for formulations without.")
      .def_readonly("dropped_contacts", &touch::dropped_contacts, "Contacts that did not fit.")
      .def_property_readonly(
          "complete", [](const touch& t) { return t.answered == status::ok; },
          "False where a capacity was reached: usable, and something is missing.")
      .def("__repr__", [](const touch& t) {
        return "Touch(" + std::to_string(t.contacts.size()) + " contacts, force " +
               std::string(py::repr(py::float_(std::sqrt(glm::dot(t.on_probe_w.force, t.on_probe_w.force))))) + " N)";
      });
}

}  // namespace asperity::python
