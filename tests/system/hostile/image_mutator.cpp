#include "image_mutator.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

namespace asperity::hostile {
namespace {

std::uint32_t big_endian(std::string_view bytes, std::size_t at, std::size_t count) {
  std::uint32_t out = 0;
  for (std::size_t i = 0; i < count; ++i) out = out << 8 | static_cast<unsigned char>(bytes[at + i]);
  return out;
}

std::string big_endian(std::uint32_t value, std::size_t count) {
  std::string out;
  for (std::size_t i = count; i-- > 0;) out += static_cast<char>(value >> 8 * i & 0xff);
  return out;
}

void change_byte(std::string& bytes, random_source& random, std::size_t from = 0) {
  if (bytes.size() <= from) return;
  char& at = bytes[from + random.below(bytes.size() - from)];
  at = random.once_in(2) ? static_cast<char>(at ^ (1 << random.below(8))) : static_cast<char>(random.bits());
}

void change_number(std::string& bytes, std::size_t at, std::size_t count, random_source& random) {
  if (at + count > bytes.size()) return;
  bytes.replace(at, count, big_endian(changed_number(big_endian(bytes, at, count), random), count));
}

std::string noise(std::size_t count, random_source& random) {
  std::string out;
  for (std::size_t i = 0; i < count; ++i) out += static_cast<char>(random.bits());
  return out;
}

/// A list takes a doubled, a dropped or two swapped items.
template <class Item>
void shuffle(std::vector<Item>& list, random_source& random) {
  if (list.empty()) return;
  const std::size_t at = random.below(list.size());
  switch (random.below(3)) {
    case 0:
      list.insert(list.begin() + static_cast<std::ptrdiff_t>(at), Item(list[random.below(list.size())]));
      break;
    case 1:
      list.erase(list.begin() + static_cast<std::ptrdiff_t>(at));
      break;
    default:
      std::swap(list[at], list[random.below(list.size())]);
  }
}

// --- PNG

struct png_chunk {
  std::string type, data;
};

constexpr std::string_view png_start("\x89PNG\r\n\x1a\n", 8);

std::vector<png_chunk> png_chunks(const std::string& png) {
  std::vector<png_chunk> out;
  for (std::size_t at = png_start.size(); at + 12 <= png.size();) {
    const std::size_t size = big_endian(png, at, 4);
    if (size > png.size() - at - 12) break;
    out.push_back({png.substr(at + 4, 4), png.substr(at + 8, size)});
    at += size + 12;
  }
  return out;
}

std::string png_bytes(const std::vector<png_chunk>& chunks, random_source& random) {
  std::string out(png_start);
  for (const png_chunk& c : chunks) {
    std::uint32_t crc = 0xffffffff;
    for (const std::string* part : {&c.type, &c.data}) {
      for (const char byte : *part) {
        crc ^= static_cast<unsigned char>(byte);
        for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1) != 0 ? 0xedb88320 : 0);
      }
    }
    auto size = static_cast<std::uint32_t>(c.data.size());
    if (random.once_in(100)) size = changed_number(size, random);
    out += big_endian(size, 4) + c.type + c.data + big_endian(random.once_in(100) ? crc + 1 : ~crc, 4);
  }
  return out;
}

/// Of a stream of stored blocks (and of no other) the checksum is made right again.
void mend_adler(std::string& zlib) {
  if (zlib.size() < 11 || !zlib.starts_with("\x78\x01") || zlib[2] != 1) return;
  const std::size_t stored = static_cast<unsigned char>(zlib[3]) | static_cast<std::size_t>(zlib[4] & 0xff) << 8;
  if (zlib.size() != stored + 11) return;
  std::uint32_t a = 1, b = 0;
  for (std::size_t i = 7; i < 7 + stored; ++i) {
    a = (a + static_cast<unsigned char>(zlib[i])) % 65521;
    b = (b + a) % 65521;
  }
  zlib.replace(7 + stored, 4, big_endian(b << 16 | a, 4));
}

void change_png(std::vector<png_chunk>& chunks, random_source& random) {
  static const std::vector<std::string> types{"IHDR", "PLTE", "IDAT", "IEND", "tRNS", "gAMA", "cHRM", "sRGB",
                                              "iCCP", "tEXt", "zTXt", "iTXt", "bKGD", "pHYs", "sBIT", "sPLT",
                                              "hIST", "tIME", "oFFs", "pCAL", "sCAL", "eXIf", "noNe"};
  png_chunk& c = chunks[random.below(chunks.size())];
  const std::size_t what = random.below(10);
  if (what < 3) {  // a field of the header
    std::string& header = chunks.front().data;
    const std::size_t field = random.below(7);
    if (field < 2) {
      change_number(header, 4 * field, 4, random);
    } else if (header.size() == 13) {
      static const std::vector<char> values{0, 1, 2, 3, 4, 6, 8, 16, 5, 7, 32};
      header[6 + field] = random.one_of(values);
    }
  } else if (what < 7) {  // what a chunk holds
    change_byte(c.data, random, c.type == "IDAT" && !random.once_in(8) ? 7 : 0);
    if (c.type == "IDAT") mend_adler(c.data);
  } else if (what == 7) {
    shuffle(chunks, random);
  } else if (what == 8) {
    if (random.once_in(2)) {
      c.type = random.one_of(types);
    } else if (!c.data.empty()) {  // a chunk becomes two, or shorter
      const std::size_t cut = random.below(c.data.size());
      const png_chunk rest{c.type, c.data.substr(cut)};
      c.data.resize(cut);
      const auto next = chunks.begin() + (&c - chunks.data()) + 1;
      if (!random.once_in(3)) chunks.insert(next, rest);
    }
  } else {
    const png_chunk extra{random.one_of(types), noise(random.below(40), random)};
    chunks.insert(chunks.begin() + static_cast<std::ptrdiff_t>(random.below(chunks.size() + 1)), extra);
  }
}

// --- JPEG

/// A marker with what follows it up to the next one: a segment, or a scan with its data.
struct jpeg_part {
  unsigned char marker = 0;
  std::string payload, scan;
};

std::vector<jpeg_part> jpeg_parts(const std::string& jpeg) {
  std::vector<jpeg_part> out;
  for (std::size_t at = 2; at + 4 <= jpeg.size() && jpeg[at] == '\xff';) {
    const std::size_t size = big_endian(jpeg, at + 2, 2);
    if (size < 2 || at + 2 + size > jpeg.size()) break;
    jpeg_part part{static_cast<unsigned char>(jpeg[at + 1]), jpeg.substr(at + 4, size - 2), {}};
    at += 2 + size;
    if (part.marker == 0xda) {
      const std::size_t begin = at;
      while (at + 1 < jpeg.size() && !(jpeg[at] == '\xff' && jpeg[at + 1] != 0)) ++at;
      part.scan = jpeg.substr(begin, at - begin);
    }
    out.push_back(std::move(part));
  }
  return out;
}

std::string jpeg_bytes(const std::vector<jpeg_part>& parts, random_source& random) {
  std::string out("\xff\xd8", 2);
  for (const jpeg_part& p : parts) {
    auto size = static_cast<std::uint32_t>(p.payload.size() + 2);
    if (random.once_in(100)) size = changed_number(size, random);
    out += '\xff';
    out += static_cast<char>(p.marker);
    out += big_endian(size, 2) + p.payload + p.scan;
  }
  return random.once_in(50) ? out : out + std::string("\xff\xd9", 2);
}

void change_jpeg(std::vector<jpeg_part>& parts, random_source& random) {
  const auto frame =
      std::find_if(parts.begin(), parts.end(), [](const jpeg_part& p) { return (p.marker & 0xf0) == 0xc0; });
  jpeg_part& p = parts[random.below(parts.size())];
  switch (random.below(8)) {
    case 0:  // height, width
      if (frame != parts.end()) change_number(frame->payload, random.once_in(2) ? 1 : 3, 2, random);
      break;
    case 1:  // precision, components and how they are sampled
      if (frame != parts.end()) change_byte(frame->payload, random, random.once_in(8) ? 0 : 5);
      break;
    case 2:
    case 3:
      change_byte(p.payload, random);
      break;
    case 4:
      change_byte(p.scan.empty() ? p.payload : p.scan, random);
      break;
    case 5:
      shuffle(parts, random);
      break;
    case 6:
      if (random.once_in(2)) {
        p.marker = static_cast<unsigned char>(0xc0 + random.below(0x3f));
      } else {
        p.payload.resize(random.below(p.payload.size() + 1));
      }
      break;
    default:
      parts.insert(parts.begin() + static_cast<std::ptrdiff_t>(random.below(parts.size() + 1)),
                   {static_cast<unsigned char>(0xc0 + random.below(0x3f)), noise(random.below(30), random), {}});
  }
}

}  // namespace

std::uint32_t changed_number(std::uint32_t value, random_source& random) {
  static const std::array<std::uint32_t, 16> strange{
      0, 1, 2, 3, 255, 256, 257, 4096, 16384, 32768, 65535, 0x7fffffff, 0x80000000, 0xffffffff, 0xfffffff8, 100000};
  switch (random.below(4)) {
    case 0:
      return strange[random.below(strange.size())];
    case 1:
      return value ^ 1U << random.below(32);
    case 2:
      return random.once_in(2) ? 2 * value : value / 2;
    default:
      return random.once_in(2) ? value + 1 : value - 1;
  }
}

std::string mutated_bytes(const std::string& bytes, random_source& random) {
  std::string out = bytes;
  for (std::size_t changes = 1 + random.below(4); changes > 0 && !out.empty(); --changes) {
    const std::size_t at = random.below(out.size());
    switch (random.below(8)) {
      case 0:
        out.resize(at);
        break;
      case 1:
        out.insert(at, noise(random.below(12), random));
        break;
      case 2:
        out.erase(at, random.below(12));
        break;
      case 3:
        out.replace(at, std::min<std::size_t>(4, out.size() - at), noise(4, random));
        break;
      default:
        change_byte(out, random);
    }
  }
  return out;
}

std::string mutated_png(const std::string& png, random_source& random) {
  std::vector<png_chunk> chunks = png_chunks(png);
  if (chunks.empty() || !png.starts_with(png_start)) return mutated_bytes(png, random);
  for (std::size_t changes = 1 + random.below(3); changes > 0 && !chunks.empty(); --changes) change_png(chunks, random);
  return png_bytes(chunks, random);
}

std::string mutated_jpeg(const std::string& jpeg, random_source& random) {
  std::vector<jpeg_part> parts = jpeg_parts(jpeg);
  if (parts.empty() || !jpeg.starts_with("\xff\xd8")) return mutated_bytes(jpeg, random);
  for (std::size_t changes = 1 + random.below(3); changes > 0 && !parts.empty(); --changes) change_jpeg(parts, random);
  return jpeg_bytes(parts, random);
}

}  // namespace asperity::hostile
