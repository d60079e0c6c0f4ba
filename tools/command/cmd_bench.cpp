// asperity bench: what a contact costs, stage by stage, on this machine.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <random>
#include <utility>

#include "approach.hpp"
#include "asperity/bake/bake.hpp"
#include "asperity/io/textured_model_file.hpp"
#include "backend_report.hpp"
#include "benchmark_models.hpp"
#include "cli.hpp"
#include "cpu_clock.hpp"
#include "interrupt.hpp"
#include "model_report.hpp"
#include "options.hpp"
#include "output_file.hpp"
#include "progress.hpp"
#include "scene_loading.hpp"
#include "statistics.hpp"
#include "text.hpp"

namespace asperity::command {
namespace {

namespace fs = std::filesystem;

struct bench_command {
  std::string probe;
  std::string fixed;
  std::string models;
  std::size_t poses = 2000;
  std::uint64_t seed = 1;
  std::optional<std::string> backend;  ///< given: compare depth backends instead
  std::optional<std::string> gpu;
  std::optional<std::uint32_t> grid;
  std::optional<std::size_t> repeats;
};

/// Poses of a probe that scrubs over the place where it first touched, pressed in by a little.
std::vector<pose> scrubbing_path(const pose& touch, const bench_command& options, double size_m) {
  std::mt19937_64 bits(options.seed);
  const auto unit = [&] { return static_cast<double>(bits() >> 11) * 0x1.0p-53; };
  constexpr double two_pi = 6.283185307179586;
  const double amplitude_m = std::min(0.01, 0.1 * size_m);
  const double press_m = std::min(0.0005, 0.005 * size_m);
  const double phase[] = {two_pi * unit(), two_pi * unit(), two_pi * unit()};
  std::vector<pose> path;
  for (std::size_t i = 0; i < options.poses; ++i) {
    // A thousand poses a second, as a device loop would ask for.
    const double t = 1e-3 * static_cast<double>(i);
    pose T = touch;
    T.position += vec3(amplitude_m * (std::sin(two_pi * 1.0 * t + phase[0]) - std::sin(phase[0])),
                       amplitude_m * (std::sin(two_pi * 0.7 * t + phase[1]) - std::sin(phase[1])), -press_m);
    T.rotation = exp_rotation({0.0, 0.0, 0.05 * std::sin(two_pi * 0.4 * t + phase[2])}) * touch.rotation;
    path.push_back(T);
  }
  return path;
}

/// Bakes a benchmark model, or takes it from the folder of baked models.
result<model_ptr> benchmark_model(models::benchmark which, const bench_command& options, progress_line& progress) {
  const std::string name(models::to_string(which));
  const fs::path kept = options.models.empty() ? fs::path() : fs::path(options.models) / (name + ".glb");
  std::error_code ignored;
  if (!kept.empty() && fs::exists(kept, ignored)) {
    result<textured_model> loaded = io::load_textured_model(kept);
    if (!loaded) return loaded.error();
    return model_ptr(std::make_shared<const textured_model>(std::move(loaded).value()));
  }
  if (!kept.empty()) {
    if (const result<void> ok = check_writable(kept); !ok) return ok.error();
  }
  bake::bake_options settings;
  settings.name = name;
  settings.triangles = models::coarse_triangle_count(which);
  settings.progress = [&](std::string_view stage, double done) {
    progress.show("baking " + name + ", " + std::string(stage), done);
    return !interrupted();
  };
  result<textured_model> baked = bake::bake(models::make_full(which), settings);
  if (!baked) return baked.error();
  if (!kept.empty()) {
    if (const result<void> saved = io::save_textured_model(*baked, kept); !saved) return saved.error();
  }
  return model_ptr(std::make_shared<const textured_model>(std::move(baked).value()));
}

result<scene> bench_scene(const bench_command& options, progress_line& progress) {
  if (!options.probe.empty()) return load_scene(options.probe, {options.fixed}, false);
  result<model_ptr> probe = benchmark_model(models::benchmark::file, options, progress);
  if (!probe) return probe.error();
  result<model_ptr> fixed = benchmark_model(models::benchmark::cad_part, options, progress);
  if (!fixed) return fixed.error();
  return scene{std::move(probe).value(), {std::move(fixed).value()}};
}

/// CPU times along the path, one entry per pose; contact times are divided by the contacts of the pose.
struct measured {
  std::vector<double> query_s;
  std::vector<double> soft_contact_s, central_contact_s;
  std::vector<double> shared_tick_s, soft_tick_s, central_tick_s;
  std::vector<double> contacts;
};

result<measured> measure(const scene& bodies, const bench_command& options, progress_line& progress) {
  paper_settings soft_settings, central_settings;
  soft_settings.depth.gradient = gradient_scheme::soft_max;
  central_settings.depth.gradient = gradient_scheme::central_difference;
  result<renderer> shared = make_renderer(bodies);
  if (!shared) return shared.error();
  result<paper_renderer> soft = make_paper_renderer(bodies, soft_settings);
  if (!soft) return soft.error();
  result<paper_renderer> central = make_paper_renderer(bodies, central_settings);
  if (!central) return central.error();

  const std::vector<pose> T_wb(bodies.fixed.size());
  const step_function step = [&](const scene_pose& at, tick& found) { return soft->step(at, found); };
  const result<pose> touch = find_touch(bodies, step, quat(1.0, 0.0, 0.0, 0.0), T_wb);
  if (!touch) return touch.error();
  const double size_m = std::min(bodies.probe->box.diagonal(), bodies.fixed.front()->box.diagonal());

  measured out;
  convex_piece_finder finder(bodies, soft_settings.finder);
  contact_set contacts(soft_settings.limits);
  std::vector<penetration> depths(soft_settings.limits.contacts);
  const std::vector<pose> path = scrubbing_path(*touch, options, size_m);
  const auto time = [](std::vector<double>& into, double share, auto&& call) {
    const double begin = cpu_seconds();
    static_cast<void>(call());
    into.push_back(share * (cpu_seconds() - begin));
  };
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (interrupted()) return error{error_code::cancelled, "interrupted: nothing was written"};
    progress.show("measuring", static_cast<double>(i) / static_cast<double>(path.size()));
    const scene_pose at{path[i], T_wb};
    time(out.query_s, 1.0, [&] { return finder.find(at, contacts); });
    out.contacts.push_back(static_cast<double>(contacts.size()));
    if (contacts.size() > 0) {
      const auto found = std::span(depths).first(contacts.size());
      const double share = 1.0 / static_cast<double>(contacts.size());
      time(out.soft_contact_s, share, [&] { return soft->depth().measure(at, contacts, found); });
      time(out.central_contact_s, share, [&] { return central->depth().measure(at, contacts, found); });
    }
    tick found;
    time(out.shared_tick_s, 1.0, [&] { return shared->step(at, found); });
    time(out.soft_tick_s, 1.0, [&] { return soft->step(at, found); });
    time(out.central_tick_s, 1.0, [&] { return central->step(at, found); });
  }
  if (out.soft_contact_s.empty()) {
    return error{error_code::invalid_argument, "the probe lost the fixed body along the path: choose other models"};
  }
  return out;
}

std::string ratio_text(double ratio) { return brief(ratio) + " x"; }

answer report(const scene& bodies, const bench_command& options, const measured& m) {
  const time_summary query = summarise(m.query_s);
  const time_summary soft = summarise(m.soft_contact_s);
  const time_summary central = summarise(m.central_contact_s);
  const time_summary shared_tick = summarise(m.shared_tick_s);
  const time_summary soft_tick = summarise(m.soft_tick_s);
  const time_summary central_tick = summarise(m.central_tick_s);
  double contacts = 0.0;
  for (const double n : m.contacts) contacts += n / static_cast<double>(m.contacts.size());
  const double most = *std::max_element(m.contacts.begin(), m.contacts.end());
  const auto body = [](const textured_model& b) {
    return json{{"name", b.name}, {"coarse_triangles", b.mesh.triangles.size()}, {"pieces", b.pieces.size()}};
  };

  answer out;
  out.document = {{"probe", body(*bodies.probe)},
                  {"fixed", body(*bodies.fixed.front())},
                  {"poses", options.poses},
                  {"seed", options.seed},
                  {"contacts", {{"mean", contacts}, {"max", most}}},
                  {"time_is", "cpu"},
                  {"seconds",
                   {{"collision_query", to_json(query)},
                    {"contact_soft", to_json(soft)},
                    {"contact_central", to_json(central)},
                    {"tick_shared", to_json(shared_tick)},
                    {"tick_soft", to_json(soft_tick)},
                    {"tick_central", to_json(central_tick)}}},
                  {"ratios",
                   {{"contact_central_to_soft", central.p50_s / soft.p50_s},
                    {"tick_shared_to_soft", shared_tick.p50_s / soft_tick.p50_s},
                    {"tick_shared_to_soft_p99", shared_tick.p99_s / soft_tick.p99_s},
                    {"tick_central_to_soft", central_tick.p50_s / soft_tick.p50_s},
                    {"collision_share_of_soft_tick", query.p50_s / soft_tick.p50_s},
                    {"collision_share_of_central_tick", query.p50_s / central_tick.p50_s},
                    {"tick_soft_p99_to_p50", soft_tick.p99_s / soft_tick.p50_s},
                    {"tick_central_p99_to_p50", central_tick.p99_s / central_tick.p50_s}}},
                  {"rates_hz",
                   {{"tick_shared", 1.0 / shared_tick.p50_s},
                    {"tick_soft", 1.0 / soft_tick.p50_s},
                    {"tick_central", 1.0 / central_tick.p50_s}}},
                  {"units", "SI"}};
  const auto name = [](const textured_model& b) {
    return b.name + " (" + std::to_string(b.pieces.size()) + " pieces)";
  };
  out.text = name(*bodies.probe) + " on " + name(*bodies.fixed.front()) + ", " + std::to_string(options.poses) +
             " poses of a scrubbing path, " + brief(contacts) + " contacts on average, CPU time of one core\n";
  out.text += row("collision query", to_text(query));
  out.text += row("contact, soft maximum", to_text(soft));
  out.text +=
      row("contact, central diff.", to_text(central) + "  (" + ratio_text(central.p50_s / soft.p50_s) + " soft)");
  out.text += row("tick, one potential", to_text(shared_tick) + "  (" + brief(1.0 / shared_tick.p50_s) + " Hz, " +
                                             ratio_text(shared_tick.p50_s / soft_tick.p50_s) + " soft)");
  out.text += row("tick, soft maximum", to_text(soft_tick) + "  (" + brief(1.0 / soft_tick.p50_s) + " Hz, " +
                                            brief(100.0 * query.p50_s / soft_tick.p50_s) + " % collision)");
  out.text += row("tick, central diff.", to_text(central_tick) + "  (" + brief(1.0 / central_tick.p50_s) + " Hz, " +
                                             ratio_text(central_tick.p50_s / soft_tick.p50_s) + " soft)");
  return out;
}

result<void> check(const bench_command& options) {
  const char* const of_backends = options.gpu       ? "--gpu"
                                  : options.grid    ? "--grid"
                                  : options.repeats ? "--repeats"
                                                    : nullptr;
  if (options.backend || of_backends == nullptr) return {};
  return error{error_code::invalid_argument,
               std::string(of_backends) + " is for comparing depth backends: add --backend all"};
}

result<answer> compare_backends(const scene& bodies, const bench_command& options, const common_options& common,
                                progress_line& progress) {
#ifdef ASPERITY_HAS_GL
  backend_bench wanted{.backend = *options.backend, .gpu = options.gpu, .seed = options.seed};
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
  const result<scene> bodies = bench_scene(options, progress);
  if (!bodies) return bodies.error();
  if (options.backend) return compare_backends(*bodies, options, common, progress);
  const result<measured> m = measure(*bodies, options, progress);
  if (!m) return m.error();
  return report(*bodies, options, *m);
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
  sub.add_option("--poses", o->poses, "Poses of the path")->check(CLI::Range(10, 1000000))->capture_default_str();
  sub.add_option("--seed", o->seed, "Seed of the path")
      ->check(whole_number_error, "WHOLE NUMBER")
      ->capture_default_str();
  sub.add_option("--backend", o->backend, "Compare depth backends on a GPU with the CPU instead: all, or one of them")
      ->check(CLI::IsMember({"all", "gl-occlusion", "gl-compute"}));
  sub.add_option("--gpu", o->gpu, "GPU to measure, an index or a part of a name; see `asperity devices --gpu`")
      ->type_name("DEVICE");
  sub.add_option("--grid", o->grid, "Samples per side of a contact's window, with --backend")
      ->check(CLI::Range(std::uint32_t{2}, depth_settings::max_grid))
      ->default_str("64");
  sub.add_option("--repeats", o->repeats, "Times that each is measured, with --backend")
      ->check(CLI::Range(std::size_t{1}, std::size_t{10000}))
      ->default_str("10");
}

}  // namespace asperity::command
