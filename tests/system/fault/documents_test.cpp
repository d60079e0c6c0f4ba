// The documents that --json promises (docs/reference/command.md): their keys, their units, their agreement.
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <utility>

#include "command_process.hpp"

namespace fault {
namespace {

class documents : public command_test {
 protected:
  [[nodiscard]] static std::string block(const char* file = "block.glb") { return (small_models() / file).string(); }
  [[nodiscard]] static std::string pin() { return (small_models() / "pin.glb").string(); }
};

void expect_keys(const json& object, std::initializer_list<const char*> keys) {
  ASSERT_TRUE(object.is_object()) << object;
  std::set<std::string> wanted(keys.begin(), keys.end());
  std::set<std::string> found;
  for (const auto& [key, value] : object.items()) found.insert(key);
  EXPECT_EQ(found, wanted);
}

void expect_numbers(const json& array, std::size_t count) {
  ASSERT_TRUE(array.is_array()) << array;
  EXPECT_EQ(array.size(), count);
  for (const json& x : array) EXPECT_TRUE(x.is_number()) << array;
}

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

  expect_keys(seen["field"], {"memory", "pitch", "relief_pitch", "thickness", "samples"});
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
  const json baked = expect_document({"bake", block("block.ply"), "--coarse", block("block_coarse.ply"), "--texture",
                                      "128", "-o", path("brick.glb"), "--picture", path("baked.png")},
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

TEST_F(documents, scale_changes_units_and_inspect_warns) {
  const json baked = expect_document({"bake", block("block.ply"), "--coarse", block("block_coarse.ply"), "--texture",
                                      "64", "--scale", "1000", "-o", path("huge.glb")},
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
      {"bake", path("full.obj"), "--units", "mm", "--texture", "96", "-o", path("made.glb")}, "asperity.bake/1");
  EXPECT_EQ(made["uvs"], "made");
  const json kept = expect_document({"bake", path("full.obj"), "--coarse", path("low.obj"), "--keep-uvs", "--units",
                                     "mm", "--texture", "96", "-o", path("kept.glb")},
                                    "asperity.bake/1");
  EXPECT_EQ(kept["uvs"], "kept");
  EXPECT_EQ(kept["warnings"], json::array());
  EXPECT_NEAR(kept["texture"]["texel"], 0.05 / (0.25 * 96), 1e-8);
  EXPECT_NEAR(kept["texture"]["utilisation"], 6 * 0.25 * 0.25, 1e-6);
  EXPECT_NE(read("kept.glb"), read("made.glb"));
  // A mesh that is its own coarse mesh keeps them too.
  const json alone = expect_document({"bake", path("low.obj"), "--keep-uvs", "--units", "mm", "--texture", "96",
                                      "--name", "full", "-o", path("alone.glb")},
                                     "asperity.bake/1");
  EXPECT_EQ(alone["uvs"], "kept");
  EXPECT_EQ(read("alone.glb"), read("kept.glb"));
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

class query_document : public documents, public testing::WithParamInterface<const char*> {};

TEST_P(query_document, is_the_contract) {
  // Ridges in grooves, and the upper block two tenths of a millimetre too low.
  const json d = expect_document(
      {"query", "--probe", block(), "--fixed", block(), "--probe-pose", "0 0 0.0198 0 0 0 1", "--contacts", GetParam()},
      "asperity.query/1");
  expect_keys(d, {"schema", "contacts", "force", "torque", "centre_of_mass", "stiffness", "formulation", "backend",
                  "bodies", "gradient_scheme", "lookup", "status", "dropped_contacts", "units"});
  EXPECT_EQ(d["formulation"], GetParam());
  EXPECT_EQ(d["gradient_scheme"], std::string(GetParam()) == "least-motion" ? "exact" : "soft");
  EXPECT_EQ(d["backend"], "cpu");
  EXPECT_EQ(d["units"], "SI");
  expect_numbers(d["force"], 3);
  expect_numbers(d["torque"], 3);
  expect_numbers(d["centre_of_mass"], 3);
  expect_numbers(d["stiffness"], 36);
  ASSERT_EQ(d["bodies"].size(), 1U);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(d["bodies"][0]["force"][i], -d["force"][i].get<double>());
  expect_numbers(d["bodies"][0]["torque"], 3);
  ASSERT_FALSE(d["contacts"].empty());
  std::array<double, 3> felt{};
  for (const json& c : d["contacts"]) {
    expect_keys(c, {"body", "p_a", "p_b", "n_ab", "centre", "u", "half_size", "separation", "depth", "soft_depth",
                    "gradient", "witness", "samples", "flags", "force", "torque"});
    for (const char* key : {"p_a", "p_b", "n_ab", "centre", "u", "witness", "force", "torque"}) {
      expect_numbers(c[key], 3);
    }
    for (std::size_t i = 0; i < 3; ++i) felt[i] += c["force"][i].get<double>();
    expect_numbers(c["gradient"], 6);
    EXPECT_EQ(c["body"], 0);
    EXPECT_TRUE(c["flags"].is_array());
    EXPECT_TRUE(c["samples"].is_number_unsigned());
    // The gradient's component along n is 1 exactly.
    double along = 0.0;
    for (std::size_t i = 0; i < 3; ++i) along += c["gradient"][i].get<double>() * c["n_ab"][i].get<double>();
    EXPECT_NEAR(along, 1.0, 1e-9);
  }
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(felt[i], d["force"][i], 1e-9);
  // From the probe above to the body below. The least motion leans towards a flank of the ridges, by 0.17 rad with this
  // small texture.
  EXPECT_NEAR(d["contacts"][0]["n_ab"][2], -1.0, std::string(GetParam()) == "least-motion" ? 0.03 : 1e-6);
  EXPECT_GT(d["contacts"][0]["depth"], 2e-4 - 1e-6);
  EXPECT_LT(d["contacts"][0]["depth"], 1e-3);  // the small texture is coarse beside the ridges
  EXPECT_GT(d["force"][2], 0.0);               // and the probe is pushed up
}

INSTANTIATE_TEST_SUITE_P(both, query_document, testing::Values("least-motion", "window"), [](const auto& formulation) {
  return std::string(formulation.param) == "window" ? "window" : "least_motion";
});

TEST_F(documents, what_belongs_to_the_paper_is_refused_without_it) {
  for (const arguments& option :
       {arguments{"--gradient", "central"}, arguments{"--grid", "32"}, arguments{"--lookup", "paper"}}) {
    arguments query{"query", "--probe", block(), "--fixed", block(), "--probe-pose", "0 0 1 0 0 0 1"};
    query.insert(query.end(), option.begin(), option.end());
    const std::string message = expect_failure(query, 1, "invalid_argument");
    EXPECT_NE(message.find(option.front()), std::string::npos);
    EXPECT_NE(message.find("--contacts window"), std::string::npos);
    query.insert(query.end(), {"--contacts", "window"});
    EXPECT_EQ(expect_document(query, "asperity.query/1")["formulation"], "window");
  }
}

TEST_F(documents, former_names_of_contacts_are_accepted) {
  arguments query{"query", "--probe", pin(), "--fixed", pin(), "--probe-pose", "0 0 1 0 0 0 1", "--contacts"};
  for (const auto& [former, name] : {std::pair{"shared", "least-motion"}, std::pair{"paper", "window"}}) {
    query.push_back(former);
    EXPECT_EQ(expect_document(query, "asperity.query/1")["formulation"], name) << former;
    query.pop_back();
  }
  const arguments session{"run", "--probe", pin(), "--fixed", pin(), "--seconds", "0.01", "--contacts", "field"};
  EXPECT_EQ(expect_document(session, "asperity.run/1")["formulation"], "planes");
}

TEST_F(documents, query_far_away_has_no_contact_and_no_force) {
  const json d = expect_document({"query", "--probe", pin(), "--fixed", pin(), "--probe-pose", "0 0 1 0 0 0 1"},
                                 "asperity.query/1");
  EXPECT_EQ(d["contacts"], json::array());
  EXPECT_EQ(d["force"], json::array({0.0, 0.0, 0.0}));
  EXPECT_EQ(d["torque"], json::array({0.0, 0.0, 0.0}));
}

TEST_F(documents, both_gradient_schemes_agree_on_the_depth) {
  const arguments query{
      "query",      "--probe", block(), "--fixed", block(), "--probe-pose", "0.001 0.0005 0.0198 0 0 0 1",
      "--contacts", "window"};
  arguments central = query;
  central.insert(central.end(), {"--gradient", "central"});
  const json soft = expect_document(query, "asperity.query/1");
  const json paper = expect_document(central, "asperity.query/1");
  ASSERT_FALSE(soft["contacts"].empty());
  ASSERT_EQ(paper["contacts"].size(), soft["contacts"].size());
  EXPECT_EQ(paper["contacts"][0]["depth"], soft["contacts"][0]["depth"]);
  EXPECT_EQ(paper["contacts"][0]["soft_depth"], paper["contacts"][0]["depth"]);
}

TEST_F(documents, the_exact_maximum_is_deeper_than_a_grid_s_and_says_how_deep_it_can_be) {
  const arguments query{"query", "--probe", block(), "--fixed", block(), "--probe-pose", "0.001 0.0005 0.0198 0 0 0 1"};
  arguments paper = query, exact = query;
  paper.insert(paper.end(), {"--contacts", "window"});
  exact.insert(exact.end(), {"--backend", "exact"});
  const json on_grid = expect_document(paper, "asperity.query/1");
  const json searched = expect_document(exact, "asperity.query/1");
  EXPECT_EQ(searched["backend"], "exact");
  EXPECT_EQ(searched["formulation"], "window");
  EXPECT_EQ(searched["gradient_scheme"], "exact");
  ASSERT_FALSE(searched["contacts"].empty());
  ASSERT_EQ(searched["contacts"].size(), on_grid["contacts"].size());
  for (std::size_t i = 0; i < searched["contacts"].size(); ++i) {
    const json &c = searched["contacts"][i], &g = on_grid["contacts"][i];
    EXPECT_EQ(c["centre"], g["centre"]) << "the same window";
    EXPECT_FALSE(g.contains("depth_at_most"));
    const double depth = c["depth"], most = c["depth_at_most"];
    EXPECT_GE(most, depth);
    EXPECT_LE(most, depth + 1e-8);
    EXPECT_GT(depth, g["depth"].get<double>()) << "samples reach the maximum from below";
    EXPECT_EQ(c["flags"], g["flags"]);
  }
}

TEST_F(documents, what_contradicts_the_exact_maximum_is_refused_by_name) {
  for (const arguments& option :
       {arguments{"--contacts", "least-motion"}, arguments{"--gradient", "soft"}, arguments{"--grid", "64"}}) {
    arguments query{"query",        "--probe",       block(),     "--fixed", block(),
                    "--probe-pose", "0 0 1 0 0 0 1", "--backend", "exact"};
    query.insert(query.end(), option.begin(), option.end());
    const std::string message = expect_failure(query, 1, "invalid_argument");
    EXPECT_NE(message.find(option.front()), std::string::npos) << message;
    EXPECT_NE(message.find("--backend exact"), std::string::npos) << message;
  }
  EXPECT_NE(expect_failure({"run", "--probe", block(), "--fixed", block(), "--backend", "exact", "--clock", "real"}, 1,
                           "invalid_argument")
                .find("--clock virtual"),
            std::string::npos);
  EXPECT_EQ(expect_document({"query", "--probe", block(), "--fixed", block(), "--probe-pose", "0 0 1 0 0 0 1",
                             "--backend", "exact", "--contacts", "window"},
                            "asperity.query/1")["contacts"],
            json::array());
}

TEST_F(documents, backends_that_are_not_built_say_so) {
#ifdef ASPERITY_HAS_GL
  const std::vector<const char*> missing{"cpu-simd"};
#else
  const std::vector<const char*> missing{"cpu-simd", "gl-occlusion", "gl-compute"};
#endif
  for (const char* backend : missing) {
    const std::string message = expect_failure(
        {"query", "--probe", block(), "--fixed", block(), "--probe-pose", "0 0 1 0 0 0 1", "--backend", backend}, 1,
        "unsupported");
    EXPECT_NE(message.find(backend), std::string::npos);
  }
  expect_failure(
      {"query", "--probe", block(), "--fixed", block(), "--probe-pose", "0 0 1 0 0 0 1", "--backend", "abacus"}, 2,
      "usage");
}

TEST_F(documents, run) {
  const json d = expect_document({"run", "--probe", block(), "--fixed", block(), "--seconds", "0.8", "--record",
                                  path("session.csv"), "--plot", path("session.svg")},
                                 "asperity.run/1");
  expect_keys(d, {"schema",
                  "formulation",
                  "probe",
                  "fixed",
                  "start",
                  "device",
                  "clock",
                  "motion",
                  "moves",
                  "seed",
                  "seconds",
                  "backend",
                  "gradient_scheme",
                  "grid",
                  "lookup",
                  "contacts",
                  "max_depth",
                  "probe_force",
                  "probe_torque",
                  "hand_force",
                  "hand_torque",
                  "energy",
                  "contact_loop",
                  "device_loop",
                  "tick_time_is",
                  "memory",
                  "rejected_samples",
                  "lost_records",
                  "fault",
                  "fault_record",
                  "interrupted",
                  "recording",
                  "plot",
                  "units",
                  "device_recording",
                  "replay",
                  "real_time",
                  "signal",
                  "driver_fault",
                  "rates",
                  "vibration",
                  "wall",
                  "coupling",
                  "rate_check",
                  "velocity",
                  "scale",
                  "gripper",
                  "transient",
                  "weight",
                  "clutch",
                  "friction",
                  "surfaces"});
  for (const char* loop : {"contact_loop", "device_loop"}) {
    expect_keys(d[loop], {"rate", "ticks", "idle", "late", "skipped", "over_period", "kept", "tick_time"});
  }
  expect_keys(d["rate_check"], {"tick_time", "processor_p99", "kept", "kept_rate"});
  EXPECT_EQ(d["formulation"], "planes");
  for (const char* key : {"band", "rest", "force", "torque"}) EXPECT_TRUE(d["vibration"].contains(key)) << key;
  EXPECT_EQ(d["device_loop"]["ticks"], 800);
  EXPECT_EQ(d["fault"], "none");
  EXPECT_EQ(d["interrupted"], false);
  EXPECT_TRUE(d["fault_record"].is_null());
  EXPECT_GT(d["contacts"]["share_of_ticks"], 0.3);
  EXPECT_GT(d["hand_force"]["max"], 0.1);
  EXPECT_GT(d["device_loop"]["tick_time"]["p50"], 0.0);
  EXPECT_GE(d["device_loop"]["tick_time"]["p99"], d["device_loop"]["tick_time"]["p50"]);
  EXPECT_EQ(files(), (std::set<std::string>{"session.csv", "session.svg"}));
  EXPECT_NE(read("session.svg").find("</svg>"), std::string::npos);
}

TEST_F(documents, run_without_support_planes) {
  for (const char* contacts : {"least-motion", "window"}) {
    const json d = expect_document(
        {"run", "--probe", pin(), "--fixed", pin(), "--seconds", "0.1", "--contacts", contacts}, "asperity.run/1");
    EXPECT_EQ(d["formulation"], contacts);
    EXPECT_TRUE(d["wall"].is_null());
    EXPECT_EQ(d["coupling"]["translation"]["stiffness"], 500.0);
    EXPECT_EQ(d["coupling"]["rotation"]["from"], "default");
  }
}

TEST_F(documents, run_with_support_planes) {
  const arguments session{"run", "--probe", block(), "--fixed", block(), "--motion", "press"};
  arguments above = session, inside = session;
  above.insert(above.end(), {"--seconds", "0.5"});
  inside.insert(inside.end(), {"--seconds", "0.05", "--probe-pose", "0.001 0.002 0.003 0 0 0 1", "--coupling", "700"});
  const json d = expect_document(above, "asperity.run/1");
  EXPECT_EQ(d["formulation"], "planes");
  expect_keys(d["wall"], {"largest_overlap", "beyond_field", "passed", "not_held", "planes_left_out", "unbalanced",
                          "friction_left_out", "body_lost", "stands_back"});
  for (const char* flag : {"beyond_field", "passed", "not_held", "planes_left_out", "unbalanced", "friction_left_out",
                           "body_lost", "stands_back"}) {
    EXPECT_EQ(d["wall"][flag]["ticks"], 0) << flag;
    EXPECT_TRUE(d["wall"][flag]["first"].is_null()) << flag;
  }
  EXPECT_GT(d["wall"]["largest_overlap"], 0.0);
  EXPECT_LT(d["wall"]["largest_overlap"], 4e-4);
  EXPECT_EQ(d["coupling"]["translation"]["from"], "device");
  EXPECT_EQ(d["coupling"]["translation"]["stiffness"], 1500.0);  // half of what the simulated device states
  EXPECT_EQ(d["coupling"]["rotation"]["stiffness"], 5.0);
  // A probe that begins within a body is told, and so is a coupling of one's own.
  const json deep = expect_document(inside, "asperity.run/1");
  EXPECT_GT(deep["wall"]["not_held"]["ticks"], 0);
  EXPECT_EQ(deep["coupling"]["translation"]["stiffness"], 700.0);
  EXPECT_EQ(deep["coupling"]["translation"]["from"], "option");
  EXPECT_EQ(deep["coupling"]["rotation"]["from"], "device");
  // The velocity of the handle, where another than that of its poses was asked for.
  EXPECT_EQ(d["velocity"]["asked"], "poses");
  arguments own = above;
  own.insert(own.end(), {"--velocity", "device"});
  const json told = expect_document(own, "asperity.run/1");
  EXPECT_GE(told["velocity"]["device_ticks"], told["device_loop"]["ticks"]);
  EXPECT_EQ(told["velocity"]["window_ticks"], 0);
  EXPECT_EQ(told["velocity"]["refused"], false);
  EXPECT_LE(told["energy"]["largest_surplus"], 1e-5);
  // Motion scaling and a clutch, which the simulated hand uses for a fifth of the session.
  EXPECT_EQ(d["scale"], 1.0);
  EXPECT_TRUE(d["clutch"].is_null());
  arguments large = session;
  large.insert(large.end(), {"--scale", "5", "--clutch", "2", "--seconds", "1.5"});
  const json scaled = expect_document(large, "asperity.run/1");
  EXPECT_EQ(scaled["scale"], 5.0);
  EXPECT_EQ(scaled["clutch"]["button"], 2);
  EXPECT_EQ(scaled["clutch"]["told"], true);
  EXPECT_NEAR(scaled["clutch"]["let_go"], 0.15, 0.01);  // of 0.3 s the second half, the first is the ramp
  EXPECT_NEAR(scaled["coupling"]["translation"]["stiffness"], 60.0, 1e-9);
  EXPECT_LE(scaled["energy"]["largest_surplus"], 1e-5);
  EXPECT_EQ(scaled["fault"], "none");
  EXPECT_TRUE(d["gripper"].is_null());  // the simulated device has none
  // The handle's weight, held up by the motors.
  EXPECT_TRUE(d["weight"].is_null());
  arguments heavy = above;
  heavy.insert(heavy.end(), {"--weight", "0.2,0,0,0.03"});
  const json held = expect_document(heavy, "asperity.run/1");
  EXPECT_EQ(held["weight"]["mass"], 0.2);
  EXPECT_EQ(held["weight"]["centre"][2], 0.03);
  EXPECT_NE(held["energy"]["of_weight"], 0.0);
  EXPECT_LE(held["energy"]["largest_surplus"], 1e-5);
  EXPECT_EQ(held["fault"], "none");
  arguments too_heavy = above;
  too_heavy.insert(too_heavy.end(), {"--weight", "0.6"});
  EXPECT_NE(expect_failure(too_heavy, 1, "invalid_argument").find("more than half"), std::string::npos);
  // What a first touch rings with.
  EXPECT_TRUE(d["transient"].is_null());
  EXPECT_EQ(d["energy"]["of_transients"], 0.0);
  arguments ringing = above;
  ringing.insert(ringing.end(), {"--transient", "20,120"});
  const json rang = expect_document(ringing, "asperity.run/1");
  EXPECT_EQ(rang["transient"]["amplitude"], 20.0);
  EXPECT_EQ(rang["transient"]["frequency"], 120.0);
  EXPECT_GE(rang["transient"]["first_touches"], 1);
  EXPECT_LE(rang["energy"]["largest_surplus"], 1e-5);
  // Friction, where it was asked for.
  EXPECT_TRUE(d["friction"].is_null());
  arguments rough = above;
  rough.insert(rough.end(), {"--friction", "0.6,0.4"});
  const json rubbed = expect_document(rough, "asperity.run/1");
  EXPECT_EQ(rubbed["friction"]["static"], 0.6);
  EXPECT_EQ(rubbed["friction"]["dynamic"], 0.4);
  EXPECT_LE(rubbed["energy"]["largest_surplus"], 1e-5);
}

TEST_F(documents, devices) {
  const json d = expect_document({"devices"}, "asperity.devices/1");
  ASSERT_GE(d["devices"].size(), 1U);
  for (const char* key : {"drivers", "problems"}) EXPECT_TRUE(d.contains(key)) << key;
  EXPECT_EQ(d["devices"][0]["name"], "simulated");
  EXPECT_EQ(d["devices"][0]["maturity"], "simulated");
}

TEST_F(documents, bench) {
  const json d = expect_document({"bench", "--probe", pin(), "--fixed", pin(), "--poses", "50"}, "asperity.bench/1");
  expect_keys(d["seconds"], {"collision_query", "contact_soft", "contact_central", "tick_planes", "every_sample",
                             "tick_least_motion", "tick_soft", "tick_central"});
  expect_keys(d["samples"], {"balls_looked_at", "near", "leaves_bounded", "read_quickly", "read_exactly"});
  EXPECT_GT(d["samples"]["near"], d["samples"]["read_exactly"]);
  for (const auto& [what, times] : d["seconds"].items()) {
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

TEST_F(documents, quiet_says_nothing) {
  const outcome done = run({"inspect", block(), "--quiet"});
  EXPECT_EQ(done.exit_status, 0);
  EXPECT_EQ(done.out + done.err, "");
  EXPECT_EQ(run({"--quiet", "inspect", block()}).out, "");
}

}  // namespace
}  // namespace fault
