// TIFF through libtiff: the first image of the file, grey or colour, of 8 or 16 bits or float32, in strips or tiles,
// uncompressed or by LZW, Deflate or PackBits.
#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>
#include <tiffio.h>
#include <vector>

#include "file_bytes.hpp"
#include "image_formats.hpp"

namespace asperity::io {
namespace {

constexpr std::size_t most_pixels_per_byte = std::size_t{1} << 15;
constexpr tmsize_t max_single_allocation = tmsize_t{512} << 20;

/// The file in memory, as libtiff wants to see it.
struct tiff_memory {
  std::string_view bytes;
  const reading_watch& watch;
  toff_t at = 0;
  std::string reason;

  static tiff_memory& of(thandle_t handle) { return *static_cast<tiff_memory*>(handle); }
  static tmsize_t read(thandle_t handle, void* to, tmsize_t count) {
    tiff_memory& m = of(handle);
    if (count <= 0 || m.at >= m.bytes.size() || !m.watch.goes_on()) return 0;
    const auto n = std::min<std::size_t>(static_cast<std::size_t>(count), m.bytes.size() - m.at);
    std::memcpy(to, m.bytes.data() + m.at, n);
    m.at += n;
    return static_cast<tmsize_t>(n);
  }
  static tmsize_t write(thandle_t, void*, tmsize_t) { return 0; }
  static toff_t seek(thandle_t handle, toff_t offset, int whence) {
    tiff_memory& m = of(handle);
    m.at = offset + (whence == SEEK_CUR ? m.at : whence == SEEK_END ? m.bytes.size() : 0);
    return m.at;
  }
  static int close(thandle_t) { return 0; }
  static toff_t size(thandle_t handle) { return of(handle).bytes.size(); }

  __attribute__((format(printf, 4, 0))) static int on_error(TIFF*, void* memory, const char*, const char* format,
                                                            va_list values) {
    char text[256];
    (void)std::vsnprintf(text, sizeof text, format, values);
    auto& reason = static_cast<tiff_memory*>(memory)->reason;
    if (reason.empty()) reason = text;  // the first is the cause
    return 1;
  }
  __attribute__((format(printf, 4, 0))) static int on_warning(TIFF*, void*, const char*, const char*, va_list) {
    return 1;
  }
};

struct close_tiff {
  void operator()(TIFF* t) const noexcept { TIFFClose(t); }
  void operator()(TIFFOpenOptions* o) const noexcept { TIFFOpenOptionsFree(o); }
};
using tiff_handle = std::unique_ptr<TIFF, close_tiff>;

tiff_handle open_tiff(tiff_memory& memory) {
  const std::unique_ptr<TIFFOpenOptions, close_tiff> options(TIFFOpenOptionsAlloc());
  TIFFOpenOptionsSetMaxSingleMemAlloc(options.get(), max_single_allocation);
  TIFFOpenOptionsSetErrorHandlerExtR(options.get(), tiff_memory::on_error, &memory);
  TIFFOpenOptionsSetWarningHandlerExtR(options.get(), tiff_memory::on_warning, &memory);
  return tiff_handle(TIFFClientOpenExt("image", "rm", &memory, tiff_memory::read, tiff_memory::write, tiff_memory::seek,
                                       tiff_memory::close, tiff_memory::size, nullptr, nullptr, options.get()));
}

struct tiff_layout {
  std::uint32_t width = 0, height = 0;
  std::uint16_t bits = 1, samples = 1, format = SAMPLEFORMAT_UINT, planar = PLANARCONFIG_CONTIG,
                photometric = PHOTOMETRIC_MINISBLACK, compression = COMPRESSION_NONE;
};

tiff_layout layout_of(TIFF* tiff) {
  tiff_layout out;
  (void)TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &out.width);
  (void)TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &out.height);
  (void)TIFFGetFieldDefaulted(tiff, TIFFTAG_BITSPERSAMPLE, &out.bits);
  (void)TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLESPERPIXEL, &out.samples);
  (void)TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLEFORMAT, &out.format);
  (void)TIFFGetFieldDefaulted(tiff, TIFFTAG_PLANARCONFIG, &out.planar);
  (void)TIFFGetField(tiff, TIFFTAG_PHOTOMETRIC, &out.photometric);
  (void)TIFFGetFieldDefaulted(tiff, TIFFTAG_COMPRESSION, &out.compression);
  return out;
}

/// What of the layout this reader does not know, or nothing.
std::string unknown_in(const tiff_layout& l) {
  // Without loss, and by decoders that every build of libtiff has and that do one thing.
  constexpr std::array<std::uint16_t, 5> known{COMPRESSION_NONE, COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE,
                                               COMPRESSION_DEFLATE, COMPRESSION_PACKBITS};
  if (std::ranges::find(known, l.compression) == known.end()) {
    return "is compressed by TIFF scheme " + std::to_string(l.compression) +
           "; export it uncompressed, or with LZW, Deflate or PackBits";
  }
  const bool known_number = (l.format == SAMPLEFORMAT_UINT && (l.bits == 8 || l.bits == 16)) ||
                            (l.format == SAMPLEFORMAT_IEEEFP && l.bits == 32);
  if (!known_number) {
    return "has samples of " + std::to_string(l.bits) + " bits in sample format " + std::to_string(l.format) +
           "; export it with 8 or 16 bits, or as float32";
  }
  if (l.samples < 1 || l.samples > 4) return "has " + std::to_string(l.samples) + " samples per pixel; export 1 or 3";
  if (l.planar != PLANARCONFIG_CONTIG && l.samples > 1) return "keeps its channels apart; export it interleaved";
  const bool grey = l.photometric == PHOTOMETRIC_MINISBLACK || l.photometric == PHOTOMETRIC_MINISWHITE;
  if (!(grey && l.samples <= 2) && !(l.photometric == PHOTOMETRIC_RGB && l.samples >= 3)) {
    return "is neither grey nor RGB (photometric " + std::to_string(l.photometric) + "); export it as one of these";
  }
  return {};
}

/// Small images have tiles larger than themselves, but not of any size: a tile is taken into memory as it is.
bool has_sensible_tiles(TIFF* tiff, const tiff_layout& l) {
  constexpr std::uint32_t always = 1024;
  constexpr std::uint64_t most_tile_pixels = std::uint64_t{1}
                                             << 24;  // decoded at once, without asking whether to go on
  std::uint32_t tile_width = 0, tile_height = 0;
  (void)TIFFGetField(tiff, TIFFTAG_TILEWIDTH, &tile_width);
  (void)TIFFGetField(tiff, TIFFTAG_TILELENGTH, &tile_height);
  return tile_width <= std::max(always, l.width + 15) && tile_height <= std::max(always, l.height + 15) &&
         std::uint64_t{tile_width} * tile_height <= most_tile_pixels;
}

/// Appends `pixels` pixels without what comes after the last channel (alpha).
void append_pixels(const tiff_layout& l, const unsigned char* from, std::size_t pixels, map_image& to) {
  reserve_row(to, pixels * to.channels);
  for (std::size_t i = 0; i < pixels; ++i) {
    for (std::size_t c = 0; c < to.channels; ++c) {
      const auto* at = reinterpret_cast<const char*>(from) + (i * l.samples + c) * (l.bits / 8U);
      float value = l.bits == 32   ? load_number<float>(at)
                    : l.bits == 16 ? static_cast<float>(load_number<std::uint16_t>(at)) / 65535.0F
                                   : static_cast<float>(load_number<std::uint8_t>(at)) / 255.0F;
      if (l.photometric == PHOTOMETRIC_MINISWHITE && l.bits != 32) value = 1.0F - value;
      to.samples.push_back(value);
    }
  }
}

bool read_strips(TIFF* tiff, const tiff_layout& l, const reading_watch& watch, map_image& to) {
  std::vector<unsigned char> row(static_cast<std::size_t>(TIFFScanlineSize64(tiff)));
  for (std::uint32_t j = 0; j < l.height; ++j) {
    watch.ask();
    if (TIFFReadScanline(tiff, row.data(), j, 0) < 0) return false;
    append_pixels(l, row.data(), l.width, to);
  }
  return true;
}

/// One row of tiles at a time.
bool read_tiles(TIFF* tiff, const tiff_layout& l, const reading_watch& watch, map_image& to) {
  std::uint32_t tile_width = 0, tile_height = 0;
  (void)TIFFGetField(tiff, TIFFTAG_TILEWIDTH, &tile_width);
  (void)TIFFGetField(tiff, TIFFTAG_TILELENGTH, &tile_height);
  const std::size_t pixel_bytes = std::size_t{l.samples} * (l.bits / 8U);
  std::vector<unsigned char> tile(static_cast<std::size_t>(TIFFTileSize64(tiff)));
  const std::size_t across = tile_width == 0 ? 0 : (l.width + std::size_t{tile_width} - 1) / tile_width;
  if (across == 0 || tile_height == 0 || tile.size() != pixel_bytes * tile_width * tile_height) return false;
  const std::size_t band_rows = std::min(tile_height, l.height);
  std::vector<unsigned char> band(across * tile_width * pixel_bytes * band_rows);
  const std::size_t band_row_bytes = across * tile_width * pixel_bytes;
  for (std::uint32_t top = 0; top < l.height; top += tile_height) {
    for (std::size_t k = 0; k < across; ++k) {
      const auto left = static_cast<std::uint32_t>(k * tile_width);
      watch.ask();
      if (TIFFReadTile(tiff, tile.data(), left, top, 0, 0) < 0) return false;
      for (std::size_t j = 0; j < band_rows; ++j)
        std::memcpy(&band[j * band_row_bytes + left * pixel_bytes], &tile[j * tile_width * pixel_bytes],
                    tile_width * pixel_bytes);
    }
    const std::size_t rows = std::min<std::size_t>(tile_height, l.height - top);
    for (std::size_t j = 0; j < rows; ++j) append_pixels(l, &band[j * band_row_bytes], l.width, to);
  }
  return true;
}

}  // namespace

result<map_image> decode_tiff(std::string_view bytes, const std::filesystem::path& file, reading_watch& watch) {
  tiff_memory memory{bytes, watch, 0, {}};
  const auto damaged = [&] {
    watch.ask();
    return fault(
        error_code::bad_format, file,
        "cannot be read as TIFF: " + plain_reason(memory.reason.empty() ? "its data are inconsistent" : memory.reason) +
            "; export it again");
  };
  const tiff_handle tiff = open_tiff(memory);
  if (!tiff) return damaged();
  const tiff_layout l = layout_of(tiff.get());
  if (const std::string unknown = unknown_in(l); !unknown.empty()) return fault(error_code::unsupported, file, unknown);
  auto sized = sized_image(l.width, l.height, l.samples >= 3 ? 3 : 1, bytes.size(), most_pixels_per_byte, file);
  if (!sized) return sized.error();
  if (TIFFIsTiled(tiff.get()) != 0 && !has_sensible_tiles(tiff.get(), l))
    return fault(error_code::bad_format, file,
                 "has tiles far larger than itself, or of more than 16777216 pixels; export it again, in strips");
  sized->bits = l.bits == 32 ? 0 : l.bits;
  const bool whole = TIFFIsTiled(tiff.get()) != 0 ? read_tiles(tiff.get(), l, watch, *sized)
                                                  : read_strips(tiff.get(), l, watch, *sized);
  if (!whole || !memory.reason.empty()) return damaged();
  return finite_image(std::move(*sized), file);
}

}  // namespace asperity::io
