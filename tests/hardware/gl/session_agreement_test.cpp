// Whole sessions of the command on the virtual clock: the same hand, the same models, the depths once from the CPU and
// once from a GPU. A session is a closed loop, in which a difference of one tick moves the probe in the next.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <sstream>
#include <string>
#include <sys/wait.h>
#include <vector>

namespace {

namespace fs = std::filesystem;

struct outcome {
  int exit_status = -1;
  std::string text;
};

outcome run(const std::string& arguments) {
  outcome out;
  FILE* const pipe = popen(("'" ASPERITY_COMMAND "' " + arguments + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return out;
  std::array<char, 1024> line{};
  while (std::fgets(line.data(), line.size(), pipe) != nullptr) out.text += line.data();
  const int state = pclose(pipe);
  out.exit_status = WIFEXITED(state) ? WEXITSTATUS(state) : 128;
  return out;
}

/// Columns of numbers by their names.
using table = std::map<std::string, std::vector<double>>;

table read_recording(const fs::path& file) {
  std::ifstream in(file);
  std::vector<std::string> names;
  table out;
  for (std::string line, cell; std::getline(in, line);) {
    std::istringstream cells(line);
    for (std::size_t i = 0; std::getline(cells, cell, ','); ++i) {
      if (out.size() <= i && names.size() == i) {
        names.push_back(cell);
        continue;
      }
      char* end = nullptr;
      const double value = std::strtod(cell.c_str(), &end);
      if (end != cell.c_str()) out[names[i]].push_back(value);
    }
  }
  return out;
}

/// Largest difference of these columns, and the largest value of the first recording.
struct difference {
  double most = 0.0, largest = 0.0;
};

difference compare(const table& a, const table& b, std::initializer_list<const char*> columns) {
  difference out;
  for (const char* name : columns) {
    const std::vector<double>&x = a.at(name), &y = b.at(name);
    EXPECT_EQ(x.size(), y.size()) << name;
    for (std::size_t i = 0; i < std::min(x.size(), y.size()); ++i) {
      out.most = std::max(out.most, std::fabs(x[i] - y[i]));
      out.largest = std::max(out.largest, std::fabs(x[i]));
    }
  }
  return out;
}

struct compared {
  const char* name;
  const char* gl;
  const char* cpu;
  double position_m, force_n, torque_n_m;  ///< bounds
};

// Measured figures stand in docs/explanation/gpu-backends.md.
constexpr std::array<compared, 2> backends{
    {{"gl-compute", "--backend gl-compute", "--contacts window", 1e-9, 1e-6, 1e-7},
     {"gl-occlusion", "--backend gl-occlusion", "--contacts window --gradient central --lookup paper", 1e-5, 0.05,
      0.002}}};

class GlSessions : public testing::TestWithParam<std::array<const char*, 2>> {
 protected:
  void SetUp() override {
    const outcome devices = run("devices --gpu");
    if (devices.exit_status != 0 || devices.text.find("OpenGL ") == std::string::npos) GTEST_SKIP() << devices.text;
    std::string name = (fs::temp_directory_path() / "asperity-gl-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override {
    std::error_code ignored;
    if (!folder_.empty()) fs::remove_all(folder_, ignored);
  }
  fs::path folder_;
};

TEST_P(GlSessions, AgreeWithTheCpu) {
  const auto [probe, fixed] = GetParam();
  const auto model = [](const char* name) { return " '" ASPERITY_TEST_MODELS_DIR "/" + std::string(name) + ".glb'"; };
  const std::string session = "run --quiet --probe" + model(probe) + " --fixed" + model(fixed) +
                              " --seconds 0.3 --motion press --press 0.03 --grid 16 --record '";
  for (const compared& c : backends) {
    table recorded[2];
    for (int on_gpu = 0; on_gpu < 2; ++on_gpu) {
      const fs::path file = folder_ / (std::string(c.name) + std::to_string(on_gpu) + ".csv");
      const outcome done = run(session + file.string() + "' " + (on_gpu == 0 ? c.cpu : c.gl));
      ASSERT_EQ(done.exit_status, 0) << done.text;
      recorded[on_gpu] = read_recording(file);
    }
    const auto of = [&](std::initializer_list<const char*> columns) {
      return compare(recorded[0], recorded[1], columns);
    };
    const difference position = of({"probe_x_m", "probe_y_m", "probe_z_m"});
    const difference force = of({"contact_fx_n", "contact_fy_n", "contact_fz_n"});
    const difference torque = of({"contact_tx_n_m", "contact_ty_n_m", "contact_tz_n_m"});
    const std::vector<double>& contacts = recorded[0].at("contacts");
    std::printf("| %s on %s | %s | %.0f | %.1e | %.1e of %.2g | %.1e of %.2g |\n", probe, fixed, c.name,
                *std::max_element(contacts.begin(), contacts.end()), position.most, force.most, force.largest,
                torque.most, torque.largest);
    EXPECT_GT(force.largest, 1.0) << "the probe has to be felt";
    EXPECT_GT(std::count_if(contacts.begin(), contacts.end(), [](double n) { return n > 0.0; }), 150);
    EXPECT_LE(position.most, c.position_m);
    EXPECT_LE(force.most, c.force_n);
    EXPECT_LE(torque.most, c.torque_n_m);
  }
}

INSTANTIATE_TEST_SUITE_P(Benchmark, GlSessions,
                         testing::Values(std::array{"block", "gear"}, std::array{"file", "cad_part"},
                                         std::array{"hammer", "torus"}),
                         [](const auto& of) { return std::string(of.param[0]) + "_on_" + of.param[1]; });

}  // namespace
