// Writing: whole or not at all, and never over something that is not a file.
#include <csignal>
#include <gtest/gtest.h>
#include <limits>
#include <sys/resource.h>
#include <sys/stat.h>

#include "asperity/io/mesh_file.hpp"
#include "asperity/io/textured_model_file.hpp"
#include "scratch_folder.hpp"
#include "some_quality.hpp"
#include "support/small_models.hpp"

namespace asperity {
namespace {

using test_support::make_flat_box;
using test_support::scratch_folder;

TEST(Save, NamesThePathThatCannotBeWritten) {
  const scratch_folder folder;
  const auto file = folder.file("no/such/folder/m.glb");
  const auto saved = io::save_textured_model(make_flat_box({1, 1, 1}), file);
  ASSERT_FALSE(saved);
  EXPECT_EQ(saved.error().code, error_code::io_failed);
  EXPECT_NE(saved.error().message.find(file.string()), std::string::npos) << saved.error().message;
  EXPECT_EQ(folder.files(), 0U);
}

TEST(Save, ReplacesAFileAndLeavesNothingBeside) {
  const scratch_folder folder;
  (void)folder.file("m.glb", "old");
  ASSERT_TRUE(io::save_textured_model(make_flat_box({1, 1, 1}), folder.file("m.glb")));
  EXPECT_TRUE(io::load_textured_model(folder.file("m.glb")));
  EXPECT_EQ(folder.files(), 1U);
}

TEST(Save, FollowsALinkToItsFile) {
  const scratch_folder folder;
  std::filesystem::create_symlink("target.glb", folder.file("link.glb"));
  ASSERT_TRUE(io::save_textured_model(make_flat_box({1, 1, 1}), folder.file("link.glb")));
  EXPECT_TRUE(std::filesystem::is_symlink(folder.file("link.glb")));
  EXPECT_TRUE(io::load_textured_model(folder.file("target.glb")));
}

TEST(Save, LeavesFoldersAndDevicesAlone) {
  const scratch_folder folder;
  std::filesystem::create_directory(folder.file("m.glb"));
  EXPECT_FALSE(io::save_textured_model(make_flat_box({1, 1, 1}), folder.file("m.glb")));
  EXPECT_TRUE(std::filesystem::is_directory(folder.file("m.glb")));
  ASSERT_EQ(::mkfifo(folder.file("p.glb").c_str(), 0600), 0);
  EXPECT_FALSE(io::save_textured_model(make_flat_box({1, 1, 1}), folder.file("p.glb")));
  EXPECT_TRUE(std::filesystem::is_fifo(folder.file("p.glb")));
  EXPECT_EQ(folder.files(), 2U);
}

TEST(Save, AFullDiskLeavesTheOldFileAndNothingElse) {
  const scratch_folder folder;
  (void)folder.file("m.glb", "old");
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{10000, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const auto saved = io::save_textured_model(make_flat_box({1, 1, 1}), folder.file("m.glb"));
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, handler);
  ASSERT_FALSE(saved);
  EXPECT_EQ(saved.error().code, error_code::io_failed);
  EXPECT_EQ(test_support::read_all(folder.file("m.glb")), "old");
  EXPECT_EQ(folder.files(), 1U);
}

TEST(Save, RefusesAModelThatWouldNotLoad) {
  const scratch_folder folder;
  textured_model broken = make_flat_box({1, 1, 1});
  broken.mesh.triangles.pop_back();
  const auto open = io::save_textured_model(broken, folder.file("m.glb"));
  ASSERT_FALSE(open);
  EXPECT_EQ(open.error().code, error_code::bad_mesh);

  textured_model foreign = make_flat_box({1, 1, 1});
  foreign.pieces[0].vertices[0].x += 0.5;
  const auto hull = io::save_textured_model(foreign, folder.file("m.glb"));
  ASSERT_FALSE(hull);
  EXPECT_NE(hull.error().message.find("no vertex of the coarse mesh"), std::string::npos) << hull.error().message;

  textured_model report = make_flat_box({1, 1, 1});
  report.report.max_error_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(io::save_textured_model(report, folder.file("m.glb")));
  report.report.max_error_m = 0.0;
  report.report.quality = test_support::some_quality();
  report.report.quality->lost_part_high.y = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(io::save_textured_model(report, folder.file("m.glb")));
  EXPECT_EQ(folder.files(), 0U);
}

}  // namespace
}  // namespace asperity
