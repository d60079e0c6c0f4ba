// The C++ part of asperity.mujoco, a module of its own, so that import asperity needs no libmujoco.
#include <array>
#include <cstring>
#include <memory>
#include <mujoco/mujoco.h>
#include <string>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "asperity/least_motion/least_motion_renderer.hpp"
#include "asperity/mujoco/conversions.hpp"
#include "asperity/mujoco/textured_contacts.hpp"
#include "asperity/planes/plane_renderer.hpp"
#include "errors.hpp"
#include "model_handle.hpp"
#include "pybind.hpp"

namespace asperity::python {
namespace {

using mujoco::pair_report;
using mujoco::textured_contacts;
using mujoco::textured_pair;

// A simulation from an MJCF, for who has no bindings of MuJoCo's.
struct mujoco_simulation {
  std::unique_ptr<mjModel, void (*)(mjModel*)> m{nullptr, &mj_deleteModel};
  std::unique_ptr<mjData, void (*)(mjData*)> d{nullptr, &mj_deleteData};
};

std::unique_ptr<mujoco_simulation> simulation_of(const std::string& file, const mjVFS* files) {
  std::array<char, 1000> why{};
  auto out = std::make_unique<mujoco_simulation>();
  out->m.reset(mj_loadXML(file.c_str(), files, why.data(), static_cast<int>(why.size())));
  if (!out->m) raise("bad_format", std::string("MuJoCo cannot read the MJCF: ") + why.data());
  out->d.reset(mj_makeData(out->m.get()));
  mj_forward(out->m.get(), out->d.get());
  return out;
}

std::unique_ptr<mujoco_simulation> simulation_of_text(const std::string& mjcf) {
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), "text.xml", static_cast<int>(mjcf.size()));
  std::memcpy(files->filedata[0], mjcf.data(), mjcf.size());
  const std::shared_ptr<void> ends(nullptr, [&](void*) { mj_deleteVFS(files.get()); });
  return simulation_of("text.xml", files.get());
}

// Numbers of the simulation itself, which numpy reads and writes.
template <class Pick>
auto numbers(Pick pick) {
  return [pick](const py::object& self) {
    const auto& s = self.cast<const mujoco_simulation&>();
    const auto [data, rows, columns] = pick(*s.m, *s.d);
    const std::vector<py::ssize_t> shape =
        columns == 0 ? std::vector<py::ssize_t>{rows} : std::vector<py::ssize_t>{rows, columns};
    return py::array_t<double>(shape, data, self);
  };
}

struct view {
  double* data;
  py::ssize_t rows, columns;
};

int id_of(const mujoco_simulation& s, mjtObj kind, const std::string& name) {
  const int id = mj_name2id(s.m.get(), kind, name.c_str());
  if (id < 0)
    raise("invalid_argument",
          "the MuJoCo model has no " + std::string(kind == mjOBJ_BODY ? "body" : "geom") + " '" + name + "'");
  return id;
}

// The contacts with what they stand on, which is kept alive.
struct contacts_handle {
  textured_contacts contacts;
  mjModel* m;
  mjData* d;
  py::object owner;
};

std::function<result<any_renderer>(scene)> renderer_of(const std::string& formulation, double stiffness_n_per_m,
                                                       double reach_m) {
  if (formulation == "least-motion") return {};
  if (formulation != "planes") {
    raise("invalid_argument", "formulation '" + formulation + "' is not known here: take least-motion or planes");
  }
  return [=](scene bodies) -> result<any_renderer> {
    plane_renderer_settings settings;
    settings.springs.stiffness_n_per_m = stiffness_n_per_m;
    settings.reach_m = reach_m;
    result<plane_renderer> made = make_plane_renderer(std::move(bodies), settings);
    if (!made) return made.error();
    return any_renderer(std::move(*made));
  };
}

mujoco::object_kind kind_of(const std::string& kind) {
  if (kind != "body" && kind != "geom")
    raise("invalid_argument", "kind '" + kind + "' is not known: take body or geom");
  return kind == "body" ? mujoco::object_kind::body : mujoco::object_kind::geom;
}

// One pair as asperity.mujoco.Pair says it.
textured_pair pair_of(const py::handle& p) {
  const auto kind = kind_of(p.attr("kind").cast<std::string>());
  const auto object = [&](const char* model, const char* name, const char* T) {
    const py::object placed = p.attr(T);
    return mujoco::textured_object{p.attr(model).cast<model_handle>().inside, p.attr(name).cast<std::string>(), kind,
                                   placed.is_none() ? pose{} : pose_of(placed, T)};
  };
  const auto stiffness = p.attr("stiffness_n_per_m").cast<double>();
  return {.probe = object("probe", "probe_name", "probe_pose"),
          .fixed = object("fixed", "fixed_name", "fixed_pose"),
          .stiffness_n_per_m = stiffness,
          .damping_s = p.attr("damping_s").cast<double>(),
          .make_renderer =
              renderer_of(p.attr("formulation").cast<std::string>(), stiffness, p.attr("reach_m").cast<double>())};
}

std::vector<textured_pair> pairs_of(const py::object& given) {
  std::vector<textured_pair> out;
  for (const py::handle p : given) out.push_back(pair_of(p));
  return out;
}

template <class T>
T* at_address(std::uintptr_t address, const char* what) {
  if (address == 0) raise("invalid_argument", std::string(what) + " has the address 0: it was closed");
  return reinterpret_cast<T*>(address);
}

std::unique_ptr<contacts_handle> contacts_of(std::uintptr_t model, std::uintptr_t data, py::object owner,
                                             const py::object& pairs) {
  auto* const m = at_address<mjModel>(model, "the model");
  auto* const d = at_address<mjData>(data, "the data");
  std::vector<textured_pair> wanted = pairs_of(pairs);
  result<textured_contacts> made = [&] {
    const py::gil_scoped_release others_may_run;
    return textured_contacts::make(*m, std::move(wanted));
  }();
  return std::make_unique<contacts_handle>(contacts_handle{unwrap(std::move(made)), m, d, std::move(owner)});
}

std::string answered(contacts_handle& self, bool whole_step) {
  const py::gil_scoped_release others_may_run;
  return to_string(whole_step ? self.contacts.step(*self.m, *self.d) : self.contacts.apply(*self.m, *self.d));
}

py::dict report_of(const contacts_handle& self, std::size_t pair) {
  if (pair >= self.contacts.size()) throw py::index_error("there is no pair of this number");
  const pair_report& r = self.contacts.report(pair);
  py::dict out;
  out["answer"] = to_string(r.answer);
  out["on_probe"] = to_array(r.on_probe_w);
  out["on_fixed"] = to_array(r.on_fixed_w);
  out["contacts"] = r.contacts;
  out["deepest_m"] = r.deepest_m;
  out["stiffness_n_per_m"] = r.stiffness_n_per_m;
  out["mass_kg"] = r.mass_kg;
  out["step_load"] = r.step_load;
  out["force_share"] = r.force_share;
  out["damping_share"] = r.damping_share;
  return out;
}

}  // namespace
}  // namespace asperity::python

PYBIND11_MODULE(_mujoco, m) {
  using namespace asperity;
  using namespace asperity::python;
  py::options without_signatures;
  without_signatures.disable_function_signatures();
  m.doc() = "The C++ part of asperity.mujoco.";
  m.attr("mujoco_version") = mj_version();
  py::module_::import("asperity._asperity");  // Model

  const auto of_body = [](auto member, py::ssize_t columns) {
    return numbers([member, columns](const mjModel& model, const mjData& d) {
      return view{d.*member, model.nbody, columns};
    });
  };
  const auto step_with = [](void (*call)(const mjModel*, mjData*)) {
    return [call](mujoco_simulation& s) {
      const py::gil_scoped_release others_may_run;
      call(s.m.get(), s.d.get());
    };
  };
  py::class_<mujoco_simulation>(
      m, "Simulation",
      "A MuJoCo simulation: what an MJCF says, and its state. Arrays are MuJoCo's own numbers, "
      "which can be written; its quaternions are w x y z.\n\n"
      ">>> from asperity.mujoco import Simulation\n"
      ">>> falls = Simulation.from_text(\"<mujoco><worldbody><body name='ball'><freejoint/><geom size='.1'/></body>\"\n"
      "...                              \"</worldbody></mujoco>\")\n"
      ">>> for _ in range(100):\n"
      "...     falls.step()\n"
      ">>> round(falls.time, 3), bool(falls.pose('ball')[2] < 0)\n"
      "(0.2, True)\n")
      .def(py::init([](const std::filesystem::path& file) { return simulation_of(file.string(), nullptr); }),
           py::arg("file"), "Of an MJCF file. Raises Error.")
      .def_static("from_text", &simulation_of_text, py::arg("mjcf"), "Of the text of an MJCF. Raises Error.")
      .def("step", step_with(&mj_step), "A whole step, without asperity's contacts.")
      .def("step1", step_with(&mj_step1), "The first half: positions, velocities, inertias.")
      .def("step2", step_with(&mj_step2), "The second half: forces, and the next state.")
      .def("forward", step_with(&mj_forward), "Everything but the next state.")
      .def("reset", step_with(&mj_resetData), "The state that the MJCF begins with.")
      .def(
          "body", [](const mujoco_simulation& s, const std::string& n) { return id_of(s, mjOBJ_BODY, n); },
          py::arg("name"), "Row of a body in the arrays. Raises Error.")
      .def(
          "geom", [](const mujoco_simulation& s, const std::string& n) { return id_of(s, mjOBJ_GEOM, n); },
          py::arg("name"), "Number of a geom. Raises Error.")
      .def(
          "pose",
          [](const mujoco_simulation& s, const std::string& n) {
            const int b = id_of(s, mjOBJ_BODY, n);
            return to_array(mujoco::pose_from_mujoco(std::span<const double, 3>(s.d->xpos + 3 * b, 3),
                                                     std::span<const double, 4>(s.d->xquat + 4 * b, 4)));
          },
          py::arg("name"), "Pose of a body as x y z qx qy qz qw (7,), world axes.")
      .def_property_readonly(
          "time", [](const mujoco_simulation& s) { return s.d->time; }, "s.")
      .def_property_readonly(
          "timestep", [](const mujoco_simulation& s) { return s.m->opt.timestep; }, "s.")
      .def_property_readonly("qpos", numbers([](const mjModel& o, const mjData& d) {
                               return view{d.qpos, o.nq, 0};
                             }),
                             "Positions of the joints (nq,).")
      .def_property_readonly("qvel", numbers([](const mjModel& o, const mjData& d) {
                               return view{d.qvel, o.nv, 0};
                             }),
                             "Velocities of the joints (nv,).")
      .def_property_readonly("ctrl", numbers([](const mjModel& o, const mjData& d) {
                               return view{d.ctrl, o.nu, 0};
                             }),
                             "Inputs of the actuators (nu,).")
      .def_property_readonly("qfrc_applied", numbers([](const mjModel& o, const mjData& d) {
                               return view{d.qfrc_applied, o.nv, 0};
                             }),
                             "Forces of the joints that others apply (nv,).")
      .def_property_readonly("xfrc_applied", of_body(&mjData::xfrc_applied, 6),
                             "Force and torque at each body's centre of mass (nbody, 6), world axes.")
      .def_property_readonly("xpos", of_body(&mjData::xpos, 3), "Positions of the bodies' frames (nbody, 3), m.")
      .def_property_readonly("xquat", of_body(&mjData::xquat, 4), "Their orientations (nbody, 4), w x y z.")
      .def_property_readonly("xipos", of_body(&mjData::xipos, 3), "The bodies' centres of mass (nbody, 3), m.")
      .def_property_readonly(
          "model_address", [](const mujoco_simulation& s) { return reinterpret_cast<std::uintptr_t>(s.m.get()); },
          "Where its mjModel is.")
      .def_property_readonly(
          "data_address", [](const mujoco_simulation& s) { return reinterpret_cast<std::uintptr_t>(s.d.get()); },
          "Where its mjData is.");

  py::class_<contacts_handle>(m, "Contacts",
                              "Textured contacts of a simulation: asperity.mujoco.contacts() makes them.")
      .def(py::init(&contacts_of), py::arg("model_address"), py::arg("data_address"), py::arg("owner"),
           py::arg("pairs"), "Of structs at two addresses, which `owner` keeps alive. Raises Error.")
      .def(
          "step", [](contacts_handle& self) { return answered(self, true); },
          "mj_step1, the contacts, mj_step2; xfrc_applied is afterwards as it was. Returns ok or what went wrong.")
      .def(
          "apply", [](contacts_handle& self) { return answered(self, false); },
          "Adds the contacts to xfrc_applied, between mj_step1 and mj_step2. Returns ok or what went wrong.")
      .def(
          "take_back", [](contacts_handle& self) { self.contacts.take_back(*self.d); },
          "Takes what apply() added out of xfrc_applied again, after mj_step2.")
      .def("report", &report_of, py::arg("pair") = 0,
           "What a pair did in the last step: answer; on_probe and on_fixed (6,), force and torque about the bodies' "
           "centres of mass, world axes; contacts, deepest_m, stiffness_n_per_m, mass_kg, step_load, force_share and "
           "damping_share.")
      .def("__len__", [](const contacts_handle& self) { return self.contacts.size(); })
      .def_property_readonly(
          "scaled", [](const contacts_handle& self) { return self.contacts.scaled(); },
          "Wrenches so far that were scaled to what the time step bears.");

  m.def(
      "switch_off_own_contacts",
      [](std::uintptr_t model, const py::object& pairs) {
        unwrap(mujoco::switch_off_own_contacts(*at_address<mjModel>(model, "the model"), pairs_of(pairs)));
      },
      py::arg("model_address"), py::arg("pairs"), "See asperity.mujoco.switch_off_own_contacts().");
}
