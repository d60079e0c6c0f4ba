// PNG through libpng, every bit depth and colour type.
#include <algorithm>
#include <csetjmp>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <png.h>
#include <string>

#include "asperity/io/image_file.hpp"
#include "file_bytes.hpp"
#include "image_formats.hpp"

namespace asperity::io {
namespace {

/// Deflate makes 1032 bytes of one at best; a byte holds 8 pixels of 1 bit.
constexpr std::size_t most_pixels_per_byte = std::size_t{1032} * 8;
constexpr std::size_t max_chunk_bytes = std::size_t{8} << 20;

struct free_memory {
  void operator()(unsigned char* p) const noexcept { std::free(p); }
};

/// What the reading works on. It stands outside the functions that libpng may leave by longjmp: a jump runs no
/// destructors.
struct png_job {
  std::string_view bytes;
  std::size_t at = 0;
  std::string reason;
  png_structp png = nullptr;
  png_infop info = nullptr;
  png_uint_32 width = 0, height = 0;
  int depth = 0, channels = 0;
  std::size_t row_bytes = 0;
  int passes = 1;
  std::size_t rows_kept = 1;  // all of an interlaced image, whose rows come in seven passes
  std::unique_ptr<unsigned char[], free_memory> rows;
  const reading_watch& watch;

  png_job(std::string_view b, const reading_watch& w) : bytes(b), watch(w) {
    png = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, on_error, on_warning);
    if (png != nullptr) info = png_create_info_struct(png);
  }
  [[nodiscard]] unsigned char* row(std::size_t j) const noexcept { return rows.get() + j % rows_kept * row_bytes; }

  png_job(const png_job&) = delete;
  png_job& operator=(const png_job&) = delete;
  ~png_job() { png_destroy_read_struct(&png, &info, nullptr); }

  static void on_error(png_structp png, png_const_charp message) {
    static_cast<png_job*>(png_get_error_ptr(png))->reason = message;
    longjmp(png_jmpbuf(png), 1);
  }
  static void on_warning(png_structp, png_const_charp) {}
  static void on_read(png_structp png, png_bytep to, std::size_t count) {
    auto& job = *static_cast<png_job*>(png_get_io_ptr(png));
    if (count > job.bytes.size() - job.at) png_error(png, "the file ends early");
    if (!job.watch.goes_on()) png_error(png, "cancelled");
    std::memcpy(to, job.bytes.data() + job.at, count);
    job.at += count;
  }
};

/// What the header says. Nothing is set up by it yet: libpng would take memory for a row of any width.
bool read_header(png_job& job) {
  if (setjmp(png_jmpbuf(job.png)) != 0) return false;
  png_set_read_fn(job.png, &job, png_job::on_read);
  png_set_user_limits(job.png, 0x7fffffff, 0x7fffffff);  // sized_image() decides
  png_set_chunk_malloc_max(job.png, max_chunk_bytes);
  png_set_crc_action(job.png, PNG_CRC_ERROR_QUIT, PNG_CRC_WARN_DISCARD);
  png_read_info(job.png, job.info);
  job.width = png_get_image_width(job.png, job.info);
  job.height = png_get_image_height(job.png, job.info);
  job.depth = png_get_bit_depth(job.png, job.info);
  job.channels = (png_get_color_type(job.png, job.info) & PNG_COLOR_MASK_COLOR) != 0 ? 3 : 1;
  return true;
}

/// Samples are brought to 8 or 16 bits, grey or colour, no alpha.
bool choose_samples(png_job& job) {
  if (setjmp(png_jmpbuf(job.png)) != 0) return false;
  const int type = png_get_color_type(job.png, job.info);
  if (type == PNG_COLOR_TYPE_PALETTE) png_set_palette_to_rgb(job.png);
  if (type == PNG_COLOR_TYPE_GRAY && job.depth < 8) png_set_expand_gray_1_2_4_to_8(job.png);
  if ((type & PNG_COLOR_MASK_ALPHA) != 0 || png_get_valid(job.png, job.info, PNG_INFO_tRNS) != 0) {
    png_set_strip_alpha(job.png);
  }
  if (job.depth == 16) png_set_swap(job.png);  // PNG is big-endian
  job.passes = png_set_interlace_handling(job.png);
  png_read_update_info(job.png, job.info);
  job.row_bytes = png_get_rowbytes(job.png, job.info);
  return png_get_channels(job.png, job.info) == job.channels;
}

bool read_row(png_job& job, std::size_t j) {
  if (setjmp(png_jmpbuf(job.png)) != 0) return false;
  png_read_row(job.png, job.row(j), nullptr);
  return true;
}

bool read_end(png_job& job) {
  if (setjmp(png_jmpbuf(job.png)) != 0) return false;
  png_read_end(job.png, nullptr);
  return true;
}

void append_samples(const png_job& job, std::size_t j, map_image& to) {
  const unsigned char* row = job.row(j);
  const std::size_t count = std::size_t{to.width} * to.channels;
  reserve_row(to, count);
  for (std::size_t i = 0; i < count; ++i) {
    if (job.depth == 16) {
      std::uint16_t value = 0;
      std::memcpy(&value, row + 2 * i, sizeof value);
      to.samples.push_back(static_cast<float>(value) / 65535.0F);
    } else {
      to.samples.push_back(static_cast<float>(row[i]) / 255.0F);
    }
  }
}

}  // namespace

result<map_image> decode_png(std::string_view bytes, const std::filesystem::path& file, reading_watch& watch) {
  png_job job(bytes, watch);
  if (job.info == nullptr) return fault(error_code::limit_exceeded, file, "does not fit into memory; reduce it first");
  const auto damaged = [&] {
    watch.ask();
    return fault(error_code::bad_format, file,
                 "cannot be read as PNG: " + plain_reason(job.reason) + ", before byte " + std::to_string(job.at) +
                     " of " + std::to_string(bytes.size()) + "; export it again");
  };
  if (!read_header(job)) return damaged();
  auto sized = sized_image(job.width, job.height, static_cast<std::uint32_t>(job.channels), bytes.size(),
                           most_pixels_per_byte, file);
  if (!sized) return sized.error();
  if (!choose_samples(job)) return damaged();
  map_image& out = *sized;
  out.bits = static_cast<std::uint32_t>(job.depth);
  if (job.passes > 1) job.rows_kept = out.height;
  // From calloc, so that rows that the file does not hold take no memory.
  job.rows.reset(static_cast<unsigned char*>(std::calloc(job.rows_kept, job.row_bytes)));
  if (!job.rows) throw std::bad_alloc();
  for (int pass = 0; pass < job.passes; ++pass) {
    for (std::size_t j = 0; j < out.height; ++j) {
      watch.ask();
      if (!read_row(job, j)) return damaged();
      if (pass + 1 == job.passes) append_samples(job, j, out);
    }
  }
  if (!read_end(job)) return damaged();
  return sized;
}

std::string encode_grey_png(std::uint32_t width, std::uint32_t height, std::string_view bytes) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = width;
  image.height = height;
  image.format = PNG_FORMAT_GRAY;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::string out(size, '\0');
  if (png_image_write_to_memory(&image, out.data(), &size, 0, bytes.data(), 0, nullptr) == 0) throw std::bad_alloc();
  out.resize(size);
  return out;
}

}  // namespace asperity::io
