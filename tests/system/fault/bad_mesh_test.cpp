// Meshes that cannot become a textured model.
#include <cmath>
#include <sstream>

#include "command_process.hpp"

namespace fault {
namespace {

class bad_mesh : public command_test {
 protected:
  // Bakes a mesh of this text and expects exit status 1 and no output file. @return the message
  std::string expect_refused(const std::string& name, const std::string& text, const std::string& code) const {
    write(name, text);
    return expect_failure({"bake", path(name), "-o", path("out.glb"), "--texture", "64"}, 1, code);
  }
};

std::string ply(const std::string& vertices, int vertex_count, const std::string& faces, int face_count) {
  return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(vertex_count) +
         "\nproperty float x\nproperty float y\nproperty float z\nelement face " + std::to_string(face_count) +
         "\nproperty list uchar int vertex_indices\nend_header\n" + vertices + faces;
}

const char* const cube_vertices =
    "v 0 0 0\nv 0.1 0 0\nv 0.1 0.1 0\nv 0 0.1 0\nv 0 0 0.1\nv 0.1 0 0.1\nv 0.1 0.1 0.1\nv 0 0.1 0.1\n";
const char* const cube_without_lid = "f 4 3 2 1\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

TEST_F(bad_mesh, file_that_is_not_there) {
  const std::string message = expect_failure({"bake", path("absent.ply"), "-o", path("out.glb")}, 1, "io_failed");
  EXPECT_NE(message.find("absent.ply"), std::string::npos);
}

TEST_F(bad_mesh, folder_instead_of_a_file) {
  std::filesystem::create_directory(path("mesh.ply"));
  expect_failure({"bake", path("mesh.ply"), "-o", path("out.glb")}, 1, "io_failed");
}

TEST_F(bad_mesh, unknown_format) { expect_refused("mesh.xyz", "0 0 0\n", "unsupported"); }

TEST_F(bad_mesh, empty_files) {
  for (const char* name : {"mesh.ply", "mesh.stl", "mesh.glb", "mesh.gltf"}) expect_refused(name, "", "bad_format");
}

TEST_F(bad_mesh, empty_mesh) {
  expect_refused("mesh.ply", ply("", 0, "", 0), "bad_format");
  expect_refused("mesh.obj", "# nothing\n", "bad_format");
}

TEST_F(bad_mesh, one_triangle) {
  expect_refused("mesh.ply", ply("0 0 0\n0.1 0 0\n0 0.1 0\n", 3, "3 0 1 2\n", 1), "bad_mesh");
}

TEST_F(bad_mesh, zero_area_triangles) {
  // Closed and manifold by its indices, but every vertex lies on one line.
  const std::string needle = ply("0 0 0\n0.1 0 0\n0.2 0 0\n0.3 0 0\n", 4, "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n", 4);
  expect_refused("mesh.ply", needle, "bad_mesh");
}

TEST_F(bad_mesh, all_vertices_in_one_point) {
  const std::string point = ply("1 1 1\n1 1 1\n1 1 1\n1 1 1\n", 4, "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n", 4);
  expect_refused("mesh.ply", point, "bad_mesh");
}

TEST_F(bad_mesh, open_surface) {
  write("mesh.obj", std::string(cube_vertices) + cube_without_lid);
  std::vector<std::string> bake{"bake", path("mesh.obj"), "-o", path("out.glb"), "--texture", "64"};
  const json repair = expect_document(bake, "asperity.bake/1").at("repair");
  EXPECT_EQ(repair.at("holes_closed"), 1);
  EXPECT_EQ(repair.at("holes_smooth"), 0);
  ASSERT_EQ(repair.at("actions").size(), 1U) << repair;
  EXPECT_EQ(repair.at("actions").at(0).at("action"), "hole");
  EXPECT_EQ(repair.at("actions").at(0).at("count"), 1);
  EXPECT_NEAR(repair.at("actions").at(0).at("largest_change").get<double>(), 0.1 * std::sqrt(2.0), 1e-6);
  EXPECT_NEAR(repair.at("made_up_share").get<double>(), 1.0 / 6.0, 1e-6);
  EXPECT_EQ(repair.at("triangles_before"), 10);
  EXPECT_EQ(repair.at("triangles_after"), 12);
  bake.emplace_back("--strict");
  const std::string message = expect_failure(bake, 1, "bad_mesh");
  EXPECT_NE(message.find("4 open edges"), std::string::npos) << message;
  EXPECT_NE(message.find("without --strict"), std::string::npos) << message;
}

// What a refusal offers works; where nothing can be made of a mesh, nothing is offered.
TEST_F(bad_mesh, the_way_out_that_a_refusal_offers_is_one) {
  const std::string cut = std::string(cube_vertices) + "f 4 3 2 1\nf 1 2 6\nf 1 6 2\nf 2 3 7 6\nf 2 3 8\nf 4 1 5 8\n";
  EXPECT_NE(expect_refused("mesh.obj", cut, "bad_mesh").find("; or add --wrap"), std::string::npos);
  const json baked = expect_document({"bake", path("mesh.obj"), "--fit", "0.1", "--wrap=0.002", "--triangles", "100",
                                      "-o", path("out.glb"), "--texture", "128"},
                                     "asperity.bake/1");
  EXPECT_GT(baked.at("wrap").at("plate_share"), 0.0);
  const std::string line = ply("0 0 0\n0.1 0 0\n0.2 0 0\n0.3 0 0\n", 4, "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n", 4);
  EXPECT_EQ(expect_refused("line.ply", line, "bad_mesh").find("--wrap"), std::string::npos);
  expect_failure({"bake", path("mesh.obj"), "--wrap", "--keep-uvs", "-o", path("no.glb")}, 1, "invalid_argument");
  expect_failure({"bake", path("mesh.obj"), "--wrap=1e-9", "-o", path("no.glb")}, 1, "invalid_argument");
}

// A lens whose rim is sharp all around: no coarse mesh of it is unfolded, however many triangles it has.
std::string sharp_lens() {
  constexpr int around = 100, rings = 80;
  const auto vertex = [](int ring, int i, double side) {
    const double r = static_cast<double>(ring) / rings, a = 2.0 * 3.14159265358979 * i / around;
    return "v " + std::to_string(r * std::cos(a)) + ' ' + std::to_string(r * std::sin(a)) + ' ' +
           std::to_string(side * 0.01 * (1.0 - r * r)) + '\n';
  };
  std::string vertices = vertex(0, 0, 1.0) + vertex(0, 0, -1.0), faces;
  for (int ring = 1; ring <= rings; ++ring) {
    for (int i = 0; i < around; ++i) vertices += vertex(ring, i, 1.0);
  }
  for (int ring = 1; ring < rings; ++ring) {
    for (int i = 0; i < around; ++i) vertices += vertex(ring, i, -1.0);
  }
  const auto number = [](int ring, int i, bool above) {
    const int of_ring = (ring - 1) * around + i % around;
    return 3 + (above || ring == rings ? of_ring : rings * around + of_ring);
  };
  const auto face = [&](int a, int b, int c, bool above) {
    faces +=
        "f " + std::to_string(a) + ' ' + std::to_string(above ? b : c) + ' ' + std::to_string(above ? c : b) + '\n';
  };
  for (const bool above : {true, false}) {
    for (int i = 0; i < around; ++i) {
      face(above ? 1 : 2, number(1, i, above), number(1, i + 1, above), above);
      for (int ring = 1; ring < rings; ++ring) {
        const int a = number(ring, i, above), b = number(ring + 1, i, above);
        const int c = number(ring + 1, i + 1, above), d = number(ring, i + 1, above);
        face(a, b, c, above);
        face(a, c, d, above);
      }
    }
  }
  return vertices + faces;
}

TEST_F(bad_mesh, no_coarse_mesh_is_sound) {
  const std::string message = expect_refused("lens.obj", sharp_lens(), "bad_mesh");
  EXPECT_NE(message.find("no sound coarse mesh of 600 triangles"), std::string::npos) << message;
  EXPECT_NE(message.find("nor with up to 19200; give a coarse mesh; or add --wrap"), std::string::npos) << message;
  const json baked = expect_document(
      {"bake", path("lens.obj"), "--fit", "0.05", "--wrap=0.001", "-o", path("out.glb"), "--texture", "128"},
      "asperity.bake/1");
  EXPECT_GT(baked.at("wrap").at("plate_share"), 0.9);
  // A coarse mesh that is given is another file: no wrap mends it.
  write("open.obj", std::string(cube_vertices) + cube_without_lid);
  const std::string of_coarse = expect_failure({"bake", path("lens.obj"), "--fit", "0.05", "--coarse", path("open.obj"),
                                                "-o", path("no.glb"), "--texture", "128"},
                                               1, "bad_mesh");
  EXPECT_EQ(of_coarse.find("--wrap"), std::string::npos) << of_coarse;
}

// Two thirds of it are missing: one command is offered, and an option that takes it at once.
TEST_F(bad_mesh, too_open_to_be_closed) {
  const std::string message =
      expect_refused("mesh.obj", std::string(cube_vertices) + "f 4 3 2 1\nf 1 2 6 5\n", "bad_mesh");
  EXPECT_NE(message.find("--wrap"), std::string::npos) << message;
  const json wrapped = expect_document({"bake", path("mesh.obj"), "--repair", "wrap", "--fit", "0.1", "--triangles",
                                        "100", "-o", path("out.glb"), "--texture", "128", "--without-field"},
                                       "asperity.bake/1");
  EXPECT_GT(wrapped.at("wrap").at("triangles"), 100);
  ASSERT_FALSE(wrapped.at("warnings").empty());
  EXPECT_EQ(wrapped.at("warnings").at(0).get<std::string>().rfind("wrapped, since it could not be repaired: ", 0), 0U);
}

// What can be mended without a doubt is mended, and said.
TEST_F(bad_mesh, inside_out_is_turned_and_reported) {
  write("mesh.obj", std::string(cube_vertices) +
                        "f 1 2 3\nf 1 3 4\nf 5 7 6\nf 5 8 7\nf 1 6 2\nf 1 5 6\nf 2 7 3\nf 2 6 7\n" +
                        "f 3 8 4\nf 3 7 8\nf 4 5 1\nf 4 8 5\n");
  const json baked = expect_document(
      {"bake", path("mesh.obj"), "-o", path("out.glb"), "--texture", "64", "--without-field"}, "asperity.bake/1");
  ASSERT_FALSE(baked.at("warnings").empty());
  EXPECT_EQ(baked.at("warnings").at(0), "the mesh was inside-out and has been turned");
}

TEST_F(bad_mesh, nan_and_infinite_vertices) {
  for (const char* number : {"nan", "inf", "-inf", "1e999"}) {
    write("mesh.obj", "v 0 0 " + std::string(number) + "\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\n" +
                          "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
    const outcome refused = run({"bake", path("mesh.obj"), "-o", path("out.glb")});
    EXPECT_EQ(refused.exit_status, 1) << number;
    EXPECT_EQ(files(), std::set<std::string>{"mesh.obj"});
  }
}

TEST_F(bad_mesh, index_that_points_nowhere) {
  expect_refused("mesh.ply", ply("0 0 0\n0.1 0 0\n0 0.1 0\n0 0 0.1\n", 4, "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 9\n", 4),
                 "bad_format");
}

TEST_F(bad_mesh, truncated_binary_ply) {
  std::filesystem::copy_file(small_models() / "block.ply", path("whole.ply"));
  const std::string whole = read("whole.ply");
  for (const std::size_t kept : {std::size_t{3}, std::size_t{100}, whole.size() / 2, whole.size() - 1}) {
    expect_refused("mesh.ply", whole.substr(0, kept), "bad_format");
  }
}

// A cube of 50 mm, drawn in millimetres.
std::string cube_50_units() {
  return "v 0 0 0\nv 50 0 0\nv 50 50 0\nv 0 50 0\nv 0 0 50\nv 50 0 50\nv 50 50 50\nv 0 50 50\n" +
         std::string(cube_without_lid) + "f 5 6 7 8\n";
}

TEST_F(bad_mesh, another_unit_is_asked_for) {
  const std::string message = expect_refused("part.obj", cube_50_units(), "invalid_argument");
  for (const char* part : {"86.6 m", "--units mm (86.6 mm)", "--units cm", "--units in", "--units m ", "--scale"})
    EXPECT_NE(message.find(part), std::string::npos) << part << ": " << message;
}

TEST_F(bad_mesh, said_units_are_taken) {
  write("part.obj", cube_50_units());
  const std::vector<std::string> bake{"bake", path("part.obj"), "-o", path("out.glb"), "--texture",
                                      "64",   "--without-field"};
  const std::pair<const char*, double> units[] = {{"mm", 0.05}, {"cm", 0.5}, {"in", 1.27}, {"m", 50.0}};
  for (const auto& [unit, side] : units) {
    std::vector<std::string> args = bake;
    args.insert(args.end(), {"--units", unit});
    const json baked = expect_document(args, "asperity.bake/1");
    EXPECT_NEAR(baked.at("size").at("high").at(0).get<double>(), side, 1e-6) << unit;
    EXPECT_NEAR(baked.at("scale").get<double>() * 50.0, side, 1e-12) << unit;
  }
}

TEST_F(bad_mesh, a_speck_is_asked_about_too) {
  std::string speck(cube_vertices);
  for (std::size_t at = 0; (at = speck.find("0.1", at)) != std::string::npos; at += 6) speck.replace(at, 3, "0.0001");
  const std::string message = expect_refused("speck.obj", speck + cube_without_lid + "f 5 6 7 8\n", "invalid_argument");
  EXPECT_NE(message.find("173 um"), std::string::npos) << message;
  EXPECT_NE(message.find("--units m "), std::string::npos) << message;
  EXPECT_EQ(message.find("--units mm"), std::string::npos) << message;
}

TEST_F(bad_mesh, texture_coordinates_that_cannot_be_kept) {
  write("bare.obj", std::string(cube_vertices) + cube_without_lid + "f 5 6 7 8\n");
  const std::vector<std::string> bake{"bake", path("bare.obj"), "--keep-uvs", "--texture", "64", "-o", path("out.glb")};
  const std::string none = expect_failure(bake, 1, "bad_mesh");
  EXPECT_NE(none.find("no texture coordinates to keep"), std::string::npos) << none;
  std::string stacked = std::string(cube_vertices) + "vt 0.1 0.1\nvt 0.9 0.1\nvt 0.9 0.9\nvt 0.1 0.9\n";
  for (const char* face : {"4 3 2 1", "1 2 6 5", "2 3 7 6", "3 4 8 7", "4 1 5 8", "5 6 7 8"}) {
    std::istringstream corners(face);
    std::string vertex;
    stacked += "f";
    for (int k = 1; corners >> vertex; ++k) stacked += ' ' + vertex + '/' + std::to_string(k);
    stacked += '\n';
  }
  write("stacked.obj", stacked);
  const std::string overlap = expect_failure(
      {"bake", path("stacked.obj"), "--keep-uvs", "--texture", "64", "-o", path("out.glb")}, 1, "bad_mesh");
  EXPECT_NE(overlap.find("triangles 0 and 2 of the coarse mesh overlap"), std::string::npos) << overlap;
  write("open.obj", std::string(cube_vertices) + cube_without_lid);
  const std::string closed = expect_failure(
      {"bake", path("open.obj"), "--keep-uvs", "--close-holes", "--texture", "64", "-o", path("out.glb")}, 1,
      "invalid_argument");
  EXPECT_NE(closed.find("have no texture coordinates"), std::string::npos) << closed;
}

TEST_F(bad_mesh, coarse_mesh_is_checked_too) {
  write("low.obj", std::string(cube_vertices) + cube_without_lid);
  expect_failure({"bake", (small_models() / "block.ply").string(), "--coarse", path("low.obj"), "-o", path("out.glb"),
                  "--texture", "64"},
                 1, "bad_mesh");
}

}  // namespace
}  // namespace fault
