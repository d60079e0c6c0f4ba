// What the library reports about models and renderers agrees within 10 % with the allocator and the operating system.
#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>
#include <map>
#include <string>

namespace asperity {
namespace {

/// One line of memory_probe. Bytes.
struct measurement {
  double reported = 0.0;
  double part = 0.0;  ///< the share of the texture or the finder in it
  double lent = 0.0;
  double resident = 0.0;
};

double difference(double reported, double counted) { return std::fabs(reported - counted) / counted; }

class MemorySystem : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    // Both tests judge one run: it takes seconds.
    static std::map<std::string, std::map<std::string, measurement>> made;
    if (const auto before = made.find(GetParam()); before != made.end()) {
      measured_ = before->second;
      return;
    }
    const std::string folder = ASPERITY_TEST_MODELS_DIR "/";
    const std::string line =
        std::string("'") + ASPERITY_MEMORY_PROBE "' '" + folder + GetParam() + ".glb' '" + folder + "cad_part.glb'";
    std::FILE* const out = ::popen(line.c_str(), "r");
    ASSERT_NE(out, nullptr);
    char name[32];
    measurement m;
    while (std::fscanf(out, "%31s %lf %lf %lf %lf", name, &m.reported, &m.part, &m.lent, &m.resident) == 5) {
      measured_[name] = m;
    }
    ASSERT_EQ(::pclose(out), 0) << line;
    ASSERT_EQ(measured_.size(), 3U);
    made.emplace(GetParam(), measured_);
  }

  std::map<std::string, measurement> measured_;
};

constexpr double bound = 0.10;

TEST_P(MemorySystem, AgreesWithTheReport) {
  for (const auto& [what, m] : measured_) {
    std::printf("%-9s reported %9.0f  allocator %9.0f (%+.2f %%)  resident %9.0f (%+.2f %%)\n", what.c_str(),
                m.reported, m.lent, 100.0 * (m.lent / m.reported - 1.0), m.resident,
                100.0 * (m.resident / m.reported - 1.0));
    EXPECT_LT(difference(m.reported, m.lent), bound) << what;
    EXPECT_LT(difference(m.reported, m.resident), bound) << what;
  }
}

TEST_P(MemorySystem, AReportThatForgetsTheTextureOrTheForceModelDoesNot) {
  for (const auto& [what, m] : measured_) {
    EXPECT_GT(difference(m.reported - m.part, m.lent), bound) << what;
    EXPECT_GT(difference(m.reported - m.part, m.resident), bound) << what;
  }
}

INSTANTIATE_TEST_SUITE_P(Models, MemorySystem, ::testing::Values("file", "gear", "hammer"),
                         [](const auto& named) { return std::string(named.param); });

}  // namespace
}  // namespace asperity
