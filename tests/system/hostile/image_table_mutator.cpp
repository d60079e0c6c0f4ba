// Mutations of TIFF and EXR: formats whose headers are tables, and point into the rest of the file.
#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "image_mutator.hpp"

namespace asperity::hostile {
namespace {

std::uint64_t number(std::string_view bytes, std::size_t at, std::size_t count, bool big_endian) {
  std::uint64_t out = 0;
  for (std::size_t i = 0; i < count; ++i) {
    out = out << 8 | static_cast<unsigned char>(bytes[at + (big_endian ? i : count - 1 - i)]);
  }
  return out;
}

void put(std::string& bytes, std::size_t at, std::size_t count, bool big_endian, std::uint64_t value) {
  for (std::size_t i = 0; i < count; ++i) {
    bytes[at + (big_endian ? count - 1 - i : i)] = static_cast<char>(value >> 8 * i & 0xff);
  }
}

void change(std::string& bytes, std::size_t at, std::size_t count, bool big_endian, random_source& random) {
  if (at + count > bytes.size()) return;
  const auto value = static_cast<std::uint32_t>(number(bytes, at, std::min<std::size_t>(count, 4), big_endian));
  put(bytes, at, count, big_endian, changed_number(value, random));
}

void change_byte(std::string& bytes, std::size_t from, std::size_t to, random_source& random) {
  if (from >= to || to > bytes.size()) return;
  char& at = bytes[from + random.below(to - from)];
  at = random.once_in(2) ? static_cast<char>(at ^ (1 << random.below(8))) : static_cast<char>(random.bits());
}

// --- TIFF

constexpr std::size_t entry_bytes = 12;

/// One change of the directory that begins at `start`, which has `count` entries.
void change_directory(std::string& tiff, std::size_t start, std::size_t count, bool big_endian, random_source& random) {
  static const std::vector<std::uint32_t> tags{254, 256, 257, 258, 259, 262, 266, 273, 274, 277, 278, 279, 284, 317,
                                               320, 322, 323, 324, 325, 338, 339, 340, 341, 347, 513, 514, 530, 532};
  const auto entry = [&](std::size_t i) { return start + 2 + entry_bytes * i; };
  const std::size_t at = entry(random.below(count)), other = entry(random.below(count));
  switch (random.below(9)) {
    case 0:
      put(tiff, at, 2, big_endian, random.one_of(tags));
      break;
    case 1:  // the type of its values
      put(tiff, at + 2, 2, big_endian, random.below(19));
      break;
    case 2:
      change(tiff, at + 4, 4, big_endian, random);
      break;
    case 3:  // an entry takes another one's place
      tiff.replace(at, entry_bytes, tiff.substr(other, entry_bytes));
      break;
    case 4:  // the last one is dropped, or the next directory is this one
      if (random.once_in(2)) {
        put(tiff, start, 2, big_endian, count - 1);
      } else {
        put(tiff, entry(count), 4, big_endian, start);
      }
      break;
    default:  // its value, which is short or long
      change(tiff, at + 8, number(tiff, at + 2, 2, big_endian) == 3 ? 2 : 4, big_endian, random);
  }
}

// --- EXR

struct exr_attribute {
  std::string name, type, data;
};

struct exr_parts {
  std::string version;  ///< magic number and version with its flags
  std::vector<exr_attribute> attributes;
  std::size_t header_bytes = 0;
  std::string rest;  ///< offsets, then blocks of lines
};

exr_parts parts_of(const std::string& exr) {
  exr_parts out;
  if (exr.size() < 9) return out;
  out.version = exr.substr(0, 8);
  std::size_t at = 8;
  while (at < exr.size() && exr[at] != '\0') {
    const std::size_t name_end = exr.find('\0', at), type_end = exr.find('\0', name_end + 1);
    if (name_end == std::string::npos || type_end == std::string::npos || type_end + 5 > exr.size()) return out;
    const std::size_t size = number(exr, type_end + 1, 4, false);
    if (size > exr.size() - type_end - 5) return out;
    out.attributes.push_back({exr.substr(at, name_end - at), exr.substr(name_end + 1, type_end - name_end - 1),
                              exr.substr(type_end + 5, size)});
    at = type_end + 5 + size;
  }
  out.header_bytes = std::min(at + 1, exr.size());
  out.rest = exr.substr(out.header_bytes);
  return out;
}

std::string exr_bytes(exr_parts parts, random_source& random) {
  std::string out = parts.version;
  for (const exr_attribute& a : parts.attributes) {
    out += a.name + '\0' + a.type + '\0' + "size" + a.data;
    auto size = static_cast<std::uint32_t>(a.data.size());
    if (random.once_in(200)) size = changed_number(size, random);
    put(out, out.size() - a.data.size() - 4, 4, false, size);
  }
  out += '\0';
  // The first offset tells where the offsets end.
  if (parts.rest.size() >= 8) {
    const std::uint64_t first = number(parts.rest, 0, 8, false);
    for (std::size_t at = 0; at + 8 <= parts.rest.size() && parts.header_bytes + at < first; at += 8) {
      put(parts.rest, at, 8, false, number(parts.rest, at, 8, false) + out.size() - parts.header_bytes);
    }
  }
  return out + parts.rest;
}

void change_exr(exr_parts& parts, random_source& random) {
  if (parts.attributes.empty()) return;
  std::vector<exr_attribute>& list = parts.attributes;
  const std::size_t i = random.below(list.size());
  exr_attribute& a = list[i];
  switch (random.below(10)) {
    case 0:
    case 1:  // a number of a window, a ratio, a channel's type or sampling
      if (a.data.size() >= 4) change(a.data, 4 * random.below(a.data.size() / 4), 4, false, random);
      break;
    case 2:
      change_byte(a.data, 0, a.data.size(), random);
      break;
    case 3:
      if (random.once_in(2)) {
        a.name = list[random.below(list.size())].name;
      } else {
        a.type = list[random.below(list.size())].type;
      }
      break;
    case 4:
      if (random.once_in(2)) {
        list.erase(list.begin() + static_cast<std::ptrdiff_t>(i));
      } else {
        list.push_back(exr_attribute(list[random.below(list.size())]));
      }
      break;
    case 5:
      a.data.resize(random.below(2 * a.data.size() + 2));
      break;
    case 6:  // tiles, long names, deep data, several parts
      change_byte(parts.version, 4, 8, random);
      break;
    case 7:
      if (parts.rest.size() >= 16) change(parts.rest, 8 * random.below(2), 8, false, random);
      break;
    default:
      change_byte(parts.rest, 0, parts.rest.size(), random);
  }
}

}  // namespace

std::string mutated_tiff(const std::string& tiff, random_source& random) {
  if (tiff.size() < 8) return mutated_bytes(tiff, random);
  std::string out = tiff;
  const bool big_endian = out[0] == 'M';
  for (std::size_t changes = 1 + random.below(3); changes > 0; --changes) {
    const std::size_t start = number(out, 4, 4, big_endian);
    const std::size_t count = start + 2 <= out.size() ? number(out, start, 2, big_endian) : 0;
    if (count == 0 || start + 6 + entry_bytes * count > out.size()) return mutated_bytes(out, random);
    const std::size_t what = random.below(20);
    if (what < 12) {
      change_directory(out, start, count, big_endian, random);
    } else if (what < 18) {
      change_byte(out, 8, out.size(), random);
    } else if (what == 18) {
      change_byte(out, 0, 8, random);
    } else {
      out.resize(out.size() - random.below(out.size() / 2));
    }
  }
  return out;
}

std::string mutated_exr(const std::string& exr, random_source& random) {
  exr_parts parts = parts_of(exr);
  if (parts.attributes.empty()) return mutated_bytes(exr, random);
  for (std::size_t changes = 1 + random.below(3); changes > 0; --changes) change_exr(parts, random);
  return exr_bytes(std::move(parts), random);
}

}  // namespace asperity::hostile
