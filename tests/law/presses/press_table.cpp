// press_table: presses pairs of bodies under a contact law and prints a line for each pair; see usage below.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include "law/presses/press_law.hpp"
#include "law/presses/press_session.hpp"
#include "law/presses/rest_session.hpp"
#include "law/presses/scrub_session.hpp"
#include "support/fresh_seed.hpp"

namespace {

using namespace asperity;
using namespace asperity::presses;

constexpr char usage[] =
    "usage: press_table [--law NAME] [--pair PROBE:FIXED]... [--touches N] [--first N] [--step MM] [--own] "
    "[--sessions [--contact-rate HZ] | --rests | --scrubs] [--dump]\n"
    "  --law NAME    least-motion or window (renderers), planes (the renderer for control loops, with\n"
    "                --sessions, --rests or --scrubs) or exit (the originals' own true depth, slow, with neither)\n"
    "  --pair A:B    only this pair, or these; any two bodies; without it all pairs of the acceptance\n"
    "  --touches N   presses on each pair (24)\n"
    "  --first N     leave the first N of the day's touches out (0)\n"
    "  --step MM     between two steps of a press (0.1)\n"
    "  --own         solids are their own coarse meshes; otherwise they are simplified\n"
    "  --sessions    a simulated hand presses with up to 20 N instead, through device and coupling\n"
    "  --contact-rate HZ  of these sessions, 100 to 10000, whose contacts then are one period late; without it 1000,\n"
    "                used in the tick that made them\n"
    "  --rests       a simulated hand rests instead, pressed in by 2 to 30 mm, and what trembles is told; with\n"
    "                this and the next one all ordered pairs of the benchmark models without --pair\n"
    "  --scrubs      a simulated hand scrubs instead, and how far its planes are off the surface is told\n"
    "  --dump        every step of every press as well\n"
    "The touches are those of the day; ASPERITY_SEED=N repeats a run. The benchmark models and the scans are taken "
    "from\n"
    "the build's test-models (ctest -R '_models' makes them), the scans' originals from ASPERITY_MODELS or\n"
    "../shared/models.\n";

struct arguments {
  std::string law = "least-motion";
  std::vector<press_pair> pairs;
  press_choice which;
  press_bake solids = press_bake::simplified;
  std::optional<double> contact_rate_hz;
  bool sessions = false, rests = false, scrubs = false, dump = false;
};

press_pair pair_named(const std::string& text) {
  const std::size_t colon = text.find(':');
  press_pair out{text.substr(0, colon), colon == std::string::npos ? "" : text.substr(colon + 1), {}};
  for (const press_pair& p : press_pairs()) {
    if (p.name() == out.name()) return p;
  }
  return out;
}

bool parse(int argc, char** argv, arguments& to) {
  for (int i = 1; i < argc; ++i) {
    const std::string name = argv[i];
    if (name == "--own") {
      to.solids = press_bake::own_coarse;
    } else if (name == "--sessions") {
      to.sessions = true;
    } else if (name == "--rests") {
      to.rests = true;
    } else if (name == "--scrubs") {
      to.scrubs = true;
    } else if (name == "--dump") {
      to.dump = true;
    } else if (i + 1 == argc) {
      return false;
    } else if (name == "--law") {
      to.law = argv[++i];
    } else if (name == "--pair") {
      to.pairs.push_back(pair_named(argv[++i]));
    } else if (name == "--touches") {
      to.which.touches = std::atoi(argv[++i]);
    } else if (name == "--first") {
      to.which.first = std::atoi(argv[++i]);
    } else if (name == "--step") {
      to.which.step_m = 1e-3 * std::atof(argv[++i]);
    } else if (name == "--contact-rate") {
      to.contact_rate_hz = std::atof(argv[++i]);
    } else {
      return false;
    }
  }
  if (to.pairs.empty()) to.pairs = to.rests || to.scrubs ? benchmark_pairs() : press_pairs();
  constexpr double least_hz = 100.0, most_hz = 1e4;
  if (to.contact_rate_hz && !(to.sessions && *to.contact_rate_hz >= least_hz && *to.contact_rate_hz <= most_hz))
    return false;
  return to.which.touches > 0 && to.which.first >= 0 && to.which.step_m > 0.0;
}

void dump(const press_row& row) {
  for (std::size_t i = 0; i < row.presses.size(); ++i) {
    for (const press_step& s : row.presses[i].steps) {
      std::printf("    %zu %6.2f mm  F.n %8.3f N  |F| %8.3f N\n", i, s.way_m * 1e3, s.along_n, s.force_n);
    }
    if (!row.presses[i].good()) std::printf("    %s\n", in_words(row, i).c_str());
  }
}

}  // namespace

int main(int argc, char** argv) {
  arguments asked;
  if (!parse(argc, argv, asked)) {
    std::fputs(usage, stderr);
    return 2;
  }
  session_rules rules;
  if (asked.contact_rate_hz) {
    rules.when.contact_period_ns = std::llround(1e9 / *asked.contact_rate_hz);
    rules.when.device_period_ns = std::min(rules.when.device_period_ns, rules.when.contact_period_ns);
    rules.when.contact_one_period_late = true;
  }
  const std::vector<press_law> laws = known_laws(1e-9 * static_cast<double>(rules.when.contact_period_ns));
  const auto law = std::find_if(laws.begin(), laws.end(), [&](const press_law& l) { return l.name == asked.law; });
  if (law == laws.end() || (asked.sessions || asked.rests || asked.scrubs ? !law->render : !law->make)) {
    std::fputs(usage, stderr);
    return 2;
  }
  press_choice which = asked.which;
  which.seed = test_support::fresh_seed("presses", std::to_string(which.touches) + " touches a pair");
  press_shelf shelf(asked.solids);
  if (asked.scrubs) {
    print_scrub_heading(stdout);
  } else if (asked.rests) {
    print_rest_heading(stdout);
  } else if (asked.sessions) {
    print_session_heading(stdout);
  } else {
    print_heading(stdout);
  }
  int failed = 0;
  for (const press_pair& pair : asked.pairs) {
    const auto start = std::chrono::steady_clock::now();
    if (const std::string why = why_without_body(pair.probe) + why_without_body(pair.fixed); !why.empty()) {
      std::printf("%s: skipped, %s\n", pair.name().c_str(), why.c_str());
      continue;
    }
    const result<const press_body*> probe = shelf.get(pair.probe), fixed = shelf.get(pair.fixed);
    if (!probe || !fixed) {
      std::printf("%s: %s\n", pair.name().c_str(), (probe ? fixed.error() : probe.error()).message.c_str());
      ++failed;
      continue;
    }
    if (asked.scrubs) {
      const result<scrub_result> row = scrub_sessions(pair, **probe, **fixed, which);
      if (row) {
        print_row(stdout, pair, *row);
        continue;
      }
      std::printf("%s: %s\n", pair.name().c_str(), row.error().message.c_str());
      ++failed;
      continue;
    }
    if (asked.sessions || asked.rests) {
      const result<render_function> render = law->render(**probe, **fixed, session_rules{}.stiffness_n_per_m);
      if (render) {
        if (asked.rests) {
          print_row(stdout, rest_sessions(pair, **probe, **fixed, *render, which));
        } else {
          print_row(stdout, press_sessions(pair, **probe, **fixed, *render, which, rules));
        }
        continue;
      }
      std::printf("%s: %s\n", pair.name().c_str(), render.error().message.c_str());
      ++failed;
      continue;
    }
    const result<step_function> step = law->make(**probe, **fixed, press_rules{}.stiffness_n_per_m);
    if (!step) {
      std::printf("%s: %s\n", pair.name().c_str(), step.error().message.c_str());
      ++failed;
      continue;
    }
    const press_row row = press_one_pair(pair, **probe, **fixed, *step, which);
    print_row(stdout, row);
    if (asked.dump) dump(row);
    std::fprintf(stderr, "%s: %.1f s, models within %.0f um of the originals\n", pair.name().c_str(),
                 std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
                 1e6 * ((*probe)->error_m() + (*fixed)->error_m()));
  }
  return failed == 0 ? 0 : 1;
}
