// The command with depth backends on a GPU: what contradicts them, a machine without one, and their agreement with the
// CPU's. On a machine without OpenGL the last is skipped, with the command's own reason.
#include <algorithm>
#include <cmath>

#include "command_process.hpp"

namespace fault {
namespace {

const process_options no_gl = [] {
  process_options without;
  without.environment.emplace_back("__EGL_VENDOR_LIBRARY_DIRS", "/nonexistent");
  return without;
}();

class gpu : public command_test {
 protected:
  [[nodiscard]] static std::string block() { return (small_models() / "block.glb").string(); }
  /// Ridges in grooves, and the upper block two tenths of a millimetre too low.
  [[nodiscard]] static arguments query(const arguments& options) {
    arguments all{
        "query",        "--probe",      block(), "--fixed", block(), "--probe-pose", "0.001 0.0005 0.0198 0 0 0 1",
        "--fixed-pose", "0 0 0 0 0 0 1"};
    all.insert(all.end(), options.begin(), options.end());
    return all;
  }
  [[nodiscard]] static arguments session(const arguments& options) {
    arguments all{"run", "--probe", block(), "--fixed", block()};
    all.insert(all.end(), options.begin(), options.end());
    return all;
  }
  /// As expect_document, but notes on stderr are allowed: that a GPU is the processor, and what a session in real time
  /// was given.
  [[nodiscard]] static json document(arguments args, const process_options& options = {}) {
    args.emplace_back("--json");
    const outcome done = run(args, options);
    if (done.exit_status != 0) throw std::runtime_error("no document: " + done.err);
    EXPECT_LE(std::count(done.err.begin(), done.err.end(), '\n'), 2) << done.err;
    EXPECT_TRUE(done.err.empty() || done.err.rfind("asperity: note: ", 0) == 0) << done.err;
    return json::parse(done.out);
  }
};

/// Those that calculate on a GPU, which has to be there.
class on_gpu : public gpu {
 protected:
  void SetUp() override {
    const outcome devices = run({"devices", "--gpu", "--json"});
    const json d = json::parse(devices.out, nullptr, false);
    if (devices.exit_status != 0) GTEST_SKIP() << devices.err;
    for (const json& device : d.at("gpus")) {
      if (device.at("problem").is_null()) return;
    }
    GTEST_SKIP() << d.at("gpus").dump();
  }
};

TEST_F(gpu, contradictions_are_named) {
  const struct {
    arguments options;
    const char* named;
    const char* mend;
  } all[] = {
      {{"--gpu", "0"}, "--gpu", "--backend gl-compute"},
      {{"--fallback"}, "--fallback", "--backend gl-compute"},
      {{"--backend", "exact", "--gpu", "0"}, "--gpu", "--backend gl-compute"},
      {{"--backend", "gl-compute", "--contacts", "least-motion"}, "--contacts least-motion", "leave out"},
      {{"--backend", "gl-occlusion", "--contacts", "least-motion"}, "--contacts least-motion", "leave out"},
      {{"--backend", "gl-occlusion", "--gradient", "soft"}, "--gradient soft", "leave it out"},
      {{"--backend", "gl-occlusion", "--lookup", "exact"}, "--lookup exact", "--backend gl-compute"},
  };
  for (const auto& wrong : all) {
    const std::string message = expect_failure(query(wrong.options), 1, "invalid_argument");
    EXPECT_NE(message.find(wrong.named), std::string::npos) << message;
    EXPECT_NE(message.find(wrong.mend), std::string::npos) << message;
    EXPECT_EQ(expect_failure(session(wrong.options), 1, "invalid_argument"), message);
  }
  for (const arguments& option : {arguments{"--repeats", "2"}, arguments{"--gpu", "0"}, arguments{"--grid", "32"}}) {
    arguments bench{"bench", "--probe", block(), "--fixed", block()};
    bench.insert(bench.end(), option.begin(), option.end());
    const std::string message = expect_failure(bench, 1, "invalid_argument");
    EXPECT_NE(message.find(option.front() + " is for comparing"), std::string::npos) << message;
  }
}

TEST_F(gpu, without_opengl_the_step_that_failed_is_named) {
  const arguments bench{"bench", "--probe", block(), "--fixed", block(), "--backend", "all"};
  for (const arguments& args :
       {arguments{"devices", "--gpu"}, bench, query({"--backend", "gl-compute"}), query({"--backend", "gl-occlusion"}),
        session({"--backend", "gl-compute", "--record", path("never.csv")})}) {
    const std::string message = expect_failure(args, 1, "unsupported", no_gl);
    EXPECT_NE(message.find("OpenGL: "), std::string::npos) << message;
    EXPECT_NE(message.find("install"), std::string::npos) << message;
  }
  const std::string message = expect_failure(query({"--backend", "gl-compute"}), 1, "unsupported", no_gl);
  EXPECT_NE(message.find("--fallback"), std::string::npos) << message;
}

TEST_F(gpu, without_opengl_the_cpu_answers_where_told_to_and_that_is_counted) {
  for (const std::string backend : {"gl-compute", "gl-occlusion"}) {
    json there = document(query({"--backend", backend, "--fallback"}), no_gl);
    const json cpu = document(
        query({"--contacts", "window", "--gradient", there.at("gradient_scheme"), "--lookup", there.at("lookup")}));
    ASSERT_FALSE(cpu.at("contacts").empty());
    EXPECT_EQ(there.at("contacts"), cpu.at("contacts"));
    EXPECT_EQ(there.at("force"), cpu.at("force"));
    EXPECT_EQ(there.at("gpu").at("fallback"), true);
    EXPECT_EQ(there.at("gpu").at("ticks"), 1);
    EXPECT_EQ(there.at("gpu").at("fallback_ticks"), 1);
    EXPECT_EQ(there.at("gpu").at("failed_ticks"), 0);
    EXPECT_TRUE(there.at("gpu").at("device").is_null());
    EXPECT_NE(there.at("gpu").at("problem").get<std::string>().find("OpenGL: "), std::string::npos);
  }
  // In a session every tick is the CPU's, and the two recordings are the same bytes.
  const json there = document(session({"--backend", "gl-compute", "--fallback", "--seconds", "0.1", "--motion", "free",
                                       "--record", path("there.csv")}),
                              no_gl);
  EXPECT_EQ(there.at("gpu").at("fallback_ticks"), there.at("gpu").at("ticks"));
  EXPECT_GE(there.at("gpu").at("ticks"), 100);
  static_cast<void>(
      document(session({"--contacts", "window", "--seconds", "0.1", "--motion", "free", "--record", path("cpu.csv")})));
  EXPECT_EQ(read("there.csv"), read("cpu.csv"));
  // Said once; not with --quiet.
  EXPECT_EQ(run(query({"--backend", "gl-compute", "--fallback", "--quiet"}), no_gl).err, "");
}

TEST_F(on_gpu, devices_are_listed_with_what_they_can_do) {
  const json d = expect_document({"devices", "--gpu"}, "asperity.devices/1");
  EXPECT_EQ(d.at("devices").size(), 1U);
  int working = 0;
  for (std::size_t i = 0; i < d.at("gpus").size(); ++i) {
    const json& device = d.at("gpus")[i];
    EXPECT_EQ(device.at("index"), i);
    EXPECT_FALSE(device.at("name").get<std::string>().empty());
    EXPECT_TRUE(device.at("software").is_boolean());
    if (!device.at("problem").is_null()) continue;
    ++working;
    EXPECT_FALSE(device.at("version").get<std::string>().empty());
    // What OpenGL 4.3 and ES 3.1 promise at least.
    EXPECT_GE(device.at("limits").at("texture_side"), 2048);
    EXPECT_GE(device.at("limits").at("storage_block_bytes"), 1 << 24);
    EXPECT_GE(device.at("limits").at("group_invocations"), 128);
  }
  EXPECT_GE(working, 1);
  EXPECT_NE(run({"devices", "--gpu"}).out.find("gpu 0"), std::string::npos);
}

TEST_F(on_gpu, a_device_is_chosen_by_index_or_name) {
  const json devices = expect_document({"devices", "--gpu"}, "asperity.devices/1").at("gpus");
  const auto usable =
      std::find_if(devices.begin(), devices.end(), [](const json& d) { return d.at("problem").is_null(); });
  const std::string name = usable->at("name");
  for (const std::string& which : {std::to_string(usable->at("index").get<int>()), name.substr(0, 6)}) {
    const json d = document(query({"--backend", "gl-compute", "--gpu", which}));
    EXPECT_NE(d.at("gpu").at("device").get<std::string>().find(which == name.substr(0, 6) ? which : name),
              std::string::npos);
  }
  for (const char* which : {"99", "abacus"}) {
    const arguments unknown = query({"--backend", "gl-compute", "--gpu", which});
    EXPECT_NE(expect_failure(unknown, 1, "invalid_argument").find(which), std::string::npos);
    arguments with_fallback = unknown;
    with_fallback.emplace_back("--fallback");  // a device that is not there is no device that fails
    expect_failure(with_fallback, 1, "invalid_argument");
  }
}

/// Largest difference of two arrays of numbers.
double apart(const json& a, const json& b) {
  double worst = 0.0;
  EXPECT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    worst = std::max(worst, std::fabs(a[i].get<double>() - b[i].get<double>()));
  }
  return worst;
}

struct agreement {
  const char* name;
  arguments gl, cpu;
  double depth_m, force_share;  ///< bounds; the force's of its own length
};

void PrintTo(const agreement& a, std::ostream* out) { *out << a.name; }

class query_on_gpu : public on_gpu, public testing::WithParamInterface<agreement> {};

TEST_P(query_on_gpu, agrees_with_the_cpu) {
  const json gl = document(query(GetParam().gl)), cpu = document(query(GetParam().cpu));
  EXPECT_EQ(gl.at("formulation"), "window");
  EXPECT_EQ(gl.at("gradient_scheme"), cpu.at("gradient_scheme"));
  EXPECT_EQ(gl.at("lookup"), cpu.at("lookup"));
  EXPECT_EQ(gl.at("gpu").at("failed_ticks"), 0);
  EXPECT_GT(gl.at("gpu").at("device_memory"), 0);
  ASSERT_FALSE(cpu.at("contacts").empty());
  ASSERT_EQ(gl.at("contacts").size(), cpu.at("contacts").size());
  double depth = 0.0;
  for (std::size_t i = 0; i < cpu.at("contacts").size(); ++i) {
    const json &g = gl.at("contacts")[i], &c = cpu.at("contacts")[i];
    EXPECT_EQ(g.at("centre"), c.at("centre"));
    EXPECT_EQ(g.at("samples"), c.at("samples"));
    EXPECT_EQ(g.at("flags"), c.at("flags"));
    EXPECT_GT(c.at("depth"), 1e-4);
    depth = std::max(depth, std::fabs(g.at("depth").get<double>() - c.at("depth").get<double>()));
  }
  const json &f = cpu.at("force"), zero = json::array({0.0, 0.0, 0.0});
  const double force = apart(gl.at("force"), f) / apart(f, zero);
  std::printf("depth %.1e m, force %.1e of itself\n", depth, force);
  EXPECT_LE(depth, GetParam().depth_m);
  EXPECT_LE(force, GetParam().force_share);
}

INSTANTIATE_TEST_SUITE_P(
    each, query_on_gpu,
    testing::Values(agreement{"compute_soft", {"--backend", "gl-compute"}, {"--contacts", "window"}, 1e-9, 1e-6},
                    agreement{"compute_central",
                              {"--backend", "gl-compute", "--gradient", "central", "--lookup", "paper"},
                              {"--contacts", "window", "--gradient", "central", "--lookup", "paper"},
                              1e-9,
                              1e-6},
                    agreement{"occlusion",
                              {"--backend", "gl-occlusion"},
                              {"--contacts", "window", "--gradient", "central", "--lookup", "paper"},
                              1e-6,
                              1e-2}),
    [](const auto& of) { return std::string(of.param.name); });

TEST_F(on_gpu, a_session_on_the_real_clock_hands_the_context_to_its_thread) {
  // Both with the approach, which ticks before the session does, and without.
  for (const arguments& start : {arguments{}, arguments{"--probe-pose", "0 0 0.0205 0 0 0 1"}}) {
    arguments args =
        session({"--backend", "gl-compute", "--grid", "16", "--seconds", "0.3", "--motion", "free", "--clock", "real"});
    args.insert(args.end(), start.begin(), start.end());
    const json d = document(args);
    EXPECT_EQ(d.at("gpu").at("failed_ticks"), 0);
    EXPECT_GT(d.at("gpu").at("ticks"), 3);
    EXPECT_GT(d.at("contact_loop").at("ticks"), 3);
  }
}

TEST_F(on_gpu, a_software_renderer_is_reported_once_and_not_when_quiet) {
  const json device = document(query({"--backend", "gl-compute"})).at("gpu");
  if (device.at("software") == false) GTEST_SKIP() << device.at("device") << " is no software renderer";
  EXPECT_NE(run(query({"--backend", "gl-compute"})).err.find("note: "), std::string::npos);
  const std::string said = run(session({"--backend", "gl-compute", "--grid", "8", "--seconds", "0.01"})).err;
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
  EXPECT_EQ(run(query({"--backend", "gl-compute", "--quiet"})).err, "");
}

TEST_F(on_gpu, bench_compares_backends_in_one_run) {
  const json d =
      document({"bench", "--probe", block(), "--fixed", block(), "--backend", "all", "--grid", "4", "--repeats", "2"});
  EXPECT_EQ(d.at("time_is"), "wall");
  EXPECT_GT(d.at("gpu").at("model_memory"), 0);
  std::set<std::string> seen;
  for (const json& b : d.at("backends")) {
    seen.insert(b.at("backend").get<std::string>() + " " + b.at("gradient_scheme").get<std::string>());
    EXPECT_GT(b.at("first_tick_seconds"), 0.0);
    ASSERT_EQ(b.at("ticks").size(), 4U);
    EXPECT_EQ(b.at("ticks")[3].at("contacts"), 256);
    for (const json& t : b.at("ticks")) {
      EXPECT_EQ(t.at("seconds").at("count"), 2);
      EXPECT_GT(t.at("ratio_to_cpu"), 0.0);
      if (b.at("backend") == "cpu") {
        EXPECT_EQ(t.at("ratio_to_cpu"), 1.0);
      }
      EXPECT_EQ(t.at("device_memory") > 0, b.at("backend") != "cpu");
    }
    const bool has_batch = b.at("gradient_scheme") == "soft";
    EXPECT_EQ(b.at("batch").is_null(), !has_batch);
    if (has_batch) {
      EXPECT_EQ(b.at("batch").at("contacts"), 4096);
    }
  }
  EXPECT_EQ(seen, (std::set<std::string>{"cpu soft", "cpu central", "gl-compute soft", "gl-compute central",
                                         "gl-occlusion central"}));
  ASSERT_EQ(d.at("planes").size(), 2U);
  for (const json& p : d.at("planes")) {
    const bool is_double = p.at("arithmetic") == "double";
    EXPECT_EQ(p.at("sizes").size(), 3U);
    for (const json& s : p.at("sizes")) EXPECT_GT(s.at("ratio_to_cpu"), 0.0);
    EXPECT_EQ(p.at("too_deep_share"), 0.0);
    EXPECT_LE(p.at("depth_difference_m"), is_double ? 1e-9 : 5e-6);
    // Ticks on the processor read slopes in single precision; a sample that looks away counts by a share that goes from
    // 1 to 0 over a tenth of a radian, and so by ten times what its slope is off. 1.9e-6 was seen.
    EXPECT_LE(p.at("force_difference_p99"), is_double ? 1e-5 : 1e-2);
  }
  EXPECT_EQ(document({"bench", "--probe", block(), "--fixed", block(), "--backend", "gl-occlusion", "--grid", "4",
                      "--repeats", "1"})
                .at("planes"),
            json::array());
}

}  // namespace
}  // namespace fault
