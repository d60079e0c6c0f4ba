// Scanned and modelled meshes as people have them, from the folder that ASPERITY_MODELS names: what the command reports
// of their bakes, and how deep the baked models are beside the meshes themselves.
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <gtest/gtest.h>
#include <memory>
#include <string>
#include <utility>

#include "asperity/io/mesh_file.hpp"
#include "asperity/io/textured_model_file.hpp"
#include "fault/command_process.hpp"
#include "oracle/against_originals.hpp"

namespace {

using namespace asperity;
using oracle::original_and_bake;

constexpr double diagonal_m = 0.16;  // of the depth comparisons: real meshes have no unit
constexpr int poses_per_pair = 70;
// These surfaces have no walls, only slopes: one is taken for what it is, up to 72 degrees.
constexpr double steepest = 3.0;

struct real_mesh {
  const char* file;
  std::size_t triangles;
  std::size_t holes;
};
constexpr real_mesh igea{"igea.ply", 268'686, 0};
constexpr real_mesh rocker_arm{"rocker-arm.obj", 20'088, 0};
constexpr real_mesh bunny{"stanford-bunny.obj", 69'451, 5};

class real_models : public fault::command_test {
 protected:
  void SetUp() override {
    const char* set = std::getenv("ASPERITY_MODELS");
    folder_ = set == nullptr ? "" : set;
    for (const real_mesh& mesh : {igea, rocker_arm, bunny}) {
      if (!std::filesystem::exists(folder_ / mesh.file)) {
        GTEST_SKIP() << "ASPERITY_MODELS names no folder with " << mesh.file;
      }
    }
  }

  [[nodiscard]] std::string source(const real_mesh& mesh) const { return (folder_ / mesh.file).string(); }

  // Bakes with the command's own defaults. @return its report
  [[nodiscard]] fault::json bake(const real_mesh& mesh, const std::string& out, const std::string& scale = "1") const {
    fault::arguments args{"bake", source(mesh), "-o", path(out), "--scale", scale};
    if (mesh.holes > 0) args.emplace_back("--close-holes");
    return expect_document(args, "asperity.bake/1");
  }

  // The mesh at `diagonal_m`, its holes as they are, and its bake.
  [[nodiscard]] original_and_bake load(const real_mesh& mesh) const {
    auto full = io::load_mesh(source(mesh));
    if (!full) throw std::runtime_error(full.error().message);
    vec3 low = full->positions.front(), high = low;
    for (const vec3& p : full->positions) {
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
    std::array<char, 40> scale{};
    std::snprintf(scale.data(), scale.size(), "%.17g", diagonal_m / glm::length(high - low));
    for (vec3& p : full->positions) p *= std::strtod(scale.data(), nullptr);
    const std::string name = std::filesystem::path(mesh.file).stem().string();
    const fault::json report = bake(mesh, name + ".glb", scale.data());
    auto model = io::load_textured_model(path(name + ".glb"));
    if (!model) throw std::runtime_error(model.error().message);
    std::printf("  %-14s RMS error %.4f %%, maximum %.3f %% of the diagonal\n", name.c_str(),
                report["bake"]["rms_error_percent"].get<double>(), report["bake"]["max_error_percent"].get<double>());
    return {name, std::move(full).value(), std::make_shared<const textured_model>(std::move(model).value())};
  }

 private:
  std::filesystem::path folder_;
};

TEST_F(real_models, reports_are_plausible) {
  for (const real_mesh& mesh : {igea, rocker_arm, bunny}) {
    SCOPED_TRACE(mesh.file);
    const fault::json report = bake(mesh, "out.glb");
    const fault::json& repair = report["repair"];
    EXPECT_EQ(report["full_triangles"].get<std::size_t>(),
              mesh.triangles + repair["triangles_added"].get<std::size_t>());
    EXPECT_EQ(repair["holes_closed"], mesh.holes);
    EXPECT_EQ(repair["area_added"] > 0.0, mesh.holes > 0);
    EXPECT_EQ(report["coarse"]["triangles"], 600);
    const std::size_t pieces = report["pieces"]["count"];
    EXPECT_GE(pieces, 20U);
    EXPECT_LE(pieces, 300U);
    const fault::json& texture = report["texture"];
    EXPECT_EQ(texture["width"], 1024);
    EXPECT_GT(texture["coverage"], 0.4);
    EXPECT_LE(texture["coverage"], 1.0);
    EXPECT_LT(texture["fallback_texels"].get<double>(), 0.01 * texture["texels"].get<double>());
    const fault::json& errors = report["bake"];
    EXPECT_GT(errors["rms_error_percent"], 1e-5) << "no bake of a scan is exact";
    EXPECT_LT(errors["rms_error_percent"], 0.01);
    EXPECT_LT(errors["max_error_percent"], 0.5);
    EXPECT_GT(errors["relief"], 10.0 * errors["rms_error"].get<double>());
    // The box is full by some part, and not by more than all.
    double box = 1.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      box *= report["size"]["high"][axis].get<double>() - report["size"]["low"][axis].get<double>();
    }
    const double volume = report["mass_properties"]["volume"];
    EXPECT_GT(volume, 0.1 * box);
    EXPECT_LT(volume, box);
    EXPECT_EQ(report["warnings"].size(), 0U) << report["warnings"];
  }
}

TEST_F(real_models, the_open_bunny_is_refused_with_its_mend) {
  const std::string message = expect_failure({"bake", source(bunny), "-o", path("out.glb")}, 1, "bad_mesh");
  EXPECT_NE(message.find("223 open edges"), std::string::npos) << message;
  EXPECT_NE(message.find("--close-holes"), std::string::npos) << message;
}

TEST_F(real_models, depth_agrees_with_the_full_resolution_meshes) {
  const original_and_bake a = load(igea), b = load(rocker_arm), c = load(bunny);
  oracle::print_heading();
  int poses = 0;
  const auto compare = [&](const original_and_bake& probe, const original_and_bake& fixed, std::uint64_t seed) {
    const oracle::comparison r = oracle::compare_with_originals(probe, fixed, poses_per_pair, seed, steepest);
    oracle::print_row(probe, fixed, r);
    poses += r.poses;
    EXPECT_EQ(r.beyond, 0) << probe.name << " on " << fixed.name << " (seed " << seed << ")";
    EXPECT_EQ(r.disagreed, 0) << probe.name << " on " << fixed.name << " (seed " << seed << ")";
    EXPECT_LE(oracle::percentile(r.on_grid_m, 0.5), r.rms_error_m);
    EXPECT_GT(oracle::percentile(r.untextured_m, 0.5), 5.0 * oracle::percentile(r.on_grid_m, 0.5));
  };
  compare(a, b, 31);
  compare(c, a, 32);
  compare(b, c, 33);
  EXPECT_GE(poses, 200);
}

}  // namespace
