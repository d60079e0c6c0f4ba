// STL, binary and ascii. The word "solid" at the start says nothing: many binary files begin with it.
#include <algorithm>
#include <cctype>
#include <string>

#include "file_bytes.hpp"
#include "file_formats.hpp"
#include "mesh_builder.hpp"
#include "text_cursor.hpp"

namespace asperity::io {
namespace {

constexpr std::size_t stl_header_bytes = 84;  // 80 of any content, then the number of triangles
constexpr std::size_t facet_bytes = 50;       // normal, three corners, two spare bytes

/// Case-insensitive: some exporters write FACET. `keyword` is in lower case.
bool is_keyword(std::string_view word, std::string_view keyword) {
  return std::equal(word.begin(), word.end(), keyword.begin(), keyword.end(),
                    [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; });
}

void add_triangle_corner(polygon_soup& soup, const vec3& p) {
  soup.corners.push_back(static_cast<std::uint32_t>(soup.positions.size()));
  soup.positions.push_back(p);
}

result<triangle_mesh> read_binary(std::string_view bytes, const std::filesystem::path& file, reading_watch& watch) {
  polygon_soup soup;
  const std::size_t count = (bytes.size() - stl_header_bytes) / facet_bytes;
  check_triangle_count(count);
  soup.positions.reserve(3 * count);
  soup.corners.reserve(3 * count);
  soup.ends.reserve(count);
  for (std::size_t f = 0; f < count; ++f) {
    watch.step();
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::size_t offset = stl_header_bytes + f * facet_bytes + 12 + 12 * corner;
      const char* at = bytes.data() + offset;
      const vec3 p(load_number<float>(at), load_number<float>(at + 4), load_number<float>(at + 8));
      if (!is_finite(p)) {
        return fault(error_code::bad_format, file,
                     "byte " + std::to_string(offset) + " (facet " + std::to_string(f) +
                         ") has a coordinate that is not finite; export the mesh again");
      }
      add_triangle_corner(soup, p);
    }
    soup.end_polygon();
  }
  return build_mesh(std::move(soup), file, watch);
}

class ascii_reader {
 public:
  ascii_reader(std::string_view bytes, const std::filesystem::path& file, reading_watch& watch)
      : cursor_(bytes, watch), file_(file), watch_(watch) {}

  result<triangle_mesh> read() {
    bool closed = false;
    for (std::string_view word = cursor_.word_anywhere(); !word.empty(); word = cursor_.word_anywhere()) {
      if (is_keyword(word, "solid") || is_keyword(word, "endsolid")) {
        closed = is_keyword(word, "endsolid");
        if (!cursor_.next_line()) break;  // the rest of the line is a name
      } else if (!is_keyword(word, "facet")) {
        return bad("has " + in_quotes(word) + " where 'facet' or 'endsolid' belongs");
      } else if (!read_facet()) {
        return bad(what_);
      }
    }
    if (!closed) return bad("ends without 'endsolid', so the file is cut off");
    return build_mesh(std::move(soup_), file_, watch_);
  }

 private:
  error bad(const std::string& what) const {
    return fault(error_code::bad_format, file_, cursor_.place() + " " + what + "; export the mesh again");
  }

  bool expect(std::string_view keyword) {
    const std::string_view word = cursor_.word_anywhere();
    if (is_keyword(word, keyword)) return true;
    what_ = word.empty() ? "ends before " + in_quotes(keyword) + ", so the file is cut off"
                         : "has " + in_quotes(word) + " where " + in_quotes(keyword) + " belongs";
    return false;
  }

  bool read_facet() {
    if (!expect("normal")) return false;
    // The three numbers of the normal are often wrong and never needed.
    for (int i = 0; i < 3; ++i) cursor_.word_anywhere();
    if (!expect("outer") || !expect("loop")) return false;
    for (int corner = 0; corner < 3; ++corner) {
      if (!expect("vertex")) return false;
      vec3 p{0.0};
      for (int axis = 0; axis < 3; ++axis) {
        const std::string_view word = cursor_.word_anywhere();
        if (!to_number(word, p[axis])) {
          what_ = "needs three numbers after 'vertex', but has " + in_quotes(word);
          return false;
        }
      }
      if (!is_finite(p)) {
        what_ = "has a coordinate that is not finite";
        return false;
      }
      add_triangle_corner(soup_, p);
    }
    soup_.end_polygon();
    return expect("endloop") && expect("endfacet");
  }

  text_cursor cursor_;
  const std::filesystem::path& file_;
  reading_watch& watch_;
  polygon_soup soup_;
  std::string what_;
};

result<triangle_mesh> read_either(std::string_view bytes, const std::filesystem::path& file, reading_watch& watch) {
  const std::size_t announced = bytes.size() < stl_header_bytes ? 0 : load_number<std::uint32_t>(bytes.data() + 80);
  if (bytes.size() >= stl_header_bytes && bytes.size() - stl_header_bytes == announced * facet_bytes) {
    return read_binary(bytes, file, watch);
  }
  text_cursor cursor(bytes, watch);
  const bool solid = is_keyword(cursor.word_anywhere(), "solid");
  cursor.next_line();
  const std::string_view second = cursor.word_anywhere();
  if (solid && (is_keyword(second, "facet") || is_keyword(second, "endsolid")))
    return ascii_reader(bytes, file, watch).read();
  if (bytes.size() < stl_header_bytes) {
    return fault(error_code::bad_format, file,
                 "has " + std::to_string(bytes.size()) +
                     " bytes, fewer than the header of a binary STL, and is no ascii STL; export the mesh again");
  }
  return fault(error_code::bad_format, file,
               "byte 80 announces " + std::to_string(announced) + " triangles, which take " +
                   std::to_string(stl_header_bytes + announced * facet_bytes) + " bytes, but the file has " +
                   std::to_string(bytes.size()) + "; export the mesh again");
}

}  // namespace

result<triangle_mesh> read_stl(std::string_view bytes, const std::filesystem::path& file, reading_watch watch) {
  return refusing(file, mesh_mend, [&] { return read_either(bytes, file, watch); });
}

}  // namespace asperity::io
