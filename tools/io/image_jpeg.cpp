// JPEG through libjpeg: what many assets keep their normal maps in. Lossy: for heights it is the poorest choice.
#include <csetjmp>
#include <cstddef>
#include <cstdio>
#include <jpeglib.h>
#include <string>
#include <vector>

#include "file_bytes.hpp"
#include "image_formats.hpp"

namespace asperity::io {
namespace {

constexpr std::size_t most_pixels_per_byte = std::size_t{1} << 13;

/// Stands outside the functions that libjpeg may leave by longjmp: a jump runs no destructors.
struct jpeg_job {
  jpeg_decompress_struct jpeg{};
  jpeg_error_mgr errors{};
  std::jmp_buf back;
  char reason[JMSG_LENGTH_MAX] = "";
  std::vector<unsigned char> row;
  jpeg_progress_mgr progress{};
  const reading_watch& watch;

  explicit jpeg_job(const reading_watch& w) : watch(w) {
    jpeg.err = jpeg_std_error(&errors);
    errors.error_exit = on_error;
    errors.emit_message = on_warning;
    progress.progress_monitor = on_progress;
    jpeg.client_data = this;
  }
  jpeg_job(const jpeg_job&) = delete;
  jpeg_job& operator=(const jpeg_job&) = delete;
  ~jpeg_job() { jpeg_destroy_decompress(&jpeg); }

  static void on_error(j_common_ptr jpeg) {
    auto& job = *static_cast<jpeg_job*>(jpeg->client_data);
    (*jpeg->err->format_message)(jpeg, job.reason);
    longjmp(job.back, 1);
  }
  /// A progressive image is decoded as a whole before its first row; this is called on the way.
  static void on_progress(j_common_ptr jpeg) {
    auto& job = *static_cast<jpeg_job*>(jpeg->client_data);
    if (!job.watch.goes_on()) longjmp(job.back, 1);
  }
  /// libjpeg fills up what is missing and warns; here that is an error.
  static void on_warning(j_common_ptr jpeg, int level) {
    if (level < 0) on_error(jpeg);
  }
};

bool read_header(jpeg_job& job, std::string_view bytes) {
  if (setjmp(job.back) != 0) return false;
  jpeg_create_decompress(&job.jpeg);
  jpeg_mem_src(&job.jpeg, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  job.jpeg.progress = &job.progress;
  (void)jpeg_read_header(&job.jpeg, TRUE);
  job.jpeg.out_color_space = job.jpeg.num_components == 1 ? JCS_GRAYSCALE : JCS_RGB;
  return true;
}

bool start(jpeg_job& job) {
  if (setjmp(job.back) != 0) return false;
  (void)jpeg_start_decompress(&job.jpeg);
  return true;
}

bool read_row(jpeg_job& job) {
  if (setjmp(job.back) != 0) return false;
  JSAMPROW row = job.row.data();
  return jpeg_read_scanlines(&job.jpeg, &row, 1) == 1;
}

}  // namespace

result<map_image> decode_jpeg(std::string_view bytes, const std::filesystem::path& file, reading_watch& watch) {
  jpeg_job job(watch);
  const auto damaged = [&] {
    watch.ask();
    return fault(error_code::bad_format, file,
                 "cannot be read as JPEG: " + plain_reason(job.reason) + "; export it again");
  };
  if (!read_header(job, bytes)) return damaged();
  const std::uint32_t channels = job.jpeg.num_components == 1 ? 1 : 3;
  auto sized =
      sized_image(job.jpeg.image_width, job.jpeg.image_height, channels, bytes.size(), most_pixels_per_byte, file);
  if (!sized) return sized.error();
  if (!start(job)) return damaged();
  sized->bits = 8;
  job.row.resize(std::size_t{sized->width} * channels);
  for (std::uint32_t j = 0; j < sized->height; ++j) {
    watch.ask();
    if (!read_row(job)) return damaged();
    reserve_row(*sized, job.row.size());
    for (const unsigned char value : job.row) sized->samples.push_back(static_cast<float>(value) / 255.0F);
  }
  return sized;
}

}  // namespace asperity::io
