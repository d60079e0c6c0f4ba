// asperity_contact_study: both formulations over many seeded contacts of baked models; see usage below.
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <future>
#include <optional>
#include <string>
#include <vector>

#include "law/contact_study/pictures.hpp"
#include "law/contact_study/report.hpp"
#include "law/contact_study/study_models.hpp"

namespace {

using namespace asperity;
using namespace asperity::contact_study;

volatile std::sig_atomic_t stop_asked = 0;

constexpr char usage[] =
    "usage: asperity_contact_study [--poses N] [--seed S] [--pair PROBE] [--pose INDEX] [--least-motion-only] [--out "
    "DIR]\n"
    "                              [--pictures-only]\n"
    "  --poses N        touching poses per pair (60)\n"
    "  --seed S         of the poses (1)\n"
    "  --pair PROBE     only the pair whose probe has this name: block, file, hammer or igea\n"
    "  --pose INDEX     begin at this pose of the seed; with --poses 1, that pose alone\n"
    "  --least-motion-only  leave the paper's formulation out\n"
    "  --out DIR        where contacts.md and the pictures go (out/study)\n"
    "  --pictures-only  draw the pictures and stop\n"
    "The real meshes are taken from the folder that ASPERITY_MODELS names, or ../shared/models.\n";

struct arguments {
  study_options study;
  std::string pair;
  std::filesystem::path out = "out/study";
  bool pictures_only = false;
};

bool parse(int argc, char** argv, arguments& to) {
  for (int i = 1; i < argc; ++i) {
    const std::string name = argv[i];
    if (name == "--least-motion-only") {
      to.study.with_window = false;
      continue;
    }
    if (name == "--pictures-only") {
      to.pictures_only = true;
      continue;
    }
    if (i + 1 == argc) return false;
    const char* value = argv[++i];
    if (name == "--poses") {
      to.study.poses = std::strtoul(value, nullptr, 10);
    } else if (name == "--seed") {
      to.study.seed = std::strtoull(value, nullptr, 10);
    } else if (name == "--pose") {
      to.study.first_index = std::strtoull(value, nullptr, 10);
    } else if (name == "--pair") {
      to.pair = value;
    } else if (name == "--out") {
      to.out = value;
    } else {
      return false;
    }
  }
  return to.study.poses > 0;
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

result<scene> load_pair(const pair_name& pair, const std::filesystem::path& kept) {
  result<model_ptr> probe = study_model(pair.probe, ASPERITY_TEST_MODELS_DIR, kept);
  if (!probe) return probe.error();
  result<model_ptr> fixed = study_model(pair.fixed, ASPERITY_TEST_MODELS_DIR, kept);
  if (!fixed) return fixed.error();
  return scene{std::move(probe).value(), {std::move(fixed).value()}};
}

std::string name_of(const pair_name& pair) { return std::string(pair.probe) + " on " + std::string(pair.fixed); }

/// What became of a pair; nothing where it was left out.
struct outcome {
  std::optional<pair_result> found;
  std::optional<trace> drawn;
  std::optional<error> fault;
};

outcome run(const pair_name& pair, const arguments& given) {
  const auto start = std::chrono::steady_clock::now();
  const std::string name = name_of(pair);
  outcome out;
  const result<scene> bodies = load_pair(pair, given.out / "models");
  if (!bodies) {
    std::printf("%s is left out: %s\n", name.c_str(), bodies.error().message.c_str());
    return out;
  }
  result<pair_of_renderers> renderers = pair_of_renderers::make(*bodies);
  if (!renderers) {
    out.fault = renderers.error();
    return out;
  }
  if (!given.pictures_only) {
    study_options options = given.study;
    options.progress = [&](const pair_result& so_far) {
      if (so_far.least_motion.size() % 10 == 0) {
        std::printf("%s: %zu of %zu poses, %.0f s\n", name.c_str(), so_far.least_motion.size(), options.poses,
                    seconds_since(start));
        std::fflush(stdout);
      }
      return stop_asked == 0;
    };
    out.found = study_pair(name, *renderers, options);
  }
  if (stop_asked == 0) out.drawn = trace_slide(name, *renderers, given.study.seed);
  return out;
}

int fail(const error& e) {
  std::fprintf(stderr, "asperity_contact_study: %s\n", e.message.c_str());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  arguments given;
  if (!parse(argc, argv, given)) {
    std::fputs(usage, stderr);
    return 2;
  }
  std::signal(SIGINT, [](int) { stop_asked = 1; });
  std::error_code ignored;
  std::filesystem::create_directories(given.out, ignored);

  // A thread per pair: they share nothing, and no figure depends on time.
  std::vector<std::future<outcome>> running;
  for (const pair_name& pair : all_pairs) {
    if (!given.pair.empty() && given.pair != pair.probe) continue;
    running.push_back(std::async(std::launch::async, [&pair, &given] { return run(pair, given); }));
  }
  std::vector<pair_result> results;
  std::vector<trace> traces;
  std::optional<error> fault;
  for (std::future<outcome>& r : running) {
    outcome done = r.get();
    if (done.fault) fault = done.fault;
    if (done.found) results.push_back(std::move(*done.found));
    if (done.drawn) traces.push_back(std::move(*done.drawn));
  }
  if (fault) return fail(*fault);

  if (!results.empty()) {
    std::printf("\n%s", text_table(results).c_str());
    std::ofstream(given.out / "contacts.md") << markdown_table(results);
  }
  if (const result<void> drawn = draw_traces(traces, given.out / "contacts-traces.png"); !drawn) {
    return fail(drawn.error());
  }
  if (const result<void> drawn = draw_spectra(given.out / "contacts-spectra.png"); !drawn) return fail(drawn.error());
  if (results.empty()) return 0;

  const std::string broken = broken_limits(results);
  std::printf("\n%s", broken.empty() ? "The default keeps its limits everywhere.\n"
                                     : ("over the limits of the default:\n" + broken).c_str());
  return broken.empty() ? 0 : 1;
}
