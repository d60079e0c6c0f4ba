// The same mesh and the same options give the same file, whatever the number of threads; a bake that is stopped leaves
// the folder as it found it, whenever that is.
#include <cmath>
#include <numbers>

#include "command_process.hpp"

namespace fault {
namespace {

class same_bytes : public command_test {
 protected:
  // A torus with waves on it, so that every stage has work for several threads; `missing` of its faces are left out.
  void write_torus(const std::string& name, int missing = 0, int around = 48, int across = 16) const {
    std::string text;
    for (int i = 0; i < around; ++i) {
      for (int j = 0; j < across; ++j) {
        const double u = 2 * std::numbers::pi * i / around, v = 2 * std::numbers::pi * j / across;
        const double tube = 0.02 + 0.0004 * std::sin(15 * u) * std::sin(5 * v);
        const double r = 0.05 + tube * std::cos(v);
        text += "v " + std::to_string(r * std::cos(u)) + ' ' + std::to_string(r * std::sin(u)) + ' ' +
                std::to_string(tube * std::sin(v)) + '\n';
      }
    }
    const auto at = [&](int i, int j) { return std::to_string(1 + (i % around) * across + j % across); };
    for (int i = 0; i < around; ++i) {
      for (int j = 0; j < across; ++j) {
        if (missing-- > 0) continue;
        text += "f " + at(i, j) + ' ' + at(i + 1, j) + ' ' + at(i + 1, j + 1) + '\n';
        text += "f " + at(i, j) + ' ' + at(i + 1, j + 1) + ' ' + at(i, j + 1) + '\n';
      }
    }
    write(name, text);
  }

  [[nodiscard]] std::string baked(const std::string& mesh, const arguments& more, int threads) const {
    arguments args{"bake", path(mesh), "-o", path("out.glb"), "--texture", "96", "--threads", std::to_string(threads)};
    args.insert(args.end(), more.begin(), more.end());
    static_cast<void>(expect_document(args, "asperity.bake/1"));
    return read("out.glb");
  }

  void expect_the_same_on_any_number_of_threads(const std::string& mesh, const arguments& more) const {
    const std::string one = baked(mesh, more, 1);
    ASSERT_GT(one.size(), 96U * 96U * 12U);
    for (const int threads : {1, 2, 7}) EXPECT_TRUE(baked(mesh, more, threads) == one) << threads << " threads";
  }
};

TEST_F(same_bytes, simplified) {
  write_torus("torus.obj");
  expect_the_same_on_any_number_of_threads("torus.obj", {"--triangles", "120", "--without-field"});
}

TEST_F(same_bytes, with_a_coarse_mesh) {
  write_torus("torus.obj");
  write_torus("coarse.obj", 0, 12, 6);
  expect_the_same_on_any_number_of_threads("torus.obj", {"--coarse", path("coarse.obj")});
}

TEST_F(same_bytes, with_holes_closed) {
  write_torus("torus.obj", 3);
  expect_the_same_on_any_number_of_threads("torus.obj", {"--triangles", "120", "--close-holes", "--without-field"});
}

TEST_F(same_bytes, wrapped) {
  write_torus("torus.obj", 3);
  expect_the_same_on_any_number_of_threads("torus.obj", {"--triangles", "120", "--wrap=0.004"});
}

// That the comparison can see: other options give another file.
TEST_F(same_bytes, other_options_give_other_bytes) {
  write_torus("torus.obj");
  const auto with = [&](const char* triangles) {
    return baked("torus.obj", {"--triangles", triangles, "--without-field"}, 2);
  };
  EXPECT_FALSE(with("120") == with("122"));
}

class interrupted_bake : public command_test {};

TEST_F(interrupted_bake, leaves_the_folder_as_it_was_at_any_time) {
  write("model.glb", "an older model");
  const arguments bake{"bake", (small_models() / "block.ply").string(), "-o", path("model.glb"), "--texture", "2048"};
  int stopped = 0;
  for (const double after_s : {0.0, 0.01, 0.03, 0.1, 0.2, 0.4}) {
    process_options options;
    options.interrupt_after_s = after_s;
    const outcome ended = run(bake, options);
    EXPECT_EQ(files(), std::set<std::string>{"model.glb"}) << after_s << " s";
    if (ended.exit_status == 0) break;  // faster than the interrupt
    ++stopped;
    EXPECT_EQ(ended.exit_status, 130) << ended.err;
    EXPECT_EQ(read("model.glb"), "an older model");
  }
  EXPECT_GE(stopped, 1);
}

}  // namespace
}  // namespace fault
