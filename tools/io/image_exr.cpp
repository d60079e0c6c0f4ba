// OpenEXR: one channel as heights, R, G and B as colour; half and float. One part of flat pixels, in lines or tiles,
// uncompressed or by RLE, ZIP or PIZ: what loses nothing.
#include <ImathBox.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfPartType.h>
#include <ImfTileDescription.h>
#include <ImfVersion.h>
#include <array>
#include <cstring>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "file_bytes.hpp"
#include "image_formats.hpp"

namespace asperity::io {
namespace {

constexpr std::size_t most_pixels_per_byte = std::size_t{1} << 15;

class memory_stream final : public Imf::IStream {
 public:
  memory_stream(std::string_view bytes, const reading_watch& watch) : IStream("image"), bytes_(bytes), watch_(watch) {}

  bool read(char to[], int count) override {
    watch_.ask();
    const auto n = static_cast<std::size_t>(count);
    if (count < 0 || n > bytes_.size() - at_) throw std::runtime_error("the file ends early");
    std::memcpy(to, bytes_.data() + at_, n);
    at_ += n;
    return at_ < bytes_.size();
  }
  std::uint64_t tellg() override { return at_; }
  void seekg(std::uint64_t position) override {
    if (position > bytes_.size()) throw std::runtime_error("the file ends early");
    at_ = static_cast<std::size_t>(position);
  }
  void clear() override {}

 private:
  std::string_view bytes_;
  const reading_watch& watch_;
  std::size_t at_ = 0;
};

/// Names of the channels that hold the map: R, G, B, or the only one, or luminance. Empty where there is no such
/// choice.
std::vector<std::string> map_channels(const Imf::ChannelList& channels) {
  if (channels.findChannel("R") != nullptr && channels.findChannel("G") != nullptr &&
      channels.findChannel("B") != nullptr)
    return {"R", "G", "B"};
  if (channels.findChannel("Y") != nullptr) return {"Y"};
  std::vector<std::string> all;
  for (auto c = channels.begin(); c != channels.end(); ++c) {
    if (std::strcmp(c.name(), "A") != 0) all.emplace_back(c.name());
  }
  return all.size() == 1 ? all : std::vector<std::string>();
}

/// What of the file's kind this reader does not know, by its version field, or nothing.
std::string unknown_in(int version) {
  if ((version & 0xff) != 2) return "is of EXR version " + std::to_string(version & 0xff) + "; export it as version 2";
  if (Imf::isNonImage(version)) return "holds deep pixels, several depths in each; export it flat";
  if (Imf::isMultiPart(version)) return "has several parts; export the one with the map as a file of its own";
  if ((version & ~(0xff | Imf::ALL_FLAGS)) != 0) return "has features that are not known; export it with one flat part";
  return {};
}

/// What of the header this reader does not know, or nothing.
std::string unknown_in(const Imf::Header& header) {
  switch (header.compression()) {
    case Imf::NO_COMPRESSION:
    case Imf::RLE_COMPRESSION:
    case Imf::ZIPS_COMPRESSION:
    case Imf::ZIP_COMPRESSION:
    case Imf::PIZ_COMPRESSION:
      break;
    default:
      return "is compressed with a loss or by a scheme that is not known; export it uncompressed, or with ZIP, PIZ or "
             "RLE";
  }
  if (header.hasType() && !Imf::isImage(header.type()))
    return "holds deep pixels, several depths in each; export it flat";
  constexpr std::uint64_t most_tile_pixels = std::uint64_t{1} << 22;  // a row of tiles is decoded at once
  if (header.hasTileDescription()) {
    const Imf::TileDescription& tile = header.tileDescription();
    const Imath::Box2i& window = header.dataWindow();
    const auto across = static_cast<std::uint64_t>(std::int64_t{window.max.x} - window.min.x + 1);
    if (tile.xSize == 0 || tile.ySize == 0 || tile.xSize > most_tile_pixels || tile.ySize > most_tile_pixels ||
        (across + tile.xSize) * tile.ySize > 4 * most_tile_pixels) {
      return "has tiles of " + std::to_string(tile.xSize) + " x " + std::to_string(tile.ySize) +
             " pixels, too large for its size; export it in scan lines";
    }
  }
  return {};
}

/// The header alone. An InputFile takes memory for the rows that its header claims, however few bytes there are.
/// @return unsupported, with what of the file is not known
result<Imf::Header> header_of(std::string_view bytes, const std::filesystem::path& file, const reading_watch& watch) {
  memory_stream stream(bytes, watch);
  std::array<char, 8> start{};  // magic number and version, little-endian
  stream.read(start.data(), static_cast<int>(start.size()));
  int version = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    version |= static_cast<int>(static_cast<unsigned char>(start[4 + k])) << (8 * k);
  }
  if (const std::string unknown = unknown_in(version); !unknown.empty())
    return fault(error_code::unsupported, file, unknown);
  Imf::Header header;
  header.readFrom(stream, version);
  if (const std::string unknown = unknown_in(header); !unknown.empty())
    return fault(error_code::unsupported, file, unknown);
  return header;
}

result<map_image> read_exr(std::string_view bytes, const std::filesystem::path& file, const reading_watch& watch) {
  const result<Imf::Header> read = header_of(bytes, file, watch);
  if (!read) return read.error();
  const Imf::Header& claimed = *read;
  const Imath::Box2i& window = claimed.dataWindow();
  const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
  const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
  const std::vector<std::string> names = map_channels(claimed.channels());
  if (names.empty())
    return fault(error_code::unsupported, file,
                 "has several channels, none of them R, G, B or Y; export the heights as one channel");
  for (const std::string& name : names) {
    const Imf::Channel& channel = claimed.channels()[name.c_str()];
    if (channel.xSampling != 1 || channel.ySampling != 1)
      return fault(error_code::unsupported, file, "has subsampled channels; export it at full resolution");
  }
  auto sized =
      sized_image(width < 0 ? 0 : static_cast<std::size_t>(width), height < 0 ? 0 : static_cast<std::size_t>(height),
                  static_cast<std::uint32_t>(names.size()), bytes.size(), most_pixels_per_byte, file);
  if (!sized) return sized.error();
  map_image& out = *sized;

  memory_stream stream(bytes, watch);
  Imf::InputFile image(stream, 0);
  // Row by row: a file that ends early has taken no memory for what it does not hold.
  const std::size_t pixel = sizeof(float) * names.size();
  std::vector<float> row(std::size_t{out.width} * names.size());
  for (int y = window.min.y; y <= window.max.y; ++y) {
    Imf::FrameBuffer frame;
    for (std::size_t c = 0; c < names.size(); ++c)
      frame.insert(names[c], Imf::Slice::Make(Imf::FLOAT, row.data() + c, Imath::V2i(window.min.x, y), out.width, 1,
                                              pixel, pixel * out.width));
    watch.ask();
    reserve_row(out, row.size());
    image.setFrameBuffer(frame);
    image.readPixels(y);
    out.samples.insert(out.samples.end(), row.begin(), row.end());
    if (y == window.max.y) break;  // the largest int has no successor
  }
  return finite_image(std::move(out), file);
}

}  // namespace

result<map_image> decode_exr(std::string_view bytes, const std::filesystem::path& file, reading_watch& watch) {
  try {
    return read_exr(bytes, file, watch);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& e) {
    watch.ask();  // OpenEXR turns what a stream throws into errors of its own
    return fault(error_code::bad_format, file,
                 "cannot be read as EXR: " + plain_reason(e.what()) + "; export it again, flat and with one part");
  }
}

}  // namespace asperity::io
