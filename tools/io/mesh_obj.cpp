// Wavefront OBJ: v, vt and f; everything else in the file is no surface and is passed over.
#include <cmath>
#include <string>

#include "file_bytes.hpp"
#include "file_formats.hpp"
#include "mesh_builder.hpp"
#include "text_cursor.hpp"

namespace asperity::io {
namespace {

constexpr std::size_t max_uvs = 3 * max_mesh_triangles;

class obj_reader {
 public:
  obj_reader(std::string_view bytes, const std::filesystem::path& file, reading_watch& watch, part_list* parts)
      : cursor_(bytes, watch), file_(file), watch_(watch) {
    soup_.parts = parts;
    if (parts != nullptr) parts->number_of("", false);
  }

  result<triangle_mesh> read() {
    do {
      const std::string_view keyword = cursor_.word();
      if (keyword.empty() || keyword[0] == '#') continue;
      const bool good = keyword == "v"                     ? read_vertex()
                        : keyword == "vt"                  ? read_uv()
                        : keyword == "f"                   ? read_face()
                        : keyword == "o" || keyword == "g" ? begin_part()
                                                           : true;
      if (!good) return fault(error_code::bad_format, file_, line_ + " " + what_ + "; export the mesh again");
    } while (cursor_.next_line());
    if (!check_indices()) return fault(error_code::bad_format, file_, line_ + " " + what_ + "; export the mesh again");
    // A mesh of which only some faces have texture coordinates has none that a bake could use.
    if (corners_with_uv_ != soup_.corners.size()) soup_.corner_uvs = {};
    lines_ = {};
    return build_mesh(std::move(soup_), file_, watch_);
  }

 private:
  bool bad(std::string what) {
    line_ = cursor_.place();
    what_ = std::move(what);
    return false;
  }

  bool read_vertex() {
    vec3 p{0.0};
    for (int axis = 0; axis < 3; ++axis) {
      const std::string_view word = cursor_.word();
      if (!to_number(word, p[axis])) return bad("needs three numbers after v, but has " + in_quotes(word));
    }
    if (!is_finite(p)) return bad("has a coordinate that is not finite");
    if (soup_.positions.size() == max_mesh_vertices) check_vertex_count(max_mesh_vertices + 1);
    soup_.positions.push_back(p);
    return true;
  }

  bool begin_part() {
    if (soup_.parts != nullptr) soup_.part = soup_.parts->number_of(cursor_.word(), false);
    return true;
  }

  bool read_uv() {
    vec2 uv{0.0};
    const std::string_view u = cursor_.word();
    const std::string_view v = cursor_.word();
    const bool good = to_number(u, uv.x) && (v.empty() || to_number(v, uv.y));
    if (!good || !std::isfinite(uv.x) || !std::isfinite(uv.y)) return bad("needs finite numbers after vt");
    if (soup_.uvs.size() == max_uvs) {
      throw rejection{error_code::limit_exceeded, "has more than the " + std::to_string(max_uvs) +
                                                      " texture coordinates of the largest mesh; " +
                                                      "decimate it first"};
    }
    soup_.uvs.emplace_back(uv.x, 1.0 - uv.y);  // OBJ counts v from the image's last row, glTF from its first
    return true;
  }

  /// Index as OBJ counts: from 1, or backwards from the newest with a minus sign.
  bool resolve(std::string_view word, std::size_t known, std::uint32_t& index) {
    std::int64_t given = 0;
    if (!to_number(word, given) || given == 0) {
      return bad("has " + in_quotes(word) + " where an index from 1 or a negative one belongs");
    }
    const std::int64_t at = given > 0 ? given - 1 : static_cast<std::int64_t>(known) + given;
    if (at < 0 || at > static_cast<std::int64_t>(max_soup_index)) {
      return bad("names index " + std::to_string(given) + " when only " + std::to_string(known) + " are defined");
    }
    index = static_cast<std::uint32_t>(at);
    return true;
  }

  bool read_face() {
    std::size_t count = 0;
    for (std::string_view word = cursor_.word(); !word.empty() && word[0] != '#'; word = cursor_.word()) {
      const std::size_t slash = word.find('/');
      std::uint32_t vertex = 0;
      if (!resolve(word.substr(0, slash), soup_.positions.size(), vertex)) return false;
      std::uint32_t uv = 0;
      if (slash != std::string_view::npos) {
        const std::string_view rest = word.substr(slash + 1);
        const std::string_view uv_word = rest.substr(0, rest.find('/'));
        if (!uv_word.empty()) {
          if (!resolve(uv_word, soup_.uvs.size(), uv)) return false;
          ++corners_with_uv_;
        }
      }
      soup_.corners.push_back(vertex);
      soup_.corner_uvs.push_back(uv);
      check_corner_count(++count);
    }
    if (count < 3) return bad("has a face of " + std::to_string(count) + " corners, fewer than 3");
    soup_.end_polygon();
    lines_.push_back(static_cast<std::uint32_t>(cursor_.line()));
    return true;
  }

  /// Faces may stand before their vertices, so ranges are checked at the end.
  bool check_indices() {
    const bool with_uvs = corners_with_uv_ == soup_.corners.size();
    std::size_t corner = 0;
    for (std::size_t k = 0; k < soup_.ends.size(); ++k) {
      for (; corner < soup_.ends[k]; ++corner) {
        const bool vertex = soup_.corners[corner] < soup_.positions.size();
        if (vertex && (!with_uvs || soup_.corner_uvs[corner] < soup_.uvs.size())) continue;
        bad(vertex ? "names texture coordinate " + std::to_string(soup_.corner_uvs[corner] + std::uint64_t{1}) +
                         " of " + std::to_string(soup_.uvs.size())
                   : "names vertex " + std::to_string(soup_.corners[corner] + std::uint64_t{1}) + " of " +
                         std::to_string(soup_.positions.size()));
        line_ = "line " + std::to_string(lines_[k]);
        return false;
      }
    }
    return true;
  }

  text_cursor cursor_;
  const std::filesystem::path& file_;
  reading_watch& watch_;
  polygon_soup soup_;                 // while it is read, with a texture coordinate for every corner, given or not
  std::vector<std::uint32_t> lines_;  // one per face
  std::size_t corners_with_uv_ = 0;
  std::string line_;
  std::string what_;
};

}  // namespace

result<triangle_mesh> read_obj(std::string_view bytes, const std::filesystem::path& file, reading_watch watch,
                               part_list* parts) {
  return refusing(file, mesh_mend, [&] { return obj_reader(bytes, file, watch, parts).read(); });
}

}  // namespace asperity::io
