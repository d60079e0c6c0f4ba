// Sessions of the two-rate loop with a simulated device, on the virtual clock.
#include <functional>
#include <utility>

#include "approach.hpp"
#include "arrays.hpp"
#include "asperity/planes/plane_renderer.hpp"
#include "errors.hpp"
#include "long_work.hpp"
#include "parts.hpp"
#include "renderer_handle.hpp"
#include "session_handle.hpp"
#include "simulated.hpp"

namespace asperity::python {
namespace {

constexpr double clearance_m = 0.003;  // the hand starts this far above the touch, as in the command's sessions

motion_kind kind_of(const std::string& name) {
  constexpr std::pair<const char*, motion_kind> all[] = {{"press", motion_kind::press},
                                                         {"scrub", motion_kind::scrub},
                                                         {"twist", motion_kind::twist},
                                                         {"tap", motion_kind::tap},
                                                         {"free", motion_kind::free}};
  for (const auto& [word, kind] : all) {
    if (name == word) return kind;
  }
  throw py::value_error("motion is '" + name + "': give press, scrub, twist, tap or free");
}

hand_settings hand_of(const std::string& name) {
  if (name == "usual") return {};
  if (name == "soft") return soft_hand();
  if (name == "firm") return firm_hand();
  throw py::value_error("hand is '" + name + "': give usual, soft or firm");
}

constexpr std::pair<const char*, device_fault> all_faults[] = {{"nan_pose", device_fault::nan_pose},
                                                               {"infinite_pose", device_fault::infinite_pose},
                                                               {"bad_rotation", device_fault::bad_rotation},
                                                               {"stale", device_fault::stale},
                                                               {"drop", device_fault::drop},
                                                               {"jump", device_fault::jump},
                                                               {"refuse_write", device_fault::refuse_write},
                                                               {"depart", device_fault::depart},
                                                               {"stuck_encoder", device_fault::stuck_encoder},
                                                               {"slow_reply", device_fault::slow_reply},
                                                               {"loss", device_fault::loss},
                                                               {"overheat", device_fault::overheat}};

device_fault fault_of(const std::string& name) {
  std::string names;
  for (const auto& [word, fault] : all_faults) {
    if (name == word) return fault;
    names += (names.empty() ? "" : ", ") + std::string(word);
  }
  throw py::value_error("there is no fault '" + name + "': there are " + names);
}

std::int64_t to_ns(double s, const char* name) {
  if (!(s >= 0.0 && s <= 1e6)) throw py::value_error(std::string(name) + " has to be from 0 to 1e6 s");
  return std::llround(1e9 * s);
}

device_wish made_device(std::uint64_t seed, const std::string& motion, double press_m,
                        std::optional<double> amplitude_m, double frequency_hz, const std::string& hand,
                        const std::vector<std::tuple<std::string, double, double>>& faults, double delay_s,
                        double jitter_s, double loss) {
  device_wish out;
  out.press_m = press_m;
  out.amplitude_m = amplitude_m;
  out.settings.seed = seed;
  out.settings.motion.kind = kind_of(motion);
  out.settings.motion.frequency_hz = frequency_hz;
  out.settings.hand = hand_of(hand);
  out.settings.measurement.delay_ns = to_ns(delay_s, "delay_s");
  out.settings.measurement.jitter_ns = to_ns(jitter_s, "jitter_s");
  out.settings.measurement.loss = loss;
  if (!std::isfinite(press_m) || !(std::fabs(press_m) <= 1.0)) throw py::value_error("press_m has to be within 1 m");
  if (!(frequency_hz > 0.0 && frequency_hz <= 1000.0))
    throw py::value_error("frequency_hz has to be above 0, at most 1000");
  if (!(loss >= 0.0 && loss <= 1.0)) throw py::value_error("loss is a probability: give 0 to 1");
  if (!(delay_s + jitter_s <= 0.02)) throw py::value_error("delay_s and jitter_s may come to 0.02 s together");
  for (const auto& [kind, from_s, until_s] : faults) {
    out.settings.faults.push_back(
        {fault_of(kind), to_ns(from_s, "a fault's from_s"), to_ns(until_s, "a fault's until_s")});
  }
  return out;
}

py::array words_of(const std::vector<std::uint8_t>& codes, auto&& word) {
  py::list out;
  for (const std::uint8_t c : codes) out.append(word(c));
  return py::module_::import("numpy").attr("array")(out, py::arg("dtype") = "U32");
}

py::tuple to_python(const recorded_rows& rows) {
  const auto n = static_cast<py::ssize_t>(rows.sample.size());
  py::array_t<double> numbers({n, static_cast<py::ssize_t>(command::recorded_numbers)});
  std::copy(rows.numbers.begin(), rows.numbers.end(), numbers.mutable_data());
  return py::make_tuple(numbers,
                        words_of(rows.sample, [](std::uint8_t c) { return to_string(static_cast<sample_verdict>(c)); }),
                        words_of(rows.device, [](std::uint8_t c) { return to_string(static_cast<device_state>(c)); }),
                        words_of(rows.fault, [](std::uint8_t c) { return to_string(static_cast<gate_fault>(c)); }));
}

std::int64_t period_of(double rate_hz, const char* name) {
  if (!(rate_hz >= 100.0 && rate_hz <= 10'000.0))
    throw py::value_error(std::string(name) + " has to be from 100 to 10000 Hz");
  return std::llround(1e9 / rate_hz);
}

/// The fixed bodies that are there as a session begins.
struct bodies_there {
  scene bodies;
  std::vector<pose> T_wb;
};

bodies_there bodies_of(renderer_handle& renderer) {
  const std::shared_ptr<scene_handle>& edited = renderer.source->edited();
  const py::gil_scoped_release others_may_run;
  if (edited) {
    const std::lock_guard lock(edited->busy);
    return {edited->now(), edited->poses_now()};
  }
  const std::lock_guard lock(renderer.busy);
  return {renderer.source->bodies(), renderer.T_wb};
}

// Where the probe begins: given, or 3 mm above its first touch straight down.
pose start_of(any_renderer& feel, const bodies_there& there, bool edited, motion_kind motion) {
  if (there.bodies.fixed.empty())
    raise("invalid_argument", "the scene has no body to begin at: give start_pose, or add() a body before");
  const command::step_function step = [&](const scene_pose& at, tick& out) {
    if (!edited) return feel.step(at, out);
    const placed_scene& placed = *feel.target<plane_renderer>()->placed();
    scene_pose in_slots{at.T_wa, placed.T_wb};
    in_slots.version = placed.version;
    return feel.step(in_slots, out);
  };
  const gpu_visit visit(gpu_use_of(feel));
  pose T_wa = unwrap(command::find_touch(there.bodies, step, quat(1.0, 0.0, 0.0, 0.0), there.T_wb));
  if (motion != motion_kind::free) T_wa.position.z += clearance_m;
  return T_wa;
}

// As in the command's sessions: oblique to both horizontal axes, so that ridges along either of them are felt.
motion_settings motion_of(const device_wish& wish, const scene& bodies, bool start_given, double scale) {
  double size = bodies.probe->box.diagonal();
  if (!bodies.fixed.empty()) size = std::min(size, bodies.fixed.front()->box.diagonal());
  motion_settings motion = wish.settings.motion;
  motion.sideways_d = {0.8, 0.6, 0.0};
  motion.depth_m = wish.press_m + (start_given ? 0.0 : clearance_m / scale);
  motion.amplitude_m = wish.amplitude_m.value_or(std::min(0.01, 0.1 * size / scale));
  return motion;
}

std::unique_ptr<session_handle> made_session(renderer_handle& renderer, const device_wish& device,
                                             const py::object& start_pose, double device_rate_hz,
                                             double contact_rate_hz, std::optional<double> coupling_n_per_m,
                                             std::optional<double> coupling_n_m_per_rad, double scale,
                                             std::optional<std::pair<double, double>> friction,
                                             const py::object& contact, const py::object& hand) {
  if (!(scale > 0.0 && std::isfinite(scale))) throw py::value_error("scale has to be above 0");
  const loop_periods periods{period_of(device_rate_hz, "device_rate_hz"),
                             period_of(contact_rate_hz, "contact_rate_hz")};
  const bool on_planes = renderer.source->wish().formulation == "planes";
  if (friction && !on_planes)
    throw py::value_error("friction is of support planes: give Renderer formulation='planes'");
  const std::shared_ptr<scene_handle>& edited = renderer.source->edited();
  if (edited && (friction || !contact.is_none())) {
    throw py::value_error(friction ? "friction is of the materials of a Scene's bodies: see Scene.set_material()"
                                   : "a contact of your own knows no Scene: give a Renderer of fixed bodies");
  }
  scene_seen seen;
  any_renderer feel = unwrap([&] {
    const py::gil_scoped_release others_may_run;
    return renderer.source->another_for(periods, scale, &seen);
  }());
  const bodies_there there = bodies_of(renderer);
  const scene& bodies = there.bodies;
  const bool start_given = !start_pose.is_none();
  const pose T_wa = start_given ? pose_of(start_pose, "start_pose")
                                : start_of(feel, there, edited != nullptr, device.settings.motion.kind);

  simulated_settings simulated = device.settings;
  simulated.motion = motion_of(device, bodies, start_given, scale);
  const mass_properties& shape = bodies.probe->mass;
  control_settings control;
  control.map = {.T_wd = {quat(1.0, 0.0, 0.0, 0.0), T_wa * shape.centre_of_mass},
                 .scale = scale,
                 .T_ha = {T_wa.rotation, -(T_wa.rotation * shape.centre_of_mass)}};
  control.probe = felt_alike(solid_probe(shape), scale);
  if (on_planes) {
    control.coupling = coupling_for(simulated.capabilities, device_rate_hz, scale);
    control.surfaces = edited ? feel.target<plane_renderer>()->placed()->surfaces : surfaces_of(bodies);
  }
  if (coupling_n_per_m) control.coupling.stiffness_n_per_m = *coupling_n_per_m;
  if (coupling_n_m_per_rad) control.coupling.stiffness_n_m_per_rad = *coupling_n_m_per_rad;
  if (friction) {
    control.friction.static_coefficient = friction->first;
    control.friction.dynamic_coefficient = friction->second;
    unwrap(check(control.friction));
    const auto override_friction = [&](surface_pair& pair) {
      pair.static_friction = friction->first;
      pair.dynamic_friction = friction->second;
    };
    for (std::optional<surface_pair>& pair : control.surfaces) {
      if (pair) override_friction(*pair);
    }
    for (mapped_pair& m : control.surfaces.mapped) override_friction(m.pair);
  }
  const auto raised = std::make_shared<raised_in_tick>();
  std::function<void(double, const pose&)> lead;
  if (!hand.is_none()) {
    simulated.lead = std::make_shared<hand_lead>();
    lead = led_by(
        hand, simulated.lead, [map = control.map](const pose& T) { return map.handle_at(T * inverse(map.T_ha)); },
        raised);
  }
  if (!contact.is_none()) feel = with_contact(std::move(feel), contact, raised);
  session_parts parts{.placement = {there.T_wb, shape.centre_of_mass},
                      .device = std::move(simulated),
                      .control = std::move(control),
                      .schedule = {.device_period_ns = periods.device_ns,
                                   .contact_period_ns = periods.contact_ns,
                                   .contact_one_period_late = true},
                      .T_wa = T_wa,
                      .raised = raised,
                      .lead = std::move(lead),
                      .edited = edited,
                      .seen = seen};
  auto out = std::make_unique<session_handle>(std::move(feel), std::move(parts));
  unwrap(out->begin());
  return out;
}

py::tuple run(session_handle& self, double seconds) {
  if (!(seconds >= 0.0 && seconds <= 1e5)) throw py::value_error("seconds has to be from 0 to 1e5 s");
  if (self.stopped()) raise("invalid_argument", "the session was stopped: make another one");
  signal_watch keep_going;
  recorded_rows rows;
  {
    const py::gil_scoped_release others_may_run;
    const std::lock_guard lock(self.busy);
    rows = self.run(seconds, std::ref(keep_going));
  }
  keep_going.rethrow();
  self.rethrow();
  return to_python(rows);
}

py::tuple stop(session_handle& self) {
  recorded_rows rows;
  {
    const py::gil_scoped_release others_may_run;
    const std::lock_guard lock(self.busy);
    rows = self.stop();
  }
  return to_python(rows);
}

std::uint64_t commit(session_handle& self) {
  return unwrap([&] {
    const py::gil_scoped_release others_may_run;
    return self.commit();
  }());
}

py::tuple scene_in_use(session_handle& self) {
  const scene_use use = self.scene_in_use();
  return py::make_tuple(use.version, use.tick, 1e-9 * static_cast<double>(use.time_ns));
}

}  // namespace

void add_sessions(py::module_& m) {
  m.attr("recording_columns") = py::tuple(py::cast(command::recording_columns()));
  py::list faults;
  for (const auto& [word, fault] : all_faults) faults.append(word);
  m.attr("device_faults") = py::tuple(faults);
  py::class_<device_wish>(
      m, "SimulatedDevice",
      "A device made of numbers, with a hand that holds it: each session makes it anew, and the same "
      "description gives the same bits.\n\n"
      ">>> device = asperity.SimulatedDevice(motion='press', hand='firm', faults=[('depart', 0.1, 0.2)])\n"
      ">>> session = asperity.Session(asperity.Renderer(probe, fixed, formulation='planes'), device)\n"
      ">>> session.run(1.0).rows < 1000, session.fault  # it ends where the gate shuts\n"
      "(True, 'device departed')\n")
      .def(py::init(&made_device), py::kw_only(), py::arg("seed") = 1, py::arg("motion") = "scrub",
           py::arg("press_m") = 0.012, py::arg("amplitude_m") = py::none(), py::arg("frequency_hz") = 1.0,
           py::arg("hand") = "usual", py::arg("faults") = std::vector<std::tuple<std::string, double, double>>{},
           py::arg("delay_s") = 0.0, py::arg("jitter_s") = 0.0, py::arg("loss") = 0.0,
           "seed: of tremor, jitter and losses.\n"
           "motion: press, scrub, twist, tap or free.\n"
           "press_m: how far the hand means to go on after the touch, m.\n"
           "amplitude_m: of scrub, tap and free, m; None: a tenth of the smaller body, at most 0.01.\n"
           "frequency_hz: of the motion.\n"
           "hand: usual, soft or firm.\n"
           "faults: (kind, from_s, until_s) each; the kinds are in device_faults.\n"
           "delay_s, jitter_s: age of a measurement, s, 0.02 together at the most. loss: share of measurements lost.")
      .def_property_readonly(
          "seed", [](const device_wish& d) { return d.settings.seed; }, "Seed of tremor, jitter and losses.")
      .def("__repr__",
           [](const device_wish& d) { return "SimulatedDevice(seed=" + std::to_string(d.settings.seed) + ")"; });
  py::class_<session_handle>(m, "SessionLoop", "Both loops on the virtual clock; asperity.Session is the way in.")
      .def(py::init(&made_session), py::arg("renderer"), py::arg("device"), py::kw_only(), py::arg("start_pose"),
           py::arg("device_rate_hz"), py::arg("contact_rate_hz"), py::arg("coupling_n_per_m"),
           py::arg("coupling_n_m_per_rad"), py::arg("scale"), py::arg("friction"), py::arg("contact") = py::none(),
           py::arg("hand") = py::none(), "See asperity.Session.")
      .def("run", &run, py::arg("seconds"), "Numbers (N, 34) and the words of sample, device and fault.")
      .def("commit", &commit, "Hands over what was changed in the scene; the version.")
      .def_property_readonly("scene_in_use", &scene_in_use, "(version, tick, time in s); see asperity.Session.")
      .def("stop", &stop, "The rows in which the wrench goes to zero, as run() gives them.")
      .def_property_readonly(
          "fault", [](session_handle& self) { return to_string(self.fault()); }, "What shut the gate, or none.")
      .def_property_readonly(
          "time_s", [](const session_handle& self) { return self.time_s(); }, "Time of the next device tick, s.");
}

}  // namespace asperity::python
