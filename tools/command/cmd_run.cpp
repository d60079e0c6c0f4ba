// asperity run: a session of the two-rate loop with a device.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <optional>
#include <thread>
#include <utility>

#include "approach.hpp"
#include "asperity/hal/simulated/simulated_device.hpp"
#include "cli.hpp"
#include "gpu_report.hpp"
#include "known_devices.hpp"
#include "model_report.hpp"
#include "options.hpp"
#include "poses.hpp"
#include "recording.hpp"
#include "render_options.hpp"
#include "scene_loading.hpp"
#include "session.hpp"
#include "session_summary.hpp"
#include "statistics.hpp"
#include "text.hpp"

namespace asperity::command {
namespace {

struct run_command {
  std::string probe;
  std::vector<std::string> fixed;
  std::string probe_pose;
  std::vector<std::string> fixed_poses;
  std::string device = "simulated";
  double seconds = 3.0;
  std::string motion = "scrub";
  std::uint64_t seed = 1;
  double press_m = 0.012;
  double contact_rate_hz = 1000.0;
  std::string clock;  // empty: what fits the device
  std::string firmware;
  std::string record;
  std::string plot;
  render_options render;
};

bool is_simulated(const run_command& options) { return options.device == "simulated"; }

std::string clock_of(const run_command& options) {
  if (!options.clock.empty()) return options.clock;
  return is_simulated(options) ? "virtual" : "real";
}

constexpr double clearance_m = 0.003;  // the hand starts this far above the touch

/// Where the bodies are; the probe's start is found later where nobody gave it.
struct given_poses {
  std::optional<pose> T_wa;
  std::vector<pose> T_wb;
};

json to_json(const pose& T) {
  const auto q = to_xyzw(T.rotation);
  return {T.position.x, T.position.y, T.position.z, q[0], q[1], q[2], q[3]};
}

result<given_poses> read_poses(const run_command& options) {
  if (options.fixed_poses.size() > options.fixed.size()) {
    return error{error_code::invalid_argument, "there are more --fixed-pose than --fixed: give at most one for each"};
  }
  given_poses out{std::nullopt, std::vector<pose>(options.fixed.size())};
  if (!options.probe_pose.empty()) {
    const result<pose> T_wa = read_pose("--probe-pose", options.probe_pose);
    if (!T_wa) return T_wa.error();
    out.T_wa = *T_wa;
  }
  for (std::size_t i = 0; i < options.fixed_poses.size(); ++i) {
    const result<pose> T_wb = read_pose("--fixed-pose", options.fixed_poses[i]);
    if (!T_wb) return T_wb.error();
    out.T_wb[i] = *T_wb;
  }
  return out;
}

// Just above the first touch, or at the touch for a motion that has no approach.
result<pose> start_above(const run_command& options, chosen_renderer& feel, const std::vector<pose>& T_wb) {
  const step_function step = [&](const scene_pose& at, tick& out) { return feel.step(at, out); };
  result<pose> touch = find_touch(feel.scene(), step, quat(1.0, 0.0, 0.0, 0.0), T_wb);
  if (touch && options.motion != "free") touch->position.z += clearance_m;
  return touch;
}

// The handle sits at the probe's centre of mass: its torque is then the one that turns the probe in the hand.
workspace_map map_of(const pose& T_wa_start, const vec3& centre_of_mass_a) {
  const quat& r = T_wa_start.rotation;
  return {.T_wd = {quat(1.0, 0.0, 0.0, 0.0), T_wa_start * centre_of_mass_a},
          .scale = 1.0,
          .T_ha = {r, -(r * centre_of_mass_a)}};
}

std::int64_t steady_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

// The axes of a device of one's own are the world's; the probe is taken up in the pose in which the hand holds the
// handle.
workspace_map map_of(const pose& T_wa_start, const vec3& centre_of_mass_a, const pose& T_dh_start) {
  const vec3 grip_w = T_wa_start * centre_of_mass_a;
  const pose T_wh_start{T_dh_start.rotation, grip_w};
  return {.T_wd = {quat(1.0, 0.0, 0.0, 0.0), grip_w - T_dh_start.position},
          .scale = 1.0,
          .T_ha = inverse(T_wh_start) * T_wa_start};
}

// Where the handle is: a device needs a moment for its first measurement.
result<pose> first_pose(any_device& device) {
  device_sample sample;
  for (int ms = 0; ms < 1000; ++ms) {
    const std::int64_t now_ns = steady_ns();
    if (device.read(now_ns, sample) == status::ok && has_all(sample.valid, sample_field::position)) return sample.T_dh;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return error{error_code::io_failed,
               std::string(device.capabilities().name) +
                   " is open and measured nothing for a second: unplug it, plug it in again, and "
                   "see `asperity devices`"};
}

motion_config motion_of(const run_command& options, const scene& bodies) {
  const double size = std::min(bodies.probe->box.diagonal(), bodies.fixed.front()->box.diagonal());
  motion_config motion;
  motion.kind = options.motion == "press"   ? motion_kind::press
                : options.motion == "twist" ? motion_kind::twist
                : options.motion == "free"  ? motion_kind::free
                                            : motion_kind::scrub;
  // Oblique to both horizontal axes, so that ridges along either of them are felt.
  motion.sideways_d = {0.8, 0.6, 0.0};
  motion.depth_m = options.press_m + (options.probe_pose.empty() ? clearance_m : 0.0);
  motion.amplitude_m = std::min(0.01, 0.1 * size);
  return motion;
}

std::string stem(const std::string& file) { return std::filesystem::path(file).stem().string(); }

std::string plot_title(const run_command& options, const session_summary& summary) {
  const char* const does = options.motion == "press"   ? " presses on "
                           : options.motion == "twist" ? " twists on "
                           : options.motion == "free"  ? " wanders over "
                                                       : " scrubs ";
  const std::string who = stem(options.probe) + does + stem(options.fixed.front());
  if (!summary.touched()) return who + " and never touches it.";
  return who + ": up to " + brief(summary.largest_hand_force_n()) + " N and " +
         brief(1e3 * summary.largest_hand_torque_n_m()) + " mN m on the hand, " + brief(summary.mean_contacts()) +
         (summary.mean_contacts() == 1.0 ? " contact" : " contacts on average") + " while touching.";
}

std::string plot_caption(const run_command& options) {
  return (is_simulated(options) ? "Simulated device" : options.device) + " at 1 kHz, contact loop at " +
         brief(options.contact_rate_hz) + " Hz, " + clock_of(options) + " clock, " +
         (formulation_name(options.render) == "shared" ? "contacts as one potential" : "contacts as in the paper") +
         (is_simulated(options) ? ", seed " + std::to_string(options.seed) : "") +
         "; world axes, torque about the probe's centre of mass.";
}

/// The files that a session leaves. Both are opened before it begins.
class session_files {
 public:
  [[nodiscard]] static result<session_files> open(const run_command& options) {
    session_files files;
    if (!options.record.empty()) {
      result<recording> opened = recording::create(options.record);
      if (!opened) return opened.error();
      files.record_.emplace(std::move(opened).value());
    }
    if (!options.plot.empty()) {
      result<output_file> opened = output_file::create(options.plot);
      if (!opened) return opened.error();
      files.plot_.emplace(std::move(opened).value());
      files.curves_.emplace(static_cast<std::size_t>(options.seconds * 1000.0));
    }
    return files;
  }

  [[nodiscard]] result<void> add(const session_record& tick) {
    if (curves_) curves_->add(tick);
    return record_ ? record_->add(tick) : result<void>();
  }

  /// Both files are written before either appears.
  [[nodiscard]] result<void> close(const run_command& options, const session_summary& summary) {
    if (plot_) {
      const bool svg = extension_error(options.plot, {".svg"}).empty();
      const plot_page page = curves_->page(plot_title(options, summary), plot_caption(options));
      if (const result<void> drawn = draw(page, svg ? plot_format::svg : plot_format::png, *plot_); !drawn)
        return drawn;
    }
    if (record_) {
      if (const result<void> closed = record_->close(); !closed) return closed;
    }
    return plot_ ? plot_->commit() : result<void>();
  }

 private:
  std::optional<recording> record_;
  std::optional<output_file> plot_;
  std::optional<session_curves> curves_;
};

json loop_json(const loop_times& times, const time_summary& measured) {
  return {{"ticks", times.ticks}, {"late", times.late}, {"skipped", times.skipped}, {"tick_time", to_json(measured)}};
}

std::string loop_text(const loop_times& times, const time_summary& measured) {
  return std::to_string(times.ticks) + " ticks, " + std::to_string(times.late) + " late, " +
         std::to_string(times.skipped) + " skipped; " + to_text(measured);
}

/// What a session holds in memory, bytes, and on a GPU.
struct memory_use {
  std::size_t models = 0;
  std::size_t renderer = 0;
  std::shared_ptr<gpu_use> gpu{};  ///< null where no GPU is used
};

// The flight recorder. What was not finite is null, as JSON has no word for it.
json fault_json(const session_outcome& ended) {
  if (ended.fault == gate_fault::none) return nullptr;
  json ticks = json::array();
  for (const flight_entry& e : ended.last_ticks) {
    ticks.push_back(
        {{"time", 1e-9 * static_cast<double>(e.time_ns)},
         {"sample", {{"sequence", e.seen.sequence}, {"pose", to_json(e.seen.T_dh)}}},
         {"wanted", {{"force", command::to_json(e.wanted.force)}, {"torque", command::to_json(e.wanted.torque)}}},
         {"sent", {{"force", command::to_json(e.sent.force)}, {"torque", command::to_json(e.sent.torque)}}}});
  }
  return {{"cause", to_string(ended.fault)}, {"time", ended.ended_at_s}, {"last_ticks", ticks}};
}

answer report(const run_command& options, const given_poses& poses, const session_outcome& ended,
              const session_summary& summary, const memory_use& memory) {
  const time_summary contact = summarise(ended.contact.seconds);
  const time_summary device = summarise(ended.device.seconds);
  json T_wb = json::array();
  for (const pose& T : poses.T_wb) T_wb.push_back(to_json(T));

  answer out;
  out.document = {{"probe", options.probe},
                  {"fixed", options.fixed},
                  {"start", {{"probe_pose", to_json(*poses.T_wa)}, {"fixed_poses", T_wb}}},
                  {"device", options.device},
                  {"clock", clock_of(options)},
                  {"motion", options.motion},
                  {"seed", options.seed},
                  {"seconds", ended.ended_at_s},
                  {"backend", options.render.backend},
                  {"formulation", formulation_name(options.render)},
                  {"gradient_scheme", gradient_name(options.render)},
                  {"grid", grid_json(options.render)},
                  {"lookup", lookup_json(options.render)}};
  out.document.update(summary.to_json());
  out.document["contact_loop"] = loop_json(ended.contact, contact);
  out.document["device_loop"] = loop_json(ended.device, device);
  out.document["tick_time_is"] = clock_of(options) == "virtual" ? "cpu" : "wall";
  out.document["memory"] = {{"models", memory.models}, {"renderer", memory.renderer}};
  if (memory.gpu) out.document["gpu"] = command::to_json(*memory.gpu);
  out.document["rejected_samples"] = ended.rejected_samples;
  out.document["lost_records"] = ended.lost_records;
  out.document["fault"] = to_string(ended.fault);
  out.document["fault_record"] = fault_json(ended);
  out.document["interrupted"] = ended.interrupted;
  out.document["recording"] = options.record.empty() ? json() : json(options.record);
  out.document["plot"] = options.plot.empty() ? json() : json(options.plot);
  out.document["units"] = "SI";

  out.text = stem(options.probe) + " felt on " + stem(options.fixed.front()) + ", " + brief(ended.ended_at_s) + " s, " +
             (is_simulated(options) ? options.motion + ", " : "") + clock_of(options) + " clock\n" + summary.to_text();
  out.text += row("contact loop", loop_text(ended.contact, contact));
  out.text += row("device loop", loop_text(ended.device, device));
  out.text += row("memory", memory_text(memory.models) + " models, " + memory_text(memory.renderer) + " renderer");
  if (memory.gpu) out.text += to_text(*memory.gpu);
  out.text += row("faults", to_string(ended.fault));
  if (!options.record.empty()) out.text += row("recording", options.record);
  if (!options.plot.empty()) out.text += row("plot", options.plot);
  if (!summary.touched())
    out.text += "  warning: the probe never touched anything: lower it with --press or --probe-pose\n";
  if (ended.lost_records > 0) {
    out.text += "  warning: " + std::to_string(ended.lost_records) + " ticks are missing from the recording\n";
  }

  if (ended.fault != gate_fault::none) {
    out.exit_status = exit_failed;
    out.complaint = "the output gate shut after " + brief(ended.ended_at_s) + " s (" + to_string(ended.fault) +
                    "): the wrench is zero; see the last rows of the recording";
  } else if (ended.interrupted) {
    out.exit_status = exit_interrupted;
    out.complaint = "interrupted after " + brief(ended.ended_at_s) + " s: the wrench is zero, the recording is closed";
  }
  return out;
}

// The first tick on a GPU compiles; the session shall not wait for that. Afterwards the thread of the contact loop
// takes the context.
result<void> make_ready(chosen_renderer& feel, const given_poses& poses) {
  tick unused;
  const status answered = feel.step({*poses.T_wa, poses.T_wb}, unused);
  feel.gpu()->leave_thread();
  if (answered == status::backend_failed) return gpu_failed(*feel.gpu());
  return {};
}

error gpu_lost(const session_record& tick) {
  return {error_code::unsupported, "the GPU gave no answer after " + brief(1e-9 * static_cast<double>(tick.time_ns)) +
                                       " s, the wrench went to zero: its driver lost the context or reports an error; "
                                       "add --fallback to let the CPU answer, or use --backend cpu"};
}

result<answer> run_session(const run_command& options, const common_options& common) {
  if (const result<void> ok = check(options.render); !ok) return ok.error();
  const bool simulated = is_simulated(options);
  const bool real_time = clock_of(options) == "real";
  if (!simulated && !real_time) {
    return error{error_code::invalid_argument,
                 "--clock virtual is for the simulated device: a hand at '" + options.device + "' lives in real time"};
  }
  if (options.render.backend == "exact" && real_time) {
    return error{error_code::invalid_argument,
                 "--backend exact takes as long as its search does, no contact would be in time: use --clock virtual"};
  }
  result<given_poses> poses = read_poses(options);
  if (!poses) return poses.error();
  result<session_files> files = session_files::open(options);
  if (!files) return files.error();

  progress_line progress(common.quiet);
  result<scene> bodies = load_scene(options.probe, options.fixed, options.render.allow_scale_mismatch);
  if (!bodies) return bodies.error();
  const mass_properties shape = bodies->probe->mass;
  std::optional<known_devices> known;  // outlives the device
  std::optional<any_device> device;
  if (simulated) {
    device.emplace(simulated_device({.seed = options.seed, .motion = motion_of(options, *bodies)}));
    if (const result<void> opened = device->open(); !opened) return opened.error();
  } else {
    known.emplace(options.firmware);
    result<any_device> opened = known->open(options.device);
    if (!opened) return opened.error();
    device.emplace(std::move(opened).value());
  }
  result<chosen_renderer> feel = make_chosen_renderer(std::move(bodies).value(), options.render);
  if (!feel) return feel.error();
  const std::shared_ptr<gpu_use> gpu = feel->gpu();
  if (gpu && !common.quiet) warn(*gpu);
  if (!poses->T_wa) {
    const result<pose> start = start_above(options, *feel, poses->T_wb);
    if (gpu && gpu->failed > 0) return gpu_failed(*gpu);
    if (!start) return start.error();
    poses->T_wa = *start;
  }
  if (gpu) {
    if (const result<void> ready = make_ready(*feel, *poses); !ready) return ready.error();
  }

  const memory_use memory{memory_bytes(feel->scene()), feel->memory_bytes(), gpu};
  session_summary summary;
  control_config control;
  control.map = map_of(*poses->T_wa, shape.centre_of_mass);
  if (!simulated) {
    const result<pose> T_dh = first_pose(*device);
    if (!T_dh) return T_dh.error();
    control.map = map_of(*poses->T_wa, shape.centre_of_mass, *T_dh);
  }
  control.probe = solid_probe(shape);
  const result<session_outcome> ended =
      run_session({.feel = std::move(feel).value(),
                   .placement = {poses->T_wb, shape.centre_of_mass},
                   .device = std::move(*device),
                   .control = control,
                   .clock = real_time ? session_clock::real_time : session_clock::virtual_time,
                   .seconds = options.seconds,
                   .contact_period_ns = std::llround(1e9 / options.contact_rate_hz),
                   .on_tick = [&](const session_record& tick) -> result<void> {
                     summary.add(tick);
                     if (gpu && tick.contact_status == status::backend_failed) return gpu_lost(tick);
                     return files->add(tick);
                   }},
                  progress);
  if (!ended) return ended.error();
  if (const result<void> closed = files->close(options, summary); !closed) return closed.error();
  return report(options, *poses, *ended, summary, memory);
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
                 "Device: simulated, or the identity, path, driver or part of the name of one of `asperity devices`")
      ->capture_default_str();
  sub.add_option("--firmware", o->firmware, "Your copy of the firmware of a Novint Falcon");
  sub.add_option("--seconds", o->seconds, "Length of the session")
      ->check(positive_number_error, "NUMBER > 0")
      ->check(CLI::Range(1e-3, 86400.0))
      ->capture_default_str();
  sub.add_option("--motion", o->motion, "What the simulated hand does")
      ->check(CLI::IsMember({"press", "scrub", "twist", "free"}))
      ->capture_default_str();
  sub.add_option("--seed", o->seed, "Seed of the simulated hand")
      ->check(whole_number_error, "WHOLE NUMBER")
      ->capture_default_str();
  sub.add_option("--press", o->press_m, "How far below the first touch the hand aims (m)")
      ->check(positive_number_error, "NUMBER > 0")
      ->capture_default_str();
  sub.add_option("--contact-rate", o->contact_rate_hz, "Rate of the contact loop (Hz); the device loop runs at 1000")
      ->check(positive_number_error, "NUMBER > 0")
      ->check(CLI::Range(1.0, 100000.0))
      ->capture_default_str();
  sub.add_option(
         "--clock", o->clock,
         "virtual: reproducible, as fast as it goes, for the simulated device its default; real: two threads in "
         "real time")
      ->check(CLI::IsMember({"virtual", "real"}));
  sub.add_option("--record", o->record, "Recording to write, a CSV table with one row per device tick");
  sub.add_option("--plot", o->plot, "Picture to write: position, force and torque over time (.png, .svg)")
      ->check(
          [](const std::string& text) {
            return extension_error(text, {".png", ".svg"});
          },
          "FILE");
  add_render_options(sub, o->render);
}

}  // namespace asperity::command
