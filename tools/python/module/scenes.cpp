// Scenes that change while they are felt.
#include <algorithm>
#include <optional>

#include "arrays.hpp"
#include "errors.hpp"
#include "long_work.hpp"
#include "model_handle.hpp"
#include "parts.hpp"
#include "renderer_handle.hpp"
#include "scene_handle.hpp"

namespace asperity::python {
namespace {

using scene_ptr = std::shared_ptr<scene_handle>;

// With the scene locked and the GIL released.
auto with_scene(scene_handle& self, auto&& work) {
  const py::gil_scoped_release others_may_run;
  const std::lock_guard lock(self.busy);
  return work();
}

scene_ptr made_scene(const model_handle& probe, std::size_t bodies, std::size_t balls) {
  const auto work = [model = probe.inside, limits = scene_limits{bodies, balls}](work_monitor&) {
    return scene_editor::make(model, limits);
  };
  return std::make_shared<scene_handle>(probe.inside, run_interruptibly<scene_editor>(work, py::none()));
}

// The field of a model: of a body that is there, kept by the model, or made now, outside of any lock.
field_body_ptr field_for(scene_handle& self, const model_ptr& model) {
  field_body_ptr known = with_scene(self, [&] {
    const auto same = std::find_if(self.bodies.begin(), self.bodies.end(),
                                   [&](const scene_handle::body& b) { return b.model == model; });
    return same != self.bodies.end() ? same->field : nullptr;
  });
  if (known) return known;
  const auto work = [model](work_monitor&) -> result<field_body_ptr> {
    result<field_scene> made = make_field_scene({model, {}});
    if (!made) return made.error();
    return std::move(made->probe);
  };
  return run_interruptibly<field_body_ptr>(work, py::none());
}

scene_handle::body* find(scene_handle& self, const body_handle& body) {
  const auto at = std::find_if(self.bodies.begin(), self.bodies.end(),
                               [&](const scene_handle::body& b) { return b.handle == body; });
  return at != self.bodies.end() ? &*at : nullptr;
}

body_handle add(scene_handle& self, const model_handle& model, const py::object& given) {
  const pose T_wb = given.is_none() ? pose{} : pose_of(given, "pose");
  const field_body_ptr field = field_for(self, model.inside);
  return unwrap(with_scene(self, [&]() -> result<body_handle> {
    result<body_handle> added = self.editor.add(model.inside, field, T_wb);
    if (!added) return added;
    const auto before = std::find_if(self.bodies.begin(), self.bodies.end(),
                                     [&](const scene_handle::body& b) { return b.handle.slot > added->slot; });
    self.bodies.insert(before, {*added, model.inside, field, T_wb});
    ++self.changes;
    return added;
  }));
}

void remove(scene_handle& self, const body_handle& body) {
  unwrap(with_scene(self, [&]() -> result<void> {
    if (const result<void> ok = self.editor.remove(body); !ok) return ok;
    std::erase_if(self.bodies, [&](const scene_handle::body& b) { return b.handle == body; });
    ++self.changes;
    return {};
  }));
}

void place(scene_handle& self, const body_handle& body, const py::object& given) {
  const pose T_wb = pose_of(given, "pose");
  unwrap(with_scene(self, [&]() -> result<void> {
    if (const result<void> ok = self.editor.place(body, T_wb); !ok) return ok;
    find(self, body)->T_wb = T_wb;
    ++self.changes;
    return {};
  }));
}

void put_in_place(scene_handle& self, const body_handle& body, const model_ptr& model, const field_body_ptr& field) {
  unwrap(with_scene(self, [&]() -> result<void> {
    if (const result<void> ok = self.editor.exchange(body, model, field); !ok) return ok;
    scene_handle::body& there = *find(self, body);
    there.model = model;
    there.field = field;
    ++self.changes;
    return {};
  }));
}

void exchange(scene_handle& self, const body_handle& body, const model_handle& model) {
  put_in_place(self, body, model.inside, field_for(self, model.inside));
}

// What is there of a body; the editor's sentence where there is none.
scene_handle::body body_there(scene_handle& self, const body_handle& body) {
  return unwrap(with_scene(self, [&]() -> result<scene_handle::body> {
    if (const scene_handle::body* const there = find(self, body)) return *there;
    return self.editor.remove(body).error();  // of a body that is gone: it changes nothing
  }));
}

void set_material(scene_handle& self, const body_handle& body, const std::optional<material>& surface) {
  const scene_handle::body there = body_there(self, body);
  model_ptr other;
  {
    const py::gil_scoped_release others_may_run;
    textured_model copy = *there.model;
    copy.surface = surface;
    copy.surface_map = {};
    other = std::make_shared<const textured_model>(std::move(copy));
  }
  put_in_place(self, body, other, there.field);
}

std::unique_ptr<renderer_handle> made_renderer(const scene_ptr& self, std::optional<double> stiffness_n_per_m,
                                               double period_s, double reach_m, unsigned threads) {
  if (stiffness_n_per_m && !(*stiffness_n_per_m > 0.0))
    raise("invalid_argument", "stiffness_n_per_m has to be above 0, or None for the usual one");
  renderer_wish wish;
  wish.formulation = "planes";
  wish.stiffness_n_per_m = stiffness_n_per_m.value_or(0.0);
  wish.period_s = period_s;
  wish.reach_m = reach_m;
  wish.threads = threads;
  return unwrap([&]() -> result<std::unique_ptr<renderer_handle>> {
    const py::gil_scoped_release others_may_run;
    result<renderer_source> source = renderer_source::make(self, std::move(wish));
    if (!source) return source.error();
    auto out = std::make_unique<renderer_handle>();
    result<any_renderer> feel = source->another(&out->seen);
    if (!feel) return feel.error();
    out->T_wb = feel->target<plane_renderer>()->placed()->T_wb;
    out->source = std::make_shared<const renderer_source>(std::move(*source));
    out->feel.push_back(std::move(*feel));
    return out;
  }());
}

}  // namespace

void add_scenes(py::module_& m) {
  py::class_<body_handle>(m, "Body", "Names a body of a Scene. Its slot is what Plane.body and Contact.body tell.")
      .def_readonly("slot", &body_handle::slot, "Its row in Touch.bodies.")
      .def_readonly("generation", &body_handle::generation,
                    "Tells it from the bodies that were in its slot before; the first is 1.")
      .def(
          "__eq__", [](const body_handle& a, const body_handle& b) { return a == b; }, py::is_operator())
      .def("__hash__", [](const body_handle& b) { return py::hash(py::make_tuple(b.slot, b.generation)); })
      .def("__repr__", [](const body_handle& b) {
        return "Body(slot=" + std::to_string(b.slot) + ", generation=" + std::to_string(b.generation) + ")";
      });
  py::class_<scene_handle, scene_ptr>(
      m, "Scene",
      "Fixed bodies that come, go, are put elsewhere and exchanged while a probe feels them. A change is seen by "
      "nobody\n"
      "until a Session or Renderer that was made of the scene takes all changes at once: their commit().\n\n"
      ">>> scene = asperity.Scene(probe)\n"
      ">>> gear = scene.add(fixed)\n"
      ">>> session = asperity.Session(scene.renderer())\n"
      ">>> felt = session.run(0.7)\n"
      ">>> scene.remove(gear)\n"
      ">>> version = session.commit()\n"
      ">>> felt = session.run(0.1)\n"
      ">>> session.scene_in_use.version == version, felt[\"contacts\"][-1]\n"
      "(True, 0.0)\n")
      .def(py::init(&made_scene), py::arg("probe"), py::kw_only(), py::arg("bodies") = scene_limits{}.bodies,
           py::arg("balls") = scene_limits{}.balls,
           "An empty scene.\n\n"
           "probe: the Model that moves.\n"
           "bodies: most fixed bodies at one time, the slots.\n"
           "balls: most balls of samples of one body, about an eighth of its samples.\n"
           "Raises Error.")
      .def("add", &add, py::arg("model"), py::arg("pose") = py::none(),
           "Puts a Model into a free slot at a pose (7,), None: the origin. Returns its Body. Makes its depth field "
           "where "
           "the model does not keep one, which takes up to seconds. Raises Error: limit_exceeded, invalid_argument.")
      .def("remove", &remove, py::arg("body"), "Takes a body away; it names nobody any more. Raises Error.")
      .def("place", &place, py::arg("body"), py::arg("pose"),
           "Puts a body at another pose (7,), at once. Raises Error.")
      .def("exchange", &exchange, py::arg("body"), py::arg("model"),
           "Gives a body another Model, at the same pose and under the same Body. Raises Error.")
      .def("set_material", &set_material, py::arg("body"), py::arg("material"),
           "Gives a body another Material all over, or None. Raises Error.")
      .def("renderer", &made_renderer, py::kw_only(), py::arg("stiffness_n_per_m") = py::none(),
           py::arg("period_s") = 1e-3, py::arg("reach_m") = 0.0, py::arg("threads") = 1U,
           "A Renderer of support planes with the scene as it is now; numbers as Renderer() takes them. Its commit() "
           "takes "
           "what is changed later. A Session takes it as any other.")
      .def(
          "model", [](scene_handle& self, const body_handle& b) { return model_handle{body_there(self, b).model}; },
          py::arg("body"), "The Model of a body. Raises Error.")
      .def(
          "pose", [](scene_handle& self, const body_handle& b) { return to_array(body_there(self, b).T_wb); },
          py::arg("body"), "The pose of a body (7,). Raises Error.")
      .def(
          "body_in",
          [](scene_handle& self, std::uint32_t slot) {
            return with_scene(self, [&] { return self.editor.in_slot(slot); });
          },
          py::arg("slot"), "The Body that is in a slot, as of Plane.body; None where it is free.")
      .def_property_readonly(
          "bodies",
          [](scene_handle& self) {
            return with_scene(self, [&] {
              std::vector<body_handle> out;
              for (const scene_handle::body& b : self.bodies) out.push_back(b.handle);
              return out;
            });
          },
          "The bodies that are there, as a list of Body, by slot.")
      .def_property_readonly(
          "probe", [](const scene_handle& self) { return model_handle{self.probe}; }, "The Model that moves.")
      .def(
          "__len__", [](scene_handle& self) { return with_scene(self, [&] { return self.bodies.size(); }); },
          "How many bodies are there.")
      .def(
          "__contains__",
          [](scene_handle& self, const body_handle& b) { return with_scene(self, [&] { return self.editor.has(b); }); },
          "Whether a Body is there.")
      .def("__repr__", [](scene_handle& self) {
        const std::size_t bodies = with_scene(self, [&] { return self.bodies.size(); });
        return "Scene('" + self.probe->name + "' on " + std::to_string(bodies) + " of " +
               std::to_string(self.editor.limits().bodies) + " bodies)";
      });
}

}  // namespace asperity::python
