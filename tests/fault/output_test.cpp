// Outputs that cannot be written: found early, one sentence, nothing left behind.
#include <unistd.h>
#include <utility>

#include "command_process.hpp"

namespace fault {
namespace {

class output : public command_test {
 protected:
  output() { write("file", "not a folder"); }

  [[nodiscard]] static std::string block(const char* file) { return (small_models() / file).string(); }
  [[nodiscard]] static arguments bake_to(const std::string& out) {
    return {"bake", block("block.ply"), "--coarse", block("block_coarse.ply"), "--texture", "64", "-o", out};
  }
  [[nodiscard]] static arguments run_with(const char* option, const std::string& out) {
    return {"run", "--probe", block("block.glb"), "--fixed", block("block.glb"), "--seconds", "0.05", option, out};
  }
  [[nodiscard]] static arguments draw_to(const std::string& out) {
    return {"inspect", block("block.glb"), "--original", block("block.ply"), "--picture", out};
  }
};

TEST_F(output, folder_that_is_not_there) {
  EXPECT_NE(expect_failure(bake_to(path("absent/model.glb")), 1, "io_failed").find("absent/model.glb"),
            std::string::npos);
  expect_failure(run_with("--record", path("absent/session.csv")), 1, "io_failed");
  expect_failure(run_with("--plot", path("absent/plot.png")), 1, "io_failed");
  EXPECT_NE(expect_failure(draw_to(path("absent/model.png")), 1, "io_failed").find("absent/model.png"),
            std::string::npos);
  arguments bake_and_draw = bake_to(path("model.glb"));
  bake_and_draw.insert(bake_and_draw.end(), {"--picture", path("absent/model.png")});
  expect_failure(bake_and_draw, 1, "io_failed");
}

TEST_F(output, parent_that_is_a_file) {
  expect_failure(bake_to(path("file/model.glb")), 1, "io_failed");
  expect_failure(run_with("--record", path("file/session.csv")), 1, "io_failed");
  expect_failure(run_with("--plot", path("file/plot.svg")), 1, "io_failed");
  expect_failure(draw_to(path("file/model.png")), 1, "io_failed");
  expect_failure({"models", "--only", "block", "-o", path("file/models")}, 1, "io_failed");
  expect_failure({"models", "--only", "block", "-o", path("file")}, 1, "io_failed");
}

TEST_F(output, folder_in_the_place_of_the_file) {
  std::filesystem::create_directory(path("model.glb"));
  std::filesystem::create_directory(path("session.csv"));
  std::filesystem::create_directory(path("model.png"));
  expect_failure(bake_to(path("model.glb")), 1, "io_failed");
  expect_failure(run_with("--record", path("session.csv")), 1, "io_failed");
  expect_failure(draw_to(path("model.png")), 1, "io_failed");
}

TEST_F(output, folder_that_may_only_be_read) {
  // No right stops root, and nothing makes a file in /proc.
  std::string folder = "/proc";
  if (geteuid() != 0) {
    folder = path("read-only");
    std::filesystem::create_directory(folder);
    std::filesystem::permissions(folder, std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  }
  const std::string message = expect_failure(bake_to(folder + "/model.glb"), 1, "io_failed");
  EXPECT_NE(message.find(folder + "/model.glb"), std::string::npos) << message;
  EXPECT_NE(message.find("writable folder"), std::string::npos) << message;
}

// File names are bytes. The model is called after its mesh, as far as that is UTF-8.
TEST_F(output, names_of_any_letters) {
  const std::vector<std::pair<std::string, std::string>> names{
      {"a mesh with spaces", "a mesh with spaces"},
      {"\xc3\xbc\xe6\x9f\x90 'quoted' \"twice\"", "\xc3\xbc\xe6\x9f\x90 'quoted' \"twice\""},
      {"-begins-with-a-dash", "-begins-with-a-dash"},
      {"latin \xe9", "latin \xef\xbf\xbd"},
      {"two\nlines", "two\nlines"},
  };
  for (const auto& [name, kept] : names) {
    std::filesystem::copy_file(block("block.ply"), path(name + ".ply"));
    const arguments bake{"bake", path(name + ".ply"), "--coarse", block("block_coarse.ply"), "--texture", "64",
                         "-o",   path(name + ".glb")};
    static_cast<void>(expect_document(bake, "asperity.bake/1"));
    const json inspected = expect_document({"inspect", path(name + ".glb")}, "asperity.inspect/1");
    EXPECT_EQ(inspected.at("name"), kept);
  }
}

TEST_F(output, unwritable_place_is_found_before_the_input_is_read) {
  const std::string message =
      expect_failure({"bake", path("absent.ply"), "-o", path("absent/model.glb")}, 1, "io_failed");
  EXPECT_NE(message.find("absent/model.glb"), std::string::npos) << message;
}

TEST_F(output, full_disk) {
  // Every write to /dev/full fails as on a full disk. A device is written in place, so its name needs no extension.
  std::filesystem::create_symlink("/dev/full", path("session.csv"));
  std::filesystem::create_symlink("/dev/full", path("plot.png"));
  expect_failure(run_with("--record", path("session.csv")), 1, "io_failed");
  expect_failure(run_with("--plot", path("plot.png")), 1, "io_failed");
  expect_failure(draw_to(path("plot.png")), 1, "io_failed");
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/full"));
}

TEST_F(output, disk_that_fills_up_while_writing) {
  process_options options;
  options.file_size_limit = 4096;
  expect_failure(bake_to(path("model.glb")), 1, "io_failed", options);
  expect_failure(run_with("--record", path("session.csv")), 1, "io_failed", options);
  expect_failure(run_with("--plot", path("plot.png")), 1, "io_failed", options);
  expect_failure(draw_to(path("model.png")), 1, "io_failed", options);
  expect_failure({"models", "--only", "block", "-o", path("")}, 1, "io_failed", options);
}

TEST_F(output, stdout_that_takes_nothing) {
  process_options options;
  options.stdout_to = "/dev/full";
  const outcome lost = run({"devices", "--json"}, options);
  EXPECT_EQ(lost.exit_status, 1);
  EXPECT_EQ(lost.err.rfind("asperity: stdout", 0), 0U) << lost.err;
}

TEST_F(output, mesh_that_would_replace_itself) {
  std::filesystem::copy_file(block("block.glb"), path("mesh.glb"));
  const std::string before = read("mesh.glb");
  expect_failure({"bake", path("mesh.glb"), "-o", path("mesh.glb")}, 1, "invalid_argument");
  EXPECT_EQ(read("mesh.glb"), before);
}

TEST_F(output, picture_that_would_replace_what_is_read) {
  std::filesystem::copy_file(block("block.glb"), path("model.glb"));
  std::filesystem::create_symlink(path("model.glb"), path("model.png"));
  const std::string before = read("model.glb");
  expect_failure({"inspect", path("model.glb"), "--picture", path("model.png")}, 1, "invalid_argument");
  std::filesystem::copy_file(block("block.ply"), path("mesh.ply"));
  std::filesystem::create_symlink(path("mesh.ply"), path("mesh.png"));
  expect_failure({"inspect", path("model.glb"), "--original", path("mesh.ply"), "--picture", path("mesh.png")}, 1,
                 "invalid_argument");
  expect_failure({"bake", path("mesh.ply"), "-o", path("new.glb"), "--picture", path("mesh.png")}, 1,
                 "invalid_argument");
  write("new.glb", "an older model");
  std::filesystem::create_symlink(path("new.glb"), path("new.png"));
  expect_failure({"bake", path("mesh.ply"), "-o", path("new.glb"), "--picture", path("new.png")}, 1,
                 "invalid_argument");
  EXPECT_EQ(read("model.glb"), before);
}

TEST_F(output, failed_picture_keeps_the_old_one) {
  write("model.png", "an older picture");
  write("broken.ply", "ply\n");
  const auto compare_to = [&](const std::string& original) {
    return arguments{"inspect", block("block.glb"), "--picture", path("model.png"), "--original", original};
  };
  EXPECT_NE(expect_failure(compare_to(path("absent.ply")), 1, "io_failed").find("absent.ply"), std::string::npos);
  EXPECT_NE(expect_failure(compare_to(path("broken.ply")), 1, "bad_format").find("broken.ply"), std::string::npos);
  arguments in_millimetres = compare_to(block("block.ply"));
  in_millimetres.insert(in_millimetres.end(), {"--scale", "0.001"});
  const std::string message = expect_failure(in_millimetres, 1, "invalid_argument");
  EXPECT_NE(message.find("--scale"), std::string::npos) << message;
  EXPECT_EQ(read("model.png"), "an older picture");
  EXPECT_EQ(run(compare_to(block("block.ply"))).exit_status, 0);
  EXPECT_EQ(read("model.png").substr(1, 3), "PNG");
}

TEST_F(output, failed_bake_keeps_the_old_model) {
  write("model.glb", "an older model");
  write("mesh.ply", "ply\n");
  expect_failure({"bake", path("mesh.ply"), "-o", path("model.glb")}, 1, "bad_format");
  EXPECT_EQ(read("model.glb"), "an older model");
}

TEST_F(output, interrupted_bake_leaves_nothing) {
  process_options options;
  options.interrupt_after_s = 0.05;
  const outcome stopped = run({"bake", block("block.ply"), "-o", path("model.glb"), "--texture", "4096"}, options);
  EXPECT_EQ(stopped.exit_status, 130);
  EXPECT_EQ(stopped.err.rfind("asperity: ", 0), 0U) << stopped.err;
  EXPECT_EQ(files(), std::set<std::string>{"file"});
}

}  // namespace
}  // namespace fault
