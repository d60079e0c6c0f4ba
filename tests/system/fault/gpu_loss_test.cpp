// A GPU that is lost in the middle of a session. The loss comes from a stand-in for EGL that the dynamic linker finds
// in place of the real one: see losing_egl.cpp.
#include <algorithm>
#include <cmath>
#include <dlfcn.h>
#include <link.h>
#include <sstream>

#include "command_process.hpp"

namespace fault {
namespace {

/// Where the dynamic linker finds EGL; empty where it does not.
std::string real_egl() {
  void* const library = dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) return "";
  link_map* map = nullptr;
  const bool known = dlinfo(library, RTLD_DI_LINKMAP, &map) == 0;
  const std::string path = known ? map->l_name : "";
  dlclose(library);
  return path;
}

/// Columns of a recording, by name.
std::vector<double> column(const std::string& recording, const std::string& name) {
  std::istringstream lines(recording);
  std::string line, cell;
  std::getline(lines, line);
  std::istringstream names(line);
  std::size_t at = 0;
  while (std::getline(names, cell, ',') && cell != name) ++at;
  std::vector<double> out;
  while (std::getline(lines, line)) {
    std::istringstream cells(line);
    for (std::size_t i = 0; i <= at; ++i) std::getline(cells, cell, ',');
    out.push_back(std::strtod(cell.c_str(), nullptr));
  }
  return out;
}

struct lost_backend {
  const char* name;
  arguments gl, cpu;
  double position_m;  ///< how far a session may be from the CPU's
};

void PrintTo(const lost_backend& b, std::ostream* out) { *out << b.name; }

class lost_gpu : public command_test, public testing::WithParamInterface<lost_backend> {
 protected:
  void SetUp() override {
    const std::string egl = real_egl();
    if (egl.empty()) GTEST_SKIP() << "there is no libEGL.so.1";
    losing_.environment = {{"LD_LIBRARY_PATH", LOSING_EGL_DIR}, {"LOSING_EGL_REAL", egl}};
    const outcome works = run(session(GetParam().gl, 0.001), after(1'000'000));
    if (works.exit_status != 0) GTEST_SKIP() << works.err;
  }
  /// The context is lost in the tick after `answers` ticks on the GPU.
  [[nodiscard]] process_options after(int answers) const {
    process_options out = losing_;
    out.environment.emplace_back("LOSING_EGL_AFTER", std::to_string(answers));
    return out;
  }
  [[nodiscard]] static arguments session(const arguments& options, double seconds) {
    const std::string block = (small_models() / "block.glb").string();
    arguments all{"run",   "--probe", block, "--fixed", block,    "--probe-pose", "0 0 0.0199 0 0 0 1",   "--motion",
                  "press", "--grid",  "16",  "--quiet", "--json", "--seconds",    std::to_string(seconds)};
    all.insert(all.end(), options.begin(), options.end());
    return all;
  }
  static arguments with(arguments all, const arguments& more) {
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }

 private:
  process_options losing_;
};

TEST_P(lost_gpu, the_cpu_answers_in_the_same_tick_and_every_such_tick_is_counted) {
  constexpr double seconds = 0.1;
  constexpr int answers = 80;  // by then the probe stays in touch
  const auto recorded = [&](const arguments& options, const char* file, const process_options& how) {
    const outcome done = run(session(with(options, {"--record", path(file)}), seconds), how);
    EXPECT_EQ(done.exit_status, 0) << done.err;
    return json::parse(done.out, nullptr, false);
  };
  static_cast<void>(recorded(GetParam().cpu, "cpu.csv", {}));
  const json kept = recorded(with(GetParam().gl, {"--fallback"}), "kept.csv", after(1'000'000)).at("gpu");
  const json early = recorded(with(GetParam().gl, {"--fallback"}), "early.csv", after(answers)).at("gpu");
  const json later = recorded(with(GetParam().gl, {"--fallback"}), "later.csv", after(answers + 1)).at("gpu");
  EXPECT_EQ(kept.at("fallback_ticks"), 0);
  for (const json* lost : {&early, &later}) {
    EXPECT_EQ(lost->at("failed_ticks"), 0) << "a tick went unanswered";
    EXPECT_EQ(lost->at("ticks"), kept.at("ticks"));
    EXPECT_GE(lost->at("fallback_ticks"), 20);
  }
  // One answer more of the GPU's is one less of the CPU's: the tick of the loss is among those.
  EXPECT_EQ(early.at("fallback_ticks").get<int>(), later.at("fallback_ticks").get<int>() + 1);
  EXPECT_EQ(early.at("fallback_ticks").get<int>() + answers, early.at("ticks").get<int>());

  // Nobody feels the loss: the probe goes where it goes on the CPU, in contact before and after.
  const std::string on_cpu = read("cpu.csv"), lost = read("early.csv");
  const std::vector<double> contacts = column(lost, "contacts");
  ASSERT_GT(contacts.size(), 95U);
  EXPECT_TRUE(std::all_of(contacts.begin() + answers - 5, contacts.end(), [](double n) { return n > 0.0; }));
  EXPECT_EQ(contacts, column(on_cpu, "contacts"));
  double apart = 0.0;
  for (const char* name : {"probe_x_m", "probe_y_m", "probe_z_m"}) {
    const std::vector<double> a = column(on_cpu, name), b = column(lost, name);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) apart = std::max(apart, std::fabs(a[i] - b[i]));
  }
  std::printf("%s, lost after %d of %d ticks: %.1e m from the CPU's session\n", GetParam().name, answers,
              early.at("ticks").get<int>(), apart);
  EXPECT_LE(apart, GetParam().position_m);
}

TEST_P(lost_gpu, without_a_fallback_the_session_ends_and_says_why) {
  const outcome done = run(session(GetParam().gl, 0.1), after(20));
  EXPECT_EQ(done.exit_status, 1);
  const json message = json::parse(done.out, nullptr, false);
  ASSERT_TRUE(message.contains("error")) << done.out;
  EXPECT_EQ(message.at("error").at("code"), "unsupported");
  EXPECT_NE(done.err.find("the wrench went to zero"), std::string::npos) << done.err;
  EXPECT_NE(done.err.find("--fallback"), std::string::npos) << done.err;
  EXPECT_EQ(std::count(done.err.begin(), done.err.end(), '\n'), 1) << done.err;
  // Lost in its first tick.
  EXPECT_EQ(run(session(GetParam().gl, 0.1), after(0)).exit_status, 1);
}

INSTANTIATE_TEST_SUITE_P(
    each, lost_gpu,
    testing::Values(lost_backend{"gl_compute", {"--backend", "gl-compute"}, {"--contacts", "window"}, 1e-9},
                    lost_backend{"gl_occlusion",
                                 {"--backend", "gl-occlusion"},
                                 {"--contacts", "window", "--gradient", "central", "--lookup", "paper"},
                                 1e-5}),
    [](const auto& of) { return std::string(of.param.name); });

}  // namespace
}  // namespace fault
