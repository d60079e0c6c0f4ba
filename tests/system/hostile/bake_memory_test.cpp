// What a bake of a huge mesh, or of one that claims to be huge, costs in memory: each in a process of its own.
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <gtest/gtest.h>
#include <numbers>
#include <string>
#include <vector>

#include "probe_process.hpp"
#include "unit/io/scratch_folder.hpp"

namespace asperity::hostile {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t times_the_file = 4;
constexpr std::size_t plus_bytes = std::size_t{16} << 20;

std::string ply_header(const char* format, const std::string& vertices, const std::string& faces) {
  return std::string("ply\nformat ") + format + " 1.0\nelement vertex " + vertices +
         "\nproperty float x\nproperty float y\nproperty float z\nelement face " + faces +
         "\nproperty list uchar uint vertex_indices\nend_header\n";
}

// A torus of 2 * around * across triangles, written piece by piece.
void write_torus(const fs::path& file, std::uint32_t around, std::uint32_t across) {
  std::ofstream out(file, std::ios::binary);
  const std::uint64_t vertices = std::uint64_t{around} * across;
  out << ply_header("binary_little_endian", std::to_string(vertices), std::to_string(2 * vertices));
  const auto put = [&](const auto& value) { out.write(reinterpret_cast<const char*>(&value), sizeof value); };
  for (std::uint32_t i = 0; i < around; ++i)
    for (std::uint32_t j = 0; j < across; ++j) {
      const double u = 2 * std::numbers::pi * i / around, v = 2 * std::numbers::pi * j / across;
      const double r = 0.05 + 0.02 * std::cos(v);
      put(std::array{static_cast<float>(r * std::cos(u)), static_cast<float>(r * std::sin(u)),
                     static_cast<float>(0.02 * std::sin(v))});
    }
  const auto at = [&](std::uint32_t i, std::uint32_t j) { return i % around * across + j % across; };
  for (std::uint32_t i = 0; i < around; ++i)
    for (std::uint32_t j = 0; j < across; ++j) {
      out.put('\3');
      put(std::array{at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      out.put('\3');
      put(std::array{at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
}

void print(const char* what, std::size_t bytes, const probe_outcome& got) {
  std::printf("bake %-30s file %9zu B  peak %7.1f MB  CPU %5.2f s  %s\n", what, bytes,
              1e-6 * static_cast<double>(got.peak_bytes), got.cpu_s, got.said.c_str());
}

TEST(BakeMemory, ClaimsOfHugeCountsCostNothing) {
  const test_support::scratch_folder folder;
  const std::string stl_claim = std::string(80, ' ') + std::string(4, '\xff') + std::string(1000, '\0');
  const std::string few(1000, '\0');
  const std::vector<std::pair<const char*, std::string>> files{
      {"vertices.ply", ply_header("binary_little_endian", "4000000000", "4") + few},
      {"faces.ply", ply_header("binary_little_endian", "4", "4000000000") + few},
      {"2_to_64.ply", ply_header("binary_little_endian", "18446744073709551615", "18446744073709551615") + few},
      {"ascii.ply", ply_header("ascii", "4000000000", "4000000000") + "0 0 0\n"},
      {"claim.stl", stl_claim},
      {"index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4000000000\n"},
      {"minus.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -1 -2 -9223372036854775808\n"},
  };
  for (const auto& [name, bytes] : files) {
    const fs::path file = folder.file(name, bytes);
    const probe_outcome got = run_probe("bake", file, {.address_space_bytes = std::size_t{256} << 20});
    print(name, bytes.size(), got);
    EXPECT_EQ(got.signal, 0) << name;
    EXPECT_LE(got.peak_bytes, times_the_file * bytes.size() + plus_bytes) << name;
    EXPECT_NE(got.said, "loaded") << name;
    EXPECT_NE(got.said.find("; "), std::string::npos) << got.said;
    EXPECT_EQ(got.said.find("memory"), std::string::npos) << name << " was believed: " << got.said;
  }
}

TEST(BakeMemory, TenMillionTrianglesAreRefusedWithinFourTimesTheFile) {
  const test_support::scratch_folder folder;
  const fs::path file = folder.file("big.ply");
  write_torus(file, 5000, 1000);
  const std::size_t bytes = fs::file_size(file);
  const probe_outcome got = run_probe("bake", file, {.cpu_s = 60});
  print("10 million triangles", bytes, got);
  EXPECT_NE(got.said.find("10000000 triangles, more than the 8000000"), std::string::npos) << got.said;
  EXPECT_NE(got.said.find("; decimate"), std::string::npos) << got.said;
  EXPECT_LE(got.peak_bytes, times_the_file * bytes + plus_bytes);
}

// What the system counts; memory_count holds what the allocator is asked for to 160.
TEST(BakeMemory, AWholeBakeTakesABoundedNumberOfBytesPerTriangle) {
  const test_support::scratch_folder folder;
  const fs::path file = folder.file("big.ply");
  write_torus(file, 400, 125);
  const probe_outcome got = run_probe("bake", file, {.cpu_s = 60});
  print("100,000 triangles to the end", fs::file_size(file), got);
  EXPECT_EQ(got.said, "loaded");
  EXPECT_LE(got.peak_bytes, std::size_t{100'000} * 200 + plus_bytes);
}

}  // namespace
}  // namespace asperity::hostile
