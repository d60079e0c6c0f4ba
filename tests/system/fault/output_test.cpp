// Outputs that cannot be written: found early, one sentence, nothing left behind.
#include <cstdio>
#include <cstdlib>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

#include "command_process.hpp"

namespace fault {
namespace {

class output : public command_test {
 protected:
  output() { write("file", "not a folder"); }

  [[nodiscard]] static std::string made(const char* file) { return (small_models() / file).string(); }
  [[nodiscard]] static arguments bake_to(const std::string& out) {
    return {"bake", made("block.ply"), "--coarse", made("block_coarse.ply"), "--texture", "64", "--without-field", "-o",
            out};
  }
  [[nodiscard]] static arguments run_with(const char* option, const std::string& out) {
    return {"run", "--probe", made("pin.glb"), "--fixed", made("pin.glb"), "--seconds", "0.05", option, out};
  }
  [[nodiscard]] static arguments draw_to(const std::string& out) {
    return {"inspect", made("block.glb"), "--original", made("block.ply"), "--picture", out};
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
    std::filesystem::copy_file(made("block.ply"), path(name + ".ply"));
    const arguments bake{"bake", path(name + ".ply"), "--coarse", made("block_coarse.ply"), "--texture",
                         "64",   "--without-field",   "-o",       path(name + ".glb")};
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
  std::filesystem::copy_file(made("block.glb"), path("mesh.glb"));
  const std::string before = read("mesh.glb");
  expect_failure({"bake", path("mesh.glb"), "-o", path("mesh.glb")}, 1, "invalid_argument");
  EXPECT_EQ(read("mesh.glb"), before);
}

TEST_F(output, picture_that_would_replace_what_is_read) {
  std::filesystem::copy_file(made("block.glb"), path("model.glb"));
  std::filesystem::create_symlink(path("model.glb"), path("model.png"));
  const std::string before = read("model.glb");
  expect_failure({"inspect", path("model.glb"), "--picture", path("model.png")}, 1, "invalid_argument");
  std::filesystem::copy_file(made("block.ply"), path("mesh.ply"));
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

TEST_F(output, of_a_session_that_would_replace_what_it_reads) {
  std::filesystem::copy_file(made("block.glb"), path("model.glb"));
  std::filesystem::create_symlink(path("model.glb"), path("link"));
  std::filesystem::create_symlink(path("link"), path("link-to-a-link"));
  std::filesystem::create_hard_link(path("model.glb"), path("second-name"));
  std::filesystem::create_symlink("link", path("plot.svg"));
  const std::string before = read("model.glb");
  const auto felt = [&](const std::string& option, const std::string& out) {
    return arguments{"run",  "--probe", path("model.glb"), "--fixed", made("block.glb"), "--seconds", "0.05",
                     option, out};
  };
  for (const char* name : {"model.glb", "./model.glb", "link", "link-to-a-link", "second-name"}) {
    for (const char* option : {"--record", "--record-device"}) {
      const std::string message = expect_failure(felt(option, path(name)), 1, "invalid_argument");
      EXPECT_NE(message.find(option), std::string::npos) << message;
      EXPECT_NE(message.find("--probe"), std::string::npos) << message;
    }
  }
  expect_failure(felt("--plot", path("plot.svg")), 1, "invalid_argument");
  arguments fixed = felt("--record", path("link"));
  std::swap(fixed[2], fixed[4]);
  EXPECT_NE(expect_failure(fixed, 1, "invalid_argument").find("--fixed"), std::string::npos);
  EXPECT_EQ(read("model.glb"), before);
}

TEST_F(output, two_that_are_one_file) {
  write("old.csv", "an older table");
  std::filesystem::create_symlink("old.csv", path("old.svg"));
  std::filesystem::create_symlink("not-there-yet", path("new.svg"));
  std::filesystem::create_directory(path("folder"));
  const auto felt = [&](const std::string& record, const std::string& more, const std::string& to) {
    return arguments{"run",  "--probe",  made("pin.glb"), "--fixed", made("pin.glb"), "--seconds",
                     "0.05", "--record", path(record),    more,      path(to)};
  };
  expect_failure(felt("old.csv", "--plot", "old.svg"), 1, "invalid_argument");
  expect_failure(felt("not-there-yet", "--plot", "new.svg"), 1, "invalid_argument");
  expect_failure(felt("new.csv", "--record-device", "folder/../new.csv"), 1, "invalid_argument");
  EXPECT_EQ(read("old.csv"), "an older table");
  EXPECT_EQ(run({"run", "--probe", made("pin.glb"), "--fixed", made("pin.glb"), "--seconds", "0.05", "--record",
                 "/dev/null", "--record-device", "/dev/null"})
                .exit_status,
            0);
}

TEST_F(output, image_of_a_gltf_asset_is_not_painted_over) {
  write("wall.gltf", R"({"asset": {"version": "2.0"}, "images": [{"uri": "wall%20map.png"}]})");
  write("wall map.png", "an image");
  const std::string message = expect_failure(
      {"bake", path("wall.gltf"), "-o", path("wall.glb"), "--picture", path("wall map.png")}, 1, "invalid_argument");
  EXPECT_NE(message.find("wall map.png"), std::string::npos) << message;
  expect_failure({"inspect", made("block.glb"), "--original", path("wall.gltf"), "--picture", path("wall map.png")}, 1,
                 "invalid_argument");
  EXPECT_EQ(read("wall map.png"), "an image");
}

TEST_F(output, page_that_is_a_link_to_a_model) {
  std::filesystem::create_directories(path("out"));
  std::filesystem::create_directories(path("models"));
  write("models/block.glb", "a model");
  std::filesystem::create_symlink("../models/block.glb", path("out/index.html"));
  expect_failure({"experiment", "fig7", "-o", path("out"), "--models", path("models")}, 1, "invalid_argument");
  EXPECT_EQ(read("models/block.glb"), "a model");
}

// Who may read a result is decided by whoever made the file, not by the program that replaces it.
TEST_F(output, keeps_mode_owner_and_links) {
  using std::filesystem::perms;
  const auto mode = [&](const std::string& name) {
    struct stat about {};
    EXPECT_EQ(stat(path(name).c_str(), &about), 0) << name;
    return about.st_mode & 07777U;
  };
  for (const char* name : {"felt.csv", "felt.dev", "plot.svg", "model.glb", "model.png"}) {
    write(name, "old");
    ASSERT_EQ(chmod(path(name).c_str(), 0600), 0);
    std::filesystem::create_symlink(name, path("link-" + std::string(name)));
  }
  ASSERT_EQ(chmod(path("felt.dev").c_str(), 0664), 0);
  const bool root = geteuid() == 0;
  ASSERT_TRUE(!root || chown(path("felt.csv").c_str(), 12345, 23456) == 0);
  for (const std::string through : {"link-", ""}) {
    EXPECT_EQ(run({"run", "--probe", made("pin.glb"), "--fixed", made("pin.glb"), "--seconds", "0.05", "--record",
                   path(through + "felt.csv"), "--record-device", path(through + "felt.dev"), "--plot",
                   path(through + "plot.svg")})
                  .exit_status,
              0);
    EXPECT_EQ(run(bake_to(path(through + "model.glb"))).exit_status, 0);
    EXPECT_EQ(run(draw_to(path(through + "model.png"))).exit_status, 0);
    for (const char* name : {"felt.csv", "plot.svg", "model.glb", "model.png"}) {
      EXPECT_EQ(mode(name), 0600U) << name;
      EXPECT_TRUE(std::filesystem::is_symlink(path("link-" + std::string(name))));
      EXPECT_NE(read(name), "old");
      write(name, "old");
    }
    EXPECT_EQ(mode("felt.dev"), 0664U);
    struct stat about {};
    ASSERT_EQ(stat(path("felt.csv").c_str(), &about), 0);
    EXPECT_TRUE(!root || (about.st_uid == 12345 && about.st_gid == 23456)) << about.st_uid << ' ' << about.st_gid;
  }
  // A new file has the mode of the session's user.
  const mode_t old_mask = umask(027);
  EXPECT_EQ(run(run_with("--record", path("new.csv"))).exit_status, 0);
  umask(old_mask);
  EXPECT_EQ(mode("new.csv"), 0640U);
}

// What dead runs left under every number that this process could have.
TEST_F(output, leftovers_of_dead_runs_are_in_nobodys_way) {
  for (int i = 0; i < 100; ++i) write("model.glb.part" + std::to_string(i), "left");
  write("felt.csv.partial-1", "left");
  const outcome baked = run(bake_to(path("model.glb")));
  EXPECT_EQ(baked.exit_status, 0) << baked.err;
  // As in a container, where every run has the same process number: in a new namespace of its own, where permitted.
  const std::string again = std::string("exec unshare --pid --fork --mount-proc ") + ASPERITY_COMMAND +
                            " run --probe " + made("pin.glb") + " --fixed " + made("pin.glb") +
                            " --seconds 0.05 --record " + path("felt.csv") + " > " + path("report") + " 2>&1";
  if (std::system("unshare --pid --fork --mount-proc true > /dev/null 2>&1") == 0) {
    EXPECT_EQ(std::system(again.c_str()), 0) << read("report");
    EXPECT_EQ(read("felt.csv.partial-1"), "left");
  } else {
    std::puts("[  NOTE    ] no process namespace may be made here: the same process number was not tried");
  }
}

TEST_F(output, failed_picture_keeps_the_old_one) {
  write("model.png", "an older picture");
  write("broken.ply", "ply\n");
  const auto compare_to = [&](const std::string& original) {
    return arguments{"inspect", made("block.glb"), "--picture", path("model.png"), "--original", original};
  };
  EXPECT_NE(expect_failure(compare_to(path("absent.ply")), 1, "io_failed").find("absent.ply"), std::string::npos);
  EXPECT_NE(expect_failure(compare_to(path("broken.ply")), 1, "bad_format").find("broken.ply"), std::string::npos);
  arguments in_millimetres = compare_to(made("block.ply"));
  in_millimetres.insert(in_millimetres.end(), {"--scale", "0.001"});
  const std::string message = expect_failure(in_millimetres, 1, "invalid_argument");
  EXPECT_NE(message.find("--scale"), std::string::npos) << message;
  EXPECT_EQ(read("model.png"), "an older picture");
  EXPECT_EQ(run(compare_to(made("block.ply"))).exit_status, 0);
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
  const outcome stopped = run({"bake", made("block.ply"), "-o", path("model.glb"), "--texture", "4096"}, options);
  EXPECT_EQ(stopped.exit_status, 130);
  EXPECT_EQ(stopped.err.rfind("asperity: ", 0), 0U) << stopped.err;
  EXPECT_EQ(files(), std::set<std::string>{"file"});
}

}  // namespace
}  // namespace fault
