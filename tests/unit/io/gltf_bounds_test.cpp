// Every bound of a .glb, met exactly and missed by one in either direction: what just fits is read, to the bit, and
// one byte, one element or one step more is refused.
#include <algorithm>
#include <cstring>
#include <functional>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "asperity/io/mesh_file.hpp"
#include "glb_editor.hpp"
#include "scratch_folder.hpp"

namespace asperity {
namespace {

using nlohmann::json;
using test_support::scratch_folder;

const std::vector<vec3> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
constexpr std::uint32_t order[] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2};
constexpr std::size_t before_bytes = 8;   // in the buffer, before the view of positions
constexpr std::size_t inner_bytes = 4;    // in the view, before the first position
constexpr std::size_t stride_bytes = 20;  // a position and eight bytes that belong to nobody

/// A .glb whose every length is exactly what it holds: the last position ends with its view, the last index with its
/// view, the buffer and the chunk.
struct tight_glb {
  json document;
  std::string bin;
  std::int64_t total_off_by = 0, json_off_by = 0, bin_off_by = 0;  // added to the lengths in the container

  tight_glb() {
    const std::size_t view_bytes = inner_bytes + 3 * stride_bytes + 12;
    bin.assign(before_bytes + view_bytes, '\x7f');  // as a float a huge number: seen at once where it is read
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const glm::vec3 p(corners[i]);
      std::memcpy(&bin[before_bytes + inner_bytes + i * stride_bytes], &p, sizeof p);
    }
    bin.append(reinterpret_cast<const char*>(order), sizeof order);
    document = {
        {"asset", {{"version", "2.0"}}},
        {"buffers", {{{"byteLength", bin.size()}}}},
        {"bufferViews",
         {{{"buffer", 0}, {"byteOffset", before_bytes}, {"byteLength", view_bytes}, {"byteStride", stride_bytes}},
          {{"buffer", 0}, {"byteOffset", before_bytes + view_bytes}, {"byteLength", sizeof order}}}},
        {"accessors",
         {{{"bufferView", 0}, {"byteOffset", inner_bytes}, {"componentType", 5126}, {"count", 4}, {"type", "VEC3"}},
          {{"bufferView", 1}, {"componentType", 5125}, {"count", 12}, {"type", "SCALAR"}}}},
        {"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"indices", 1}}}}}}},
        {"nodes", {{{"mesh", 0}}}},
        {"scenes", {{{"nodes", {0}}}}},
        {"scene", 0}};
  }

  std::size_t json_beyond_words = 0;  // bytes by which the JSON chunk ends beside a multiple of four

  /// Adds to a whole number of the document.
  void move(const char* list, std::size_t i, const char* key, std::int64_t by) {
    json& field = document[list][i][key];
    field = (field.is_null() ? 0 : field.get<std::int64_t>()) + by;
  }

  [[nodiscard]] std::string bytes() const {
    std::string text = document.dump();
    text.resize((text.size() + 3) / 4 * 4 + json_beyond_words, ' ');
    std::string out = "glTF";
    const auto word = [&](std::size_t value, std::int64_t off_by = 0) {
      const auto w = static_cast<std::uint32_t>(static_cast<std::int64_t>(value) + off_by);
      out.append(reinterpret_cast<const char*>(&w), 4);
    };
    word(2);
    word(12 + 8 + text.size() + 8 + bin.size(), total_off_by);
    word(text.size(), json_off_by);
    out += "JSON" + text;
    word(bin.size(), bin_off_by);
    return out + std::string("BIN\0", 4) + bin;
  }
};

using change = std::function<void(tight_glb&)>;

result<triangle_mesh> read(const change& make) {
  const scratch_folder folder;
  tight_glb file;
  make(file);
  return io::load_mesh(folder.file("t.glb", file.bytes()));
}

void expect_whole(const change& make, const char* what) {
  const auto mesh = read(make);
  ASSERT_TRUE(mesh) << what << ": " << mesh.error().message;
  EXPECT_EQ(mesh->positions, corners) << what;
  ASSERT_EQ(mesh->triangles.size(), 4U) << what;
  for (std::size_t i = 0; i < 12; ++i) EXPECT_EQ(mesh->triangles[i / 3][i % 3], order[i]) << what;
}

void expect_refused(const change& make, const std::string& says, const char* what) {
  const auto mesh = read(make);
  ASSERT_FALSE(mesh) << what << " is read";
  EXPECT_NE(mesh.error().message.find(says), std::string::npos) << what << " says: " << mesh.error().message;
}

TEST(GltfBounds, WhatFitsExactlyIsReadToTheBit) {
  expect_whole([](tight_glb&) {}, "the file as it is");
  // The same positions with every number of their way changed together.
  expect_whole(
      [](tight_glb& f) {
        f.move("bufferViews", 0, "byteOffset", 4);
        f.move("bufferViews", 0, "byteLength", -4);
        f.move("accessors", 0, "byteOffset", -4);
      },
      "an offset of the view instead of the accessor");
  expect_whole([](tight_glb& f) { f.move("bufferViews", 0, "byteLength", 48); }, "a view over what follows");
  expect_whole(
      [](tight_glb& f) {
        for (int k = 0; k < 3; ++k) f.bin += '\0';  // padding of the chunk is no part of the buffer
        f.bin += '\0';
      },
      "a chunk longer than the buffer");
}

TEST(GltfBounds, OneMoreThanThereIsIsRefused) {
  struct miss {
    const char* list;
    std::size_t i;
    const char* key;
    std::int64_t by;
    const char* says;
  };
  const std::vector<miss> all{
      {"buffers", 0, "byteLength", 1, "buffers[0].byteLength is "},
      {"buffers", 0, "byteLength", -1, "bufferViews[1] lies outside its buffer"},
      {"bufferViews", 0, "byteLength", 49, "bufferViews[0] lies outside its buffer"},
      {"bufferViews", 0, "byteLength", -1, "accessors[0] (count 4) lies outside its bufferView"},
      {"bufferViews", 1, "byteLength", 1, "bufferViews[1] lies outside its buffer"},
      {"bufferViews", 1, "byteLength", -1, "accessors[1] (count 12) lies outside its bufferView"},
      {"bufferViews", 1, "byteOffset", 1, "bufferViews[1] lies outside its buffer"},
      {"bufferViews", 1, "byteOffset", 48, "bufferViews[1] lies outside its buffer"},
      {"bufferViews", 1, "byteOffset", 49, "bufferViews[1] lies outside its buffer"},
      {"bufferViews", 1, "byteLength", -48, "bufferViews[1] lies outside its buffer"},
      {"accessors", 1, "byteOffset", 45, "accessors[1] (count 12) lies outside its bufferView"},
      {"accessors", 0, "count", -4, "accessors[0] (count 0) lies outside its bufferView"},
      {"bufferViews", 0, "byteOffset", 49, "bufferViews[0] lies outside its buffer"},
      {"bufferViews", 0, "byteStride", 4, "accessors[0] (count 4) lies outside its bufferView"},
      {"bufferViews", 0, "byteStride", 1, "byteStride is not a multiple of 4"},
      {"bufferViews", 0, "byteStride", -1, "byteStride is not a multiple of 4"},
      {"bufferViews", 0, "byteStride", -12, "accessors[0] (count 4) lies outside its bufferView"},
      {"accessors", 0, "count", 1, "accessors[0] (count 5) lies outside its bufferView"},
      {"accessors", 0, "count", -1, "names vertex 3 of 3"},
      {"accessors", 0, "byteOffset", 1, "accessors[0] (count 4) lies outside its bufferView"},
      {"accessors", 1, "count", 1, "accessors[1] (count 13) lies outside its bufferView"},
      {"accessors", 1, "count", -1, "has 11 corners, not a multiple of 3"},
      {"accessors", 1, "byteOffset", 1, "accessors[1] (count 12) lies outside its bufferView"},
  };
  for (const miss& m : all) {
    const std::string what =
        std::string(m.list) + "[" + std::to_string(m.i) + "]." + m.key + (m.by < 0 ? " " : " +") + std::to_string(m.by);
    expect_refused([&](tight_glb& f) { f.move(m.list, m.i, m.key, m.by); }, m.says, what.c_str());
  }
  // An accessor that begins at the very end of its view, and one that lies half a step beyond.
  expect_refused([](tight_glb& f) { f.move("accessors", 1, "byteOffset", 48); }, "lies outside its bufferView", "end");
  expect_refused([](tight_glb& f) { f.move("accessors", 1, "byteOffset", 49); }, "lies outside its bufferView", "past");
}

TEST(GltfBounds, LengthsOfTheContainerAreExact) {
  for (const std::int64_t by : {-4, -1, 1, 4}) {
    expect_refused([&](tight_glb& f) { f.total_off_by = by; }, "byte 8 announces", "total length");
    expect_refused([&](tight_glb& f) { f.json_off_by = by; }, "byte ", "JSON chunk");
    expect_refused([&](tight_glb& f) { f.bin_off_by = by; }, "byte ", "BIN chunk");
  }
}

TEST(GltfBounds, ChunksEndAtAMultipleOfFourBytes) {
  for (const std::size_t beyond : {1U, 2U, 3U}) {
    expect_refused([&](tight_glb& f) { f.json_beyond_words = beyond; }, "begins no JSON chunk that fits", "JSON");
    expect_refused([&](tight_glb& f) { f.bin += std::string(beyond, '\0'); }, "begins no BIN chunk that fits", "BIN");
  }
  expect_whole([](tight_glb& f) { f.json_beyond_words = 4; }, "four more");
}

/// The file with positions this far apart, and nothing between the last one and the view's end.
void set_stride(tight_glb& f, std::size_t stride) {
  std::string spaced = f.bin.substr(0, before_bytes + inner_bytes);
  for (std::size_t i = 0; i < 4; ++i) {
    spaced += f.bin.substr(before_bytes + inner_bytes + i * stride_bytes, 12);
    if (i < 3) spaced += std::string(stride - 12, '\x7f');
  }
  const std::size_t view_bytes = inner_bytes + 3 * stride + 12;
  f.bin = spaced + f.bin.substr(f.bin.size() - sizeof order);
  f.document["buffers"][0]["byteLength"] = f.bin.size();
  f.document["bufferViews"][0]["byteLength"] = view_bytes;
  f.document["bufferViews"][0]["byteStride"] = stride;
  f.document["bufferViews"][1]["byteOffset"] = before_bytes + view_bytes;
}

TEST(GltfBounds, StridesFromOneElementToTheLargest) {
  expect_whole([](tight_glb& f) { set_stride(f, 12); }, "stride 12");
  expect_whole([](tight_glb& f) { set_stride(f, 252); }, "stride 252");
  expect_refused([](tight_glb& f) { set_stride(f, 256); }, "is not a multiple of 4 up to 252", "stride 256");
  expect_whole(
      [](tight_glb& f) {
        set_stride(f, 12);
        f.document["bufferViews"][0].erase("byteStride");
      },
      "packed");
}

TEST(GltfBounds, OneElementThatFillsItsViewIsRead) {
  const auto one = read([](tight_glb& f) {
    f.move("accessors", 0, "byteOffset", 3 * stride_bytes);
    f.move("accessors", 0, "count", -3);
    f.move("accessors", 1, "count", -9);
    std::fill(f.bin.end() - sizeof order, f.bin.end(), '\0');
  });
  ASSERT_TRUE(one) << one.error().message;
  EXPECT_EQ(one->positions, (std::vector<vec3>{corners[3]}));
}

TEST(GltfBounds, AFileOfAHeaderAloneIsTooShort) {
  const scratch_folder folder;
  for (std::size_t size = 4; size < 28; ++size) {
    std::string bytes = tight_glb().bytes().substr(0, size);
    const auto length = static_cast<std::uint32_t>(size);
    if (size >= 12) std::memcpy(&bytes[8], &length, 4);
    const auto mesh = io::load_mesh(folder.file("t.glb", bytes));
    ASSERT_FALSE(mesh) << size;
    EXPECT_NE(mesh.error().message.find(size < 20 ? "fewer than the header" : "byte 12 begins no JSON chunk"),
              std::string::npos)
        << size << ": " << mesh.error().message;
  }
}

/// A step backwards reads what is there, and shows whose bytes they are.
TEST(GltfBounds, OffsetsThatAreOneStepShortReadOtherBytes) {
  const auto earlier = read([](tight_glb& f) { f.move("accessors", 0, "byteOffset", -4); });
  ASSERT_TRUE(earlier) << earlier.error().message;
  EXPECT_GT(earlier->positions[0].x, 1e38);
  const auto view = read([](tight_glb& f) { f.move("bufferViews", 0, "byteOffset", -4); });
  ASSERT_TRUE(view) << view.error().message;
  EXPECT_GT(view->positions[0].x, 1e38);
}

}  // namespace
}  // namespace asperity
