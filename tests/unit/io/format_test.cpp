// The same small surfaces in every format and dialect.
#include <algorithm>
#include <array>
#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <vector>

#include "asperity/io/mesh_file.hpp"
#include "scratch_folder.hpp"
#include "support/real_meshes.hpp"

namespace asperity {
namespace {

using test_support::scratch_folder;
using triangle = std::array<std::uint32_t, 3>;

template <class T>
void append(std::string& to, T value, bool big_endian) {
  std::string raw(reinterpret_cast<const char*>(&value), sizeof value);
  if (big_endian) std::reverse(raw.begin(), raw.end());
  to += raw;
}

/// A unit square of two triangles, as every test below writes it.
void expect_square(const result<triangle_mesh>& mesh) {
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->positions, (std::vector<vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}));
  EXPECT_EQ(mesh->triangles, (std::vector<triangle>{{0, 1, 2}, {0, 2, 3}}));
}

TEST(Ply, ReadsAsciiWithCommentsExtraPropertiesAndElements) {
  const scratch_folder folder;
  expect_square(io::load_mesh(folder.file("square.ply",
                                          "ply\r\nformat ascii 1.0\r\ncomment made by hand\r\nobj_info none\r\n"
                                          "element camera 1\nproperty float focal\nproperty list uchar float lens\n"
                                          "element vertex 4\nproperty uchar red\nproperty double x\nproperty float y\n"
                                          "property int z\nproperty list uchar short neighbours\n"
                                          "element nothing 99999999999\n"
                                          "element face 1\nproperty uchar kind\n"
                                          "property list uchar int vertex_index\nend_header\n"
                                          "0.5 2 1.5 2.5\n"
                                          "255 0 0 0 0\n255 1 +0.0 0 2 7 8\n\n255 1e0 1 0 0\n255 0 1 0 1 3\n"
                                          "9 4 0 1 2 3\n")));
}

class PlyBinary : public ::testing::TestWithParam<bool> {};

TEST_P(PlyBinary, ReadsEveryPropertyType) {
  const bool big = GetParam();
  std::string bytes = std::string("ply\nformat binary_") + (big ? "big" : "little") +
                      "_endian 1.0\nelement vertex 4\nproperty int8 a\nproperty float64 x\nproperty uint16 b\n"
                      "property short y\nproperty float z\nproperty list uint32 double c\n"
                      "element face 2\nproperty list ushort uint vertex_indices\nproperty uint8 d\nend_header\n";
  const std::array<std::array<int, 2>, 4> corners{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  for (const auto& c : corners) {
    append(bytes, std::int8_t{-1}, big);
    append(bytes, static_cast<double>(c[0]), big);
    append(bytes, std::uint16_t{65535}, big);
    append(bytes, static_cast<std::int16_t>(c[1]), big);
    append(bytes, 0.0F, big);
    append(bytes, std::uint32_t{2}, big);
    append(bytes, 1e300, big);
    append(bytes, 2.0, big);
  }
  for (const triangle& t : {triangle{0, 1, 2}, triangle{0, 2, 3}}) {
    append(bytes, std::uint16_t{3}, big);
    for (const std::uint32_t v : t) append(bytes, v, big);
    append(bytes, std::uint8_t{7}, big);
  }
  const scratch_folder folder;
  expect_square(io::load_mesh(folder.file("square.ply", bytes)));
}

// The upper half of the unsigned types and the lower one of the others: a sign too much or too few shows.
TEST_P(PlyBinary, ReadsTheWholeRangeOfEveryInteger) {
  const bool big = GetParam();
  const auto read = [&](const std::string& type, auto most, auto least) {
    std::string bytes = std::string("ply\nformat binary_") + (big ? "big" : "little") +
                        "_endian 1.0\nelement vertex 3\nproperty " + type + " x\nproperty " + type +
                        " y\nproperty float z\nelement face 1\nproperty list uchar uchar vertex_indices\nend_header\n";
    for (int corner = 0; corner < 3; ++corner) {
      append(bytes, corner == 1 ? most : least, big);
      append(bytes, corner == 2 ? most : least, big);
      append(bytes, 0.0F, big);
    }
    for (const int i : {3, 0, 1, 2}) append(bytes, static_cast<std::uint8_t>(i), big);
    const scratch_folder folder;
    const auto mesh = io::load_mesh(folder.file("range.ply", bytes));
    ASSERT_TRUE(mesh) << type << ": " << mesh.error().message;
    const auto high = static_cast<double>(most);
    const auto low = static_cast<double>(least);
    EXPECT_EQ(mesh->positions, (std::vector<vec3>{{low, low, 0}, {high, low, 0}, {low, high, 0}})) << type;
  };
  const auto read_all_of = [&](const std::string& type, auto zero) {
    using limits = std::numeric_limits<decltype(zero)>;
    read(type, limits::max(), limits::min());
  };
  read_all_of("char", std::int8_t{});
  read_all_of("uchar", std::uint8_t{});
  read_all_of("short", std::int16_t{});
  read_all_of("ushort", std::uint16_t{});
  read_all_of("int", std::int32_t{});
  read_all_of("uint", std::uint32_t{});
}

INSTANTIATE_TEST_SUITE_P(ByteOrders, PlyBinary, ::testing::Bool(),
                         [](const auto& order) { return order.param ? "Big" : "Little"; });

TEST(Ply, AcceptsFacesBeforeVertices) {
  const scratch_folder folder;
  const auto mesh = io::load_mesh(folder.file("t.ply",
                                              "ply\nformat ascii 1.0\nelement face 1\n"
                                              "property list uchar int vertex_indices\nelement vertex 3\n"
                                              "property float x\nproperty float y\nproperty float z\nend_header\n"
                                              "3 2 1 0\n0 0 0\n1 0 0\n0 1 0"));
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->triangles, (std::vector<triangle>{{2, 1, 0}}));
}

TEST(Ply, SavedMeshComesBackBitForBit) {
  triangle_mesh mesh;
  mesh.positions = {{0.1, -0.0, 0.3}, {1.0 / 3.0, 2e-300, 5.0}, {1, 2, 3}, {-1e4, 0.7, 1e-9}};
  mesh.triangles = {{0, 1, 2}, {3, 2, 1}, {0, 2, 3}};
  const scratch_folder folder;
  ASSERT_TRUE(io::save_ply(mesh, folder.file("m.ply")));
  const auto back = io::load_mesh(folder.file("m.ply"));
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->positions, mesh.positions);
  EXPECT_EQ(back->triangles, mesh.triangles);
}

TEST(Ply, SavesFloat32WhereItLosesNothing) {
  triangle_mesh mesh;
  mesh.positions = {{0.5, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  const scratch_folder folder;
  ASSERT_TRUE(io::save_ply(mesh, folder.file("m.ply")));
  EXPECT_NE(test_support::read_all(folder.file("m.ply")).find("property float x"), std::string::npos);
  mesh.positions[0].x = 0.1;
  ASSERT_TRUE(io::save_ply(mesh, folder.file("m.ply")));
  EXPECT_NE(test_support::read_all(folder.file("m.ply")).find("property double x"), std::string::npos);
}

TEST(Obj, ReadsEveryFormOfCornerAndNegativeIndices) {
  const scratch_folder folder;
  expect_square(io::load_mesh(folder.file("square.obj",
                                          "# a square\no thing\nmtllib none.mtl\nv 0 0 0\nv 1 0 0 1.0 0.5 0.5 0.5\r\n"
                                          "v 1 1 0\nvn 0 0 1\nv 0 1 \\\n 0\nusemtl red\ns off\n"
                                          "f 1//1 2//-1 -2 # corners\nf -4/ 3 4\nl 1 2\np 1\n")));
}

TEST(Obj, SplitsQuadsAndKeepsTextureCoordinatesFromTheFirstRow) {
  const scratch_folder folder;
  const auto mesh = io::load_mesh(folder.file("square.obj",
                                              "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 0.75\nvt 0 1\n"
                                              "f 1/1/1 2/2/1 3/-2 4/4\n"));
  expect_square(mesh);
  ASSERT_EQ(mesh->uvs.size(), 2U);
  EXPECT_EQ(mesh->uvs[0], (std::array<vec2, 3>{vec2(0, 1), vec2(1, 1), vec2(1, 0.25)}));
  EXPECT_EQ(mesh->uvs[1], (std::array<vec2, 3>{vec2(0, 1), vec2(1, 0.25), vec2(0, 0)}));
}

TEST(Obj, HasNoTextureCoordinatesWhereOneCornerLacksThem) {
  const scratch_folder folder;
  const auto mesh = io::load_mesh(folder.file("t.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nf 1/1 2/1 3\n"));
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_TRUE(mesh->uvs.empty());
}

TEST(Obj, SplitsAConcavePolygonWithoutFoldingOver) {
  // An L: a fan from its first corner would cover ground outside.
  const scratch_folder folder;
  const auto mesh =
      io::load_mesh(folder.file("l.obj", "v 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nv 0 0 0\nv 2 0 0\nf 1 2 3 4 5 6\n"));
  ASSERT_TRUE(mesh) << mesh.error().message;
  ASSERT_EQ(mesh->triangles.size(), 4U);
  double area = 0.0;
  for (const triangle& t : mesh->triangles) {
    const auto& p = mesh->positions;
    const double twice = glm::cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]).z;
    EXPECT_GE(twice, 0.0);
    area += 0.5 * twice;
  }
  EXPECT_DOUBLE_EQ(area, 3.0);
}

TEST(Stl, ReadsAsciiOfSeveralSolids) {
  const std::string facet = "facet normal nan nan nan\nouter loop\nvertex ";
  const scratch_folder folder;
  expect_square(io::load_mesh(folder.file(
      "square.STL", "solid first facet of a name\n" + facet + "0 0 0\nvertex 1 0 0\nvertex 1 1 0\nendloop\nendfacet\n" +
                        "endsolid first\nSOLID\n" + facet +
                        "0 0 0\nvertex 1 1 0\nVERTEX 0 1 0\nendloop\nendfacet\nendsolid")));
}

TEST(Stl, ReadsBinaryThatBeginsLikeAscii) {
  std::string bytes = "solid but binary\nfacet normal";
  bytes.resize(80, ' ');
  append(bytes, std::uint32_t{2}, false);
  const std::array<std::array<vec3, 3>, 2> facets{
      {{vec3(0, 0, 0), vec3(1, 0, 0), vec3(1, 1, 0)}, {vec3(-0.0, 0, 0), vec3(1, 1, 0), vec3(0, 1, 0)}}};
  for (const auto& facet : facets) {
    bytes.append(12, '\0');
    for (const vec3& p : facet) {
      for (int axis = 0; axis < 3; ++axis) append(bytes, static_cast<float>(p[axis]), false);
    }
    bytes.append(2, '\0');
  }
  const scratch_folder folder;
  expect_square(io::load_mesh(folder.file("square.stl", bytes)));  // -0 and 0 are one place
}

TEST(Mesh, LeavesOutVerticesThatNoTriangleUses) {
  const scratch_folder folder;
  expect_square(io::load_mesh(
      folder.file("square.obj", "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 8 8 8\nv 1 1 0\nv 0 1 0\nf 2 3 5\nf 2 5 6\n")));
}

TEST(Mesh, RealModelsAreReadWhole) {
  const std::filesystem::path folder = test_support::real_mesh_folder();
  for (const char* const file : {"igea.ply", "stanford-bunny.obj"}) {
    if (const std::string why = test_support::why_without(file); !why.empty()) GTEST_SKIP() << why;
  }
  const auto igea = io::load_mesh(folder / "igea.ply");
  ASSERT_TRUE(igea) << igea.error().message;
  EXPECT_EQ(igea->triangles.size(), 268686U);
  const auto bunny = io::load_mesh(folder / "stanford-bunny.obj");
  ASSERT_TRUE(bunny) << bunny.error().message;
  EXPECT_EQ(bunny->triangles.size(), 69451U);
}

}  // namespace
}  // namespace asperity
