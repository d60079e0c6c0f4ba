// asperity run: a session of the two-rate loop with a device.
#include <cmath>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "asperity/control/real_time_thread.hpp"
#include "asperity/device/simulated/simulated_device.hpp"
#include "cli.hpp"
#include "device_recorder.hpp"
#include "device_replay.hpp"
#include "driver_guard.hpp"
#include "driver_options.hpp"
#include "file_names.hpp"
#include "gpu_report.hpp"
#include "interrupt.hpp"
#include "known_devices.hpp"
#include "options.hpp"
#include "poses.hpp"
#include "rate_check.hpp"
#include "render_kinds.hpp"
#include "run_abandon.hpp"
#include "run_command.hpp"
#include "run_files.hpp"
#include "run_report.hpp"
#include "run_start.hpp"
#include "run_view.hpp"
#include "scene_loading.hpp"
#include "session.hpp"
#include "session_summary.hpp"
#include "text.hpp"

namespace asperity::command {
namespace {

result<void> check_options(const run_command& options) {
  if (options.view && !view_port_of(*options.view)) {
    return error{error_code::invalid_argument,
                 "--view " + *options.view + ": a port is a whole number from 0 (any that is free) to 65535"};
  }
  if (!options.view && options.view_address != run_command().view_address) {
    return error{error_code::invalid_argument, "--view-address is of the live page: add --view"};
  }
  if (is_led(options) && !options.view) {
    return error{error_code::invalid_argument, "--motion mouse leads the hand from the live page: add --view"};
  }
  if (is_led(options) && !is_simulated(options)) {
    return error{error_code::invalid_argument,
                 "--motion mouse leads the simulated hand: leave it out, or use --device simulated"};
  }
  if (const result<void> ok = check(options.render); !ok) return ok;
  if (is_replay(options) && replayed_file(options).empty()) {
    return error{error_code::invalid_argument, "--device replay: names no file: use --device replay:FILE"};
  }
  const bool real_time = clock_of(options) == "real";
  if (is_replay(options) && real_time) {
    return error{
        error_code::invalid_argument,
        "--clock real is not for a replay, whose ticks are at the times of the recording: use --clock virtual"};
  }
  if (!is_simulated(options) && !is_replay(options) && !real_time) {
    return error{error_code::invalid_argument,
                 "--clock virtual is for the simulated device and for replays: a hand at '" + options.device +
                     "' lives in real time"};
  }
  if (options.render.backend == "exact" && real_time) {
    return error{error_code::invalid_argument,
                 "--backend exact takes as long as its search does, no contact would be in time: use --clock virtual"};
  }
  if (!options.friction.empty() && formulation_name(options.render) != "planes") {
    return error{error_code::invalid_argument,
                 "--friction is of support planes: leave it out, or use --contacts planes"};
  }
  if (options.no_local_model && formulation_name(options.render) != "planes") {
    return error{error_code::invalid_argument,
                 "--no-local-model is of support planes: leave it out, or use --contacts planes"};
  }
  if (!options.moves.empty() && formulation_name(options.render) != "planes") {
    return error{error_code::invalid_argument,
                 "--move is for support planes, which go with their bodies: leave it out, or use --contacts planes"};
  }
  const double longest_recorded_s = most_recorded_ticks / options.device_rate_hz;
  if (!options.record_device.empty() && seconds_of(options) > longest_recorded_s) {
    return error{error_code::invalid_argument, "--record-device holds " + brief(longest_recorded_s) +
                                                   " s at the most, more calls are in no recording: use --seconds " +
                                                   brief(longest_recorded_s)};
  }
  std::vector<named_file> inputs{{"--probe", options.probe}, {"--firmware", options.firmware}};
  for (const std::string& body : options.fixed) inputs.push_back({"--fixed", body});
  if (is_replay(options)) inputs.push_back({"--device", replayed_file(options)});
  const std::vector<named_file> outputs{
      {"--record", options.record}, {"--record-device", options.record_device}, {"--plot", options.plot}};
  return check_outputs(inputs, outputs);
}

// What a session is felt with. The parts behind the device outlive it, and the watch outlives both.
struct felt_device {
  driver_watch& watch;
  std::unique_ptr<known_devices> known;
  std::optional<device_replay> replay;
  std::optional<any_device> device;
  std::shared_ptr<hand_lead> lead;  // that a page leads the simulated hand by

  explicit felt_device(driver_watch& calls) : watch(calls) {}
  felt_device(const felt_device&) = delete;
  felt_device& operator=(const felt_device&) = delete;
  ~felt_device() {
    device.reset();
    const driver_watch::call closing(watch, driver_call::close);
    known.reset();
  }
};

// The simulated hand holds the clutch's button down for a fifth of the session, in its middle.
std::vector<scripted_press> presses_of(const run_command& options) {
  if (options.clutch_button == 0) return {};
  const double length_ns = 1e9 * seconds_of(options);
  return {{.buttons = button_bit(options.clutch_button),
           .from_ns = std::llround(0.4 * length_ns),
           .until_ns = std::llround(0.6 * length_ns)}};
}

result<void> open_device(const run_command& options, const scene& bodies, felt_device& felt) {
  if (is_led(options)) felt.lead = std::make_shared<hand_lead>();
  if (felt.replay) {
    felt.device.emplace(felt.replay->device());
  } else if (is_simulated(options)) {
    // A simulated handle has the weight that is to be held up.
    plant_settings plant;
    if (const std::optional<weight_settings> w = weight_of(options.weight)) {
      plant.gravity_d = w->mass_kg / plant.mass_kg * w->gravity_d;
      plant.centre_h = w->centre_h;
    }
    felt.device.emplace(simulated_device({.seed = options.seed,
                                          .motion = motion_of(options, bodies),
                                          .plant = plant,
                                          .presses = presses_of(options),
                                          .lead = felt.lead}));
    return felt.device->open();
  } else {
    {
      const driver_watch::call finding(felt.watch, driver_call::find);
      result<std::unique_ptr<known_devices>> known =
          known_devices::look(options.drivers, options.device, options.firmware);
      if (!known) return known.error();
      felt.known = std::move(known).value();
    }
    const driver_watch::call opening(felt.watch, driver_call::open);
    result<any_device> opened = felt.known->open(options.device);
    if (!opened) return opened.error();
    felt.device.emplace(watched_device(std::move(opened).value(), felt.watch));
  }
  return {};
}

// Asked between the steps of the start, which may take long: nothing is opened or armed for a session that nobody wants
// any more.
result<void> still_wanted() {
  if (!interrupted()) return {};
  return error{error_code::cancelled, "interrupted by " + signal_name(stop_signal()) +
                                          " before the session began: nothing was felt, nothing was written"};
}

// Where the handle is at the start; nothing for the simulated device, which moves where it is put.
result<std::optional<pose>> start_of_handle(const run_command& options, const felt_device& felt, any_device& device) {
  if (felt.replay) return felt.replay->T_dh_start();
  if (is_simulated(options)) return std::optional<pose>();
  const result<pose> T_dh = first_pose(device);
  if (!T_dh) return T_dh.error();
  return std::optional(*T_dh);
}

// The motions of --move, and where their bodies begin.
result<void> read_moves(const run_command& options, std::vector<pose>& T_wb, std::vector<body_script>& out) {
  for (const std::string& text : options.moves) {
    result<body_script> move = body_script::read(text, options.fixed.size());
    if (!move) return move.error();
    for (const body_script& other : out) {
      if (other.body() != move->body()) continue;
      return error{error_code::invalid_argument,
                   "--move names body " + std::to_string(move->body() + 1) + " twice: one motion for each body"};
    }
    T_wb[move->body()] = move->begins_at(T_wb[move->body()]);
    out.push_back(std::move(move).value());
  }
  if (out.size() <= most_moving_bodies) return {};
  return error{error_code::limit_exceeded,
               "--move is for " + std::to_string(most_moving_bodies) + " bodies at the most"};
}

// The first tick on a GPU compiles; the session shall not wait for that. Afterwards the thread of the contact loop
// takes the context.
result<void> make_ready(any_renderer& feel, const gpu_use& gpu, const given_poses& poses) {
  tick unused;
  const status answered = feel.step({*poses.T_wa, poses.T_wb}, unused);
  gpu.leave_thread();
  if (answered == status::backend_failed) return gpu_failed(gpu);
  return {};
}

// Whether this machine keeps the contact loop's rate. Nothing for contacts that a session does not wait for, and on a
// GPU, whose ticks are counted and whose contexts stay with one thread.
std::optional<rate_check> look_at_rate(const render_options& chosen, any_renderer& feel,
                                       const scene_placement& placement, const std::optional<pose>& touch_T_wa,
                                       const control_settings& control) {
  if (chosen.backend != "cpu") return std::nullopt;
  const auto look = [&](any_renderer& with) -> std::optional<rate_check> {
    const result<pose> touch = touch_T_wa ? result<pose>(*touch_T_wa) : first_touch(with, placement.T_wb);
    if (!touch) return std::nullopt;
    rate_check out = check_rate(with, placement, *touch, control, chosen.periods);
    out.threads = more_threads(chosen, std::thread::hardware_concurrency());
    return out;
  };
  // Windows go on from those of the tick before, so a session begins with a renderer that knows of none of
  // these. The others tell the same whatever they were asked before.
  if (formulation_name(chosen) != "window") return look(feel);
  result<any_renderer> another = make_chosen_renderer(feel.scene(), chosen);
  return another ? look(*another) : std::nullopt;
}

error gpu_lost(const session_record& tick) {
  return {error_code::unsupported, "the GPU gave no answer after " + brief(1e-9 * static_cast<double>(tick.time_ns)) +
                                       " s, the wrench went to zero: its driver lost the context or reports an error; "
                                       "add --fallback to let the CPU answer, or use --backend cpu"};
}

result<answer> run_session(const run_command& options, const common_options& common) {
  if (const result<void> ok = check_options(options); !ok) return ok.error();
  session_findings found(periods_of(options));
  result<given_poses> poses = read_poses(options);
  if (!poses) return poses.error();
  result<session_files> files = session_files::open(options);
  if (!files) return files.error();
  std::vector<body_script> moves;
  if (const result<void> read = read_moves(options, poses->T_wb, moves); !read) return read.error();
  session_rescue rescue;
  driver_watch watch;
  // These see the device's end, too.
  std::optional<device_hold> hold;
  std::optional<driver_guard> guard;
  felt_device felt(watch);
  if (is_replay(options)) {
    result<device_replay> opened = device_replay::open(replayed_file(options));
    if (!opened) return opened.error();
    felt.replay.emplace(std::move(opened).value());
  }

  progress_line progress(common.quiet);
  result<scene> bodies = load_scene(options.probe, options.fixed, options.render.allow_scale_mismatch);
  if (!bodies) return bodies.error();
  const mass_properties shape = bodies->probe->mass;
  if (const result<void> wanted = still_wanted(); !wanted) return wanted.error();
  // A search for the exact maximum cannot be hurried, and no hand waits for its end.
  if (options.render.backend != "exact") hold.emplace();
  if (!is_simulated(options) && !is_replay(options)) {
    guard.emplace(watch, [&](const std::string& what) { abandon(rescue, *files, what, common.json); });
  }
  if (const result<void> opened = open_device(options, *bodies, felt); !opened) return opened.error();
  render_options chosen = options.render;
  chosen.periods = periods_of(options);
  chosen.motion_scale = options.scale;
  if (clock_of(options) == "real") chosen.set_up_helper = set_up_real_time_helper;
  result<any_renderer> feel = make_chosen_renderer(std::move(bodies).value(), chosen);
  if (!feel) return feel.error();
  const std::shared_ptr<gpu_use> gpu = gpu_use_of(*feel);
  if (const result<void> wanted = still_wanted(); !wanted) return wanted.error();
  if (gpu && !common.quiet) warn(*gpu);
  std::optional<pose> touch_T_wa;
  if (!poses->T_wa) {
    const result<pose> touch = first_touch(*feel, poses->T_wb);
    if (gpu && gpu->failed > 0) return gpu_failed(*gpu);
    if (!touch) return touch.error();
    touch_T_wa = *touch;
    poses->T_wa = start_above(options, *touch);
  }
  if (gpu) {
    if (const result<void> ready = make_ready(*feel, *gpu, *poses); !ready) return ready.error();
  }

  found.poses = *poses;
  found.memory = {memory_bytes(feel->scene()), feel->memory_bytes(), gpu};
  any_device device = files->recorder() ? files->recorder()->around(*felt.device) : std::move(*felt.device);
  const result<std::optional<pose>> T_dh = start_of_handle(options, felt, device);
  if (!T_dh) return T_dh.error();
  control_settings control;
  control.map = *T_dh ? map_of(*poses->T_wa, shape.centre_of_mass, options.scale, **T_dh)
                      : map_of(*poses->T_wa, shape.centre_of_mass, options.scale);
  control.clutch.buttons = button_bit(options.clutch_button);
  control.probe = found.probe = felt_alike(solid_probe(shape), options.scale);
  found.coupling = coupling_of(options, device.capabilities(), control.map.scale);
  control.coupling = found.coupling.settings;
  control.velocity = velocity_of(options);
  control.transient = transient_of(options.transient).value_or(transient_settings{});
  control.weight = weight_of(options.weight).value_or(weight_settings{});
  if (const result<void> fits = check(control.weight, device.capabilities()); !fits) return fits.error();
  if (formulation_name(options.render) == "planes") control.surfaces = surfaces_of(feel->scene());
  if (!options.friction.empty()) {
    control.friction = friction_of(options.friction).value_or(friction_settings{});
    const auto override_friction = [&](surface_pair& pair) {
      pair.static_friction = control.friction.static_coefficient;
      pair.dynamic_friction = control.friction.dynamic_coefficient;
    };
    for (std::optional<surface_pair>& pair : control.surfaces) {
      if (pair) override_friction(*pair);
    }
    for (mapped_pair& m : control.surfaces.mapped) override_friction(m.pair);
  }
  control.local_model = !options.no_local_model;
  found.surfaces = control.surfaces;
  found.rate = look_at_rate(chosen, *feel, {poses->T_wb, shape.centre_of_mass}, touch_T_wa, control);
  if (found.rate && !common.quiet && !common.json) complain("note: " + to_text(*found.rate));
  if (const result<void> wanted = still_wanted(); !wanted) return wanted.error();
  std::optional<run_view> page;
  if (options.view) {
    result<run_view> opened = run_view::open(options, feel->scene(), poses->T_wb, *poses->T_wa, control.map,
                                             device.capabilities(), felt.lead);
    if (!opened) return opened.error();
    page.emplace(std::move(opened).value());
    complain("note: the page is at " + page->url());
  }
  result<session_outcome> ended =
      run_session({.feel = page ? page->around(std::move(feel).value()) : std::move(feel).value(),
                   .placement = {poses->T_wb, shape.centre_of_mass},
                   .device = std::move(device),
                   .control = control,
                   .moves = std::move(moves),
                   .clock = clock_of(options) == "real" ? session_clock::real_time : session_clock::virtual_time,
                   .seconds = options.seconds.value_or(felt.replay ? felt.replay->seconds(periods_of(options).device_ns)
                                                                   : seconds_of(options)),
                   .periods = periods_of(options),
                   .ticks = felt.replay ? std::optional(felt.replay->ticks()) : std::nullopt,
                   .on_tick = [&](const session_record& tick) -> result<void> {
                     found.summary.add(tick);
                     if (gpu && tick.contact_status == status::backend_failed) return gpu_lost(tick);
                     return files->add(tick);
                   },
                   .on_start =
                       [&](const real_time_grants& got) {
                         if (!common.quiet) complain("note: real time: " + to_text(got));
                       },
                   .guard = guard ? &*guard : nullptr,
                   .rescue = &rescue,
                   .watch = page ? std::optional(page->watch()) : std::nullopt},
                  progress);
  page.reset();
  if (!ended) return ended.error();
  if (felt.replay) found.replay = felt.replay->outcome();
  if (felt.known) found.driver = felt.known->what_happened();
  {
    const std::lock_guard lock(rescue.writing);
    if (const result<void> closed = files->close(options, *ended, found.summary); !closed) return closed.error();
  }
  found.ended = std::move(ended).value();
  return report(options, found);
}

}  // namespace

void add_run(command_line& line) {
  const auto o = std::make_shared<run_command>();
  CLI::App& sub = line.add("run", "Feel one model with another through a device",
                           [o](const common_options& common) { return run_session(*o, common); });
  sub.add_option("--probe", o->probe, "Textured model that the hand moves (.glb)")->required();
  sub.add_option("--fixed", o->fixed, "Textured model that it touches (.glb); may be given several times")
      ->required()
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  sub.add_option("--probe-pose", o->probe_pose,
                 "Pose of the probe at the start, \"x y z qx qy qz qw\" (m); by default just above the fixed body")
      ->check(pose_form_error, "POSE");
  sub.add_option("--fixed-pose", o->fixed_poses, "Pose of each fixed body, in their order; the origin by default")
      ->check(pose_form_error, "POSE")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  sub.add_option("--device", o->device,
                 "Device: simulated; the identity, path, driver or part of the name of one of `asperity devices`; or "
                 "replay:FILE, a session on record. A driver in the driver path is enabled by its name here")
      ->capture_default_str();
  sub.add_option("--firmware", o->firmware, "Your copy of the firmware of a Novint Falcon");
  add_driver_options(sub, o->drivers);
  sub.add_option("--seconds", o->seconds,
                 "Length of the session, 3 by default; a replay lasts as long as its recording")
      ->check(positive_number_error, "NUMBER > 0")
      ->check(CLI::Range(1e-3, 86400.0));
  sub.add_option("--motion", o->motion, "What the simulated hand does; mouse: what a person does on the page of --view")
      ->check(CLI::IsMember({"press", "scrub", "twist", "free", "mouse"}))
      ->capture_default_str();
  sub.add_option("--seed", o->seed, "Seed of the simulated hand")
      ->check(whole_number_error, "WHOLE NUMBER")
      ->capture_default_str();
  sub.add_option("--press", o->press_m, "How far below the first touch the hand aims (m)")
      ->check(positive_number_error, "NUMBER > 0")
      ->capture_default_str();
  sub.add_option("--device-rate", o->device_rate_hz, "Rate of the device loop (Hz), 100 to 10000")
      ->check(loop_rate_error, "RATE")
      ->capture_default_str();
  sub.add_option("--contact-rate", o->contact_rate_hz,
                 "Rate of the contact loop (Hz), 100 to 10000; faster than the device loop, contacts are fresher")
      ->check(loop_rate_error, "RATE")
      ->capture_default_str();
  sub.add_option("--threads", o->render.threads,
                 "Threads that share a contact tick, with the same result for any number; they want processors of "
                 "their own")
      ->check(CLI::Range(1, 16))
      ->capture_default_str();
  sub.add_option("--coupling", o->coupling_n_per_m,
                 "Stiffness of the virtual coupling (N/m); by default what the device can show, and 500 with other "
                 "contacts than planes")
      ->check(positive_number_error, "NUMBER > 0")
      ->check(CLI::Range(1.0, 1e5));
  sub.add_option("--coupling-rotation", o->coupling_n_m_per_rad,
                 "The same of the rotation (N m/rad); by default what the device can show, and 3 with other contacts")
      ->check(positive_number_error, "NUMBER > 0")
      ->check(CLI::Range(1e-3, 1e3));
  sub.add_option(
         "--scale", o->scale,
         "Motion scaling: metres of the world for a metre of the device, 0.1 to 10; the force is scaled so that "
         "energy is kept")
      ->check(positive_number_error, "NUMBER > 0")
      ->check(CLI::Range(0.1, 10.0))
      ->capture_default_str();
  sub.add_option("--clutch", o->clutch_button,
                 "Button, 1 to 32, that lets go of the probe while it is held down; the simulated hand holds it for a "
                 "fifth of the session")
      ->check(CLI::Range(1, 32));
  sub.add_option(
         "--weight", o->weight,
         "Weight of the handle that the motors hold up: its mass (kg), and its centre in the handle's frame (m)")
      ->check(weight_error, "KG[,X,Y,Z]");
  sub.add_option(
         "--transient", o->transient,
         "What a first touch rings with: peak force for each m/s of approach (N), frequency (Hz, 150), decay (s, "
         "0.015)")
      ->check(transient_error, "N[,HZ[,S]]");
  sub.add_option("--velocity", o->velocity,
                 "Velocity of the handle for the coupling's damper: of its last poses, of a window of poses, which "
                 "smooths an encoder's steps, or the device's own")
      ->check(CLI::IsMember({"poses", "window", "device"}))
      ->capture_default_str();
  sub.add_option(
         "--friction", o->friction,
         "Coefficients of friction on support planes, STATIC or STATIC,DYNAMIC: 0.6,0.4; by default those of the "
         "models' materials, or none")
      ->check(friction_error, "MU[,MU]");
  sub.add_flag("--no-local-model", o->no_local_model,
               "Support planes stay between two contacts; by default they are read again where the probe is");
  sub.add_option("--move", o->moves,
                 "How a fixed body moves: conveyor=SPEED[,WAY] (m/s, m), pendulum=DEGREES,SECONDS, turntable=RPM, or "
                 "FILE.csv of poses; N: in front for the N-th body; may be given several times")
      ->check(body_script_error, "MOTION")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  sub.add_option(
         "--clock", o->clock,
         "virtual: reproducible, as fast as it goes, the default of the simulated device and of a replay; real: two "
         "threads in real time")
      ->check(CLI::IsMember({"virtual", "real"}));
  sub.add_option("--record", o->record,
                 "Recording to write, one row per device tick: .csv, .npz for numpy, .mcap for ROS 2's tools");
  sub.add_option("--record-device", o->record_device,
                 "Device recording to write, every call to the device and its answer; --device replay:FILE plays it");
  sub.add_option("--plot", o->plot, "Picture to write: position, force and torque over time (.png, .svg)")
      ->check(
          [](const std::string& text) {
            return extension_error(text, {".png", ".svg"});
          },
          "FILE");
  sub.add_option(
         "--view", o->view,
         "Show the session on a page of a browser, at this port or 8765; the session then lasts 600 s by default")
      ->expected(0, 1)
      ->type_name("[PORT]");
  sub.add_option("--view-address", o->view_address,
                 "Address of this machine at which the page is; another one than the loopback needs the token that is "
                 "printed")
      ->capture_default_str();
  o->render.usual_contacts = "planes";
  add_render_options(sub, o->render, {"planes", "least-motion", "window"});
}

}  // namespace asperity::command
