// asperity bench: what a contact costs, stage by stage, on this machine.
#include <algorithm>
#include <optional>
#include <utility>

#include "asperity/window/window_depth_settings.hpp"
#include "backend_report.hpp"
#include "cli.hpp"
#include "interrupt.hpp"
#include "model_report.hpp"
#include "model_shelf.hpp"
#include "options.hpp"
#include "progress.hpp"
#include "scene_loading.hpp"
#include "stage_times.hpp"
#include "statistics.hpp"
#include "text.hpp"
#ifdef ASPERITY_HAS_RIVALS
#include "rival_report.hpp"
#endif

namespace asperity::command {
namespace {

struct bench_command {
  std::string probe;
  std::string fixed;
  std::string models;
  scrubbing motion;
  std::optional<std::size_t> poses;  ///< not given: as many as what is measured usually takes
  bool rivals = false;               ///< race with other libraries instead
  std::optional<std::size_t> judged;
  std::string plot;
  std::optional<std::string> backend;  ///< given: compare depth backends instead
  std::optional<std::string> gpu;
  std::optional<std::uint32_t> grid;
  std::optional<std::size_t> repeats;
};

result<scene> bench_scene(const bench_command& options, progress_line& progress) {
  if (!options.probe.empty()) return load_scene(options.probe, {options.fixed}, false);
  experiment::model_shelf shelf(options.models, [&](std::string_view what, double done) {
    progress.show(what, done);
    return !interrupted();
  });
  result<model_ptr> probe = shelf.benchmark(models::benchmark::file);
  if (!probe) return probe.error();
  result<model_ptr> fixed = shelf.benchmark(models::benchmark::cad_part);
  if (!fixed) return fixed.error();
  return scene{std::move(probe).value(), {std::move(fixed).value()}};
}

std::string ratio_text(double ratio) { return brief(ratio) + " x"; }

answer report(const scene& bodies, const bench_command& options, const stage_times& m) {
  const time_summary query = summarise(m.query_s);
  const time_summary soft = summarise(m.soft_contact_s);
  const time_summary central = summarise(m.central_contact_s);
  const time_summary least_motion_tick = summarise(m.least_motion_tick_s);
  const time_summary soft_tick = summarise(m.soft_tick_s);
  const time_summary central_tick = summarise(m.central_tick_s);
  const time_summary planes_tick = summarise(m.planes_tick_s);
  const time_summary every_sample = summarise(m.every_sample_s);
  const time_summary probe = summarise(m.probe_s);
  const time_summary rubbing_probe = summarise(m.rubbing_probe_s);
  const time_summary planes_far_tick = summarise(m.planes_far_tick_s);
  const time_summary soft_far_tick = summarise(m.soft_far_tick_s);
  const time_summary follow = summarise(m.follow_s);
  const std::optional<time_summary> shared =
      m.follow_shared_s.empty() ? std::nullopt : std::optional(summarise(m.follow_shared_s));
  const auto mean_of = [&](std::uint32_t depth_work::*part) {
    double sum = 0.0;
    for (const depth_work& w : m.planes_work) sum += static_cast<double>(w.*part);
    return sum / static_cast<double>(m.planes_work.size());
  };
  double planes_held = 0.0;
  for (const double n : m.planes_held) planes_held += n / static_cast<double>(m.planes_held.size());
  double contacts = 0.0;
  for (const double n : m.contacts) contacts += n / static_cast<double>(m.contacts.size());
  const double most = *std::max_element(m.contacts.begin(), m.contacts.end());
  const auto body = [](const textured_model& b) {
    return json{{"name", b.name}, {"coarse_triangles", b.mesh.triangles.size()}, {"pieces", b.pieces.size()}};
  };

  answer out;
  out.document = {{"probe", body(*bodies.probe)},
                  {"fixed", body(*bodies.fixed.front())},
                  {"poses", options.motion.poses},
                  {"seed", options.motion.seed},
                  {"contacts", {{"mean", contacts}, {"max", most}}},
                  {"planes_held", {{"mean", planes_held}}},
                  {"samples",
                   {{"balls_looked_at", mean_of(&depth_work::looked_at)},
                    {"near", mean_of(&depth_work::listed)},
                    {"leaves_bounded", mean_of(&depth_work::bounded)},
                    {"read", mean_of(&depth_work::read)}}},
                  {"threads", options.motion.threads},
                  {"time_is", "cpu"},
                  {"seconds",
                   {{"collision_query", to_json(query)},
                    {"contact_soft", to_json(soft)},
                    {"contact_central", to_json(central)},
                    {"tick_planes", to_json(planes_tick)},
                    {"every_sample", to_json(every_sample)},
                    {"follow_on_wall", to_json(follow)},
                    {"follow_shared_on_wall", shared ? to_json(*shared) : json()},
                    {"probe_on_planes", to_json(probe)},
                    {"probe_rubbing_on_planes", to_json(rubbing_probe)},
                    {"tick_least_motion", to_json(least_motion_tick)},
                    {"tick_soft", to_json(soft_tick)},
                    {"tick_central", to_json(central_tick)}}},
                  {"ratios",
                   {{"contact_central_to_soft", central.p50_s / soft.p50_s},
                    {"every_sample_to_tick_planes", every_sample.p50_s / planes_tick.p50_s},
                    {"follow_to_follow_shared", shared ? json(follow.p50_s / shared->p50_s) : json()},
                    {"follow_to_follow_shared_p99", shared ? json(follow.p99_s / shared->p99_s) : json()},
                    {"tick_planes_p99_to_p50", planes_tick.p99_s / planes_tick.p50_s},
                    {"tick_planes_with_far_bodies", planes_far_tick.p50_s / planes_tick.p50_s},
                    {"tick_soft_with_far_bodies", soft_far_tick.p50_s / soft_tick.p50_s},
                    {"tick_least_motion_to_soft", least_motion_tick.p50_s / soft_tick.p50_s},
                    {"tick_least_motion_to_soft_p99", least_motion_tick.p99_s / soft_tick.p99_s},
                    {"tick_central_to_soft", central_tick.p50_s / soft_tick.p50_s},
                    {"collision_share_of_soft_tick", query.p50_s / soft_tick.p50_s},
                    {"collision_share_of_central_tick", query.p50_s / central_tick.p50_s},
                    {"tick_soft_p99_to_p50", soft_tick.p99_s / soft_tick.p50_s},
                    {"tick_central_p99_to_p50", central_tick.p99_s / central_tick.p50_s}}},
                  {"rates_hz",
                   {{"tick_planes", 1.0 / planes_tick.p50_s},
                    {"tick_least_motion", 1.0 / least_motion_tick.p50_s},
                    {"tick_soft", 1.0 / soft_tick.p50_s},
                    {"tick_central", 1.0 / central_tick.p50_s}}},
                  {"units", "SI"}};
  const auto name = [](const textured_model& b) {
    return printable(b.name) + " (" + std::to_string(b.pieces.size()) + " pieces)";
  };
  out.text = name(*bodies.probe) + " on " + name(*bodies.fixed.front()) + ", " + std::to_string(options.motion.poses) +
             " poses of a scrubbing path, " + brief(contacts) + " contacts on average, CPU time of one core\n";
  out.text += row("collision query", to_text(query));
  out.text += row("contact, soft maximum", to_text(soft));
  out.text +=
      row("contact, central diff.", to_text(central) + "  (" + ratio_text(central.p50_s / soft.p50_s) + " soft)");
  out.text += row("tick, planes", to_text(planes_tick) + "  (" + brief(1.0 / planes_tick.p50_s) + " Hz)");
  out.text += row("all near samples", to_text(every_sample) + "  (" +
                                          ratio_text(every_sample.p50_s / planes_tick.p50_s) + " tick, planes)");
  out.text += row("samples of that tick", brief(mean_of(&depth_work::looked_at)) + " balls looked at, " +
                                              brief(mean_of(&depth_work::listed)) + " samples near, " +
                                              brief(mean_of(&depth_work::read)) + " read; " +
                                              brief(mean_of(&depth_work::bounded)) + " leaves bounded");
  out.text += row("tick that follows", to_text(follow) + " on the wall");
  out.text +=
      row("shared by " + std::to_string(options.motion.threads) + " threads",
          shared ? to_text(*shared) + " on the wall  (one thread takes " + ratio_text(follow.p50_s / shared->p50_s) +
                       " p50, " + ratio_text(follow.p99_s / shared->p99_s) + " p99)"
                 : std::string("not measured: this machine has fewer processors"));
  out.text += row("device tick: probe",
                  to_text(probe) + " on " + brief(planes_held) + " planes; with friction " + to_text(rubbing_probe));
  out.text +=
      row("tick, one potential", to_text(least_motion_tick) + "  (" + brief(1.0 / least_motion_tick.p50_s) + " Hz, " +
                                     ratio_text(least_motion_tick.p50_s / soft_tick.p50_s) + " soft)");
  out.text += row("tick, soft maximum", to_text(soft_tick) + "  (" + brief(1.0 / soft_tick.p50_s) + " Hz, " +
                                            brief(100.0 * query.p50_s / soft_tick.p50_s) + " % collision)");
  out.text += row("tick, central diff.", to_text(central_tick) + "  (" + brief(1.0 / central_tick.p50_s) + " Hz, " +
                                             ratio_text(central_tick.p50_s / soft_tick.p50_s) + " soft)");
  out.text += row("with " + std::to_string(far_bodies) + " bodies out of reach",
                  ratio_text(planes_far_tick.p50_s / planes_tick.p50_s) + " tick, planes; " +
                      ratio_text(soft_far_tick.p50_s / soft_tick.p50_s) + " tick, soft maximum");
  return out;
}

result<void> check(const bench_command& options) {
  const char* const of_backends = options.gpu       ? "--gpu"
                                  : options.grid    ? "--grid"
                                  : options.repeats ? "--repeats"
                                                    : nullptr;
  if (!options.backend && of_backends != nullptr) {
    return error{error_code::invalid_argument,
                 std::string(of_backends) + " is for comparing depth backends: add --backend all"};
  }
  if (!options.rivals && (options.judged || !options.plot.empty())) {
    return error{error_code::invalid_argument, std::string(options.judged ? "--judged" : "--plot") +
                                                   " is for the race with other libraries: add --rivals"};
  }
  return {};
}

result<answer> race_with_rivals(const bench_command& options, progress_line& progress) {
#ifdef ASPERITY_HAS_RIVALS
  rival_bench wanted{.settings = {.seed = options.motion.seed}, .models = options.models, .plot = options.plot};
  wanted.settings.poses = options.poses.value_or(wanted.settings.poses);
  wanted.settings.judged = options.judged.value_or(wanted.settings.judged);
  return race_rivals(wanted, progress);
#else
  static_cast<void>(options), static_cast<void>(progress);
  return error{error_code::unsupported,
               "other libraries are not part of this build: run ./dev bench --rivals, or build with "
               "ASPERITY_BUILD_RIVALS on"};
#endif
}

result<answer> compare_backends(const scene& bodies, const bench_command& options, const common_options& common,
                                progress_line& progress) {
#ifdef ASPERITY_HAS_GL
  backend_bench wanted{.backend = *options.backend, .gpu = options.gpu, .seed = options.motion.seed};
  wanted.grid = options.grid.value_or(wanted.grid);
  wanted.repeats = options.repeats.value_or(wanted.repeats);
  const result<bench_of_backends> timed = time_backends(bodies, wanted, progress);
  if (!timed) return timed.error();
  return report(bodies, wanted, *timed, common.quiet);
#else
  static_cast<void>(bodies), static_cast<void>(options), static_cast<void>(common), static_cast<void>(progress);
  return error{error_code::unsupported,
               "OpenGL is not part of this build, so that there are no depth backends to compare: leave out --backend"};
#endif
}

result<answer> bench(const bench_command& options, const common_options& common) {
  if (const result<void> ok = check(options); !ok) return ok.error();
  progress_line progress(common.quiet);
  if (options.rivals) return race_with_rivals(options, progress);
  const result<scene> bodies = bench_scene(options, progress);
  if (!bodies) return bodies.error();
  if (options.backend) return compare_backends(*bodies, options, common, progress);
  bench_command along = options;
  along.motion.poses = options.poses.value_or(along.motion.poses);
  const result<stage_times> m = time_stages(*bodies, along.motion, progress);
  if (!m) return m.error();
  return report(*bodies, along, *m);
}

}  // namespace

void add_bench(command_line& line) {
  const auto o = std::make_shared<bench_command>();
  CLI::App& sub = line.add("bench", "Measure what contacts and ticks cost on this machine",
                           [o](const common_options& common) { return bench(*o, common); });
  auto* probe =
      sub.add_option("--probe", o->probe, "Textured model that moves (.glb); by default the benchmark's file");
  auto* fixed =
      sub.add_option("--fixed", o->fixed, "Textured model that stays (.glb); by default the benchmark's CAD part");
  probe->needs(fixed);
  fixed->needs(probe);
  sub.add_option("--models", o->models, "Folder of baked benchmark models; what is missing there is baked and kept")
      ->check(CLI::ExistingDirectory)
      ->excludes(probe);
  sub.add_option("--poses", o->poses, "Poses of the path; with --rivals 400")
      ->check(CLI::Range(10, 1000000))
      ->default_str(std::to_string(o->motion.poses));
  sub.add_option("--seed", o->motion.seed, "Seed of the path")
      ->check(whole_number_error, "WHOLE NUMBER")
      ->capture_default_str();
  sub.add_option("--threads", o->motion.threads, "Threads that share a tick of planes, beside one that works alone")
      ->check(CLI::Range(2, 16))
      ->capture_default_str();
  auto* rivals = sub.add_flag("--rivals", o->rivals,
                              "Race with other libraries on full-resolution meshes instead, judged by the originals; "
                              "./dev bench --rivals builds them in")
                     ->excludes(probe);
  sub.add_option("--judged", o->judged, "Poses of the path that are judged, with --rivals")
      ->check(CLI::Range(std::size_t{1}, std::size_t{100000}))
      ->default_str("40");
  sub.add_option("--plot", o->plot, "Picture of error over time to write, with --rivals (.png, .svg)")
      ->check([](const std::string& text) {
        return extension_error(text, {".png", ".svg"});
      });
  sub.add_option("--backend", o->backend, "Compare depth backends on a GPU with the CPU instead: all, or one of them")
      ->check(CLI::IsMember({"all", "gl-occlusion", "gl-compute"}))
      ->excludes(rivals);
  sub.add_option("--gpu", o->gpu, "GPU to measure, an index or a part of a name; see `asperity devices --gpu`")
      ->type_name("DEVICE");
  sub.add_option("--grid", o->grid, "Samples per side of a contact's window, with --backend")
      ->check(CLI::Range(std::uint32_t{2}, window_depth_settings::max_grid))
      ->default_str("64");
  sub.add_option("--repeats", o->repeats, "Times that each is measured, with --backend")
      ->check(CLI::Range(std::size_t{1}, std::size_t{10000}))
      ->default_str("10");
}

}  // namespace asperity::command
