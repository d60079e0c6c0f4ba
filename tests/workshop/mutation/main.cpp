// asperity_mutate: plants bugs and says which of them the tests see. See ./dev mutate.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "workshop/mutation/copy_sources.hpp"
#include "workshop/mutation/ledger.hpp"
#include "workshop/mutation/plant.hpp"
#include "workshop/mutation/trial.hpp"

namespace {

using namespace asperity;
using namespace asperity::mutation;
namespace fs = std::filesystem;

struct order {
  fs::path root;
  fs::path work;
  std::vector<std::string> wanted;
  bool list = false;
  bool again = false;
  unsigned jobs = 1;
};

struct planned {
  bug what;
  std::string digest;
};

bool is_wanted(const bug& b, const std::vector<std::string>& wanted) {
  if (wanted.empty()) return true;
  return std::any_of(wanted.begin(), wanted.end(), [&](const std::string& w) {
    return b.room == w || b.name.find(w) != std::string::npos || b.file.find(w) != std::string::npos;
  });
}

// Everything in the catalogue, each bug planted once for its digest: a list that no longer fits stops here.
result<std::vector<planned>> plan(const order& o) {
  const result<std::vector<bug>> bugs = read_catalogues((o.root / "tests/workshop/mutation/catalogue").string());
  if (!bugs) return bugs.error();
  std::vector<planned> all;
  for (const bug& b : *bugs) {
    const result<std::string> source = read_text(o.root / b.file);
    if (!source) return source.error();
    const result<std::string> broken = plant(*source, b);
    if (!broken) return broken.error();
    all.push_back({b, digest_of(*broken, b)});
  }
  return all;
}

// A copy of the sources and a build of it for one worker.
result<workshop> open_workshop(const order& o, unsigned worker) {
  const fs::path place = o.work / std::to_string(worker);
  workshop w{place / "source",
             place / "build",
             "cmake --build {build} -j 1 --target {test}",
             "GTEST_FAIL_FAST=1 ctest --test-dir {build} -R ^{test}$ --output-on-failure --no-tests=error",
             1200,
             120,
             {}};
  const result<void> copied = copy_sources(o.root, w.source);
  if (!copied) return copied.error();
  fs::create_directories(w.build);
  // A bug may leave a name unused: no reason not to build it.
  const std::string configure = "cd '" + w.source.string() + "' && cmake --preset release -B '" + w.build.string() +
                                "' -DASPERITY_WERROR=OFF -DASPERITY_MUTANT=ON > '" +
                                (place / "configure.log").string() + "' 2>&1";
  if (std::system(configure.c_str()) != 0) {
    return error{error_code::io_failed, "configuring failed: " + (place / "configure.log").string()};
  }
  return w;
}

class campaign {
 public:
  campaign(const order& o, std::vector<planned> chosen, ledger& book)
      : order_(o), chosen_(std::move(chosen)), book_(&book) {}

  // @return whether every trial came to an outcome
  bool run() {
    std::vector<std::thread> workers;
    const auto jobs = std::min<std::size_t>(order_.jobs, chosen_.size());
    for (unsigned i = 0; i < jobs; ++i) workers.emplace_back([this, i] { work(i); });
    for (std::thread& w : workers) w.join();
    return !failed_;
  }

 private:
  void work(unsigned worker) {
    result<workshop> shop = open_workshop(order_, worker);
    if (!shop) return fail(shop.error());
    std::set<std::string> sound;
    for (std::size_t i = take(); i < chosen_.size(); i = take()) {
      const bug& b = chosen_[i].what;
      for (const std::string& test : b.tests) {
        if (!sound.insert(test).second) continue;
        const result<double> seconds = try_sound(*shop, test);
        if (!seconds) return fail(seconds.error());
        say("%s: %.1f s without a bug\n", test.c_str(), *seconds);
        shop->run_limits[test] = 20 + static_cast<int>(std::ceil(10.0 * *seconds));
      }
      const result<outcome> became = try_bug(*shop, b);
      if (!became) return fail(became.error());
      const std::lock_guard lock(mutex_);
      ++done_;
      std::printf("%zu/%zu %-9s %5.1f s  %s  %s %s\n", done_, chosen_.size(), to_string(became->answer),
                  became->seconds, b.name.c_str(), became->test.c_str(), became->how.c_str());
      std::fflush(stdout);
      const result<void> kept = book_->add(b.name, chosen_[i].digest, *became);
      if (!kept) std::fprintf(stderr, "%s\n", kept.error().message.c_str());
    }
  }

  std::size_t take() {
    const std::lock_guard lock(mutex_);
    return failed_ ? chosen_.size() : next_++;
  }

  template <class... Values>
  void say(const char* format, Values... values) {
    const std::lock_guard lock(mutex_);
    std::printf(format, values...);
    std::fflush(stdout);
  }

  void fail(const error& e) {
    const std::lock_guard lock(mutex_);
    std::fprintf(stderr, "mutate: %s\n", e.message.c_str());
    failed_ = true;
  }

  order order_;
  std::vector<planned> chosen_;
  ledger* book_;
  std::mutex mutex_;
  std::size_t next_ = 0;
  std::size_t done_ = 0;
  bool failed_ = false;
};

std::string today() {
  const std::time_t now = std::time(nullptr);
  char text[16];
  std::strftime(text, sizeof text, "%Y-%m-%d", std::gmtime(&now));
  return text;
}

void print_list(const std::vector<planned>& all, const order& o, const ledger& book) {
  double seconds = 0;
  int listed = 0;
  for (const planned& p : all) {
    if (!is_wanted(p.what, o.wanted)) continue;
    const outcome* const known = book.find(p.what.name, p.digest);
    std::printf("%-10s %-9s %s  (%s)\n", p.what.room.c_str(), known != nullptr ? to_string(known->answer) : "not tried",
                p.what.name.c_str(), p.what.file.c_str());
    seconds += known != nullptr ? known->seconds : 15.0;
    ++listed;
  }
  std::printf("%d bugs, about %.0f minutes for one worker where the tests are built\n", listed, seconds / 60.0);
}

int run(const order& o) {
  const result<std::vector<planned>> all = plan(o);
  if (!all) {
    std::fprintf(stderr, "mutate: %s\n", all.error().message.c_str());
    return 2;
  }
  fs::create_directories(o.work);
  ledger book(o.work / "results.tsv");
  if (o.list) return print_list(*all, o, book), 0;

  std::vector<planned> chosen;
  for (const planned& p : *all) {
    const outcome* const known = book.find(p.what.name, p.digest);
    const bool kept = known != nullptr && known->answer == verdict::caught && !o.again;
    if (is_wanted(p.what, o.wanted) && !kept) chosen.push_back(p);
  }
  std::printf("%zu of %zu bugs to plant\n", chosen.size(), all->size());
  if (!campaign(o, chosen, book).run()) return 2;

  std::vector<finding> findings;
  for (const planned& p : *all) {
    const outcome* const known = book.find(p.what.name, p.digest);
    if (known != nullptr) findings.push_back({p.what, *known});
  }
  std::printf("%s\n", totals(findings).c_str());
  const bool whole = findings.size() == all->size();
  const fs::path table = whole ? o.root / "docs/reference/mutations.md" : o.work / "mutations.md";
  const result<void> written = write_text(table, page(findings, today()));
  if (!written) std::fprintf(stderr, "mutate: %s\n", written.error().message.c_str());
  std::printf("table: %s%s\n", table.c_str(), whole ? "" : " (not every bug has been tried)");
  return std::all_of(findings.begin(), findings.end(),
                     [](const finding& f) { return f.became.answer == verdict::caught; })
             ? 0
             : 1;
}

}  // namespace

int main(int argc, char** argv) {
  order o;
  o.jobs = std::max(1U, std::thread::hardware_concurrency());
  o.root = ".";
  CLI::App app("plants bugs in a copy of the sources and says which of them the tests see", "./dev mutate");
  app.add_option("name", o.wanted, "only bugs of this room, or with this in their name or file");
  app.add_flag("--list", o.list, "only say which bugs there are, and what became of them");
  app.add_flag("--again", o.again, "also those that were caught before");
  app.add_option("--jobs", o.jobs, "workers; each keeps a build of its own")->check(CLI::Range(1, 64));
  app.add_option("--root", o.root, "the sources")->check(CLI::ExistingDirectory);
  CLI11_PARSE(app, argc, argv);
  o.root = fs::absolute(o.root).lexically_normal();
  o.work = o.root / "build/mutation";
  return run(o);
}
