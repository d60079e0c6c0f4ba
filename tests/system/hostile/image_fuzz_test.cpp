// Image files changed at random: byte by byte, and with the format's structure kept. Each ends in a sentence or in an
// image, within a bound on memory.
#include <algorithm>
#include <cstdio>
#include <gtest/gtest.h>
#include <ostream>
#include <string>
#include <sys/resource.h>
#include <vector>

#include "file_bytes.hpp"
#include "fuzz_runs.hpp"
#include "image_formats.hpp"
#include "image_mutator.hpp"
#include "peak_memory.hpp"
#include "support/image_writers.hpp"
#include "support/png_image.hpp"

namespace asperity::hostile {
namespace {

using namespace test_support;

struct image_format {
  const char* name;
  std::vector<std::string> good;
  std::string (*mutate)(const std::string&, random_source&);
};

void PrintTo(const image_format& f, std::ostream* to) { *to << f.name; }

std::vector<float> waves(std::size_t count) {
  std::vector<float> out;
  for (std::size_t i = 0; i < count; ++i) out.push_back(1e-5F * static_cast<float>(i * i % 251));
  return out;
}

std::vector<image_format> formats() {
  const std::string pixels(20 * 12, 'p');
  return {
      {"PNG",
       {png_image{20, 12, 8, 0, pixels, {}}.bytes(), png_image{5, 6, 16, 6, pixels, {}}.bytes(),
        png_image{40, 12, 4, 3, pixels, std::string(48, 'q')}.bytes(), compressed_png_bytes(40, 30, false),
        compressed_png_bytes(30, 20, true)},
       mutated_png},
      {"TIFF",
       {tiff_bytes({}), tiff_bytes({.bits = 32, .tile = 16}), tiff_bytes({.bits = 8, .channels = 3, .compression = 5}),
        tiff_bytes({.compression = 8, .big_endian = true}), tiff_bytes({.bits = 8, .compression = 32773, .tile = 16})},
       mutated_tiff},
      {"EXR",
       {exr_bytes(20, 12, {"Y"}, waves(240), 0), exr_bytes(20, 40, {"Y"}, waves(800), 3),
        exr_bytes(16, 12, {"R", "G", "B"}, waves(576), 1), exr_bytes(30, 33, {"depth"}, waves(990), 4)},
       mutated_exr},
      {"JPEG",
       {jpeg_bytes(40, 24, 90), jpeg_bytes(40, 24, 90, true), jpeg_bytes(33, 17, 50, false, true)},
       mutated_jpeg},
  };
}

result<map_image> read(const std::string& bytes) {
  return io::without_exceptions("fuzz", [&] { return io::decode_image(bytes, "fuzz"); });
}

/// What a decoder asks for beyond this it does not get: a run that grows ends in a failure, not in the machine's
/// memory.
class ImageFuzz : public testing::TestWithParam<image_format> {
 protected:
  void SetUp() override {
    ASSERT_EQ(::getrlimit(RLIMIT_AS, &before_), 0);
    rlimit lower = before_;
    // Beside what the program has mapped before: threads of earlier tests have left heaps of their own.
    lower.rlim_cur = std::min<rlim_t>(before_.rlim_max, peak_memory::mapped_bytes() + (rlim_t{2} << 30));
    if (peak_memory().works()) ::setrlimit(RLIMIT_AS, &lower);
  }
  void TearDown() override { ::setrlimit(RLIMIT_AS, &before_); }

 private:
  rlimit before_{};
};

/// What a run may take: four times the file and the image that came of it, and a constant for tables of the decoders
/// and for what a damaged file claims.
constexpr std::size_t plus_bytes = std::size_t{24} << 20;

struct outcome {
  double loaded = 0.0;
  std::size_t kinds = 0;
  std::size_t other_pixels = 0;  ///< images that differ from the good one: a change went through the decoder
};

outcome fuzz_images(const image_format& format, const char* how, const std::string& good, std::size_t runs,
                    std::uint64_t seed, std::string (*mutate)(const std::string&, random_source&)) {
  const std::vector<float> pixels = read(good).value().samples;
  outcome out;
  peak_memory memory;
  std::size_t most = 0;
  if (!memory.works()) std::printf("  skipped: the bound on memory: this build or system does not tell it\n");
  const auto watched = [&](const std::string& bytes) {
    memory.begin();
    result<map_image> image = read(bytes);
    const std::size_t taken = memory.works() ? memory.bytes() : 0;
    const std::size_t natural = bytes.size() + (image ? 4 * image->samples.size() : 0);
    EXPECT_LE(taken, 4 * natural + plus_bytes) << (image ? std::string("an image") : image.error().message);
    if (!image) {
      EXPECT_EQ(image.error().message.find("does not fit into memory"), std::string::npos) << "a claim was believed";
    }
    most = std::max(most, taken);
    out.other_pixels += image && image->samples != pixels ? 1U : 0U;
    return image;
  };
  const tally t = fuzz(runs, seed, good, mutate, watched);
  t.print((std::string(format.name) + ", " + how).c_str());
  std::printf("  %zu images with other pixels; at most %.1f MB\n", out.other_pixels, 1e-6 * static_cast<double>(most));
  out.loaded = t.loaded();
  out.kinds = t.kinds();
  return out;
}

// All runs in every build: the images are small.
TEST_P(ImageFuzz, ByteByByte) {
  std::uint64_t seed = 1;
  for (const std::string& good : GetParam().good) {
    (void)fuzz_images(GetParam(), "byte by byte", good, 800, seed++, mutated_bytes);
  }
}

TEST_P(ImageFuzz, WithItsStructureKept) {
  std::uint64_t seed = 1;
  for (const std::string& good : GetParam().good) {
    const outcome got = fuzz_images(GetParam(), "structure kept", good, 1600, seed++, GetParam().mutate);
    EXPECT_GT(got.loaded, 0.05) << "mutations stop at the header";
    EXPECT_LT(got.loaded, 0.95);
    EXPECT_GT(got.other_pixels, 10U);
  }
}

INSTANTIATE_TEST_SUITE_P(, ImageFuzz, testing::ValuesIn(formats()),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace asperity::hostile
