// From poses to wrenches.
#include <algorithm>
#include <functional>
#include <optional>
#include <span>
#include <thread>

#include "arrays.hpp"
#include "asperity/planes/plane_renderer.hpp"
#include "batch.hpp"
#include "errors.hpp"
#include "gpu_renderers.hpp"
#include "long_work.hpp"
#include "model_handle.hpp"
#include "parts.hpp"
#include "renderer_handle.hpp"
#include "touches.hpp"

namespace asperity::python {
namespace {

constexpr unsigned most_threads = 256;

std::vector<model_ptr> models_of(const py::object& fixed) {
  std::vector<model_ptr> out;
  if (py::isinstance<model_handle>(fixed)) {
    out.push_back(fixed.cast<model_handle>().inside);
    return out;
  }
  for (const py::handle one : fixed) {
    if (!py::isinstance<model_handle>(one)) throw py::type_error("fixed has to be a Model or a sequence of Models");
    out.push_back(one.cast<model_handle>().inside);
  }
  return out;
}

std::vector<pose> fixed_poses_of(const py::object& given, std::size_t bodies) {
  if (given.is_none()) return std::vector<pose>(bodies);
  std::vector<pose> out = poses_of(given, "fixed_poses");
  if (out.size() != bodies) {
    throw py::value_error("fixed_poses has shape (" + std::to_string(out.size()) +
                          ", 7): give one row for each of the " + std::to_string(bodies) + " fixed bodies");
  }
  return out;
}

void check_sizes(const scene& bodies, bool allow_scale_mismatch) {
  constexpr double largest_ratio = 500.0;
  for (std::size_t i = 0; i < bodies.fixed.size() && !allow_scale_mismatch; ++i) {
    const double a_m = bodies.probe->box.diagonal(), b_m = bodies.fixed[i]->box.diagonal();
    if (a_m <= largest_ratio * b_m && b_m <= largest_ratio * a_m) continue;
    raise("invalid_argument", "the diagonals of the probe (" + std::to_string(a_m) + " m) and of fixed body " +
                                  std::to_string(i) + " (" + std::to_string(b_m) +
                                  " m) differ more than 500 times: is one of them in millimetres? Bake it again with "
                                  "scale=0.001, or pass allow_scale_mismatch=True if this is meant");
  }
}

std::unique_ptr<renderer_handle> made_renderer(
    const model_handle& probe, const py::object& fixed, const py::object& fixed_poses,
    const std::optional<std::string>& formulation, std::optional<double> stiffness_n_per_m, double period_s,
    double softness_m, double sharpness, double reach_m, std::uint32_t grid, const std::optional<std::string>& gradient,
    const std::optional<std::string>& lookup, const std::string& backend, const std::string& gpu, bool fallback,
    unsigned threads, bool allow_scale_mismatch) {
  scene bodies{probe.inside, models_of(fixed)};
  check_sizes(bodies, allow_scale_mismatch);
  auto out = std::make_unique<renderer_handle>();
  out->T_wb = fixed_poses_of(fixed_poses, bodies.fixed.size());
  if (stiffness_n_per_m && !(*stiffness_n_per_m > 0.0))
    raise("invalid_argument", "stiffness_n_per_m has to be above 0, or None for the usual one");
  // What a backend implies: queries draw as the paper did.
  const bool queries = backend == "gl-occlusion";
  renderer_wish wish{formulation.value_or(backend == "cpu" ? "least-motion" : "window"),
                     stiffness_n_per_m.value_or(0.0),
                     period_s,
                     softness_m,
                     sharpness,
                     reach_m,
                     grid,
                     gradient.value_or(queries ? "central" : "soft"),
                     lookup.value_or(queries ? "paper" : "exact"),
                     backend,
                     gpu,
                     fallback,
                     threads};
  const auto work = [bodies = std::move(bodies), wish = std::move(wish)](work_monitor&) mutable
      -> result<std::pair<std::shared_ptr<const renderer_source>, std::shared_ptr<any_renderer>>> {
    result<renderer_source> source = renderer_source::make(std::move(bodies), std::move(wish));
    if (!source) return source.error();
    result<any_renderer> feel = source->another();
    if (!feel) return feel.error();
    return std::pair(std::make_shared<const renderer_source>(std::move(*source)),
                     std::make_shared<any_renderer>(std::move(*feel)));
  };
  auto [source, feel] =
      run_interruptibly<std::pair<std::shared_ptr<const renderer_source>, std::shared_ptr<any_renderer>>>(work,
                                                                                                          py::none());
  out->source = std::move(source);
  out->feel.push_back(std::move(*feel));
  return out;
}

void refuse(status answered, const std::string& where) {
  raise("unsupported",
        "the contact could not be computed at " + where + " (" + to_string(answered) + "): inspect the models");
}

// One tick without the GIL; `look` sees what it found before another thread can step.
template <class Look>
void step_one(renderer_handle& self, const py::object& given, const Look& look) {
  const pose T_wa = pose_of(given, "pose");
  status answered;
  {
    const py::gil_scoped_release others_may_run;
    const std::lock_guard lock(self.busy);
    tick found;
    const gpu_visit visit(gpu_use_of(self.feel.front()));
    scene_pose at{T_wa, self.T_wb};
    at.version = self.seen.version;
    answered = self.feel.front().step(at, found);
    if (answered == status::capacity_reached) ++self.incomplete;
    look(found, answered);
  }
  if (answered != status::ok && answered != status::capacity_reached) refuse(answered, "this pose");
}

py::array_t<double> step(renderer_handle& self, const py::object& given) {
  wrench felt;
  step_one(self, given, [&](const tick& found, status) { felt = found.force.on_probe_w; });
  return to_array(felt);
}

touch query(renderer_handle& self, const py::object& given) {
  touch out;
  step_one(self, given, [&](const tick& found, status answered) { out = touch_of(found, answered); });
  return out;
}

result<void> have_renderers(renderer_handle& self, std::size_t wanted) {
  while (self.feel.size() < wanted) {
    result<any_renderer> more = self.source->another_alone();
    if (!more) return more.error();
    self.feel.push_back(std::move(*more));
  }
  return {};
}

std::size_t threads_of(unsigned wanted) {
  if (wanted > most_threads)
    throw py::value_error("threads has to be from 0 (all of the machine's) to " + std::to_string(most_threads));
  return wanted != 0 ? wanted : std::max(1U, std::thread::hardware_concurrency());
}

// One row of a batch: the wrench, six numbers.
status step_row(any_renderer& feel, const pose& T_wa, std::span<const pose> T_wb, std::uint64_t version,
                std::span<double, 6> out) {
  tick found;
  scene_pose at{T_wa, T_wb};
  at.version = version;
  const status answered = feel.step(at, found);
  const vec6 w = to_vec6(found.force.on_probe_w);
  for (std::size_t k = 0; k < 6; ++k) out[k] = w[k];
  return answered;
}

py::array_t<double> step_batch(renderer_handle& self, const py::object& given, unsigned threads) {
  std::size_t used = threads_of(threads);
  const std::vector<pose> T_wa = poses_of(given, "poses");
  py::array_t<double> out({static_cast<py::ssize_t>(T_wa.size()), py::ssize_t{6}});
  double* const rows = out.mutable_data();
  if (self.source->remembers() || self.source->edited()) used = 1;
  signal_watch keep_going;
  batch_outcome outcome;
  result<void> ready;
  {
    const py::gil_scoped_release others_may_run;
    const std::lock_guard lock(self.busy);
    const gpu_visit visit(gpu_use_of(self.feel.front()));
    ready = have_renderers(self, used);
    const auto step = [&](std::size_t thread, std::size_t i) {
      return step_row(self.feel[thread], T_wa[i], self.T_wb, self.seen.version, std::span<double, 6>(rows + 6 * i, 6));
    };
    if (ready) outcome = step_rows({.rows = T_wa.size(), .threads = used}, step, std::ref(keep_going));
    self.incomplete += outcome.incomplete;
  }
  unwrap(ready);
  keep_going.rethrow();
  if (outcome.failed != status::ok) refuse(outcome.failed, "row " + std::to_string(outcome.failed_at) + " of poses");
  return out;
}

// One pose for each of several renderers. A renderer is stepped once, by one thread, so that what it remembers does not
// depend on the threads.
py::array_t<double> step_each(const py::sequence& renderers, const py::object& given, unsigned threads) {
  const std::size_t used = threads_of(threads);
  std::vector<py::object> kept;  // alive while the GIL is not held
  std::vector<renderer_handle*> each;
  for (const py::handle one : renderers) {
    if (!py::isinstance<renderer_handle>(one)) throw py::type_error("renderers has to be a sequence of Renderers");
    kept.push_back(py::reinterpret_borrow<py::object>(one));
    each.push_back(&one.cast<renderer_handle&>());
  }
  std::vector<renderer_handle*> sorted = each;
  std::sort(sorted.begin(), sorted.end());
  if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end())
    throw py::value_error("a Renderer is there twice: of one with many poses, step_batch() takes all of them");
  const std::vector<pose> T_wa = poses_of(given, "poses");
  if (T_wa.size() != each.size()) {
    throw py::value_error("poses has shape (" + std::to_string(T_wa.size()) + ", 7): give one row for each of the " +
                          std::to_string(each.size()) + " renderers");
  }
  py::array_t<double> out({static_cast<py::ssize_t>(T_wa.size()), py::ssize_t{6}});
  double* const rows = out.mutable_data();
  signal_watch keep_going;
  batch_outcome outcome;
  {
    const py::gil_scoped_release others_may_run;
    const auto step = [&](std::size_t, std::size_t i) {
      renderer_handle& self = *each[i];
      const std::lock_guard lock(self.busy);
      const gpu_visit visit(gpu_use_of(self.feel.front()));
      const status answered =
          step_row(self.feel.front(), T_wa[i], self.T_wb, self.seen.version, std::span<double, 6>(rows + 6 * i, 6));
      if (answered == status::capacity_reached) ++self.incomplete;
      return answered;
    };
    constexpr std::size_t blocks_per_thread = 8, longest_block = 32;
    const std::size_t block = std::clamp<std::size_t>(each.size() / (blocks_per_thread * used), 1, longest_block);
    outcome = step_rows({.rows = each.size(), .threads = used, .block = block}, step, std::ref(keep_going));
  }
  keep_going.rethrow();
  if (outcome.failed != status::ok) refuse(outcome.failed, "row " + std::to_string(outcome.failed_at) + " of poses");
  return out;
}

// What another thread may be changing; it holds the lock without the GIL.
auto read_locked(renderer_handle& self, auto&& read) {
  const py::gil_scoped_release others_may_run;
  const std::lock_guard lock(self.busy);
  return read();
}

py::array_t<double> fixed_poses(renderer_handle& self) {
  const std::vector<pose> T_wb = read_locked(self, [&] {
    std::vector<pose> there;
    for (std::size_t b = 0; b < self.T_wb.size(); ++b) {
      if (self.feel.front().scene().fixed[b]) there.push_back(self.T_wb[b]);
    }
    return there;
  });
  py::array_t<double> out({static_cast<py::ssize_t>(T_wb.size()), py::ssize_t{7}});
  for (std::size_t i = 0; i < T_wb.size(); ++i) {
    const py::array_t<double> row = to_array(T_wb[i]);
    std::copy(row.data(), row.data() + 7, out.mutable_data() + 7 * i);
  }
  return out;
}

void set_fixed_poses(renderer_handle& self, const py::object& given) {
  if (self.source->edited())
    raise("invalid_argument", "the bodies of this renderer are in a Scene: place() them there, then commit() here");
  std::vector<pose> T_wb = fixed_poses_of(given, self.source->bodies().fixed.size());
  read_locked(self, [&] {
    self.T_wb = std::move(T_wb);
    return true;
  });
}

// A renderer that goes on with another version lets a body that came upon the probe stand back, which is for hands. Here
// an answer is of its pose alone, so a new one is made.
std::uint64_t commit(renderer_handle& self) {
  if (!self.source->edited())
    raise("invalid_argument", "the renderer's bodies are not in a Scene: make it with Scene.renderer()");
  result<void> made;
  {
    const py::gil_scoped_release others_may_run;
    const std::lock_guard lock(self.busy);
    if (self.source->lacks(self.seen)) {
      scene_seen seen;
      result<any_renderer> feel = self.source->another(&seen);
      if (feel) {
        self.T_wb = feel->target<plane_renderer>()->placed()->T_wb;
        self.feel.front() = std::move(*feel);
        self.seen = seen;
      } else {
        made = feel.error();
      }
    }
  }
  unwrap(made);
  return self.seen.version;
}

// Those that are there: a Scene has slots without one.
std::vector<model_handle> fixed_models(renderer_handle& self) {
  return read_locked(self, [&] {
    std::vector<model_handle> out;
    for (const model_ptr& b : self.feel.front().scene().fixed) {
      if (b) out.push_back({b});
    }
    return out;
  });
}

std::string repr(renderer_handle& self) {
  return "Renderer('" + self.source->bodies().probe->name + "' on " + std::to_string(fixed_models(self).size()) +
         " fixed, formulation='" + self.source->wish().formulation + "')";
}

py::object gpu_of(renderer_handle& self) {
  gpu_use use;
  const bool has = read_locked(self, [&] {
    const std::shared_ptr<gpu_use> now = gpu_use_of(self.feel.front());
    if (now) use = *now;
    return now != nullptr;
  });
  if (!has) return py::none();
  return py::dict(py::arg("device") = use.device, py::arg("version") = use.version, py::arg("software") = use.software,
                  py::arg("device_bytes") = use.device_bytes, py::arg("problem") = use.problem,
                  py::arg("ticks") = use.ticks, py::arg("failed") = use.failed, py::arg("fallbacks") = use.fallbacks);
}

std::size_t memory_of(renderer_handle& self) {
  return read_locked(self, [&] {
    std::size_t bytes = 0;
    for (const any_renderer& r : self.feel) bytes += r.memory_bytes();
    return bytes;
  });
}

}  // namespace

void add_renderers(py::module_& m) {
  py::class_<renderer_handle>(
      m, "Renderer",
      "Feels the contact between a probe, which moves, and fixed bodies. Poses are x y z (m) qx "
      "qy qz qw, wrenches force (N) and torque (N m) about the probe's centre of mass, both in "
      "world axes. Several threads may use one; steps wait for each other.")
      .def(py::init(&made_renderer), py::arg("probe"), py::arg("fixed"), py::kw_only(),
           py::arg("fixed_poses") = py::none(), py::arg("formulation") = py::none(),
           py::arg("stiffness_n_per_m") = py::none(), py::arg("period_s") = 1e-3, py::arg("softness_m") = 0.0,
           py::arg("sharpness") = 0.0, py::arg("reach_m") = 0.0, py::arg("grid") = 64, py::arg("gradient") = py::none(),
           py::arg("lookup") = py::none(), py::arg("backend") = "cpu", py::arg("gpu") = "", py::arg("fallback") = false,
           py::arg("threads") = 1U, py::arg("allow_scale_mismatch") = false,
           "A renderer of a Model and one or several others.\n\n"
           "fixed_poses: (M, 7), one row per fixed body; None: all at the origin.\n"
           "formulation: least-motion, the default on the CPU; planes, for control loops, the only one that feels "
           "materials;\n"
           "    window, the paper's, the default on a GPU; exact, the same with the maximum itself, slow.\n"
           "stiffness_n_per_m: of a contact; None: the formulation's own.\n"
           "period_s: between two steps, which says how soft contacts of least motion are and how far planes look.\n"
           "softness_m, sharpness: of least motion; 0: what fits the period.\n"
           "reach_m: gaps up to this are reported as planes; 0: none with least motion, what fits the period with "
           "planes.\n"
           "grid, gradient (soft, central), lookup (exact, paper): of windows; samples per side, and how depths are "
           "taken.\n"
           "backend: where the depths of windows are computed: cpu, gl-compute or gl-occlusion, as `asperity "
           "--backend`. "
           "Queries\n"
           "    draw as the paper did: central, paper.\n"
           "gpu: index of a GPU, or part of its name; empty: the first that works.\n"
           "fallback: the CPU answers where the GPU does not; Renderer.gpu tells.\n"
           "threads: that share a step of planes, 1 to 16, with the same bits for any number; they want processors of "
           "their own.\n"
           "    For many poses use step_batch(): its threads take a pose each.\n"
           "Raises Error.")
      .def("step", &step, py::arg("pose"),
           "The wrench on the probe (6,) at a pose (7,). Raises ValueError for another shape, Error for what is no "
           "pose.\n\n"
           ">>> print(renderer.step([0, 0, z, 0, 0, 0, 1])[:3])  # N\n"
           "[1.53258676e-04 9.98003320e-02 1.87556295e+00]\n")
      .def("step_batch", &step_batch, py::arg("poses"), py::kw_only(), py::arg("threads") = 0U,
           "The wrenches (N, 6) at poses (N, 7), on several threads, 0: as many as the machine has. Each row has the "
           "bits of step() at that pose, whatever the threads. Windows depend on the pose before: theirs are computed "
           "in order on one thread. So are those of a Scene.\n\n"
           ">>> down = np.tile([0, 0, z, 0, 0, 0, 1.0], (5, 1))\n"
           ">>> down[:, 2] += np.linspace(1e-3, 0, 5)\n"
           ">>> renderer.step_batch(down).shape\n"
           "(5, 6)\n")
      .def("query", &query, py::arg("pose"), "A Touch at a pose (7,): contacts, planes, and the wrench in its parts.")
      .def_property(
          "fixed_poses", &fixed_poses, &set_fixed_poses,
          "Poses of the fixed bodies (M, 7), as in fixed; set them between steps to move bodies. Those of a Scene are "
          "placed there.")
      .def_property_readonly(
          "formulation", [](const renderer_handle& self) { return self.source->wish().formulation; },
          "least-motion, planes, window or exact.")
      .def_property_readonly(
          "backend", [](const renderer_handle& self) { return self.source->wish().backend; },
          "cpu, gl-compute or gl-occlusion.")
      .def_property_readonly("gpu", &gpu_of,
                             "What it does with a GPU, as a dict: device, version, software, device_bytes, problem "
                             "(why it was never used), and of the steps so far ticks, failed and fallbacks, which the "
                             "CPU answered; None on the CPU.")
      .def_property_readonly(
          "probe", [](const renderer_handle& self) { return model_handle{self.source->bodies().probe}; },
          "The Model that moves.")
      .def_property_readonly("fixed", &fixed_models,
                             "The Models that stay, as a list; of a Scene those that are there, by slot.")
      .def("commit", &commit,
           "Goes on with the Scene as it is now: all changes at once. Returns the version. Raises Error where the "
           "renderer was not made by Scene.renderer().")
      .def_property_readonly(
          "incomplete", [](renderer_handle& self) { return read_locked(self, [&] { return self.incomplete; }); },
          "Steps so far at which a capacity was reached: usable, and something was missing.")
      .def_property_readonly("memory_bytes", &memory_of, "Memory that it takes beside its models, bytes.")
      .def("__repr__", &repr);
  m.def(
      "step_each", &step_each, py::arg("renderers"), py::arg("poses"), py::kw_only(), py::arg("threads") = 0U,
      "One step of each of N renderers, as of N environments that go on together: the wrenches (N, 6) at poses (N, 7), "
      "on "
      "several threads, 0: as many as the machine has. Each row has the bits of renderers[i].step(poses[i]), whatever "
      "the threads. Raises ValueError where a renderer is there twice.\n\n"
      ">>> pairs = [asperity.Renderer(probe, fixed, formulation='planes') for _ in range(3)]\n"
      ">>> asperity.step_each(pairs, [[0, 0, z + 1e-3 * i, 0, 0, 0, 1] for i in range(3)]).shape\n"
      "(3, 6)\n");
}

}  // namespace asperity::python
