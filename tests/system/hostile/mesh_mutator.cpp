#include "mesh_mutator.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

namespace asperity::hostile {
namespace {

constexpr std::array<std::array<float, 3>, 4> corners{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
constexpr std::array<std::array<std::uint32_t, 3>, 4> faces{{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};

template <class T>
void append(std::string& to, const T& value) {
  to.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string ply_header(const std::string& format) {
  return "ply\nformat " + format +
         " 1.0\ncomment small\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
         "element face 4\nproperty list uchar uint vertex_indices\nend_header\n";
}

std::string words_of(const std::array<float, 3>& p) {
  std::string out;
  for (const float x : p) out += std::to_string(static_cast<int>(x)) + " ";
  return out;
}

/// Begin and end of every word, or of every line.
std::vector<std::pair<std::size_t, std::size_t>> pieces(const std::string& text, std::size_t end, const char* between) {
  std::vector<std::pair<std::size_t, std::size_t>> out;
  for (std::size_t at = text.find_first_not_of(between); at < end; at = text.find_first_not_of(between, at)) {
    const std::size_t stop = std::min(text.find_first_of(between, at), end);
    out.emplace_back(at, stop);
    at = stop;
  }
  return out;
}

std::size_t change_text(std::string& file, std::size_t end, random_source& random) {
  static const std::vector<std::string> words{"0",
                                              "1",
                                              "-1",
                                              "3",
                                              "4",
                                              "255",
                                              "99999999999999999999",
                                              "4294967295",
                                              "2147483648",
                                              "nan",
                                              "inf",
                                              "1e999",
                                              "1e-999",
                                              "0x10",
                                              "-",
                                              "",
                                              "vertex",
                                              "face",
                                              "list",
                                              "float",
                                              "uchar",
                                              "int",
                                              "x",
                                              "ply",
                                              "end_header",
                                              "element",
                                              "property",
                                              "v",
                                              "f",
                                              "vt",
                                              "solid",
                                              "facet",
                                              "vertex",
                                              "endloop",
                                              "1/1",
                                              "-2//3",
                                              "double",
                                              "int8",
                                              "element face 7",
                                              "endsolid",
                                              "1/9",
                                              "\xff\xfe",
                                              "\\",
                                              "property float q"};
  const auto places = pieces(file, end, random.once_in(4) ? "\n" : " \n");
  if (places.empty()) return end;
  const auto [first, last] = random.one_of(places);
  const auto [other, other_end] = random.one_of(places);
  const std::string here = file.substr(first, last - first);
  std::string by;
  switch (random.below(5)) {
    case 0:
      by = file.substr(other, other_end - other);
      break;
    case 1:
      by = here + " " + here;
      break;
    case 2:
      break;  // dropped
    default:
      by = random.one_of(words);
  }
  file.replace(first, last - first, by);
  return end + by.size() - here.size();
}

void change_bytes(std::string& file, std::size_t begin, random_source& random) {
  static const std::vector<std::uint32_t> words{0,          1,          3,          4,          5,
                                                0x7fc00000, 0x7f800000, 0xffffffff, 0x7fffffff, 0x3f800000};
  if (file.size() < begin + 5) return;
  const std::size_t at = begin + random.below(file.size() - begin - 4);
  if (random.once_in(2)) {
    std::memcpy(file.data() + at, &random.one_of(words), 4);
  } else {
    file[at] = static_cast<char>(random.bits());
  }
}

}  // namespace

std::string good_ascii_ply() {
  std::string out = ply_header("ascii");
  for (const auto& p : corners) out += words_of(p) + "\n";
  for (const auto& f : faces) {
    out += '3';
    for (const std::uint32_t v : f) out.append(" ").append(std::to_string(v));
    out += '\n';
  }
  return out;
}

std::string good_binary_ply() {
  std::string out = ply_header("binary_little_endian");
  for (const auto& p : corners) append(out, p);
  for (const auto& f : faces) {
    out += '\3';
    append(out, f);
  }
  return out;
}

std::string good_obj() {
  std::string out = "# small\nvt 0 0\nvt 1 0\nvt 0 1\n";
  for (const auto& p : corners) out += "v " + words_of(p) + "\n";
  for (const auto& f : faces) {
    out += 'f';
    for (std::size_t k = 0; k < 3; ++k) {
      out.append(" ").append(std::to_string(f[k] + 1)).append("/").append(std::to_string(k + 1));
    }
    out += '\n';
  }
  return out + "f -4 -3 -2 -1\n";
}

std::string good_ascii_stl() {
  std::string out = "solid small\n";
  for (const auto& f : faces) {
    out += "facet normal 0 0 1\nouter loop\n";
    for (const std::uint32_t v : f) out += "vertex " + words_of(corners[v]) + "\n";
    out += "endloop\nendfacet\n";
  }
  return out + "endsolid small\n";
}

std::string good_binary_stl() {
  std::string out(80, ' ');
  append(out, static_cast<std::uint32_t>(faces.size()));
  for (const auto& f : faces) {
    append(out, corners[0]);
    for (const std::uint32_t v : f) append(out, corners[v]);
    out.append(2, '\0');
  }
  return out;
}

std::string mutated_mesh(const std::string& file, std::size_t text_end, random_source& random) {
  std::string out = file;
  for (std::size_t changes = 1 + random.below(3); changes > 0; --changes) {
    if (text_end > 0 && (text_end >= out.size() || random.once_in(2))) {
      text_end = change_text(out, text_end, random);
    } else {
      change_bytes(out, text_end, random);
    }
  }
  if (random.once_in(10)) out.resize(random.below(out.size() + 1));
  return out;
}

}  // namespace asperity::hostile
