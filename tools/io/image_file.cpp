#include "asperity/io/image_file.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "file_bytes.hpp"
#include "image_formats.hpp"

namespace asperity::io {
namespace {

constexpr std::uintmax_t max_image_bytes = std::uintmax_t{1} << 30;

}  // namespace

result<map_image> sized_image(std::size_t width, std::size_t height, std::uint32_t channels, std::size_t bytes,
                              std::size_t most_per_byte, const std::filesystem::path& file) {
  const std::string size = std::to_string(width) + " x " + std::to_string(height) + " pixels";
  if (width == 0 || height == 0)
    return fault(error_code::bad_format, file, "says that it has " + size + "; export it again");
  if (width > max_image_side || height > max_image_side || width * height * channels > max_image_samples)
    return fault(error_code::limit_exceeded, file,
                 "says that it has " + size + " of " + std::to_string(channels) +
                     (channels == 1 ? " channel" : " channels") + ", more than the limit of " +
                     std::to_string(max_image_side) + " a side and " + std::to_string(max_image_samples) +
                     " samples; reduce it first");
  if (width * height / most_per_byte > bytes)
    return fault(error_code::bad_format, file,
                 "says that it has " + size + ", which its " + std::to_string(bytes) +
                     " bytes cannot hold: it is cut off or damaged; export it again");
  map_image out;
  out.width = static_cast<std::uint32_t>(width);
  out.height = static_cast<std::uint32_t>(height);
  out.channels = channels;
  return out;
}

void reserve_row(map_image& image, std::size_t samples) {
  const std::size_t needed = image.samples.size() + samples;
  if (needed <= image.samples.capacity()) return;
  const std::size_t whole = std::size_t{image.width} * image.height * image.channels;
  // From a quarter on at once: a last step from nearly all to all would hold the image twice.
  image.samples.reserve(std::max(needed, 4 * needed >= whole ? whole : 2 * needed));
}

result<map_image> finite_image(map_image&& image, const std::filesystem::path& file) {
  for (std::size_t i = 0; i < image.samples.size(); ++i) {
    if (std::isfinite(image.samples[i])) continue;
    const std::size_t pixel = i / image.channels;
    return fault(error_code::bad_format, file,
                 "has a sample that is not a finite number, first at column " + std::to_string(pixel % image.width) +
                     ", row " + std::to_string(pixel / image.width) + "; fill such holes before exporting it");
  }
  return std::move(image);
}

std::string plain_reason(std::string_view text) {
  constexpr std::size_t longest = 160;
  std::string out(text.substr(0, longest));
  for (char& c : out) {
    if (c < ' ' || c > '~') c = ' ';
  }
  return out;
}

result<map_image> decode_image(std::string_view bytes, const std::filesystem::path& file, reading_watch watch) {
  using namespace std::string_view_literals;
  if (bytes.starts_with("\x89PNG\r\n\x1a\n"sv)) return decode_png(bytes, file, watch);
  if (bytes.starts_with("II\x2a\0"sv) || bytes.starts_with("MM\0\x2a"sv) || bytes.starts_with("II\x2b\0"sv) ||
      bytes.starts_with("MM\0\x2b"sv))
    return decode_tiff(bytes, file, watch);
  if (bytes.starts_with("\x76\x2f\x31\x01"sv)) return decode_exr(bytes, file, watch);
  if (bytes.starts_with("\xff\xd8\xff"sv)) return decode_jpeg(bytes, file, watch);
  return fault(error_code::unsupported, file,
               "does not begin like a PNG, TIFF, EXR or JPEG image; export it as one of these, heights best with 16 "
               "bits or as floating-point numbers");
}

result<map_image> load_image(const std::filesystem::path& file, const std::function<bool()>& keep_going) {
  return without_exceptions(file, [&]() -> result<map_image> {
    const reading_watch watch(keep_going);
    const auto bytes = read_file(file, max_image_bytes, watch);
    if (!bytes) return bytes.error();
    return decode_image(*bytes, file, watch);
  });
}

}  // namespace asperity::io
