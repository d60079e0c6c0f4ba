#include "relief_image.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <vector>

namespace asperity::io {
namespace {

/// Heights above the coarse surface at pixel centres; zero outside the charts.
struct height_image {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<double> pixels;
};

/// Barycentric coordinates of p in a triangle of the plane. @pre the triangle has area
vec3 barycentric(const std::array<vec2, 3>& t, const vec2& p) {
  const auto area2 = [](const vec2& a, const vec2& b, const vec2& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  };
  const double whole = area2(t[0], t[1], t[2]);
  const double b1 = area2(t[0], p, t[2]) / whole;
  const double b2 = area2(t[0], t[1], p) / whole;
  return {1.0 - b1 - b2, b1, b2};
}

void draw_triangle(const textured_model& model, std::size_t t, height_image& image) {
  const auto& uv = model.mesh.triangles[t].uv;
  const auto c = corners(model.mesh, t);
  const vec3 normal = glm::normalize(area_normal(c));
  const auto pixels = [](double x, double y, double z, std::uint32_t size) {
    const double last = size - 1.0;
    return std::pair(static_cast<std::uint32_t>(std::clamp(std::floor(std::min({x, y, z}) * size - 0.5), 0.0, last)),
                     static_cast<std::uint32_t>(std::clamp(std::ceil(std::max({x, y, z}) * size - 0.5), 0.0, last)));
  };
  const auto [left, right] = pixels(uv[0].x, uv[1].x, uv[2].x, image.width);
  const auto [low, high] = pixels(uv[0].y, uv[1].y, uv[2].y, image.height);
  for (std::uint32_t j = low; j <= high; ++j) {
    for (std::uint32_t i = left; i <= right; ++i) {
      const vec2 p((i + 0.5) / image.width, (j + 0.5) / image.height);
      const vec3 b = barycentric(uv, p);
      if (b.x < 0.0 || b.y < 0.0 || b.z < 0.0) continue;
      const vec3 coarse = b.x * c[0] + b.y * c[1] + b.z * c[2];
      image.pixels[std::size_t{j} * image.width + i] = glm::dot(normal, model.texture.sample(p) - coarse);
    }
  }
}

/// Checksum of a PNG chunk (polynomial 0xedb88320, bit by bit: the image is small).
std::uint32_t crc32(std::string_view bytes) noexcept {
  std::uint32_t crc = 0xffffffff;
  for (const char c : bytes) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1) != 0 ? 0xedb88320 : 0);
  }
  return ~crc;
}

std::uint32_t adler32(std::string_view bytes) noexcept {
  std::uint32_t a = 1;
  std::uint32_t b = 0;
  for (const char c : bytes) {
    a = (a + static_cast<unsigned char>(c)) % 65521;
    b = (b + a) % 65521;
  }
  return b << 16 | a;
}

void append_big_endian(std::string& to, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) to += static_cast<char>(value >> shift & 0xff);
}

void append_chunk(std::string& png, std::string_view type, std::string_view data) {
  append_big_endian(png, static_cast<std::uint32_t>(data.size()));
  const std::string body = std::string(type) + std::string(data);
  png += body;
  append_big_endian(png, crc32(body));
}

/// zlib stream of stored blocks: no compression, no compressor.
std::string stored(std::string_view data) {
  std::string out("\x78\x01", 2);
  constexpr std::size_t largest = 65535;
  for (std::size_t at = 0; at < data.size(); at += largest) {
    const std::size_t n = std::min(largest, data.size() - at);
    out += static_cast<char>(at + n == data.size() ? 1 : 0);
    for (const std::size_t word : {n, ~n}) {
      out += static_cast<char>(word & 0xff);
      out += static_cast<char>(word >> 8 & 0xff);
    }
    out += data.substr(at, n);
  }
  append_big_endian(out, adler32(data));
  return out;
}

std::string grey_png(const height_image& image) {
  double scale = 0.0;
  for (const double h : image.pixels) scale = std::max(scale, std::fabs(h));
  std::string rows;
  for (std::uint32_t j = 0; j < image.height; ++j) {
    rows += '\0';  // filter: none
    for (std::uint32_t i = 0; i < image.width; ++i) {
      const double h = image.pixels[std::size_t{j} * image.width + i];
      rows += static_cast<char>(std::lround(128.0 + (scale > 0.0 ? 127.0 * h / scale : 0.0)));
    }
  }
  std::string header;
  append_big_endian(header, image.width);
  append_big_endian(header, image.height);
  header += std::string("\x08\x00\x00\x00\x00", 5);  // 8 bits, grey, deflate, no filter method, not interlaced
  std::string png = "\x89PNG\r\n\x1a\n";
  append_chunk(png, "IHDR", header);
  append_chunk(png, "IDAT", stored(rows));
  append_chunk(png, "IEND", {});
  return png;
}

}  // namespace

std::string relief_png(const textured_model& model) {
  constexpr std::uint32_t largest_side = 256;
  height_image image;
  image.width = std::min(model.texture.width, largest_side);
  image.height = std::min(model.texture.height, largest_side);
  image.pixels.assign(std::size_t{image.width} * image.height, 0.0);
  for (std::size_t t = 0; t < model.mesh.triangles.size(); ++t) draw_triangle(model, t, image);
  return grey_png(image);
}

}  // namespace asperity::io
