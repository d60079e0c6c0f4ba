// PNG files for tests, written without any library: stored, not compressed.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace asperity::test_support {

/// What a PNG is made of; each part can be given wrongly.
struct png_image {
  std::uint32_t width = 0, height = 0;
  int depth = 8;       ///< bits per sample
  int colour = 0;      ///< 0 grey, 2 RGB, 3 palette, 4 grey and alpha, 6 RGB and alpha
  std::string pixels;  ///< rows one after another, samples of 16 bits with their upper byte first
  std::string palette;

  [[nodiscard]] std::string bytes() const {
    std::string rows;
    const std::size_t row = height == 0 ? 0 : pixels.size() / height;
    for (std::size_t j = 0; j < height; ++j) rows += '\0' + pixels.substr(j * row, row);
    std::string header = word(width) + word(height);
    header += {static_cast<char>(depth), static_cast<char>(colour), 0, 0, 0};
    std::string out = "\x89PNG\r\n\x1a\n" + chunk("IHDR", header);
    if (!palette.empty()) out += chunk("PLTE", palette);
    return out + chunk("IDAT", stored(rows)) + chunk("IEND", {});
  }

  static std::string word(std::uint32_t x) {
    return {static_cast<char>(x >> 24), static_cast<char>(x >> 16 & 0xff), static_cast<char>(x >> 8 & 0xff),
            static_cast<char>(x & 0xff)};
  }

 private:
  static std::string chunk(std::string_view type, const std::string& data) {
    const std::string body = std::string(type) + data;
    std::uint32_t crc = 0xffffffff;
    for (const char c : body) {
      crc ^= static_cast<unsigned char>(c);
      for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1) != 0 ? 0xedb88320 : 0);
    }
    return word(static_cast<std::uint32_t>(data.size())) + body + word(~crc);
  }
  static std::string stored(std::string_view data) {
    std::string out("\x78\x01", 2);
    std::uint32_t a = 1, b = 0;
    for (const char c : data) {
      a = (a + static_cast<unsigned char>(c)) % 65521;
      b = (b + a) % 65521;
    }
    for (std::size_t at = 0; at < data.size(); at += 65535) {
      const std::size_t n = std::min<std::size_t>(65535, data.size() - at);
      out += static_cast<char>(at + n == data.size() ? 1 : 0);
      for (const std::size_t w : {n, ~n}) {
        out += static_cast<char>(w & 0xff);
        out += static_cast<char>(w >> 8 & 0xff);
      }
      out += data.substr(at, n);
    }
    return out + word(b << 16 | a);
  }
};

}  // namespace asperity::test_support
