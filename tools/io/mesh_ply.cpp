// PLY: ascii and binary of either byte order, any property types, any further elements and properties.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "file_bytes.hpp"
#include "file_formats.hpp"
#include "mesh_builder.hpp"
#include "text_cursor.hpp"

namespace asperity::io {
namespace {

enum class scalar : std::uint8_t { i8, u8, i16, u16, i32, u32, f32, f64 };

constexpr std::size_t size_of(scalar s) noexcept {
  constexpr std::array<std::size_t, 8> sizes{1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<std::size_t>(s)];
}

std::optional<scalar> scalar_named(std::string_view name) {
  constexpr std::array<std::array<std::string_view, 2>, 8> names{{{"char", "int8"},
                                                                  {"uchar", "uint8"},
                                                                  {"short", "int16"},
                                                                  {"ushort", "uint16"},
                                                                  {"int", "int32"},
                                                                  {"uint", "uint32"},
                                                                  {"float", "float32"},
                                                                  {"double", "float64"}}};
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (name == names[i][0] || name == names[i][1]) return static_cast<scalar>(i);
  }
  return std::nullopt;
}

/// What a property means to us.
enum class role : std::uint8_t { none, x, y, z, corners };

struct property {
  scalar type = scalar::f32;
  std::optional<scalar> list_count;  // set where the property is a list
  role meaning = role::none;
};

struct element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<property> properties;

  [[nodiscard]] bool has(role r) const {
    return std::any_of(properties.begin(), properties.end(), [r](const property& p) { return p.meaning == r; });
  }
};

enum class encoding : std::uint8_t { none, ascii, little, big };

/// Limit for elements, and for the properties of one: both are searched by name.
constexpr std::size_t max_header_items = 256;

struct ply_header {
  encoding format = encoding::none;
  std::vector<element> elements;
  std::size_t bytes = 0;
  std::size_t lines = 0;
};

/// Role of a property in its element; only scalars can be coordinates and only lists can be corners.
role role_of(std::string_view element_name, std::string_view name, bool list) {
  if (element_name == "vertex" && !list) {
    return name == "x" ? role::x : name == "y" ? role::y : name == "z" ? role::z : role::none;
  }
  if (element_name == "face" && list && (name == "vertex_indices" || name == "vertex_index")) return role::corners;
  return role::none;
}

class header_reader {
 public:
  header_reader(std::string_view bytes, const std::filesystem::path& file, reading_watch& watch)
      : bytes_(bytes), cursor_(bytes, watch), file_(file) {}

  result<ply_header> read() {
    if (cursor_.word() != "ply" || !cursor_.next_line()) return bad("is not 'ply', so this is no PLY file");
    for (;;) {
      const std::string_view keyword = cursor_.word();
      if (keyword == "end_header") break;
      bool good = true;
      if (keyword == "format") {
        good = read_format();
      } else if (keyword == "element") {
        good = read_element();
      } else if (keyword == "property") {
        good = read_property();
      } else if (!keyword.empty() && keyword != "comment" && keyword != "obj_info") {
        return bad("has the unknown keyword " + in_quotes(keyword));
      }
      if (!good) return bad(what_);
      if (!cursor_.next_line()) return bad("ends before 'end_header', so the file is cut off");
    }
    if (!cursor_.next_line()) return bad("ends after 'end_header', so the file is cut off");
    if (header_.format == encoding::none) return bad("ends a header without a 'format' line");
    header_.bytes = bytes_.size() - cursor_.left();
    header_.lines = cursor_.line();
    return std::move(header_);
  }

 private:
  error bad(const std::string& what) const {
    return fault(error_code::bad_format, file_, cursor_.place() + " " + what + "; export the mesh again");
  }

  bool read_format() {
    const std::string_view name = cursor_.word();
    header_.format = name == "ascii"                  ? encoding::ascii
                     : name == "binary_little_endian" ? encoding::little
                     : name == "binary_big_endian"    ? encoding::big
                                                      : encoding::none;
    what_ = "has a format other than ascii, binary_little_endian and binary_big_endian";
    return header_.format != encoding::none;
  }

  bool read_element() {
    element e;
    e.name = cursor_.word();
    what_ = "needs a name and a number after 'element'";
    if (e.name.empty() || !to_number(cursor_.word(), e.count)) return false;
    what_ = "is one element more than the limit of " + std::to_string(max_header_items);
    if (header_.elements.size() == max_header_items) return false;
    header_.elements.push_back(std::move(e));
    return true;
  }

  bool read_property() {
    what_ = "has a property before any element";
    if (header_.elements.empty()) return false;
    element& owner = header_.elements.back();
    property p;
    std::string_view type = cursor_.word();
    const bool list = type == "list";
    if (list) {
      p.list_count = scalar_named(cursor_.word());
      what_ = "has a list whose length is not of an integer type";
      if (!p.list_count || *p.list_count >= scalar::f32) return false;
      type = cursor_.word();
    }
    const auto known = scalar_named(type);
    what_ = "has the unknown property type " + in_quotes(type);
    if (!known) return false;
    p.type = *known;
    p.meaning = role_of(owner.name, cursor_.word(), list);
    what_ = "names a property a second time";
    if (p.meaning != role::none && owner.has(p.meaning)) return false;
    what_ = "has vertex indices that are not of an integer type";
    if (p.meaning == role::corners && p.type >= scalar::f32) return false;
    what_ = "is one property more than the limit of " + std::to_string(max_header_items);
    if (owner.properties.size() == max_header_items) return false;
    owner.properties.push_back(p);
    return true;
  }

  std::string_view bytes_;
  text_cursor cursor_;
  const std::filesystem::path& file_;
  ply_header header_;
  std::string what_;
};

/// Numbers of an ascii body.
class ascii_source {
 public:
  ascii_source(std::string_view body, std::size_t line, reading_watch& watch) : cursor_(body, watch, line) {}

  bool number(scalar, double& value) {
    const std::string_view word = cursor_.word_anywhere();
    cut_off_ = word.empty();
    return to_number(word, value);
  }
  /// Smallest size of one number: a digit and what parts it from the next.
  static std::size_t least_bytes(scalar) noexcept { return 2; }
  [[nodiscard]] std::size_t left() const { return cursor_.left() + 1; }  // the last number needs nothing after it
  [[nodiscard]] std::string place() const { return cursor_.place(); }
  [[nodiscard]] bool cut_off() const { return cut_off_; }
  bool at_end() { return cursor_.word_anywhere().empty(); }

 private:
  text_cursor cursor_;
  bool cut_off_ = false;
};

/// Numbers of a binary body of either byte order.
class binary_source {
 public:
  binary_source(std::string_view body, std::size_t offset, bool swapped)
      : body_(body), offset_(offset), swapped_(swapped) {}

  bool number(scalar type, double& value) {
    const std::size_t n = size_of(type);
    cut_off_ = body_.size() - at_ < n;
    if (cut_off_) return false;
    std::array<char, 8> raw{};
    const char* from = body_.data() + at_;
    for (std::size_t i = 0; i < n; ++i) raw[i] = from[swapped_ ? n - 1 - i : i];
    at_ += n;
    switch (type) {
      case scalar::i8:
        value = load_number<std::int8_t>(raw.data());
        break;
      case scalar::u8:
        value = load_number<std::uint8_t>(raw.data());
        break;
      case scalar::i16:
        value = load_number<std::int16_t>(raw.data());
        break;
      case scalar::u16:
        value = load_number<std::uint16_t>(raw.data());
        break;
      case scalar::i32:
        value = load_number<std::int32_t>(raw.data());
        break;
      case scalar::u32:
        value = load_number<std::uint32_t>(raw.data());
        break;
      case scalar::f32:
        value = static_cast<double>(load_number<float>(raw.data()));
        break;
      case scalar::f64:
        value = load_number<double>(raw.data());
        break;
    }
    return true;
  }
  static std::size_t least_bytes(scalar type) noexcept { return size_of(type); }
  [[nodiscard]] std::size_t left() const { return body_.size() - at_; }
  [[nodiscard]] std::string place() const { return "byte " + std::to_string(offset_ + at_); }
  [[nodiscard]] bool cut_off() const { return cut_off_; }
  /// Line ends behind the last element are harmless; anything else means that the counts are wrong.
  bool at_end() {
    while (at_ < body_.size() && (body_[at_] == '\n' || body_[at_] == '\r')) ++at_;
    return at_ == body_.size();
  }

 private:
  std::string_view body_;
  std::size_t offset_;
  std::size_t at_ = 0;
  bool swapped_;
  bool cut_off_ = false;
};

template <class Source>
class body_reader {
 public:
  body_reader(Source source, const std::filesystem::path& file, reading_watch& watch)
      : source_(std::move(source)), file_(file), watch_(watch) {}

  result<triangle_mesh> read(const ply_header& header) {
    for (const element& e : header.elements) {
      if (e.properties.empty()) continue;  // nothing is stored of it, whatever its count
      if (!fits(e)) {
        return bad("begins " + std::to_string(e.count) + " elements " + in_quotes(e.name) + ", more than the " +
                   std::to_string(source_.left()) +
                   " bytes that follow can hold: the file is cut off or its header wrong");
      }
      for (index_ = 0; index_ < e.count; ++index_) {
        if (!read_one(e)) return bad(what_ + " (" + name_of(e) + " " + std::to_string(index_) + ")");
      }
    }
    if (!source_.at_end()) return bad("has more data than the header announces");
    for (std::size_t k = 0, corner = 0; k < soup_.ends.size(); ++k) {
      for (; corner < soup_.ends[k]; ++corner) {
        if (soup_.corners[corner] >= soup_.positions.size()) {
          return fault(error_code::bad_format, file_,
                       "face " + std::to_string(k) + " names vertex " + std::to_string(soup_.corners[corner]) + " of " +
                           std::to_string(soup_.positions.size()) + "; export the mesh again");
        }
      }
    }
    return build_mesh(std::move(soup_), file_, watch_);
  }

 private:
  error bad(const std::string& what) const {
    return fault(error_code::bad_format, file_, source_.place() + " " + what + "; export the mesh again");
  }

  /// Whether what is left can hold all elements at their smallest. Makes every later reserve safe.
  bool fits(const element& e) {
    std::size_t least = 0;
    for (const property& p : e.properties) least += Source::least_bytes(p.list_count.value_or(p.type));
    if (e.count > source_.left() / least || e.count > max_soup_index) return false;
    if (e.has(role::x)) {
      check_vertex_count(e.count);
      soup_.positions.reserve(static_cast<std::size_t>(e.count));
    }
    if (e.has(role::corners)) {
      check_triangle_count(e.count);
      soup_.ends.reserve(static_cast<std::size_t>(e.count));
      soup_.corners.reserve(static_cast<std::size_t>(e.count) * 3);
    }
    return true;
  }

  /// The element as messages name it: "vertex" and "face" without quotes.
  static std::string name_of(const element& e) {
    return e.name == "vertex" || e.name == "face" ? e.name : in_quotes(e.name);
  }

  bool number(scalar type, double& value) {
    watch_.step();
    if (source_.number(type, value)) return true;
    what_ = source_.cut_off() ? "is the end of the file within an element" : "holds something that is not a number";
    return false;
  }

  bool read_one(const element& e) {
    vec3 p{0.0};
    for (const property& q : e.properties) {
      if (q.list_count) {
        if (!read_list(q)) return false;
        continue;
      }
      double value = 0.0;
      if (!number(q.type, value)) return false;
      if (q.meaning == role::x) p.x = value;
      if (q.meaning == role::y) p.y = value;
      if (q.meaning == role::z) p.z = value;
    }
    if (e.name != "vertex") return true;
    what_ = "follows a coordinate that is not finite";
    if (!is_finite(p)) return false;
    soup_.positions.push_back(p);
    return true;
  }

  bool read_list(const property& q) {
    double length = 0.0;
    if (!number(*q.list_count, length)) return false;
    const std::size_t room = source_.left() / Source::least_bytes(q.type);
    if (!(length >= 0.0 && length == std::floor(length) && length <= static_cast<double>(room))) {
      what_ = "follows a list length that the rest of the file cannot hold";
      return false;
    }
    const auto n = static_cast<std::size_t>(length);
    if (q.meaning == role::corners && n < 3) {
      what_ = "begins a face of " + std::to_string(n) + " corners, fewer than 3";
      return false;
    }
    if (q.meaning == role::corners) check_corner_count(n);
    for (std::size_t i = 0; i < n; ++i) {
      double value = 0.0;
      if (!number(q.type, value)) return false;
      if (q.meaning != role::corners) continue;
      if (!(value >= 0.0 && value <= static_cast<double>(max_soup_index) && value == std::floor(value))) {
        what_ = "follows a vertex index that is not a whole number from 0";
        return false;
      }
      soup_.corners.push_back(static_cast<std::uint32_t>(value));
    }
    if (q.meaning == role::corners) soup_.end_polygon();
    return true;
  }

  Source source_;
  const std::filesystem::path& file_;
  reading_watch& watch_;
  polygon_soup soup_;
  std::uint64_t index_ = 0;
  std::string what_;
};

std::optional<error> check_elements(const ply_header& header, const std::filesystem::path& file) {
  const auto find = [&](std::string_view name) {
    return std::find_if(header.elements.begin(), header.elements.end(),
                        [&](const element& e) { return e.name == name; });
  };
  for (const element& e : header.elements) {
    if (find(e.name) != header.elements.begin() + (&e - header.elements.data())) {
      return fault(error_code::bad_format, file, "has two elements " + in_quotes(e.name) + "; export the mesh again");
    }
  }
  const auto vertex = find("vertex");
  if (vertex == header.elements.end() || !vertex->has(role::x) || !vertex->has(role::y) || !vertex->has(role::z)) {
    return fault(error_code::bad_format, file, "has no element 'vertex' with x, y and z; export the mesh again");
  }
  const auto face = find("face");
  if (face == header.elements.end() || !face->has(role::corners)) {
    return fault(
        error_code::unsupported, file,
        "has no faces with 'vertex_indices' (a point cloud, or triangle strips); export it as a triangle mesh");
  }
  return std::nullopt;
}

}  // namespace

result<triangle_mesh> read_ply(std::string_view bytes, const std::filesystem::path& file, reading_watch watch) {
  return refusing(file, mesh_mend, [&]() -> result<triangle_mesh> {
    const auto header = header_reader(bytes, file, watch).read();
    if (!header) return header.error();
    if (auto e = check_elements(*header, file)) return *e;
    const std::string_view body = bytes.substr(header->bytes);
    if (header->format == encoding::ascii) {
      return body_reader(ascii_source(body, header->lines, watch), file, watch).read(*header);
    }
    return body_reader(binary_source(body, header->bytes, header->format == encoding::big), file, watch).read(*header);
  });
}

}  // namespace asperity::io
