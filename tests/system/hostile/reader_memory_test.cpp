// What reading takes in memory, each file in a process of its own: at most four times the file and 512 MiB, as
// load_mesh() and load_image() promise, or a refusal that costs next to nothing.
#include <array>
#include <cstdint>
#include <cstdio>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "asperity/device/device_recording.hpp"
#include "attacks.hpp"
#include "probe_process.hpp"
#include "support/byte_strings.hpp"
#include "support/image_writers.hpp"
#include "unit/io/scratch_folder.hpp"

namespace asperity::hostile {
namespace {

constexpr std::size_t times_the_file = 4;
constexpr std::size_t plus_bytes = std::size_t{512} << 20;
constexpr std::size_t refusal_bytes = std::size_t{16} << 20;

using test_support::put;
using test_support::repeated;

std::string ply_header(const char* coordinate, const char* count, const char* index, std::size_t vertices,
                       std::size_t faces) {
  return std::string("ply\nformat binary_little_endian 1.0\nelement vertex ") + std::to_string(vertices) +
         "\nproperty " + coordinate + " x\nproperty " + coordinate + " y\nproperty " + coordinate +
         " z\nelement face " + std::to_string(faces) + "\nproperty list " + count + " " + index +
         " vertex_indices\nend_header\n";
}

const std::string four_vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";

std::string one_polygon_ply(std::uint32_t corners) {
  std::string out = ply_header("uchar", "uint", "uint", 4, 1) + std::string("\0\0\0\1\0\0\0\1\0\0\0\1", 12);
  put(out, corners);
  for (std::uint32_t i = 0; i < corners; ++i) put(out, i % 4);
  return out;
}

/// Four bytes a triangle, and twelve of coordinates.
std::string smallest_triangles_ply(std::size_t n) {
  return ply_header("uchar", "uchar", "uchar", 4, n) + std::string("\0\0\0\1\0\0\0\1\0\0\0\1", 12) +
         repeated(std::string("\3\0\1\2", 4), n);
}

/// Three bytes a vertex.
std::string smallest_vertices_ply(std::size_t n) {
  std::string out = ply_header("uchar", "uchar", "uchar", n, 1);
  for (std::size_t i = 0; i < n; ++i)
    out += {static_cast<char>(i), static_cast<char>(i >> 8), static_cast<char>(i >> 16)};
  return out + std::string("\3\0\1\2", 4);
}

std::string stl(std::uint32_t facets) {
  std::string out(80, ' ');
  put(out, facets);
  for (std::uint32_t i = 0; i < facets; ++i) {
    for (const std::uint32_t x : {0U, 0U, 1U, i, 0U, 0U, 0U, i, 0U, 0U, 0U, i}) put(out, static_cast<float>(x));
    out += std::string(2, '\0');
  }
  return out;
}

struct large_file {
  const char* name;
  const char* how;
  std::string bytes;
  const char* says;  // part of the refusal; "loaded" where it is read
};

void expect_bounded(const large_file& f) {
  const test_support::scratch_folder folder;
  const auto file = folder.file(f.name, f.bytes);
  const probe_outcome got = run_probe(f.how, file, {.cpu_s = 60});
  std::printf("%-6s %-22s file %9zu B  peak %6.1f MB  CPU %5.2f s  %.90s\n", f.how, f.name, f.bytes.size(),
              1e-6 * static_cast<double>(got.peak_bytes), got.cpu_s,
              got.said.substr(got.said.find(": ") == std::string::npos ? 0 : got.said.find(": ") + 2).c_str());
  EXPECT_EQ(got.signal, 0) << f.name;
  EXPECT_NE(got.said.find(f.says), std::string::npos) << f.name << ": " << got.said;
  // Refused before it is read: the file itself is all that was taken.
  const bool loads = std::string(f.says) == "loaded";
  EXPECT_LE(got.peak_bytes, loads ? times_the_file * f.bytes.size() + plus_bytes : f.bytes.size() + refusal_bytes)
      << f.name;
}

TEST(ReaderMemory, OnePolygonOfSevenMillionCornersIsRefusedAndCostsItsFile) {
  const char* says = "more than the 65536 that a polygon may have; triangulate";
  expect_bounded({"one.ply", "mesh", one_polygon_ply(7'000'000), says});
  expect_bounded({"one.obj", "mesh", four_vertices + "f" + repeated(" 1 2 3 4", 3'500'000) + "\n", says});
  expect_bounded({"continued.obj", "mesh", four_vertices + "f" + repeated(" \\\n1", 5'000'000) + "\n", says});
}

TEST(ReaderMemory, CountsBeyondTheLimitsAreRefused) {
  expect_bounded({"triangles.ply", "mesh", smallest_triangles_ply(8'000'001), "has 8000001 triangles, more than"});
  expect_bounded({"vertices.ply", "mesh", smallest_vertices_ply(16'000'001), "has 16000001 vertices, more than"});
}

TEST(ReaderMemory, ASmallFileOfALargeImage) {
  for (const std::uint32_t side : {2048U, 11'500U}) {
    const std::string png = test_support::flat_png_bytes(side, side, false);
    expect_bounded({"flat.png", "image", png, side > 8192 ? "more than the limit of 16384 a side" : "loaded"});
  }
  expect_bounded({"tall.png", "image", test_support::flat_png_bytes(2048, 2048, true), "loaded"});
}

/// A recording of nothing but calls of open(), three bytes each, as the encoder writes it.
std::string opened_again_and_again(std::size_t calls) {
  recording_encoder e;
  std::string out = e.begin({}, device_state::present);
  for (std::size_t i = 0; i < calls; ++i) out += e.call({.call = device_call::open});
  return out + e.end();
}

TEST(ReaderMemory, DISABLED_ARecordingOfShortCallsIsRefusedBeforeItFillsTheMemory) {
  const test_support::scratch_folder folder;
  const std::string bytes = opened_again_and_again(8'000'000);
  const probe_outcome got = run_probe("recording", folder.file("o.dev", bytes), {.cpu_s = 60});
  std::printf("recording of 8 million calls: file %zu B, peak %.1f MB, %s\n", bytes.size(),
              1e-6 * static_cast<double>(got.peak_bytes), got.said.c_str());
  EXPECT_NE(got.said.find("so many calls in so few bytes"), std::string::npos) << got.said;
  // Its calls take four times the file and the constant at most, beside the file itself.
  EXPECT_LE(got.peak_bytes, (times_the_file + 1) * bytes.size() + plus_bytes + refusal_bytes);
}

// The largest of every kind: minutes and gigabytes, for a nightly run.
TEST(ReaderMemory, DISABLED_TheLargestOfEveryFormat) {
  expect_bounded({"triangles.ply", "mesh", smallest_triangles_ply(8'000'000), "loaded"});
  expect_bounded({"vertices.ply", "mesh", smallest_vertices_ply(16'000'000), "loaded"});
  expect_bounded({"triangles.stl", "mesh", stl(8'000'000), "loaded"});
  expect_bounded({"uvs.obj", "mesh", four_vertices + "vt 0\n" + repeated("f 1/1 2/1 3/1\n", 8'000'000), "loaded"});
  expect_bounded(
      {"more_uvs.obj", "mesh", four_vertices + repeated("vt 0\n", 24'000'000) + "f 1/1 2/1 3/1\n", "loaded"});
  expect_bounded({"flat.png", "image", test_support::flat_png_bytes(8192, 8192, false), "loaded"});
  expect_bounded({"deep.png", "image", test_support::flat_png_bytes(8192, 8192, true), "loaded"});
  expect_bounded({"interlaced.png", "image", test_support::flat_png_bytes(8192, 8192, true, true), "loaded"});
  expect_bounded({"grey.jpg", "image", test_support::jpeg_bytes(8192, 8192, 60, true, true), "loaded"});
  expect_bounded({"colour.jpg", "image", test_support::jpeg_bytes(5461, 4096, 60, true), "loaded"});
  expect_bounded(
      {"f.exr", "image", test_support::exr_bytes(8192, 8192, {"Y"}, std::vector<float>(1U << 26, 0.5F), 1), "loaded"});
  expect_bounded(
      {"strips.tif", "image", test_support::tiff_bytes({.width = 8192, .height = 8192, .compression = 8}), "loaded"});
  nlohmann::json document = tetrahedron();
  document["buffers"][0]["uri"] = "data:application/octet-stream;base64," + std::string(std::size_t{127} << 20, 'A');
  expect_bounded({"text.gltf", "mesh", document.dump(), "loaded"});
}

}  // namespace
}  // namespace asperity::hostile
