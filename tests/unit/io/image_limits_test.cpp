// Which codecs and layouts of images are read, and that every other is refused in one line.
#include <ImfChannelList.h>
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineOutputFile.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfPartType.h>
#include <ImfTiledOutputFile.h>
#include <array>
#include <csetjmp>
#include <cstring>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "asperity/io/image_file.hpp"
#include "scratch_folder.hpp"
#include "support/image_writers.hpp"
#include "support/png_image.hpp"

namespace asperity {
namespace {

using test_support::scratch_folder;
using test_support::tiff_bytes;

void expect_unsupported(const std::string& name, const std::string& bytes, const std::string& says) {
  const scratch_folder folder;
  const auto image = io::load_image(folder.file(name, bytes));
  ASSERT_FALSE(image) << name << " is read";
  EXPECT_EQ(image.error().code, error_code::unsupported) << image.error().message;
  EXPECT_NE(image.error().message.find(says), std::string::npos) << image.error().message << "\nlacks: " << says;
  EXPECT_NE(image.error().message.find("; export "), std::string::npos) << image.error().message;
}

map_image expect_read(const std::string& name, const std::string& bytes) {
  const scratch_folder folder;
  const auto image = io::load_image(folder.file(name, bytes));
  EXPECT_TRUE(image) << name << ": " << image.error().message;
  return image ? *image : map_image{};
}

std::string with_tag(std::string tiff, std::uint16_t tag, std::uint16_t value) {
  const auto byte = [&](std::size_t at) { return static_cast<std::size_t>(static_cast<unsigned char>(tiff[at])); };
  const std::size_t start = byte(4) | byte(5) << 8 | byte(6) << 16;
  for (std::size_t at = start + 2; at + 12 <= tiff.size(); at += 12) {
    if ((byte(at) | byte(at + 1) << 8) != tag) continue;
    std::memcpy(&tiff[at + 8], &value, 2);
    return tiff;
  }
  ADD_FAILURE() << "no tag " << tag;
  return tiff;
}

TEST(ImageLimits, TiffByTheNamedCompressionsAndNoOther) {
  const std::vector<float> plain = expect_read("1.tif", tiff_bytes({})).samples;
  for (const std::uint16_t compression : std::vector<std::uint16_t>{1, 5, 8, 32946, 32773}) {
    const std::string name = std::to_string(compression) + ".tif";
    EXPECT_EQ(expect_read(name, tiff_bytes({.compression = compression})).samples, plain) << name;
    EXPECT_FALSE(expect_read(name, tiff_bytes({.compression = compression, .tile = 16})).samples.empty());
  }
  const std::string good = tiff_bytes({.bits = 8});
  for (const std::uint16_t other : std::vector<std::uint16_t>{2, 3, 4, 6, 7, 32766, 32809, 32895, 32909, 34661, 34676,
                                                              34677, 34712, 34887, 34925, 50000, 50001, 50002, 60000}) {
    expect_unsupported("a.tif", with_tag(good, 259, other), "is compressed by TIFF scheme " + std::to_string(other));
  }
  expect_unsupported("planar.tif", with_tag(tiff_bytes({.channels = 3}), 284, 2), "keeps its channels apart");
  expect_unsupported("ycbcr.tif", with_tag(tiff_bytes({.channels = 3}), 262, 6), "neither grey nor RGB");
  expect_unsupported("signed.tif", with_tag(good, 339, 2), "sample format 2");
}

struct memory_out final : Imf::OStream {
  memory_out() : OStream("image") {}
  void write(const char from[], int count) override {
    const auto n = static_cast<std::size_t>(count);
    if (bytes.size() < at + n) bytes.resize(at + n);
    std::memcpy(&bytes[at], from, n);
    at += n;
  }
  std::uint64_t tellp() override { return at; }
  void seekp(std::uint64_t to) override { at = static_cast<std::size_t>(to); }
  std::string bytes;
  std::size_t at = 0;
};

/// A real one: every pixel holds two depths.
std::string deep_exr() {
  constexpr int side = 4;
  Imf::Header header(side, side);
  header.channels().insert("Z", Imf::Channel(Imf::FLOAT));
  header.setType(Imf::DEEPSCANLINE);
  header.compression() = Imf::ZIPS_COMPRESSION;
  std::array<float, 2> depths{0.1F, 0.2F};
  std::vector<unsigned> counts(side * side, 2);
  std::vector<float*> pointers(side * side, depths.data());
  memory_out out;
  {
    Imf::DeepScanLineOutputFile file(out, header, 0);
    Imf::DeepFrameBuffer frame;
    frame.insertSampleCountSlice(
        Imf::Slice(Imf::UINT, reinterpret_cast<char*>(counts.data()), sizeof(unsigned), sizeof(unsigned) * side));
    frame.insert("Z", Imf::DeepSlice(Imf::FLOAT, reinterpret_cast<char*>(pointers.data()), sizeof(float*),
                                     sizeof(float*) * side, sizeof(float)));
    file.setFrameBuffer(frame);
    file.writePixels(side);
  }
  return out.bytes;
}

std::string tiled_exr(unsigned tile) {
  constexpr int side = 8;
  Imf::Header header(side, side);
  header.channels().insert("Y", Imf::Channel(Imf::FLOAT));
  header.setTileDescription(Imf::TileDescription(tile, tile, Imf::ONE_LEVEL));
  std::vector<float> values(side * side, 0.25F);
  memory_out out;
  {
    Imf::TiledOutputFile file(out, header, 0);
    Imf::FrameBuffer frame;
    frame.insert("Y",
                 Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()), sizeof(float), sizeof(float) * side));
    file.setFrameBuffer(frame);
    file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
  }
  return out.bytes;
}

std::string with_flag(std::string exr, unsigned flag) {
  std::uint32_t version = 0;
  std::memcpy(&version, &exr[4], 4);
  version |= flag;
  std::memcpy(&exr[4], &version, 4);
  return exr;
}

TEST(ImageLimits, ExrOfOneFlatPartWithoutLossAndNoOther) {
  const std::vector<float> heights(64, 0.125F);
  for (const int compression : {0, 1, 2, 3, 4}) {  // none, RLE, ZIPS, ZIP, PIZ
    EXPECT_EQ(expect_read("a.exr", test_support::exr_bytes(8, 8, {"Y"}, heights, compression)).samples, heights);
  }
  for (const int compression : {5, 6, 7, 8, 9}) {  // PXR24, B44, B44A, DWAA, DWAB
    expect_unsupported("a.exr", test_support::exr_bytes(8, 8, {"Y"}, heights, compression), "with a loss");
  }
  EXPECT_EQ(expect_read("tiles.exr", tiled_exr(4)).samples, std::vector<float>(64, 0.25F));
  EXPECT_EQ(expect_read("tile.exr", tiled_exr(64)).samples, std::vector<float>(64, 0.25F));
  std::string wide = tiled_exr(4);
  const std::size_t at = wide.find(std::string("tiledesc\0\x09\0\0\0", 13)) + 13;
  const std::array<std::uint32_t, 2> huge{1U << 30, 1U << 30};
  std::memcpy(&wide[at], huge.data(), sizeof huge);
  expect_unsupported("wide.exr", wide, "has tiles of 1073741824 x 1073741824 pixels");

  expect_unsupported("deep.exr", deep_exr(), "holds deep pixels");
  const std::string good = test_support::exr_bytes(8, 8, {"Y"}, heights);
  expect_unsupported("deep_flag.exr", with_flag(good, 0x800), "holds deep pixels");
  expect_unsupported("parts.exr", with_flag(good, 0x1000), "has several parts");
  expect_unsupported("future.exr", with_flag(good, 0x10000), "features that are not known");
  expect_unsupported("version.exr", with_flag(good, 1), "is of EXR version 3");
  // Deep by its header alone, where the version says that it is an image.
  std::string sly = deep_exr();
  sly[5] = static_cast<char>(sly[5] & ~0x08);
  expect_unsupported("sly.exr", sly, "holds deep pixels");
}

TEST(ImageLimits, PngInterlacedIsTheSameImage) {
  constexpr std::uint32_t width = 37, height = 21;
  std::vector<unsigned char> grey;
  for (std::uint32_t i = 0; i < width * height; ++i) grey.push_back(static_cast<unsigned char>(i * i % 251));
  const std::string rows(grey.begin(), grey.end());
  EXPECT_EQ(expect_read("i.png", test_support::grey_png_bytes(width, height, false, true,
                                                              [&](std::uint32_t j) { return &grey[j * width]; }))
                .samples,
            expect_read("p.png", test_support::png_image{width, height, 8, 0, rows, {}}.bytes()).samples);
}

TEST(ImageLimits, AreThoseOfTheHeader) {
  const scratch_folder folder;
  const auto claim = [&](std::uint32_t width, std::uint32_t height) {
    const auto image =
        io::load_image(folder.file("c.png", test_support::png_image{width, height, 8, 0, "x", {}}.bytes()));
    return image.error().message;
  };
  EXPECT_EQ(claim(8192, 8192).find("more than the limit"), std::string::npos) << "within it; its bytes are too few";
  EXPECT_NE(claim(8192, 8193).find("more than the limit"), std::string::npos);
  EXPECT_NE(claim(11500, 11500).find("more than the limit"), std::string::npos);
  EXPECT_NE(claim(16385, 1).find("more than the limit"), std::string::npos);
}

}  // namespace
}  // namespace asperity
