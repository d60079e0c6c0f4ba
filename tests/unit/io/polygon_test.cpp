// Polygons of many corners: split without folding over, in a time that grows with their corners, or refused.
#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <gtest/gtest.h>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "asperity/io/mesh_file.hpp"
#include "scratch_folder.hpp"

namespace asperity {
namespace {

using outline = std::vector<vec2>;

std::string obj_of(const outline& polygon, int copies = 1) {
  std::string text;
  std::string face = "f";
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    text += "v " + std::to_string(polygon[i].x) + " " + std::to_string(polygon[i].y) + " 0\n";
    face += " " + std::to_string(i + 1);
  }
  for (int k = 0; k < copies; ++k) text += face + "\n";
  return text;
}

double area2(const vec3& a, const vec3& b, const vec3& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Every triangle turns as the polygon does and their areas sum up to its own: nothing folds over or is left out.
void expect_split(const outline& given, const char* what) {
  const test_support::scratch_folder folder;
  const auto mesh = io::load_mesh(folder.file("p.obj", obj_of(given)));
  ASSERT_TRUE(mesh) << what << ": " << mesh.error().message;
  ASSERT_EQ(mesh->positions.size(), given.size()) << what;
  EXPECT_EQ(mesh->triangles.size(), given.size() - 2) << what;
  double whole = 0.0;
  for (std::size_t i = 0; i < given.size(); ++i) {
    const vec3& p = mesh->positions[i];
    const vec3& q = mesh->positions[(i + 1) % given.size()];
    whole += p.x * q.y - p.y * q.x;
  }
  double parts = 0.0;
  for (const auto& t : mesh->triangles) {
    const double a = area2(mesh->positions[t[0]], mesh->positions[t[1]], mesh->positions[t[2]]);
    parts += a;
    EXPECT_GE(a * whole, -1e-9 * whole * whole) << what << " folds over";
  }
  EXPECT_NEAR(parts, whole, 1e-9 * std::fabs(whole)) << what;
}

outline comb(int teeth) {
  outline out;
  for (int i = 0; i < teeth; ++i) out.insert(out.end(), {{1.0 * i, 0.0}, {i + 0.5, 1.0}});
  out.insert(out.end(), {{1.0 * teeth, 9.0}, {0.0, 9.0}});
  return out;
}

outline gear(int corners) {
  outline out;
  for (int i = 0; i < corners; ++i) {
    const double a = 2.0 * std::numbers::pi * i / corners;
    const double r = i / 2 % 2 == 0 ? 1.0 : 1.1;
    out.emplace_back(100.0 * r * std::cos(a), 100.0 * r * std::sin(a));
  }
  return out;
}

/// An arm of this many corners on either side, wound about the origin.
outline spiral(int corners, double turns) {
  outline out;
  const auto at = [&](int i, double out_by) {
    const double t = static_cast<double>(i) / corners;
    const double a = 2.0 * std::numbers::pi * turns * t;
    return vec2(std::cos(a), std::sin(a)) * (100.0 * t + 10.0 + out_by);
  };
  for (int i = 0; i < corners; ++i) out.push_back(at(i, 0.0));
  for (int i = corners; i-- > 0;) out.push_back(at(i, 30.0 / turns));
  return out;
}

TEST(Polygon, IsSplitWithoutFoldingOver) {
  for (const int n : {5, 16, 17, 18, 100, 2000}) expect_split(comb(n), "comb");
  for (const int n : {8, 12, 20, 1000, 65'536}) expect_split(gear(n), "gear");
  for (const int n : {6, 10, 40, 150}) expect_split(spiral(n, n / 30.0 + 0.5), "spiral");
  std::mt19937_64 bits(5);
  std::uniform_real_distribution<double> radius(1.0, 50.0);
  for (int k = 0; k < 30; ++k) {  // stars about the origin: any radii make a simple polygon
    const int n = 4 + static_cast<int>(bits() % (k % 20 == 0 ? 3000 : 40));
    outline star;
    for (int i = 0; i < n; ++i) {
      const double a = 2.0 * std::numbers::pi * i / n;
      star.push_back(radius(bits) * vec2(std::cos(a), std::sin(a)));
    }
    if (k % 2 == 1) std::reverse(star.begin(), star.end());
    expect_split(star, "star");
  }
}

// A square with a square hole, as exporters write it: one outline that goes in and out along a bridge.
TEST(Polygon, WithAHoleOnABridgeIsSplit) {
  outline out;
  const auto side = [&](vec2 from, vec2 to, int parts) {
    for (int i = 0; i < parts; ++i) out.push_back(glm::mix(from, to, static_cast<double>(i) / parts));
  };
  for (const int parts : {1, 8, 64}) {
    out.clear();
    const std::array<vec2, 5> outer{{{0, 0}, {16, 0}, {16, 16}, {0, 16}, {0, 0}}};
    const std::array<vec2, 5> inner{{{4, 4}, {4, 8}, {8, 8}, {8, 4}, {4, 4}}};
    for (std::size_t i = 0; i < 4; ++i) side(outer[i], outer[i + 1], parts);
    out.push_back(outer[4]);
    for (std::size_t i = 0; i < 4; ++i) side(inner[i], inner[i + 1], parts);
    out.push_back(inner[4]);
    const test_support::scratch_folder folder;
    const auto mesh = io::load_mesh(folder.file("p.obj", obj_of(out)));
    ASSERT_TRUE(mesh) << mesh.error().message;
    double sum = 0.0;
    for (const auto& t : mesh->triangles) {
      const double a = area2(mesh->positions[t[0]], mesh->positions[t[1]], mesh->positions[t[2]]);
      EXPECT_GE(a, 0.0);
      sum += a;
    }
    EXPECT_NEAR(0.5 * sum, 256.0 - 16.0, 1e-9) << parts;
  }
}

/// Processor time of reading a file, the lesser of two, and whether it could be read.
std::pair<double, bool> cpu_of(const std::string& text) {
  const test_support::scratch_folder folder;
  const auto file = folder.file("p.obj", text);
  double least = 1e9;
  bool good = true;
  for (int k = 0; k < 4; ++k) {
    const std::clock_t start = std::clock();
    const auto mesh = io::load_mesh(file);
    least = std::min(least, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
    good = mesh.has_value();
    if (!good) {
      EXPECT_NE(mesh.error().message.find("winds too much to be split; triangulate"), std::string::npos)
          << mesh.error().message;
    }
  }
  return {least, good};
}

outline tangle(int corners, unsigned seed) {
  std::mt19937_64 bits(seed);
  std::uniform_real_distribution<double> anywhere(0.0, 1000.0);
  outline out;
  for (int i = 0; i < corners; ++i) out.emplace_back(anywhere(bits), anywhere(bits));
  return out;
}

// Four times the corners take about four times as long, whatever the shape: 16 times would be quadratic. What runs beside
// it shares its caches, so the least of four counts.
TEST(Polygon, TakesTimeInProportionToItsCornersOrIsRefused) {
  for (const auto& [what, shape] : std::vector<std::pair<const char*, outline (*)(int)>>{
           {"gear", gear},
           {"comb", [](int n) { return comb(n / 2); }},
           {"spiral", [](int n) { return spiral(n / 2, 40.0); }},
           {"spiral of ever more turns", [](int n) { return spiral(n / 2, n / 100.0); }},
           {"tangle", [](int n) { return tangle(n, 3); }}}) {
    const auto [few_s, few_good] = cpu_of(obj_of(shape(3'000)));
    const auto [many_s, many_good] = cpu_of(obj_of(shape(12'000)));
    std::printf("%-28s 3,000 corners %7.4f s (%s), 12,000 corners %7.4f s (%s)\n", what, few_s,
                few_good ? "split" : "refused", many_s, many_good ? "split" : "refused");
    EXPECT_LT(many_s, 11.0 * few_s + 0.003) << what;
  }
  // Small ones are never refused; many of them cost what their corners do.
  for (const int corners : {5, 16}) {
    const auto [few_s, few_good] = cpu_of(obj_of(tangle(corners, 1), 1'000));
    const auto [many_s, many_good] = cpu_of(obj_of(tangle(corners, 1), 4'000));
    EXPECT_TRUE(few_good && many_good);
    EXPECT_LT(many_s, 11.0 * few_s + 0.003) << corners;
  }
}

}  // namespace
}  // namespace asperity
