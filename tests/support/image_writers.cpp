#include "support/image_writers.hpp"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfOutputFile.h>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <jpeglib.h>
#include <png.h>
#include <tiffio.h>

namespace asperity::test_support {
namespace {

/// A file in memory that grows where it is written to.
struct growing_file {
  std::string bytes;
  std::uint64_t at = 0;

  void put(const void* from, std::size_t count) {
    if (bytes.size() < at + count) bytes.resize(at + count);
    std::memcpy(bytes.data() + at, from, count);
    at += count;
  }
};

growing_file& file_of(thandle_t handle) { return *static_cast<growing_file*>(handle); }

tmsize_t tiff_read(thandle_t handle, void* to, tmsize_t count) {
  growing_file& f = file_of(handle);
  const auto n = std::min<std::uint64_t>(static_cast<std::uint64_t>(count), f.bytes.size() - f.at);
  std::memcpy(to, f.bytes.data() + f.at, n);
  f.at += n;
  return static_cast<tmsize_t>(n);
}
tmsize_t tiff_write(thandle_t handle, void* from, tmsize_t count) {
  file_of(handle).put(from, static_cast<std::size_t>(count));
  return count;
}
toff_t tiff_seek(thandle_t handle, toff_t offset, int whence) {
  growing_file& f = file_of(handle);
  f.at = offset + (whence == SEEK_CUR ? f.at : whence == SEEK_END ? f.bytes.size() : 0);
  return f.at;
}
int tiff_close(thandle_t) { return 0; }
toff_t tiff_size(thandle_t handle) { return file_of(handle).bytes.size(); }

std::string tiff_samples(const tiff_layout& l, std::uint32_t across, std::uint32_t rows) {
  std::string out;
  for (std::uint32_t i = 0; i < across * rows * l.channels; ++i) {
    const std::uint32_t height = i * i % 251;
    if (l.bits == 32) {
      const float value = 1e-5F * static_cast<float>(height);
      out.append(reinterpret_cast<const char*>(&value), sizeof value);
    } else if (l.bits == 16) {
      const auto value = static_cast<std::uint16_t>(height * 257);
      out.append(reinterpret_cast<const char*>(&value), sizeof value);
    } else {
      out += static_cast<char>(height);
    }
  }
  return out;
}

class exr_stream final : public Imf::OStream {
 public:
  exr_stream() : OStream("image") {}
  void write(const char from[], int count) override { file.put(from, static_cast<std::size_t>(count)); }
  std::uint64_t tellp() override { return file.at; }
  void seekp(std::uint64_t to) override { file.at = to; }
  growing_file file;
};

}  // namespace

std::string compressed_png_bytes(std::uint32_t width, std::uint32_t height, bool deep) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = width;
  image.height = height;
  image.format = deep ? PNG_FORMAT_LINEAR_Y : PNG_FORMAT_GRAY;
  std::vector<std::uint16_t> pixels;  // of 8 bits: two in each
  for (std::uint32_t i = 0; i < width * height; ++i) pixels.push_back(static_cast<std::uint16_t>(i * i % 251 * 200));
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::string out(size, '\0');
  (void)png_image_write_to_memory(&image, out.data(), &size, 0, pixels.data(), 0, nullptr);
  out.resize(size);
  return out;
}

std::string grey_png_bytes(std::uint32_t width, std::uint32_t height, bool deep, bool interlaced,
                           const std::function<const unsigned char*(std::uint32_t)>& row) {
  std::string out;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(
      png, &out,
      [](png_structp p, png_bytep from, png_size_t n) {
        static_cast<std::string*>(png_get_io_ptr(p))->append(reinterpret_cast<const char*>(from), n);
      },
      [](png_structp) {});
  png_set_IHDR(png, info, width, height, deep ? 16 : 8, PNG_COLOR_TYPE_GRAY,
               interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  png_set_filter(png, 0, PNG_FILTER_NONE);
  png_write_info(png, info);
  for (int pass = png_set_interlace_handling(png); pass > 0; --pass) {
    for (std::uint32_t j = 0; j < height; ++j) png_write_row(png, row(j));
  }
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  return out;
}

std::string flat_png_bytes(std::uint32_t width, std::uint32_t height, bool deep, bool interlaced) {
  const std::vector<unsigned char> grey(std::size_t{width} * (deep ? 2 : 1), 0x40);
  return grey_png_bytes(width, height, deep, interlaced, [&](std::uint32_t) { return grey.data(); });
}

std::string tiff_bytes(const tiff_layout& l) {
  growing_file file;
  TIFF* const tiff = TIFFClientOpen("image", l.big_endian ? "wb" : "wl", &file, tiff_read, tiff_write, tiff_seek,
                                    tiff_close, tiff_size, nullptr, nullptr);
  if (tiff == nullptr) return {};
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, l.width);
  TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, l.height);
  TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, l.bits);
  TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, l.channels);
  TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, l.bits == 32 ? SAMPLEFORMAT_IEEEFP : SAMPLEFORMAT_UINT);
  TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, l.channels == 1 ? PHOTOMETRIC_MINISBLACK : PHOTOMETRIC_RGB);
  TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  TIFFSetField(tiff, TIFFTAG_COMPRESSION, l.compression);
  if (l.tile > 0) {
    TIFFSetField(tiff, TIFFTAG_TILEWIDTH, l.tile);
    TIFFSetField(tiff, TIFFTAG_TILELENGTH, l.tile);
    std::string tile = tiff_samples(l, l.tile, l.tile);
    for (std::uint32_t y = 0; y < l.height; y += l.tile) {
      for (std::uint32_t x = 0; x < l.width; x += l.tile) (void)TIFFWriteTile(tiff, tile.data(), x, y, 0, 0);
    }
  } else {
    TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, 8U);
    for (std::uint32_t y = 0; y < l.height; ++y) {
      std::string row = tiff_samples(l, l.width, 1);
      (void)TIFFWriteScanline(tiff, row.data(), y, 0);
    }
  }
  TIFFClose(tiff);
  return file.bytes;
}

std::string exr_bytes(int width, int height, const std::vector<std::string>& channels, const std::vector<float>& values,
                      int compression) {
  Imf::Header header(width, height);
  header.compression() = static_cast<Imf::Compression>(compression);
  Imf::FrameBuffer frame;
  std::vector<float> held = values;  // OpenEXR takes a pointer that could be written to
  for (std::size_t c = 0; c < channels.size(); ++c) {
    header.channels().insert(channels[c], Imf::Channel(Imf::FLOAT));
    const std::size_t pixel = sizeof(float) * channels.size();
    frame.insert(channels[c], Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(held.data() + c), pixel,
                                         pixel * static_cast<std::size_t>(width)));
  }
  exr_stream stream;
  {
    Imf::OutputFile out(stream, header, 0);
    out.setFrameBuffer(frame);
    out.writePixels(height);
  }
  return stream.file.bytes;
}

std::string jpeg_bytes(int width, int height, int quality, bool progressive, bool grey) {
  jpeg_compress_struct c{};
  jpeg_error_mgr errors{};
  c.err = jpeg_std_error(&errors);
  jpeg_create_compress(&c);
  unsigned char* memory = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&c, &memory, &size);
  c.image_width = static_cast<JDIMENSION>(width);
  c.image_height = static_cast<JDIMENSION>(height);
  c.input_components = grey ? 1 : 3;
  c.in_color_space = grey ? JCS_GRAYSCALE : JCS_RGB;
  jpeg_set_defaults(&c);
  jpeg_set_quality(&c, quality, TRUE);
  if (progressive) jpeg_simple_progression(&c);
  jpeg_start_compress(&c, TRUE);
  std::vector<unsigned char> row;
  for (int i = 0; i < width; ++i) {
    if (grey) {
      row.push_back(static_cast<unsigned char>(i));
    } else {
      row.insert(row.end(), {128, static_cast<unsigned char>(i), 250});
    }
  }
  for (int j = 0; j < height; ++j) {
    JSAMPROW at = row.data();
    (void)jpeg_write_scanlines(&c, &at, 1);
  }
  jpeg_finish_compress(&c);
  std::string out(reinterpret_cast<const char*>(memory), size);
  jpeg_destroy_compress(&c);
  std::free(memory);
  return out;
}

}  // namespace asperity::test_support
