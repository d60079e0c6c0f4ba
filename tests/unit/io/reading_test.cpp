// Reading as a piece of work: it can be cancelled, asks often enough whether it is wanted, and takes time in proportion
// to the file.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <ctime>
#include <functional>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "asperity/io/image_file.hpp"
#include "asperity/io/material_file.hpp"
#include "asperity/io/mesh_file.hpp"
#include "asperity/io/textured_model_file.hpp"
#include "scratch_folder.hpp"
#include "support/byte_strings.hpp"
#include "support/image_writers.hpp"
#include "support/small_models.hpp"

namespace asperity {
namespace {

using test_support::put;
using test_support::repeated;
using test_support::scratch_folder;
using go_on = std::function<bool()>;

std::string ply(const std::string& format, const std::string& type, std::size_t vertices, std::size_t faces,
                const std::string& more = "") {
  return "ply\nformat " + format + " 1.0\n" + more + "element vertex " + std::to_string(vertices) + "\nproperty " +
         type + " x\nproperty " + type + " y\nproperty " + type + " z\nelement face " + std::to_string(faces) +
         "\nproperty list uchar uint vertex_indices\nend_header\n";
}

std::string binary_ply(std::size_t n) {
  std::string out = ply("binary_little_endian", "float", n, n);
  for (std::size_t i = 0; i < n; ++i) {
    for (const std::size_t x : {i % 1000, i / 1000, i % 7}) put(out, static_cast<float>(x));
  }
  for (std::size_t i = 0; i < n; ++i) {
    out += '\3';
    for (const std::size_t v : {i, (i + 1) % n, (i + 2) % n}) put(out, static_cast<std::uint32_t>(v));
  }
  return out;
}

/// Positions that the table of an earlier welding put into one slot, all of them: there they took quadratic time.
std::string colliding_ply(std::size_t n) {
  constexpr std::uint64_t k = 0x9e3779b97f4a7c15U;
  std::uint64_t inverse = k;  // of k modulo 2^64, by Newton's method
  for (int i = 0; i < 6; ++i) inverse *= 2 - k * inverse;
  const auto step = [](std::uint64_t h, double x) {
    h = (h ^ std::bit_cast<std::uint64_t>(x)) * k;
    return h ^ h >> 32U;
  };
  const std::uint64_t target = step(step(step(0, 1.0), 2.0), 3.0);
  const std::uint64_t before = (target ^ target >> 32U) * inverse;
  std::string positions;
  std::size_t made = 0;
  for (double x = 1.0; made < n; x += 1e-9) {
    const auto z = std::bit_cast<double>(before ^ step(step(0, x), 0.5));
    if (!std::isfinite(z)) continue;
    for (const double c : {x, 0.5, z}) put(positions, c);
    ++made;
  }
  std::string out = ply("binary_little_endian", "double", n, n / 3) + positions;
  for (std::size_t i = 0; i + 2 < n; i += 3) {
    out += '\3';
    for (const std::size_t v : {i, i + 1, i + 2}) put(out, static_cast<std::uint32_t>(v));
  }
  return out;
}

std::string obj_grid(std::size_t n) {
  std::string out;
  for (std::size_t i = 0; i < n; ++i) out += "v " + std::to_string(i % 300) + " " + std::to_string(i / 300) + " 0\n";
  for (std::size_t i = 3; i <= n; ++i) out += "f -1 -2 " + std::to_string(i) + "\n";
  return out;
}

std::string stl_text(std::size_t n) {
  return "solid a\n" +
         repeated("facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n", n) +
         "endsolid a\n";
}

std::string gltf_text(std::size_t n) {
  std::string nodes = "{}";
  for (std::size_t i = 1; i < n; ++i) nodes += R"(,{"children":[)" + std::to_string(i - 1) + "]}";
  return R"({"asset":{"version":"2.0"},"nodes":[)" + nodes + R"(],"scenes":[{"nodes":[)" + std::to_string(n - 1) +
         "]}]}";
}

struct growing_file {
  const char* name;  // its extension chooses the reader
  std::function<std::string(std::size_t)> of_size;
  std::size_t few;
};

std::vector<growing_file> growing_files() {
  const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  return {
      {"binary.ply", binary_ply, 20'000},
      {"colliding.ply", colliding_ply, 8'000},
      {"ascii.ply",
       [](std::size_t n) { return ply("ascii", "float", 3, n) + "0 0 0\n1 0 0\n0 1 0\n" + repeated("3 0 1 2\n", n); },
       30'000},
      {"comments.ply",
       [](std::size_t n) {
         return ply("ascii", "float", 3, 1, repeated("comment x\n", n)) + "0 0 0 1 0 0 0 1 0 3 0 1 2";
       },
       50'000},
      {"lists.ply",
       [](std::size_t n) {
         return ply("binary_little_endian", "float", 0, 0,
                    "element other " + std::to_string(n) +
                        "\nproperty list uchar uchar a\nproperty list uchar uchar b\n") +
                repeated(std::string("\x02xy\0", 4), n);
       },
       100'000},
      {"grid.obj", obj_grid, 10'000},
      {"comments.obj", [three](std::size_t n) { return three + repeated("# x\n", n) + "f 1 2 3\n"; }, 100'000},
      {"continued.obj", [three](std::size_t n) { return three + "f 1 2 " + repeated("\\\n", n) + "3\n"; }, 100'000},
      {"one_line.obj", [three](std::size_t n) { return three + "# " + std::string(n, 'x') + "\nf 1 2 3\n"; },
       4'000'000},
      {"uvs.obj", [three](std::size_t n) { return three + repeated("vt 0 0\n", n) + "f 1/1 2/2 3/-1\n"; }, 50'000},
      {"text.stl", stl_text, 4'000},
      {"nodes.gltf", gltf_text, 4'000},
      {"names.gltf",
       [](std::size_t n) {
         std::string keys = R"({"asset":{"version":"2.0"})";
         for (std::size_t i = 0; i < n; ++i) keys += R"(,"k)" + std::to_string(i) + R"(":0)";
         return keys + "}";
       },
       8'000},
  };
}

/// Lesser processor time of two.
double cpu_s(const std::function<void()>& work) {
  double least = 1e9;
  for (int k = 0; k < 2; ++k) {
    const std::clock_t start = std::clock();
    work();
    least = std::min(least, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  }
  return least;
}

// Four times the file takes about four times the time; 16 times would be quadratic.
TEST(Reading, TakesTimeInProportionToTheFile) {
  const scratch_folder folder;
  for (const growing_file& f : growing_files()) {
    const auto few = folder.file(std::string("few_") + f.name, f.of_size(f.few));
    const auto many = folder.file(std::string("many_") + f.name, f.of_size(4 * f.few));
    std::string said;
    const double few_s = cpu_s([&] { (void)io::load_mesh(few).has_value(); });
    const double many_s = cpu_s([&] {
      const auto mesh = io::load_mesh(many);
      said = mesh ? "read" : mesh.error().message;
    });
    std::printf("%-15s %8.3f MB %7.4f s, four times that %7.4f s: %.60s\n", f.name,
                1e-6 * static_cast<double>(std::filesystem::file_size(few)), few_s, many_s, said.c_str());
    EXPECT_LT(many_s, 9.0 * few_s + 0.003) << f.name;
  }
}

struct kind_of_file {
  std::string name;
  std::string bytes;
  std::function<std::optional<error>(const std::filesystem::path&, const go_on&)> read;
};

template <class T>
std::optional<error> error_of(const result<T>& got) {
  return got ? std::nullopt : std::optional(got.error());
}

std::vector<kind_of_file> long_files(const scratch_folder& folder) {
  const auto mesh = [](const std::filesystem::path& f, const go_on& g) { return error_of(io::load_mesh(f, g)); };
  const auto image = [](const std::filesystem::path& f, const go_on& g) { return error_of(io::load_image(f, g)); };
  const auto model = [](const std::filesystem::path& f, const go_on& g) {
    return error_of(io::load_textured_model(f, g));
  };
  const auto material = [](const std::filesystem::path& f, const go_on& g) {
    return error_of(io::load_normal_texture(f, g));
  };
  const auto box = test_support::make_textured_box({0.01, 0.01, 0.01}, 256, test_support::ridges(1e-4, 4e-3));
  EXPECT_TRUE(io::save_textured_model(box, folder.file("m.glb")));
  std::vector<kind_of_file> out{
      {"a.ply", binary_ply(20'000), mesh},
      {"b.ply", ply("ascii", "float", 3, 100'000) + "0 0 0 1 0 0 0 1 0\n" + repeated("3 0 1 2\n", 100'000), mesh},
      {"a.obj", obj_grid(10'000), mesh},
      {"word.obj", "v 0 0 0\n# " + std::string(3'000'000, 'x'), mesh},
      {"a.stl", stl_text(6'000), mesh},
      {"a.gltf", R"({"asset":{"version":"2.0"},"x":")" + std::string(3'000'000, 'x') + "\"}", mesh},
      {"b.gltf", R"({"asset":{"version":"2.0"},"x":")" + std::string(3'000'000, 'x') + "\"}", material},
      {"m.glb", test_support::read_all(folder.file("m.glb")), model},
      {"a.png", test_support::flat_png_bytes(2048, 1024, true), image},
      {"strips.tif", test_support::tiff_bytes({.width = 512, .height = 512, .compression = 8}), image},
      {"tiles.tif", test_support::tiff_bytes({.width = 512, .height = 512, .compression = 5, .tile = 64}), image},
      {"a.exr", test_support::exr_bytes(512, 512, {"Y"}, std::vector<float>(1U << 18, 0.5F)), image},
      {"a.jpg", test_support::jpeg_bytes(512, 1024, 90), image},
      {"progressive.jpg", test_support::jpeg_bytes(512, 1024, 90, true), image},
  };
  return out;
}

// What the reading itself has spent of a processor, however many others share it.
double spent_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Asked at most so far apart, whatever the file: a person's wish to stop is heard after half a second of work.
TEST(Reading, AsksOftenWhetherItIsWantedAndEndsWhereItIsNot) {
  const scratch_folder folder;
  for (const kind_of_file& f : long_files(folder)) {
    const auto file = folder.file(f.name, f.bytes);
    std::size_t asked = 0;
    double longest_s = 0.0;
    double last = spent_s();
    const auto note = [&] {
      const double now = spent_s();
      longest_s = std::max(longest_s, now - last);
      last = now;
      ++asked;
      return true;
    };
    const auto whole = f.read(file, note);
    (void)note();
    const std::size_t all = asked;
    std::printf("%-16s asked %6zu times, at most %5.3f s apart: %.50s\n", f.name.c_str(), all, longest_s,
                whole ? whole->message.c_str() : "read");
    EXPECT_LT(longest_s, 0.5) << f.name;
    ASSERT_GE(all, 3U) << f.name;
    // Early, in the middle and near the end.
    for (const std::size_t stop_at : {std::size_t{1}, all / 2, all - 1}) {
      asked = 0;
      const auto ended = f.read(file, [&] { return ++asked < stop_at; });
      ASSERT_TRUE(ended) << f.name << " goes on after " << stop_at << " of " << all;
      EXPECT_EQ(ended->code, error_code::cancelled) << ended->message;
      EXPECT_EQ(ended->message.rfind(file.string() + ": ", 0), 0U) << ended->message;
      EXPECT_LE(asked, stop_at + 3) << f.name << " asks on after it was told to end";
    }
  }
}

}  // namespace
}  // namespace asperity
