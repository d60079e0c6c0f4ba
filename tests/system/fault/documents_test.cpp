// Documents of --json (docs/reference/command.md): their keys, their units, their agreement. Those of query and of run are
// beside this.
#include "documents.hpp"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <utility>

namespace fault {
namespace {

TEST_F(documents, models) {
  const json d = expect_document({"models", "--only", "gear", "-o", path("made")}, "asperity.models/1");
  ASSERT_EQ(d["meshes"].size(), 2U);
  EXPECT_EQ(d["meshes"][0]["triangles"], 25600);
  EXPECT_EQ(d["meshes"][1]["triangles"], 1600);
  EXPECT_EQ(files(), (std::set<std::string>{"made", "made/gear.ply", "made/gear_coarse.ply"}));
}

TEST_F(documents, bake_and_inspect_report_the_same) {
  const json baked = expect_document(
      {"bake", block("block.ply"), "--coarse", block("block_coarse.ply"), "--texture", "128", "-o", path("brick.glb")},
      "asperity.bake/1");
  EXPECT_EQ(baked["name"], "block");
  EXPECT_EQ(baked["full_triangles"], 65536);
  EXPECT_EQ(baked["coarse"]["triangles"], 16);
  EXPECT_EQ(baked["pieces"]["count"], 1);
  EXPECT_EQ(baked["texture"]["width"], 128);
  EXPECT_EQ(baked["units"], "SI");
  EXPECT_GT(baked["bake"]["max_error"], baked["bake"]["rms_error"]);
  EXPECT_GT(baked["bake"]["peak_to_valley"],
            0.9e-3);  // ridges of half a millimetre either way, seen by a small texture
  EXPECT_FALSE(baked["stages"].empty());
  for (const char* way : {"to_original", "to_textured"}) {
    expect_keys(baked["bake"][way], {"rms", "p50", "p99", "max"});
    EXPECT_LE(baked["bake"][way]["p50"], baked["bake"][way]["p99"]);
    EXPECT_LE(baked["bake"][way]["p99"], baked["bake"][way]["max"]);
  }
  EXPECT_GT(baked["bake"]["crack"], 0.0);
  expect_keys(baked["bake"]["lost"], {"share", "largest_share", "centre", "low", "high"});
  expect_keys(baked["texture"]["spacing"], {"p50", "p99", "max"});
  EXPECT_NEAR(baked["texture"]["utilisation"], baked["texture"]["coverage"], 0.05);
  EXPECT_LT(baked["pieces"]["surface_to_hull"], 1e-6);  // a block is its own hull

  const json seen = expect_document({"inspect", path("brick.glb")}, "asperity.inspect/1");
  for (const char* key : {"name", "full_triangles", "coarse", "pieces", "texture"})
    EXPECT_EQ(seen[key], baked[key]) << key;
  EXPECT_EQ(seen["bake"], baked["bake"]);
  // The file keeps positions in single precision.
  EXPECT_NEAR(seen["size"]["diagonal"], baked["size"]["diagonal"], 1e-8);
  EXPECT_NEAR(seen["mass_properties"]["volume"], baked["mass_properties"]["volume"], 1e-11);
  // Texels are most of a model, but for its field.
  const double texels = 12.0 * seen["texture"]["width"].get<double>() * seen["texture"]["height"].get<double>();
  const double but_field = seen["memory"].get<double>() - seen["field"]["memory"].get<double>();
  EXPECT_GT(but_field, texels);
  EXPECT_LT(but_field, 1.5 * texels);
  EXPECT_EQ(seen["warnings"], json::array());

  expect_keys(seen["field"], {"memory", "pitch", "relief_pitch", "thickness", "samples", "plain_samples"});
  EXPECT_EQ(seen["field"], baked["field"]);
  EXPECT_GT(seen["field"]["samples"], 1000);
  const json without = expect_document({"bake", block("block.ply"), "--coarse", block("block_coarse.ply"), "--texture",
                                        "128", "-o", path("bare.glb"), "--without-field"},
                                       "asperity.bake/1");
  EXPECT_TRUE(without["field"].is_null());
  EXPECT_TRUE(expect_document({"inspect", path("bare.glb")}, "asperity.inspect/1")["field"].is_null());
  EXPECT_LT(read("bare.glb").size(), read("brick.glb").size() / 2);
  // The same answer, whether the field was kept or is made now.
  const auto felt = [&](const std::string& model) {
    return expect_document(
        {"query", "--probe", path(model), "--fixed", path(model), "--probe-pose", "0 0 0.0198 0 0 0 1"},
        "asperity.query/1");
  };
  const json by_kept = felt("brick.glb"), by_made = felt("bare.glb");
  EXPECT_GT(std::abs(by_kept["force"][2].get<double>()), 0.01);
  EXPECT_EQ(by_kept["force"], by_made["force"]);
  EXPECT_EQ(by_kept["torque"], by_made["torque"]);
}

TEST_F(documents, pictures) {
  const std::initializer_list<const char*> keys{"file",  "shows",   "colours_from", "colours_to",
                                                "least", "largest", "rms"};
  const json baked =
      expect_document({"bake", block("block.ply"), "--coarse", block("block_coarse.ply"), "--texture", "128", "-o",
                       path("brick.glb"), "--picture", path("baked.png"), "--without-field"},
                      "asperity.bake/1");
  expect_keys(baked["picture"], keys);
  EXPECT_EQ(baked["picture"]["shows"], "distance to the original");
  EXPECT_LE(baked["picture"]["rms"], baked["bake"]["max_error"]);
  EXPECT_GT(baked["picture"]["rms"], 0.0);
  // The same picture afterwards, from the files.
  const json seen = expect_document({"inspect", path("brick.glb"), "--original", block("block.ply"), "--picture",
                                     path("inspected.png"), "--up", "z", "--turn", "0", "--scale", "1"},
                                    "asperity.inspect/1");
  expect_keys(seen["picture"], keys);
  EXPECT_NEAR(seen["picture"]["rms"], baked["picture"]["rms"], 1e-8);
  const json alone =
      expect_document({"inspect", path("brick.glb"), "--picture", path("alone.png")}, "asperity.inspect/1");
  EXPECT_EQ(alone["picture"]["shows"], "height above the coarse surface");
  EXPECT_NEAR(alone["picture"]["largest"], 0.5e-3, 0.05e-3);  // the block's ridges
  EXPECT_NEAR(alone["picture"]["least"], -0.5e-3, 0.05e-3);
  EXPECT_EQ(run({"inspect", path("brick.glb"), "--picture", path("again.png")}).exit_status, 0);
  EXPECT_EQ(read("again.png"), read("alone.png"));
  EXPECT_NE(read("inspected.png"), read("alone.png"));
}

TEST_F(documents, a_wrap_tells_what_it_did) {
  write("open.obj",
        "v 0 0 0\nv 4 0 0\nv 4 3 0\nv 0 3 0\nv 0 0 12\nv 4 0 12\nv 4 3 12\nv 0 3 12\n"
        "f 4 3 2 1\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
  const json d = expect_document({"bake", path("open.obj"), "--fit", "0.13", "--up=-x", "--wrap=0.002", "--thickness",
                                  "0.006", "--triangles", "60", "--texture", "96", "-o", path("box.glb")},
                                 "asperity.bake/1");
  const json& wrap = d["wrap"];
  expect_keys(wrap, {"cell", "thickness", "triangles_in", "triangles", "components", "dropped_triangles",
                     "turned_triangles", "plate_share", "cavities_filled", "specks_dropped", "far", "made_up_share",
                     "lost_share", "to_original", "to_wrap"});
  for (const char* way : {"to_original", "to_wrap"}) expect_keys(wrap[way], {"p50", "p99", "max"});
  EXPECT_EQ(wrap["cell"], 0.002);
  EXPECT_EQ(wrap["thickness"], 0.006);
  EXPECT_EQ(wrap["triangles_in"], 10);
  EXPECT_EQ(wrap["triangles"], d["full_triangles"]);
  EXPECT_EQ(wrap["components"], 1);
  EXPECT_EQ(wrap["plate_share"], 0.0);
  EXPECT_NEAR(wrap["made_up_share"], 12.0 / 192.0, 0.03) << "the lid";
  EXPECT_NEAR(d["scale"], 0.01, 1e-15);
  // z was 12 long and lies along -x or x now; x, 4 long, points down.
  const auto length = [&](std::size_t axis) {
    return d["size"]["high"][axis].get<double>() - d["size"]["low"][axis].get<double>();
  };
  EXPECT_NEAR(length(0), 0.12, 0.003);
  EXPECT_NEAR(length(1), 0.03, 0.003);
  EXPECT_NEAR(length(2), 0.04, 0.003);
  EXPECT_NEAR(d["size"]["low"][2], -0.04, 0.003);
}

TEST_F(documents, a_split_bake_writes_all_models_or_none) {
  const std::string faces =
      "f -8 -6 -5 -7\nf -4 -3 -1 -2\nf -8 -7 -3 -4\nf -6 -2 -1 -5\nf -8 -4 -2 -6\nf -7 -5 -1 -3\n";
  const auto cube = [&](const std::string& name, int x) {
    std::string out = "o " + name + "\n";
    for (int i = 0; i < 8; ++i)
      out +=
          "v " + std::to_string(x + (i & 1)) + " " + std::to_string(i >> 1 & 1) + " " + std::to_string(i >> 2) + "\n";
    return out + faces;
  };
  write("two.obj", cube("left", 0) + cube("right", 2));
  const std::vector<std::string> how{"--split", "--fit", "0.1", "--triangles", "40", "--texture", "96", "-o"};
  const auto bake = [&](const std::string& mesh, const std::string& out) {
    std::vector<std::string> args{"bake", path(mesh)};
    args.insert(args.end(), how.begin(), how.end());
    args.push_back(path(out));
    return args;
  };
  const json d = expect_document(bake("two.obj", "out.glb"), "asperity.bake/1");
  ASSERT_EQ(d["models"].size(), 2U);
  EXPECT_EQ(d["models"][0]["file"], path("out-left.glb"));
  EXPECT_EQ(d["models"][1]["name"], "out-right");
  EXPECT_NEAR(d["models"][1]["size"]["low"][0], 2.0 * 0.1 / std::sqrt(11.0), 1e-6)
      << "in its place, at the common scale";
  EXPECT_EQ(files(), (std::set<std::string>{"two.obj", "out-left.glb", "out-right.glb"}));
  write("bad.obj", cube("left", 0) + "o fin\nv 5 0 0\nv 6 0 0\nv 5 1 0\nf -3 -2 -1\n");
  expect_failure(bake("bad.obj", "no.glb"), 1, "bad_mesh");
  EXPECT_EQ(files(), (std::set<std::string>{"two.obj", "bad.obj", "out-left.glb", "out-right.glb"}));
}

TEST_F(documents, scale_changes_units_and_inspect_warns) {
  const json baked = expect_document({"bake", block("block.ply"), "--coarse", block("block_coarse.ply"), "--texture",
                                      "64", "--scale", "1000", "-o", path("huge.glb"), "--without-field"},
                                     "asperity.bake/1");
  EXPECT_NEAR(baked["size"]["high"][0], 20.0, 0.1);  // 40 mm wide, about the origin
  const json seen = expect_document({"inspect", path("huge.glb")}, "asperity.inspect/1");
  ASSERT_FALSE(seen["warnings"].empty());
  EXPECT_NE(seen["warnings"][0].get<std::string>().find("--scale"), std::string::npos);
}

// A cube of 50 mm, drawn in millimetres, each face with a place of its own in the image.
std::string unwrapped_cube() {
  std::string out = "v 0 0 0\nv 50 0 0\nv 50 50 0\nv 0 50 0\nv 0 0 50\nv 50 0 50\nv 50 50 50\nv 0 50 50\n";
  const char* const faces[] = {"4 3 2 1", "1 2 6 5", "2 3 7 6", "3 4 8 7", "4 1 5 8", "5 6 7 8"};
  std::string lines;
  for (int f = 0; f < 6; ++f) {
    const double u = 0.05 + 0.3 * (f % 3), v = 0.1 + 0.4 * (f / 3);
    std::istringstream corners(faces[f]);
    lines += "f";
    for (int k = 0; k < 4; ++k) {
      const double side = 0.25;
      out += "vt " + std::to_string(u + (k == 1 || k == 2 ? side : 0.0)) + ' ' +
             std::to_string(v + (k >= 2 ? side : 0.0)) + '\n';
      std::string vertex;
      corners >> vertex;
      lines += ' ' + vertex + '/' + std::to_string(4 * f + k + 1);
    }
    lines += '\n';
  }
  return out + lines;
}

TEST_F(documents, a_bake_keeps_texture_coordinates) {
  write("low.obj", unwrapped_cube());
  write("full.obj", unwrapped_cube());
  const json made = expect_document(
      {"bake", path("full.obj"), "--units", "mm", "--texture", "96", "-o", path("made.glb"), "--without-field"},
      "asperity.bake/1");
  EXPECT_EQ(made["uvs"], "made");
  const json kept = expect_document({"bake", path("full.obj"), "--coarse", path("low.obj"), "--keep-uvs", "--units",
                                     "mm", "--texture", "96", "-o", path("kept.glb"), "--without-field"},
                                    "asperity.bake/1");
  EXPECT_EQ(kept["uvs"], "kept");
  EXPECT_EQ(kept["warnings"], json::array());
  EXPECT_NEAR(kept["texture"]["texel"], 0.05 / (0.25 * 96), 1e-8);
  EXPECT_NEAR(kept["texture"]["utilisation"], 6 * 0.25 * 0.25, 1e-6);
  EXPECT_NE(read("kept.glb"), read("made.glb"));
  // A mesh that is its own coarse mesh keeps them too.
  const json alone = expect_document({"bake", path("low.obj"), "--keep-uvs", "--units", "mm", "--texture", "96",
                                      "--name", "full", "-o", path("alone.glb"), "--without-field"},
                                     "asperity.bake/1");
  EXPECT_EQ(alone["uvs"], "kept");
  EXPECT_EQ(read("alone.glb"), read("kept.glb"));
}

// A grey image of two pixels, 0 and 255, over the unwrapped cube: each face is half of one material, half of the other.
TEST_F(documents, a_map_of_materials) {
  constexpr unsigned char image[]{0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48,
                                  0x44, 0x52, 0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x01, 0x08, 0x00, 0x00, 0x00,
                                  0x00, 0xd1, 0x49, 0x20, 0x56, 0x00, 0x00, 0x00, 0x0b, 0x49, 0x44, 0x41, 0x54, 0x78,
                                  0x9c, 0x63, 0x60, 0xf8, 0x0f, 0x00, 0x01, 0x02, 0x01, 0x00, 0x42, 0xbe, 0xbc, 0x68,
                                  0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
  write("halves.png", std::string(reinterpret_cast<const char*>(image), sizeof image));
  write("cube.obj", unwrapped_cube());
  const auto bake = [&](const std::string& mesh, std::initializer_list<std::string> more) {
    std::vector<std::string> args{"bake",           mesh, "--units", "mm", "--texture", "64", "-o", path("cube.glb"),
                                  "--without-field"};
    args.insert(args.end(), more.begin(), more.end());
    return args;
  };
  const std::string map = path("halves.png");
  const json baked = expect_document(
      bake(path("cube.obj"), {"--material-map", map, "--material-at", "000000=ice", "--material-at", "255=rubber"}),
      "asperity.bake/1");
  ASSERT_EQ(baked["materials"].size(), 2U);
  double whole = 0.0;
  for (const json& m : baked["materials"]) {
    expect_keys(m, {"name", "stiffness", "dissipation", "friction", "share"});
    whole += m["share"].get<double>();
    EXPECT_GT(m["share"], 0.1);
  }
  EXPECT_NEAR(whole, 1.0, 1e-9);
  EXPECT_EQ(baked["material"]["name"], "ice");
  EXPECT_EQ(baked["materials"][1]["name"], "rubber");
  EXPECT_EQ(expect_document({"inspect", path("cube.glb")}, "asperity.inspect/1")["materials"], baked["materials"]);
  const json felt =
      expect_document({"run", "--probe", pin(), "--fixed", path("cube.glb"), "--seconds", "0.02"}, "asperity.run/1");
  ASSERT_EQ(felt["surfaces"][0]["others"].size(), 1U);
  expect_keys(felt["surfaces"][0]["others"][0], {"stiffness", "dissipation", "friction", "of_probe", "of_fixed"});
  EXPECT_EQ(felt["surfaces"][0]["others"][0]["of_fixed"], 1);
  EXPECT_NEAR(felt["surfaces"][0]["others"][0]["stiffness"], 3000.0, 1e-6);
  const json rubbed =
      expect_document({"run", "--probe", pin(), "--fixed", path("cube.glb"), "--seconds", "0.02", "--friction", "0.5"},
                      "asperity.run/1");
  EXPECT_EQ(rubbed["surfaces"][0]["others"][0]["friction"]["static"], 0.5);

  const auto refused = [&](const std::vector<std::string>& args, int status, const char* code, const char* why) {
    const std::string message = expect_failure(args, status, code);
    EXPECT_NE(message.find(why), std::string::npos) << message;
  };
  const std::string ice = "0=ice", rubber = "255=rubber";
  refused({"bake", block("block.ply"), "--texture", "64", "-o", path("cube.glb"), "--material-map", map,
           "--material-at", ice, "--material-at", rubber},
          1, "bad_mesh", "has no texture coordinates");
  refused(bake(path("cube.obj"), {"--material-map", map, "--material-at", ice}), 1, "invalid_argument",
          "2 to 8 colours");
  refused(bake(path("cube.obj"), {"--material-map", map, "--material-at", ice, "--material-at", "255=felt"}), 1,
          "invalid_argument", "there is no material 'felt'");
  refused(bake(path("cube.obj"), {"--material-map", map, "--material-at", ice, "--material-at", "red=rubber"}), 1,
          "invalid_argument", "six hexadecimal digits");
  refused(bake(path("cube.obj"), {"--material-map", map, "--material-at", ice, "--material-at", "256=rubber"}), 1,
          "invalid_argument", "a grey level from 0 to 255");
  refused(bake(path("cube.obj"), {"--material-map", path("absent.png"), "--material-at", ice, "--material-at", rubber}),
          1, "io_failed", "absent.png");
}

TEST_F(documents, inspect_takes_the_original_in_its_own_units) {
  write("cube.obj", unwrapped_cube());
  ASSERT_EQ(run({"bake", path("cube.obj"), "--units", "mm", "--texture", "64", "-o", path("cube.glb")}).exit_status, 0);
  const std::vector<std::string> inspect{"inspect",        path("cube.glb"), "--original",
                                         path("cube.obj"), "--picture",      path("cube.png")};
  const auto with = [&](std::initializer_list<const char*> more) {
    std::vector<std::string> args = inspect;
    args.insert(args.end(), more.begin(), more.end());
    return args;
  };
  for (const auto& said : {with({"--units", "mm"}), with({"--scale", "0.001"})}) {
    const json seen = expect_document(said, "asperity.inspect/1");
    EXPECT_LT(seen["picture"]["largest"], 1e-6);
  }
  const std::string message = expect_failure(inspect, 1, "invalid_argument");
  EXPECT_NE(message.find("--units mm (86.6 mm)"), std::string::npos) << message;
}

TEST_F(documents, inspect_turns_the_original_as_the_bake_did) {
  write("wedge.obj", "v 0 0 0\nv 0.1 0 0\nv 0 0.06 0\nv 0.01 0.02 0.03\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
  for (const char* up : {"x", "y", "z", "-x", "-y", "-z"}) {
    SCOPED_TRACE(up);
    ASSERT_EQ(run({"bake", path("wedge.obj"), std::string("--up=") + up, "--texture", "64", "--without-field", "-o",
                   path("wedge.glb")})
                  .exit_status,
              0);
    for (const char* said : {"x", "y", "z", "-x", "-y", "-z"}) {
      const arguments inspect{"inspect",
                              path("wedge.glb"),
                              "--original",
                              path("wedge.obj"),
                              "--picture",
                              path("wedge.png"),
                              std::string("--original-up=") + said};
      if (std::string(said) == up) {
        EXPECT_LT(expect_document(inspect, "asperity.inspect/1")["picture"]["largest"], 2e-3);
      } else {
        expect_failure(inspect, 1, "invalid_argument");
      }
    }
  }
}

TEST_F(documents, devices) {
  const json d = expect_document({"devices"}, "asperity.devices/1");
  ASSERT_GE(d["devices"].size(), 1U);
  for (const char* key : {"drivers", "problems"}) EXPECT_TRUE(d.contains(key)) << key;
  EXPECT_EQ(d["devices"][0]["name"], "simulated");
  EXPECT_EQ(d["devices"][0]["maturity"], "simulated");
}

TEST_F(documents, a_panel_of_a_device) {
  const outcome done = run({"devices", "--view", "0", "--seconds", "0.2", "--json"});
  if (done.err.find("no live page") != std::string::npos) GTEST_SKIP() << "this build has no live page";
  EXPECT_EQ(done.exit_status, 0);
  EXPECT_EQ(without_notes(done.err), "");  // the note has the address
  const json d = json::parse(done.out, nullptr, false);
  ASSERT_TRUE(d.is_object()) << done.out;
  EXPECT_EQ(d["schema"], "asperity.devices/1");
  expect_keys(d["panel"], {"device", "ticks", "lost_periods", "longest_gap", "rejected_samples", "fault", "most_force",
                           "largest_force", "longest_without_beat", "press_count", "presses", "armed_at_end"});
  EXPECT_EQ(d["panel"]["device"], "simulated");
  EXPECT_EQ(d["panel"]["largest_force"], 0.0);
  EXPECT_FALSE(d["panel"]["armed_at_end"]);
}

TEST_F(documents, bench) {
  const json d = expect_document({"bench", "--probe", pin(), "--fixed", pin(), "--poses", "50"}, "asperity.bench/1");
  expect_keys(d["seconds"], {"collision_query", "contact_soft", "contact_central", "tick_planes", "every_sample",
                             "follow_on_wall", "follow_shared_on_wall", "probe_on_planes", "probe_rubbing_on_planes",
                             "tick_least_motion", "tick_soft", "tick_central"});
  EXPECT_GT(d["planes_held"]["mean"], 0.0);
  expect_keys(d["samples"], {"balls_looked_at", "near", "leaves_bounded", "read"});
  EXPECT_GT(d["samples"]["near"], d["samples"]["read"]);
  EXPECT_EQ(d["threads"], 2);
  for (const auto& [what, times] : d["seconds"].items()) {
    if (what == "follow_shared_on_wall" && times.is_null()) continue;  // of a machine with one processor
    EXPECT_GT(times["p50"], 0.0) << what;
    EXPECT_GE(times["p99"], times["p50"]) << what;
  }
  EXPECT_GT(d["ratios"]["contact_central_to_soft"], 0.0);
  EXPECT_GT(d["ratios"]["tick_planes_with_far_bodies"], 0.0);
  EXPECT_GT(d["ratios"]["tick_soft_with_far_bodies"], 0.0);
}

TEST_F(documents, examples_of_the_reference_page_work) {
  std::ifstream page(ASPERITY_SOURCE_DIR "/docs/reference/command.md");
  const std::string folder = std::filesystem::path(ASPERITY_COMMAND).parent_path().string();
  int examples = 0;
  bool inside = false;
  for (std::string line; std::getline(page, line);) {
    if (line == "```sh" || line == "```") {
      inside = line == "```sh";
      continue;
    }
    if (!inside) continue;
    ++examples;
    const std::string quietly = line.find('>') == std::string::npos ? " > /dev/null" : "";
    const std::string shell = "cd '" + path("") + "' && PATH='" + folder + "':\"$PATH\" && " + line + quietly;
    EXPECT_EQ(std::system(shell.c_str()), 0) << line;
  }
  EXPECT_GE(examples, 10);
}

// Whether this build has the live page, which needs a library of its own.
bool has_page() { return run({"view", "--help"}).exit_status == 0; }

TEST_F(documents, view_of_a_model_and_of_a_recording) {
  if (!has_page()) GTEST_SKIP() << "this build has no live page (Debian: libcivetweb-dev)";
  const json model = expect_document({"view", pin(), "--export", path("pin.html")}, "asperity.view/1");
  expect_keys(model, {"schema", "file", "ticks", "recordings", "export"});
  EXPECT_EQ(model["file"], pin());
  EXPECT_EQ(model["ticks"], 0);
  expect_keys(model["export"], {"file", "bytes"});
  EXPECT_EQ(model["export"]["file"], path("pin.html"));
  EXPECT_EQ(model["export"]["bytes"], read("pin.html").size());

  ASSERT_EQ(
      run({"run", "--probe", pin(), "--fixed", pin(), "--seconds", "0.05", "--record", path("felt.csv")}).exit_status,
      0);
  const json session = expect_document(
      {"view", path("felt.csv"), "--probe", pin(), "--fixed", pin(), "--export", path("felt.html")}, "asperity.view/1");
  EXPECT_EQ(session["ticks"], 51) << "at 1 kHz, the first and the last among them";
  EXPECT_EQ(session["export"]["bytes"], read("felt.html").size());
  const json two = expect_document(
      {"view", path("felt.csv"), path("felt.csv"), "--probe", pin(), "--fixed", pin(), "--export", path("felt.html")},
      "asperity.view/1");
  ASSERT_EQ(two["recordings"].size(), 2U);
  expect_keys(two["recordings"][1], {"file", "ticks", "from_s", "to_s", "period_s"});
  EXPECT_EQ(two["recordings"][1]["ticks"], 51);
  EXPECT_DOUBLE_EQ(two["recordings"][1]["period_s"].get<double>(), 1e-3);
  const std::set<std::string> made{"pin.html", "felt.csv", "felt.html"};
  EXPECT_EQ(files(), made);

  expect_failure({"view", path("felt.csv"), "--export", path("no.html")}, 1, "invalid_argument");
  expect_failure({"view", pin(), "--probe", pin(), "--export", path("no.html")}, 1, "invalid_argument");
  expect_failure({"view", path("nothing.glb"), "--export", path("no.html")}, 1, "io_failed");
  expect_failure({"view", pin(), "--port", "65536"}, 1, "invalid_argument");
  expect_failure({"view", pin(), pin(), "--export", path("no.html")}, 1, "invalid_argument");
  expect_failure({"view", "--gallery", pin(), "--export", path("no.html")}, 1, "invalid_argument");
  expect_failure({"view", pin(), "--original", path("nothing.ply"), "--export", path("no.html")}, 1, "io_failed");
}

TEST_F(documents, a_served_page_ends_with_a_document) {
  if (!has_page()) GTEST_SKIP() << "this build has no live page (Debian: libcivetweb-dev)";
  process_options ended;
  ended.interrupt_after_s = 1.0;
  const outcome shown = run({"view", pin(), "--port", "0", "--json"}, ended);
  EXPECT_NE(shown.err.find("note: the page is at http://127.0.0.1:"), std::string::npos) << shown.err;
  const json d = json::parse(shown.out, nullptr, false);
  expect_keys(d, {"schema", "file", "ticks", "recordings"});

  const outcome listed = run({"view", "--gallery", pin(), pin(), "--port", "0", "--json"}, ended);
  const json gallery = json::parse(listed.out, nullptr, false);
  expect_keys(gallery, {"schema", "models", "sessions"});
  EXPECT_EQ(gallery["models"].size(), 2U);
  EXPECT_EQ(gallery["sessions"], 0);

  // A session tells the same of itself, whether it is looked at or not.
  const std::vector<std::string> run_briefly{"run", "--probe", pin(), "--fixed", pin(), "--seconds", "0.05", "--json"};
  std::vector<std::string> looked_at = run_briefly;
  looked_at.insert(looked_at.end(), {"--view", "0"});
  const outcome alone = run(run_briefly), with_page = run(looked_at);
  EXPECT_EQ(with_page.exit_status, 0) << with_page.err;
  EXPECT_NE(with_page.err.find("http://127.0.0.1:"), std::string::npos) << with_page.err;
  const json one = json::parse(alone.out), other = json::parse(with_page.out);
  for (const auto& [key, value] : one.items()) EXPECT_TRUE(other.contains(key)) << key;
  EXPECT_EQ(one.size(), other.size());
  for (const char* key : {"surfaces", "contacts", "hand_force", "hand_torque", "energy"}) {
    EXPECT_TRUE(one.contains(key)) << key;
    EXPECT_EQ(one[key], other[key]) << key;
  }
}

TEST_F(documents, quiet_says_nothing) {
  const outcome done = run({"inspect", block(), "--quiet"});
  EXPECT_EQ(done.exit_status, 0);
  EXPECT_EQ(done.out + done.err, "");
  EXPECT_EQ(run({"--quiet", "inspect", block()}).out, "");
}

}  // namespace
}  // namespace fault
