// asperity view: a recording or a model on a page of a browser.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "asperity/io/mesh_file.hpp"
#include "asperity/io/textured_model_file.hpp"
#include "asperity/picture/model_picture.hpp"
#include "cli.hpp"
#include "file_names.hpp"
#include "interrupt.hpp"
#include "led_session.hpp"
#include "mesh_placing.hpp"
#include "mesh_units.hpp"
#include "options.hpp"
#include "output_file.hpp"
#include "poses.hpp"
#include "recording_reader.hpp"
#include "run_start.hpp"
#include "run_view.hpp"
#include "scene_loading.hpp"
#include "text.hpp"
#include "view/page_files.hpp"
#include "view/page_server.hpp"
#include "view/shown_mesh.hpp"

namespace asperity::command {
namespace {

struct view_command {
  std::vector<std::string> files;
  std::string probe;
  std::vector<std::string> fixed;
  std::vector<std::string> fixed_poses;
  std::optional<double> scale;  // of the session's motion, or of the original
  std::string port = std::to_string(usual_view_port);
  std::string address = "127.0.0.1";
  std::string exported;
  std::string original;
  std::string original_up = "z";
  std::optional<std::string> units;  // of the original
  bool gallery = false;
};

constexpr std::size_t most_recordings = 2;
constexpr std::size_t most_listed = 500;

bool is_recording(const std::string& file) { return extension_error(file, {".csv"}).empty(); }
bool is_recording(const view_command& options) { return is_recording(options.files.front()); }

std::string title_of(const view_command& options) {
  std::string out = file_stem(options.files.front());
  if (options.files.size() > 1) out += " and " + file_stem(options.files[1]);
  return out;
}

bool is_gallery(const view_command& options) {
  std::error_code unread;
  return options.gallery || std::filesystem::is_directory(options.files.front(), unread);
}

result<void> check_gallery(const view_command& options) {
  if (!options.exported.empty() || !options.original.empty() || !options.probe.empty() || !options.fixed.empty()) {
    return error{error_code::invalid_argument,
                 "a gallery has its models from the list: leave out --probe, --fixed, --original and --export"};
  }
  if (!view::is_loopback(options.address)) {
    return error{error_code::invalid_argument,
                 "a gallery starts sessions, which is for this machine alone: leave --view-address out"};
  }
  return {};
}

// The models that were named, and those of the folders that were.
result<std::vector<std::string>> listed_models(const view_command& options) {
  namespace fs = std::filesystem;
  std::vector<std::string> out;
  for (const std::string& file : options.files) {
    std::error_code failed;
    if (!fs::is_directory(file, failed)) {
      if (!extension_error(file, {".glb"}).empty() || !fs::is_regular_file(file, failed)) {
        return error{error_code::invalid_argument, file + " is no textured model (.glb) and no folder of them"};
      }
      out.push_back(file);
      continue;
    }
    std::vector<std::string> inside;
    for (fs::directory_iterator at(file, failed), end; !failed && at != end; at.increment(failed)) {
      if (extension_error(at->path().string(), {".glb"}).empty()) inside.push_back(at->path().string());
    }
    if (failed) return error{error_code::io_failed, "cannot read the folder " + file + ": " + failed.message()};
    std::sort(inside.begin(), inside.end());
    out.insert(out.end(), inside.begin(), inside.end());
  }
  if (out.empty()) {
    return error{error_code::invalid_argument,
                 options.files.front() + " has no textured model (.glb): bake one with `asperity bake`"};
  }
  if (out.size() > most_listed) {
    return error{error_code::limit_exceeded,
                 "a gallery lists " + std::to_string(most_listed) + " models at the most: name a folder with fewer"};
  }
  return out;
}

result<void> check_files(const view_command& options) {
  if (is_gallery(options)) return check_gallery(options);
  const bool recordings = is_recording(options);
  for (const std::string& file : options.files) {
    if (is_recording(file) != recordings) {
      return error{error_code::invalid_argument,
                   options.files.front() + " and " + file + " are a recording and a model: name recordings or a model"};
    }
  }
  if (!recordings && options.files.size() > 1) {
    return error{error_code::invalid_argument,
                 "a page shows one model: name one, or recordings (.csv), or add --gallery"};
  }
  if (options.files.size() > most_recordings) {
    return error{error_code::limit_exceeded, "a page shows two recordings beside each other at the most"};
  }
  return {};
}

result<view::page_scene> recorded_scene(const view_command& options) {
  if (!options.original.empty()) {
    return error{error_code::invalid_argument, "--original is of a model (.glb): leave it out for a recording"};
  }
  if (options.probe.empty() || options.fixed.empty()) {
    return error{error_code::invalid_argument,
                 "a recording does not hold the models: name those of its session with --probe and --fixed"};
  }
  const result<std::vector<pose>> T_wb = read_fixed_poses(options.fixed_poses, options.fixed.size());
  if (!T_wb) return T_wb.error();
  const result<scene> bodies = load_scene(options.probe, options.fixed, true);
  if (!bodies) return bodies.error();
  view::page_scene shown{.mode = view::page_mode::replay, .title = title_of(options), .bodies = {}};
  for (std::size_t i = 0; i < options.files.size(); ++i) {
    shown.bodies.push_back({file_stem(options.probe), bodies->probe, {}});
  }
  for (std::size_t b = 0; b < options.fixed.size(); ++b) {
    shown.bodies.push_back({file_stem(options.fixed[b]), bodies->fixed[b], (*T_wb)[b]});
  }
  return shown;
}

result<view::page_scene> model_scene(const view_command& options) {
  if (!options.probe.empty() || !options.fixed.empty()) {
    return error{error_code::invalid_argument,
                 "--probe and --fixed are of a recording (.csv): leave them out for a model"};
  }
  result<textured_model> model = io::load_textured_model(options.files.front());
  if (!model) return model.error();
  std::shared_ptr<triangle_mesh> original;
  if (!options.original.empty()) {
    result<triangle_mesh> loaded = io::load_mesh(options.original, not_interrupted);
    if (!loaded) return loaded.error();
    original = std::make_shared<triangle_mesh>(std::move(loaded).value());
    mesh_units units;
    units.units = options.units;
    units.scale = options.scale;
    if (const result<void> ok = bring_to_metres(units, options.original, *original); !ok) return ok.error();
    turn_up(options.original_up, *original);
    const std::string name = std::filesystem::path(options.original).filename().string();
    if (const result<void> fits = picture::check_original(*model, *original, name); !fits) return fits.error();
  }
  return view::page_scene{
      .mode = view::page_mode::model,
      .title = title_of(options),
      .bodies = {{title_of(options), std::make_shared<const textured_model>(std::move(model).value()), {}, original}}};
}

result<void> serve(const view_command& options, view::page_content content) {
  view::server_settings settings{
      .address = options.address, .port = view_port_of(options.port).value_or(usual_view_port), .token = {}};
  if (!view::is_loopback(settings.address)) {
    result<std::string> token = view::make_token();
    if (!token) return token.error();
    settings.token = std::move(token).value();
  }
  const result<view::page_server> server = view::page_server::start(settings, std::move(content), nullptr);
  if (!server) return server.error();
  complain("note: the page is at " + server->url() + ", until Ctrl-C");
  while (!interrupted()) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  return {};
}

// Starts the sessions that pages ask for, one at a time, until somebody interrupts.
result<answer> serve_gallery(const view_command& options) {
  const result<std::vector<std::string>> files = listed_models(options);
  if (!files) return files.error();
  view::page_scene shown{.mode = view::page_mode::gallery, .title = "Models", .bodies = {}};
  for (const std::string& file : *files) shown.listed.push_back(file_stem(file));
  view::gallery models(shown.listed);
  const view::server_settings settings{
      .address = options.address, .port = view_port_of(options.port).value_or(usual_view_port), .token = {}};
  const result<view::page_server> server =
      view::page_server::start(settings, view::make_content(shown, {}, view::live_points), nullptr, &models);
  if (!server) return server.error();
  complain("note: the page is at " + server->url() + ", until Ctrl-C");
  std::optional<led_session> session;
  std::size_t sessions = 0;
  using told = view::gallery::told;
  using phase = view::gallery::phase;
  for (; !interrupted(); std::this_thread::sleep_for(std::chrono::milliseconds(30))) {
    if (const auto [asked, wish] = models.take(); asked) {
      session.reset();
      if (!wish) continue;
      result<led_session> started = led_session::start((*files)[wish->probe], (*files)[wish->fixed]);
      if (!started) {
        models.became({phase::idle, {}, started.error().message});
        continue;
      }
      session.emplace(std::move(started).value());
      ++sessions;
    }
    if (!session) continue;
    if (session->look()) {
      models.became(session->url().empty() ? told{phase::starting, {}, {}} : told{phase::running, session->url(), {}});
    } else {
      models.became({phase::idle, {}, session->trouble()});
      session.reset();
    }
  }
  answer out;
  out.document = {{"models", shown.listed}, {"sessions", sessions}};
  return out;
}

result<answer> show(const view_command& options, const common_options&) {
  if (!view_port_of(options.port)) {
    return error{error_code::invalid_argument, "--port " + options.port + ": a port is a whole number from 0 to 65535"};
  }
  if (const result<void> ok = check_files(options); !ok) return ok.error();
  if (is_gallery(options)) return serve_gallery(options);
  std::vector<named_file> inputs{{"--probe", options.probe}};
  for (const std::string& file : options.files) inputs.push_back({"view", file});
  if (!options.original.empty()) {
    for (named_file& file : mesh_files(options.original, "--original")) inputs.push_back(std::move(file));
  }
  for (const std::string& body : options.fixed) inputs.push_back({"--fixed", body});
  const named_file exported{"--export", options.exported};
  if (const result<void> ok = check_outputs(inputs, {&exported, 1}); !ok) return ok.error();
  std::optional<output_file> page;
  if (!options.exported.empty()) {
    result<output_file> opened = output_file::create(options.exported);
    if (!opened) return opened.error();
    page.emplace(std::move(opened).value());
  }
  std::vector<view::shown_recording> recordings;
  for (const std::string& file : options.files) {
    if (!is_recording(file)) break;
    result<std::vector<view::trace_row>> read = read_recording(file, options.scale.value_or(1.0));
    if (!read) return read.error();
    recordings.push_back({file_stem(file), std::move(read).value()});
  }
  result<view::page_scene> shown = is_recording(options) ? recorded_scene(options) : model_scene(options);
  if (!shown) return shown.error();
  if (!recordings.empty() && recordings.front().rows.size() > 1) {
    shown->device_period_s = recordings.front().period_s();
  }
  if (is_recording(options)) shown->map.scale = options.scale.value_or(1.0);
  const std::size_t points = page ? view::exported_points : view::live_points;
  view::page_content content = view::make_content(*shown, recordings, points);
  answer out;
  out.document = {{"file", options.files.front()},
                  {"ticks", recordings.empty() ? 0 : recordings.front().rows.size()},
                  {"recordings", json::array()}};
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    const view::shown_recording& r = recordings[i];
    out.document["recordings"].push_back({{"file", options.files[i]},
                                          {"ticks", r.rows.size()},
                                          {"from_s", r.rows.front().time_s},
                                          {"to_s", r.rows.back().time_s},
                                          {"period_s", r.period_s()}});
  }
  if (!page) {
    if (const result<void> served = serve(options, std::move(content)); !served) return served.error();
    return out;
  }
  const std::string text = view::export_page(content);
  if (const result<void> written = page->write(text); !written) return written.error();
  if (const result<void> there = page->commit(); !there) return there.error();
  out.document["export"] = {{"file", options.exported}, {"bytes", text.size()}};
  out.text = row("page", options.exported + ", " + memory_text(text.size()));
  return out;
}

}  // namespace

void add_view(command_line& line) {
  const auto o = std::make_shared<view_command>();
  CLI::App& sub = line.add("view", "Show recordings or a model on a page of a browser",
                           [o](const common_options& common) { return show(*o, common); });
  sub.add_option(
         "files", o->files,
         "Recording of `run --record` (.csv), two of them to compare, a textured model (.glb), or a folder of them")
      ->required();
  sub.add_option("--probe", o->probe, "Model that the hand moved, for a recording");
  sub.add_option("--fixed", o->fixed, "Model that it touched, for a recording; may be given several times")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  sub.add_option("--fixed-pose", o->fixed_poses, "Pose of each fixed body, in their order; the origin by default")
      ->check(pose_form_error, "POSE")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  auto* original = sub.add_option("--original", o->original,
                                  "Mesh that the model was baked from: the page can then colour the distance to it");
  add_original_up(sub, o->original_up, original);
  auto* scale = sub.add_option("--scale", o->scale,
                               "Motion scaling of the session on record; with --original: metres per unit of it")
                    ->check(positive_number_error, "NUMBER > 0");
  sub.add_flag("--gallery", o->gallery, "List the models, to pick two of them and touch one with the other");
  sub.add_option("--units", o->units, "Unit of the original: m, cm, mm or in")
      ->check(CLI::IsMember({"m", "cm", "mm", "in"}))
      ->excludes(scale)
      ->needs(original);
  sub.add_option("--port", o->port, "Port of the page; 0: any that is free")->capture_default_str();
  sub.add_option("--view-address", o->address,
                 "Address of this machine at which the page is; another one than the loopback needs the token that is "
                 "printed")
      ->capture_default_str();
  sub.add_option("--export", o->exported, "Write the page as one file that anybody can open, and serve nothing")
      ->check([](const std::string& text) { return extension_error(text, {".html"}); }, "FILE");
}

}  // namespace asperity::command
