// Plain meshes from glTF: nodes, index types, buffers inside and beside the file, and nothing from elsewhere.
#include <array>
#include <cstring>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "asperity/io/mesh_file.hpp"
#include "glb_editor.hpp"
#include "scratch_folder.hpp"

namespace asperity {
namespace {

using nlohmann::json;
using test_support::scratch_folder;
using triangle = std::array<std::uint32_t, 3>;

template <class T>
std::string bytes_of(const std::vector<T>& items) {
  return {reinterpret_cast<const char*>(items.data()), items.size() * sizeof(T)};
}

const std::vector<float> triangle_positions{0, 0, 0, 1, 0, 0, 0, 1, 0};

/// One triangle in one node; `buffer` is put in as it is.
json one_triangle(const json& buffer) {
  return {{"asset", {{"version", "2.0"}}},
          {"buffers", {buffer}},
          {"bufferViews", {{{"buffer", 0}, {"byteLength", 36}}}},
          {"accessors", {{{"bufferView", 0}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}}}},
          {"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 0}}}}}}}}},
          {"nodes", {{{"mesh", 0}}}},
          {"scenes", {{{"nodes", {0}}}}},
          {"scene", 0}};
}

void expect_error(const result<triangle_mesh>& mesh, error_code code, const std::string& says) {
  ASSERT_FALSE(mesh) << says;
  EXPECT_EQ(mesh.error().code, code) << mesh.error().message;
  EXPECT_NE(mesh.error().message.find(says), std::string::npos) << mesh.error().message << "\nlacks: " << says;
}

TEST(Gltf, ReadsABufferBesideTheFile) {
  const scratch_folder folder;
  (void)folder.file("tri angle.bin", bytes_of(triangle_positions) + "more");
  const auto mesh =
      io::load_mesh(folder.file("t.gltf", one_triangle({{"byteLength", 36}, {"uri", "tri%20angle.bin"}}).dump()));
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->positions, (std::vector<vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(mesh->triangles, (std::vector<triangle>{{0, 1, 2}}));
}

TEST(Gltf, ReadsADataUri) {
  const std::string uri = "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
  const scratch_folder folder;
  const auto mesh = io::load_mesh(folder.file("t.gltf", one_triangle({{"byteLength", 36}, {"uri", uri}}).dump()));
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->positions, (std::vector<vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
}

TEST(Gltf, NeverLeavesItsFolder) {
  const scratch_folder outer;
  std::filesystem::create_directories(outer.file("inner/deeper"));
  (void)outer.file("secret.bin", bytes_of(triangle_positions));
  (void)outer.file("inner/deeper/fine.bin", bytes_of(triangle_positions));
  std::filesystem::create_symlink(outer.file("secret.bin"), outer.file("inner/link.bin"));
  const auto load = [&](const std::string& uri) {
    return io::load_mesh(outer.file("inner/t.gltf", one_triangle({{"byteLength", 36}, {"uri", uri}}).dump()));
  };
  EXPECT_TRUE(load("deeper/fine.bin"));
  EXPECT_TRUE(load("./deeper/../deeper/fine.bin"));
  for (const std::string uri : {"../secret.bin", "%2e%2e/secret.bin", "deeper/../../secret.bin", "/etc/passwd",
                                "file:///etc/passwd", "", ".", ".."}) {
    SCOPED_TRACE(uri);
    expect_error(load(uri), error_code::bad_format, "leads out of the document's folder");
  }
  (void)outer.file("secret.bin", bytes_of(triangle_positions));
  expect_error(load(outer.file("secret.bin").string()), error_code::bad_format, "leads out of");
  expect_error(load("link.bin"), error_code::io_failed, "link.bin: is or lies behind a link");
  expect_error(load("absent.bin"), error_code::io_failed, "absent.bin: cannot be found");
  expect_error(load("deeper"), error_code::io_failed, "is a directory");
  expect_error(load("%zz"), error_code::bad_format, "broken % code");
}

/// Two triangles of a quad, in a tree of nodes.
json quad_scene(int index_type, const std::string& positions, const std::string& indices) {
  return {{"asset", {{"version", "2.0"}}},
          {"buffers", {{{"byteLength", positions.size() + indices.size()}}}},
          {"bufferViews",
           {{{"buffer", 0}, {"byteLength", positions.size()}, {"byteStride", 20}},
            {{"buffer", 0}, {"byteOffset", positions.size()}, {"byteLength", indices.size()}}}},
          {"accessors",
           {{{"bufferView", 0}, {"componentType", 5126}, {"count", 4}, {"type", "VEC3"}},
            {{"bufferView", 0}, {"byteOffset", 12}, {"componentType", 5126}, {"count", 4}, {"type", "VEC2"}},
            {{"bufferView", 1}, {"componentType", index_type}, {"count", 6}, {"type", "SCALAR"}},
            {{"componentType", 5126}, {"count", 9}, {"type", "MAT4"}}}},  // used by no mesh
          {"meshes",
           {{{"primitives",
              {{{"attributes", {{"POSITION", 0}, {"TEXCOORD_0", 1}}}, {"indices", 2}},
               {{"attributes", {{"POSITION", 0}}}, {"mode", 0}}}}}}},  // and its points
          {"nodes", {{{"mesh", 0}}}}};
}

const std::vector<float> quad_vertices{0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 1, 1, 0, 1, 1, 0, 1, 0, 0, 1};

std::string glb(const json& document, const std::string& bin) {
  test_support::glb_editor editor(std::string("glTF\2\0\0\0\0\0\0\0\2\0\0\0JSON{}\0\0\0\0\0\0\0\0", 30));
  editor.json = document;
  editor.bin = bin;
  editor.bin.resize((bin.size() + 3) / 4 * 4);
  return editor.bytes();
}

template <class Index>
void expect_quad(int index_type) {
  const std::string indices = bytes_of(std::vector<Index>{0, 1, 2, 0, 2, 3});
  const std::string positions = bytes_of(quad_vertices);
  const scratch_folder folder;
  const auto mesh =
      io::load_mesh(folder.file("q.glb", glb(quad_scene(index_type, positions, indices), positions + indices)));
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->positions, (std::vector<vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}));
  EXPECT_EQ(mesh->triangles, (std::vector<triangle>{{0, 1, 2}, {0, 2, 3}}));
  ASSERT_EQ(mesh->uvs.size(), 2U);
  EXPECT_EQ(mesh->uvs[1], (std::array<vec2, 3>{vec2(0, 0), vec2(1, 1), vec2(0, 1)}));
}

TEST(Gltf, ReadsInterleavedVerticesAndEveryIndexType) {
  expect_quad<std::uint8_t>(5121);
  expect_quad<std::uint16_t>(5123);
  expect_quad<std::uint32_t>(5125);
}

TEST(Gltf, MovesMeshesByTheirNodes) {
  const std::string bin = bytes_of(triangle_positions);
  json document = one_triangle({{"byteLength", 36}});
  const double s = std::sqrt(0.5);
  // Turned by 90 degrees about z (x y z w), doubled, moved; below it a mirrored copy by matrix.
  document["nodes"] = {
      {{"translation", {10, 0, 0}}, {"rotation", {0, 0, s, s}}, {"scale", {2, 2, 2}}, {"mesh", 0}, {"children", {1}}},
      {{"matrix", {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 3, 1}}, {"mesh", 0}},
      {{"mesh", 0}}};  // in no scene
  const scratch_folder folder;
  const auto mesh = io::load_mesh(folder.file("n.glb", glb(document, bin)));
  ASSERT_TRUE(mesh) << mesh.error().message;
  const std::vector<vec3> expected{{10, 0, 0}, {10, 2, 0}, {8, 0, 0}, {10, 0, 6}, {10, -2, 6}, {8, 0, 6}};
  ASSERT_EQ(mesh->positions.size(), expected.size());
  ASSERT_EQ(mesh->triangles.size(), 2U);
  for (std::size_t t = 0; t < 2; ++t) {
    const auto& v = mesh->triangles[t];
    const vec3 normal =
        glm::cross(mesh->positions[v[1]] - mesh->positions[v[0]], mesh->positions[v[2]] - mesh->positions[v[0]]);
    EXPECT_GT(normal.z, 0.0) << "a mirrored triangle keeps its outside";
  }
  for (const vec3& e : expected) {
    double nearest = 1e9;
    for (const vec3& p : mesh->positions) nearest = std::min(nearest, glm::length(p - e));
    EXPECT_LT(nearest, 1e-12);
  }
}

TEST(Gltf, NamesWhatItCannotRead) {
  const scratch_folder folder;
  const std::string bin = bytes_of(triangle_positions);
  const auto with = [&](const char* pointer, const json& value) {
    json document = one_triangle({{"byteLength", 36}});
    document[json::json_pointer(pointer)] = value;
    return io::load_mesh(folder.file("f.glb", glb(document, bin)));
  };
  using enum error_code;
  expect_error(with("/asset/version", "1.0"), unsupported, "glTF version '1.0'");
  expect_error(with("/extensionsRequired", {"KHR_draco_mesh_compression"}), unsupported, "KHR_draco_mesh_compression");
  EXPECT_TRUE(with("/extensionsRequired", {"KHR_materials_unlit"}));
  expect_error(with("/accessors/0/sparse", json::object()), unsupported, "accessors[0] is sparse");
  expect_error(with("/accessors/0/componentType", 5122), unsupported, "not float32 VEC3");
  expect_error(with("/meshes/0/primitives/0/mode", 5), unsupported, "strip or fan");
  expect_error(with("/nodes/0/children", {0}), bad_format, "its own ancestor");
  expect_error(with("/nodes/0/mesh", 7), bad_format, "nodes[0].mesh is 7, but there are only 1");
  expect_error(with("/nodes/0/scale", {1, 2}), bad_format, "does not hold 3 finite numbers");
  expect_error(with("/scenes/0/nodes", {1}), bad_format, "one of the 1 nodes");
  expect_error(with("/scenes/0/nodes", json::array()), bad_format, "holds no faces");
  expect_error(with("/nodes/0", {{"mesh", 0}, {"scale", {1e308, 1, 1}}, {"translation", {1e308, 0, 0}}}), bad_format,
               "is moved beyond all numbers by its node");
}

TEST(Gltf, CopiesBeyondTheLimitAreRefused) {
  // 5,000 nodes that each place 12,000 triangles: a small file that asks for 60 million.
  const std::size_t corners = 36000;
  const std::string bin = bytes_of(std::vector<float>(3 * corners, 1.0F));
  json document = one_triangle({{"byteLength", bin.size()}});
  document["bufferViews"][0]["byteLength"] = bin.size();
  document["accessors"][0]["count"] = corners;
  document["nodes"] = json::array();
  document["scenes"][0]["nodes"] = json::array();
  for (int n = 0; n < 5000; ++n) {
    document["nodes"].push_back({{"mesh", 0}});
    document["scenes"][0]["nodes"].push_back(n);
  }
  const scratch_folder folder;
  expect_error(io::load_mesh(folder.file("copies.glb", glb(document, bin))), error_code::limit_exceeded, "8 million");
}

}  // namespace
}  // namespace asperity
