// Image files that claim to be huge, each in a process of its own under limits: what is not in the file takes no
// memory. Alone, and as the normal texture of a glTF material.
#include <array>
#include <cstdint>
#include <cstdio>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "attacks.hpp"
#include "probe_process.hpp"
#include "support/image_writers.hpp"
#include "support/png_image.hpp"
#include "unit/io/scratch_folder.hpp"

namespace asperity::hostile {
namespace {

using namespace test_support;

constexpr std::size_t times_the_file = 4;
constexpr std::size_t plus_bytes = std::size_t{16} << 20;

/// An entry of a little-endian TIFF's directory takes another value.
std::string with_tag(std::string tiff, std::uint16_t tag, std::uint32_t value) {
  const auto byte = [&](std::size_t at) { return static_cast<std::size_t>(static_cast<unsigned char>(tiff[at])); };
  const std::size_t start = byte(4) | byte(5) << 8 | byte(6) << 16;
  for (std::size_t at = start + 2; at + 12 <= tiff.size(); at += 12) {
    if ((byte(at) | byte(at + 1) << 8) != tag) continue;
    tiff[at + 2] = 4;  // a long number
    for (std::size_t i = 0; i < 4; ++i) tiff[at + 8 + i] = static_cast<char>(value >> 8 * i & 0xff);
    return tiff;
  }
  ADD_FAILURE() << "no tag " << tag;
  return tiff;
}

std::string with_window(std::string exr, const std::array<std::int32_t, 4>& window) {
  const std::string before = std::string("dataWindow\0box2i\0\x10\0\0\0", 21);
  const std::size_t at = exr.find(before);
  EXPECT_NE(at, std::string::npos);
  return exr.replace(at + before.size(), 16, reinterpret_cast<const char*>(window.data()), 16);
}

/// @param marker of the frame: 0xc0 baseline, 0xc2 progressive
std::string with_size(std::string jpeg, char marker, std::uint32_t width, std::uint32_t height) {
  const std::size_t at = jpeg.find(std::string("\xff") + marker);
  EXPECT_NE(at, std::string::npos);
  const std::string size{static_cast<char>(height >> 8), static_cast<char>(height), static_cast<char>(width >> 8),
                         static_cast<char>(width)};
  return jpeg.replace(at + 5, 4, size);
}

std::vector<std::pair<std::string, std::string>> huge_claims() {
  const std::string tiled = tiff_bytes({.bits = 8, .tile = 16}), strips = tiff_bytes({.bits = 8});
  const std::string exr = exr_bytes(8, 8, {"Y"}, std::vector<float>(64, 0.1F), 0);
  const std::string baseline = jpeg_bytes(16, 16, 90), progressive = jpeg_bytes(16, 16, 90, true);
  constexpr std::int32_t far = 0x7fffffff;
  return {
      {"most.png", png_image{16384, 4096, 8, 0, "x", {}}.bytes()},
      {"more.png", png_image{0x7fffffff, 20000, 16, 6, "x", {}}.bytes()},
      {"row.png", png_image{0x7fffffff, 1, 16, 6, "x", {}}.bytes()},
      {"most.tif", with_tag(with_tag(strips, 256, 16384), 257, 4096)},
      {"more.tif", with_tag(with_tag(strips, 256, 0xffffffff), 257, 0xffffffff)},
      {"tile.tif", with_tag(with_tag(tiled, 322, 60000), 323, 60000)},
      {"tile_wide.tif", with_tag(tiled, 322, 0x7ffffff0)},
      {"tile_high.tif", with_tag(tiled, 323, 0x7ffffff0)},
      {"strip_bytes.tif", with_tag(strips, 279, 0xffffff00)},
      {"most.exr", with_window(exr, {0, 0, 16383, 4095})},
      {"more.exr", with_window(exr, {-far, -far, far, far})},
      {"row.exr", with_window(exr, {0, 0, far - 1, 0})},
      {"column.exr", with_window(exr, {0, 0, 0, far - 1})},
      {"most.jpg", with_size(baseline, '\xc0', 16384, 1365)},
      {"more.jpg", with_size(baseline, '\xc0', 65500, 65500)},
      {"most_progressive.jpg", with_size(progressive, '\xc2', 16384, 1365)},
  };
}

void expect_refused(const char* how, const std::filesystem::path& file, std::size_t bytes) {
  const probe_outcome got = run_probe(how, file, {.address_space_bytes = std::size_t{256} << 20});
  std::printf("%-8s %-22s file %6zu B  peak %5.1f MB  CPU %5.2f s  %.120s\n", how, file.filename().c_str(), bytes,
              1e-6 * static_cast<double>(got.peak_bytes), got.cpu_s, got.said.c_str());
  EXPECT_EQ(got.signal, 0) << file;
  EXPECT_LE(got.peak_bytes, times_the_file * bytes + plus_bytes) << file;
  EXPECT_NE(got.said, "loaded") << file;
  EXPECT_NE(got.said.find("; "), std::string::npos) << got.said;
  EXPECT_EQ(got.said.find("memory"), std::string::npos) << file << " was believed: " << got.said;
}

TEST(ImageMemory, ClaimsOfHugeSizesCostNothing) {
  const scratch_folder folder;
  for (const auto& [name, bytes] : huge_claims()) expect_refused("image", folder.file(name, bytes), bytes.size());
}

// A file that stays small and is what it says: the same limits let it through.
TEST(ImageMemory, AnHonestImageLoadsUnderTheSameLimits) {
  const scratch_folder folder;
  for (const auto& [name, bytes] : std::vector<std::pair<std::string, std::string>>{
           {"good.png", compressed_png_bytes(64, 64, true)},
           {"good.tif", tiff_bytes({.bits = 32, .tile = 16})},
           {"good.exr", exr_bytes(8, 8, {"Y"}, std::vector<float>(64, 0.1F))},
           {"good.jpg", jpeg_bytes(16, 16, 90)}}) {
    const probe_outcome got =
        run_probe("image", folder.file(name, bytes), {.address_space_bytes = std::size_t{256} << 20});
    EXPECT_EQ(got.said, "loaded") << name;
    EXPECT_LE(got.peak_bytes, plus_bytes) << name;
  }
}

/// A tetrahedron whose material has this image as its normal texture, inside the file.
std::string asset_with(const std::string& image) {
  nlohmann::json document = tetrahedron();
  std::string bin = tetrahedron_bytes();
  document["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", bin.size()}, {"byteLength", image.size()}});
  bin += image;
  document["buffers"][0]["byteLength"] = bin.size();
  document["images"] = {{{"bufferView", document["bufferViews"].size() - 1}, {"mimeType", "image/png"}}};
  document["textures"] = {{{"source", 0}}};
  document["materials"] = {{{"normalTexture", {{"index", 0}}}}};
  document["meshes"][0]["primitives"][0]["material"] = 0;
  return glb(document, bin);
}

TEST(ImageMemory, AMaterialWithAHostileImageIsRefusedWithItsName) {
  const scratch_folder folder;
  auto images = huge_claims();
  const std::string good = compressed_png_bytes(64, 64, false);
  images.emplace_back("cut_off.png", good.substr(0, good.size() / 2));
  images.emplace_back("text.png", "<html>not an image</html>");
  for (const auto& [name, image] : images) {
    const std::string bytes = asset_with(image);
    const auto file = folder.file(name + ".glb", bytes);
    expect_refused("material", file, bytes.size());
    EXPECT_NE(run_probe("material", file, {}).said.find("images[0]"), std::string::npos) << name;
  }
  EXPECT_EQ(
      run_probe("material", folder.file("good.glb", asset_with(png_image{1, 1, 8, 2, "\x80\x80\xff", {}}.bytes())), {})
          .said,
      "loaded");
}

}  // namespace
}  // namespace asperity::hostile
