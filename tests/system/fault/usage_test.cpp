// Command lines that are wrong in themselves: exit status 2, whatever else is true.
#include "command_process.hpp"

namespace fault {
namespace {

class usage : public command_test {};

TEST_F(usage, without_a_subcommand) { expect_failure({}, 2, "usage"); }

TEST_F(usage, unknown_subcommand_is_named) {
  EXPECT_NE(expect_failure({"feel"}, 2, "usage").find("feel"), std::string::npos);
}

TEST_F(usage, unknown_option_is_named) {
  const std::string message = expect_failure({"inspect", "model.glb", "--colour"}, 2, "usage");
  EXPECT_NE(message.find("--colour"), std::string::npos);
  EXPECT_NE(message.find("asperity inspect --help"), std::string::npos);
}

TEST_F(usage, missing_argument) {
  EXPECT_NE(expect_failure({"bake", path("mesh.ply")}, 2, "usage").find("output"), std::string::npos);
  expect_failure({"query", "--probe", path("a.glb"), "--fixed", path("b.glb")}, 2, "usage");
  expect_failure({"run", "--probe", path("a.glb")}, 2, "usage");
  expect_failure({"models"}, 2, "usage");
}

TEST_F(usage, bad_number) {
  const arguments bake{"bake", path("mesh.ply"), "-o", path("model.glb")};
  for (const arguments& wrong : std::initializer_list<arguments>{{"--triangles", "many"},
                                                                 {"--triangles", "-3"},
                                                                 {"--texture", "0"},
                                                                 {"--texture", "12x"},
                                                                 {"--scale", "nan"},
                                                                 {"--scale", "0"},
                                                                 {"--scale", "inf"},
                                                                 {"--units", "km"},
                                                                 {"--units", "mm", "--scale", "0.001"},
                                                                 {"--pieces", "0"}}) {
    arguments args = bake;
    args.insert(args.end(), wrong.begin(), wrong.end());
    expect_failure(args, 2, "usage");
  }
  const arguments session{"run", "--probe", path("a.glb"), "--fixed", path("b.glb")};
  for (const arguments& wrong : std::initializer_list<arguments>{
           {"--seconds", "nan"}, {"--seconds", "-1"}, {"--contact-rate", "fast"}, {"--seed", "-1"}}) {
    arguments args = session;
    args.insert(args.end(), wrong.begin(), wrong.end());
    expect_failure(args, 2, "usage");
  }
}

TEST_F(usage, rates_that_no_loop_is_made_for) {
  for (const char* option : {"--device-rate", "--contact-rate"}) {
    for (const char* rate : {"99.9", "10000.1", "0", "-1000", "nan", "inf", "1e9", "1 kHz", ""}) {
      const std::string message =
          expect_failure({"run", "--probe", path("a.glb"), "--fixed", path("b.glb"), option, rate}, 2, "usage");
      EXPECT_NE(message.find(option), std::string::npos) << message;
      EXPECT_NE(message.find("'" + std::string(rate) + "' is not a rate from 100 to 10000 Hz"), std::string::npos)
          << message;
    }
  }
}

TEST_F(usage, words_that_are_not_choices) {
  const arguments session{"run", "--probe", path("a.glb"), "--fixed", path("b.glb")};
  for (const arguments& wrong : std::initializer_list<arguments>{{"--motion", "dance"},
                                                                 {"--clock", "sand"},
                                                                 {"--gradient", "steep"},

                                                                 {"--plot", path("plot.jpg")}}) {
    arguments args = session;
    args.insert(args.end(), wrong.begin(), wrong.end());
    expect_failure(args, 2, "usage");
  }
  expect_failure({"bake", path("mesh.ply"), "-o", path("model.obj")}, 2, "usage");
}

TEST_F(usage, options_of_a_picture_need_a_picture) {
  for (const arguments& alone : std::initializer_list<arguments>{{"--original", path("mesh.ply")},
                                                                 {"--up", "y"},
                                                                 {"--turn", "30"},
                                                                 {"--picture", path("model.jpg")},
                                                                 {"--picture", path("model.png"), "--scale", "0.001"},
                                                                 {"--picture", path("model.png"), "--units", "mm"},
                                                                 {"--picture", path("model.png"), "--up", "w"}}) {
    arguments args{"inspect", path("model.glb")};
    args.insert(args.end(), alone.begin(), alone.end());
    expect_failure(args, 2, "usage");
  }
}

TEST_F(usage, options_that_exclude_each_other) {
  expect_failure({"bake", path("mesh.ply"), "-o", path("model.glb"), "--triangles", "500", "--coarse", path("low.ply")},
                 2, "usage");
  expect_failure({"inspect", path("model.glb"), "--picture", path("model.png"), "--original", path("mesh.obj"),
                  "--units", "mm", "--scale", "0.001"},
                 2, "usage");
}

TEST_F(usage, pose_that_is_not_seven_numbers) {
  for (const char* pose : {"", "0 0 0", "0 0 0 0 0 0 1 0", "0 0 zero 0 0 0 1", "0,0,0,0,0,0,1", "0 0 0 0 0 0 1e999"}) {
    expect_failure({"query", "--probe", path("a.glb"), "--fixed", path("b.glb"), "--probe-pose", pose}, 2, "usage");
  }
}

TEST_F(usage, help_and_version_everywhere) {
  for (const char* sub : {"", "bake", "inspect", "query", "run", "models", "devices", "bench"}) {
    for (const char* option : {"--help", "--version"}) {
      arguments args;
      if (*sub != '\0') args.emplace_back(sub);
      args.emplace_back(option);
      const outcome shown = run(args);
      EXPECT_EQ(shown.exit_status, 0) << sub << ' ' << option;
      EXPECT_EQ(shown.err, "");
      EXPECT_NE(shown.out.find(option == std::string("--version") ? "asperity 0." : "--json"), std::string::npos);
    }
  }
}

TEST_F(usage, no_escape_sequences) {
  for (const arguments& args : {arguments{"--help"}, arguments{"devices"}, arguments{"feel"}}) {
    const outcome shown = run(args);
    EXPECT_EQ((shown.out + shown.err).find('\x1b'), std::string::npos);
  }
}

}  // namespace
}  // namespace fault
