// Images of surfaces: what each format holds comes out as it is, and a broken file says how it is broken.
#include <array>
#include <cstring>
#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <vector>

#include "asperity/io/image_file.hpp"
#include "scratch_folder.hpp"
#include "support/image_writers.hpp"
#include "support/png_image.hpp"

namespace asperity {
namespace {

using test_support::exr_bytes;
using test_support::jpeg_bytes;
using test_support::png_image;
using test_support::scratch_folder;

void expect_error(const result<map_image>& image, error_code code, const std::string& says) {
  ASSERT_FALSE(image) << says;
  EXPECT_EQ(image.error().code, code) << image.error().message;
  EXPECT_NE(image.error().message.find(says), std::string::npos) << image.error().message << "\nlacks: " << says;
}

map_image loaded(const scratch_folder& folder, const std::string& name, const std::string& bytes) {
  const auto image = io::load_image(folder.file(name, bytes));
  EXPECT_TRUE(image) << image.error().message;
  return image ? *image : map_image{};
}

TEST(Png, ReadsEveryDepthAndColourAsItStands) {
  const scratch_folder folder;
  const map_image grey =
      loaded(folder, "8.png", png_image{3, 2, 8, 0, std::string("\x00\x01\x80\xff\x7f\x10", 6), {}}.bytes());
  EXPECT_EQ(grey.width, 3U);
  EXPECT_EQ(grey.height, 2U);
  EXPECT_EQ(grey.channels, 1U);
  EXPECT_EQ(grey.bits, 8U);
  EXPECT_EQ(grey.samples, (std::vector<float>{0, 1 / 255.0F, 128 / 255.0F, 1, 127 / 255.0F, 16 / 255.0F}));
  const map_image deep =
      loaded(folder, "16.png", png_image{2, 1, 16, 0, std::string("\x01\x02\xff\xff", 4), {}}.bytes());
  EXPECT_EQ(deep.bits, 16U);
  EXPECT_EQ(deep.samples, (std::vector<float>{0x102 / 65535.0F, 1}));
  const map_image colour = loaded(folder, "rgba.png", png_image{1, 1, 8, 6, "\x10\x20\x30\x40", {}}.bytes());
  EXPECT_EQ(colour.channels, 3U) << "alpha is left out";
  EXPECT_EQ(colour.samples, (std::vector<float>{16 / 255.0F, 32 / 255.0F, 48 / 255.0F}));
  const map_image palette =
      loaded(folder, "p.png", png_image{2, 1, 1, 3, "\x40", std::string("\x01\x02\x03\x04\x05\x06", 6)}.bytes());
  EXPECT_EQ(palette.samples,
            (std::vector<float>{1 / 255.0F, 2 / 255.0F, 3 / 255.0F, 4 / 255.0F, 5 / 255.0F, 6 / 255.0F}));
  const map_image bits = loaded(folder, "1.png", png_image{4, 1, 1, 0, "\x50", {}}.bytes());
  EXPECT_EQ(bits.samples, (std::vector<float>{0, 1, 0, 1}));
}

TEST(Png, SaysWhatIsBroken) {
  const scratch_folder folder;
  const std::string good = png_image{64, 64, 8, 0, std::string(64 * 64, 'x'), {}}.bytes();
  const auto load = [&](const std::string& bytes) { return io::load_image(folder.file("b.png", bytes)); };
  for (const std::size_t length : {20U, 40U, 60U, 1000U, 4000U})
    expect_error(load(good.substr(0, length)), error_code::bad_format, "the file ends early");
  std::string changed = good;
  changed[2000] = 'y';
  expect_error(load(changed), error_code::bad_format, "cannot be read as PNG");
  // Sizes that the bytes cannot hold take no memory.
  expect_error(load(png_image{16000, 4000, 8, 0, "x", {}}.bytes()), error_code::bad_format, "cannot hold");
  expect_error(load(png_image{70000, 1, 8, 0, "x", {}}.bytes()), error_code::limit_exceeded, "70000 x 1 pixels");
  expect_error(load(png_image{0, 4, 8, 0, "x", {}}.bytes()), error_code::bad_format, "cannot be read as PNG");
  expect_error(load(png_image{4, 4, 7, 0, "x", {}}.bytes()), error_code::bad_format, "cannot be read as PNG");
  expect_error(load("GIF89a and so on"), error_code::unsupported, "does not begin like a PNG");
  expect_error(load(""), error_code::bad_format, "is empty");
  expect_error(io::load_image(folder.file("absent.png")), error_code::io_failed, "cannot be found");
}

/// A TIFF of one strip, little-endian, uncompressed; each number can be given wrongly.
struct tiff_image {
  std::uint32_t width = 0, height = 0;
  std::uint16_t bits = 8, samples = 1, format = 1, photometric = 1;
  std::string pixels;

  [[nodiscard]] std::string bytes() const {
    std::string out = "II";
    put<std::uint16_t>(out, 42);
    put(out, static_cast<std::uint32_t>(8 + pixels.size()));
    out += pixels;
    const std::vector<std::array<std::uint32_t, 2>> tags{
        {256, width},   {257, height},      {258, bits},
        {259, 1},       {262, photometric}, {273, 8},
        {277, samples}, {278, height},      {279, static_cast<std::uint32_t>(pixels.size())},
        {284, 1},       {339, format}};
    put(out, static_cast<std::uint16_t>(tags.size()));
    for (const auto& [tag, value] : tags) {
      put(out, static_cast<std::uint16_t>(tag));
      put<std::uint16_t>(out, 4);
      put<std::uint32_t>(out, 1);
      put(out, value);
    }
    put<std::uint32_t>(out, 0);
    return out;
  }
  template <class T>
  static void put(std::string& to, T value) {
    to.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  template <class T>
  static std::string of(const std::vector<T>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
  }
};

TEST(Tiff, ReadsWholeNumbersAndFloats) {
  const scratch_folder folder;
  EXPECT_EQ(loaded(folder, "8.tif", tiff_image{2, 1, 8, 1, 1, 1, std::string("\x00\x80", 2)}.bytes()).samples,
            (std::vector<float>{0, 128 / 255.0F}));
  EXPECT_EQ(loaded(folder, "white.tif", tiff_image{2, 1, 8, 1, 1, 0, std::string("\x00\xff", 2)}.bytes()).samples,
            (std::vector<float>{1, 0}));
  const map_image deep =
      loaded(folder, "16.tif", tiff_image{1, 2, 16, 1, 1, 1, tiff_image::of<std::uint16_t>({515, 65535})}.bytes());
  EXPECT_EQ(deep.bits, 16U);
  EXPECT_EQ(deep.samples, (std::vector<float>{515 / 65535.0F, 1}));
  const map_image heights =
      loaded(folder, "f.tif", tiff_image{2, 1, 32, 1, 3, 1, tiff_image::of<float>({-0.25F, 1e-5F})}.bytes());
  EXPECT_EQ(heights.bits, 0U);
  EXPECT_EQ(heights.samples, (std::vector<float>{-0.25F, 1e-5F}));
}

TEST(Tiff, SaysWhatIsBroken) {
  const scratch_folder folder;
  const auto load = [&](const std::string& bytes) { return io::load_image(folder.file("b.tif", bytes)); };
  const float nan = std::numeric_limits<float>::quiet_NaN();
  expect_error(load(tiff_image{2, 2, 32, 1, 3, 1, tiff_image::of<float>({1, 2, 3, nan})}.bytes()),
               error_code::bad_format, "not a finite number, first at column 1, row 1");
  expect_error(load(tiff_image{1, 1, 64, 1, 3, 1, tiff_image::of<double>({1})}.bytes()), error_code::unsupported,
               "64 bits in sample format 3");
  expect_error(load(tiff_image{4, 1, 12, 1, 1, 1, "123456"}.bytes()), error_code::unsupported, "12 bits");
  expect_error(load(tiff_image{1, 1, 8, 3, 1, 6, "123"}.bytes()), error_code::unsupported, "neither grey nor RGB");
  expect_error(load(tiff_image{64, 64, 8, 1, 1, 1, "few"}.bytes()), error_code::bad_format, "cannot be read as TIFF");
  expect_error(load(tiff_image{16384, 4096, 8, 1, 1, 1, "few"}.bytes()), error_code::bad_format, "cannot hold");
  expect_error(load(tiff_image{20000, 20000, 8, 1, 1, 1, "few"}.bytes()), error_code::limit_exceeded, "20000 x 20000");
  expect_error(load(tiff_image{0xffffffff, 0xffffffff, 8, 1, 1, 1, "few"}.bytes()), error_code::bad_format,
               "cannot be read as TIFF");
  const std::string good = tiff_image{64, 64, 8, 1, 1, 1, std::string(4096, 'x')}.bytes();
  for (const std::size_t length : {6U, 100U, 4100U, 4150U})
    expect_error(load(good.substr(0, length)), error_code::bad_format, "cannot be read as TIFF");
}

TEST(Exr, ReadsHeightsAndNormals) {
  const scratch_folder folder;
  const map_image heights = loaded(folder, "h.exr", exr_bytes(2, 2, {"Y"}, {0.5F, -1e-4F, 3, 4}));
  EXPECT_EQ(heights.bits, 0U);
  EXPECT_EQ(heights.channels, 1U);
  EXPECT_EQ(heights.samples, (std::vector<float>{0.5F, -1e-4F, 3, 4}));
  EXPECT_EQ(loaded(folder, "one.exr", exr_bytes(1, 1, {"depth"}, {7})).samples, std::vector<float>{7});
  EXPECT_EQ(loaded(folder, "rgb.exr", exr_bytes(1, 1, {"R", "G", "B"}, {0.1F, 0.2F, 0.3F})).samples,
            (std::vector<float>{0.1F, 0.2F, 0.3F}));
}

TEST(Exr, SaysWhatIsBroken) {
  const scratch_folder folder;
  const auto load = [&](const std::string& bytes) { return io::load_image(folder.file("b.exr", bytes)); };
  expect_error(load(exr_bytes(1, 1, {"Y"}, {std::numeric_limits<float>::infinity()})), error_code::bad_format,
               "not a finite number");
  expect_error(load(exr_bytes(1, 1, {"U", "V"}, {1, 2})), error_code::unsupported, "none of them R, G, B or Y");
  const std::string good = exr_bytes(32, 32, {"Y"}, std::vector<float>(1024, 0.1F));
  for (const std::size_t length : {std::size_t{8}, std::size_t{50}, good.size() / 2, good.size() - 3})
    expect_error(load(good.substr(0, length)), error_code::bad_format, "cannot be read as EXR");
  // The data window's lower right corner, planted far out: its name is in the file once.
  std::string huge = good;
  const std::size_t window = huge.find("dataWindow") + std::string("dataWindow0box2i0").size() + 4;
  const std::array<std::int32_t, 2> far{99999, 99999};
  std::memcpy(huge.data() + window + 8, far.data(), sizeof far);
  const auto refused = load(huge);
  ASSERT_FALSE(refused);
}

TEST(Jpeg, ReadsColoursAndSaysWhatIsBroken) {
  const scratch_folder folder;
  const std::string good = jpeg_bytes(64, 16, 100);
  const map_image image = loaded(folder, "n.jpg", good);
  ASSERT_EQ(image.channels, 3U);
  ASSERT_EQ(image.samples.size(), 64U * 16U * 3U);
  EXPECT_NEAR(image.at(10, 5, 0), 128 / 255.0, 0.01);
  EXPECT_NEAR(image.at(40, 5, 1), 40 / 255.0, 0.015);
  const auto load = [&](const std::string& bytes) { return io::load_image(folder.file("b.jpg", bytes)); };
  for (const std::size_t length : {std::size_t{4}, std::size_t{100}, good.size() / 2 + 200, good.size() - 10})
    expect_error(load(good.substr(0, length)), error_code::bad_format, "cannot be read as JPEG");
}

}  // namespace
}  // namespace asperity
