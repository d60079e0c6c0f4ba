#include "bake/wrap_sheets.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "bake/geometry.hpp"
#include "bake/halfedges.hpp"
#include "bake/parallel.hpp"
#include "bake/winding_number.hpp"

namespace asperity::bake {
namespace {

constexpr double piece_in_cells = 0.75;
constexpr double beside_in_cells = 0.05;  // where the two sides of a surface are looked at
constexpr double behind_in_cells = 0.75;  // where a body has to be behind its surface
constexpr double sheet_winding = 0.7;
constexpr double narrow_in_cells = 2.0;

// A piece of a triangle, and the place that speaks for it.
struct piece {
  std::uint32_t triangle = 0;
  std::uint32_t number = 0;  // among the pieces of its triangle
  std::uint32_t place = 0;
};

std::uint32_t cuts_of(const std::array<vec3, 3>& c, double cell_m) noexcept {
  const double longest = std::max({glm::length(c[1] - c[0]), glm::length(c[2] - c[1]), glm::length(c[0] - c[2])});
  return std::max(1U, static_cast<std::uint32_t>(std::min(1e5, std::ceil(longest / (piece_in_cells * cell_m)))));
}

// Piece `number` of a triangle cut into n * n alike ones: row by row, upright and inverted in turn.
std::array<vec3, 3> corners_of_piece(const std::array<vec3, 3>& c, std::uint32_t n, std::uint32_t number) noexcept {
  const auto row = static_cast<std::uint32_t>(std::sqrt(static_cast<double>(number) + 0.5));
  const std::uint32_t at = number - row * row;
  const std::uint32_t i = at / 2;
  const vec3 u = (c[1] - c[0]) / static_cast<double>(n);
  const vec3 v = (c[2] - c[1]) / static_cast<double>(n);
  const auto grid = [&](std::uint32_t r, std::uint32_t k) {
    return c[0] + static_cast<double>(r) * u + static_cast<double>(k) * v;
  };
  if (at % 2 == 0) return {grid(row, i), grid(row + 1, i), grid(row + 1, i + 1)};
  return {grid(row, i), grid(row + 1, i + 1), grid(row, i + 1)};
}

vec3 middle(const std::array<vec3, 3>& c) noexcept { return (c[0] + c[1] + c[2]) / 3.0; }

// The cell that p lies in, and which of eight ways the surface faces there.
std::uint64_t bin_of(const vec3& p, const vec3& n, const vec3& low, double cell_m) noexcept {
  const vec3 at = glm::floor((p - low) / cell_m);
  const auto cell = [](double x) { return static_cast<std::uint64_t>(x) & 0xfffffU; };
  const std::uint64_t facing = (n.x < 0.0 ? 1U : 0U) | (n.y < 0.0 ? 2U : 0U) | (n.z < 0.0 ? 4U : 0U);
  return facing << 60U | cell(at.z) << 40U | cell(at.y) << 20U | cell(at.x);
}

class sorter {
 public:
  sorter(const triangle_mesh& mesh, double cell_m, unsigned threads, stage_monitor& monitor)
      : mesh_(mesh), cell_(cell_m), threads_(threads), monitor_(monitor) {}

  std::optional<sorted_soup> sort() {
    if (!cut()) {
      out_.too_large = true;
      return std::move(out_);
    }
    thin_.assign(out_.places.size(), 0);
    std::vector<double> inner(out_.places.size(), 1.0);
    if (!look(mesh_, &inner)) return std::nullopt;
    const std::vector<char> sheet = find_sheets(inner);
    const bool any_sheet = std::ranges::find(sheet, 1) != sheet.end();
    out_.body.positions = mesh_.positions;
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t)
      if (sheet[t] == 0) out_.body.triangles.push_back(mesh_.triangles[t]);
    // Without the sheets the rest has another winding number.
    if (any_sheet && !out_.body.triangles.empty() && !look(out_.body, nullptr)) return std::nullopt;
    if (!keep_wide_walls(sheet)) return std::nullopt;
    gather(sheet);
    return std::move(out_);
  }

 private:
  [[nodiscard]] std::array<vec3, 3> triangle(std::uint32_t t) const noexcept {
    return corners(mesh_.positions, mesh_.triangles[t]);
  }

  // @return false where there would be too many pieces
  bool cut() {
    std::size_t count = 0;
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
      const std::size_t n = cuts_of(triangle(t), cell_);
      if ((count += n * n) > most_soup_pieces) return false;
    }
    const vec3 low = bounds_of(mesh_.positions).low;
    std::vector<std::pair<std::uint64_t, std::uint32_t>> bins;
    bins.reserve(count);
    pieces_.reserve(count);
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
      const auto c = triangle(t);
      const vec3 n = unit_normal(c);
      const std::uint32_t cuts = cuts_of(c, cell_);
      for (std::uint32_t k = 0; k < cuts * cuts; ++k) {
        bins.emplace_back(bin_of(middle(corners_of_piece(c, cuts, k)), n, low, cell_),
                          static_cast<std::uint32_t>(pieces_.size()));
        pieces_.push_back({t, k, 0});
      }
    }
    std::ranges::sort(bins);
    for (std::size_t i = 0; i < bins.size(); ++i) {
      piece& p = pieces_[bins[i].second];
      if (i == 0 || bins[i].first != bins[i - 1].first) {
        const auto c = triangle(p.triangle);
        out_.places.push_back(middle(corners_of_piece(c, cuts_of(c, cell_), p.number)));
        out_.normals.push_back(unit_normal(c));
      }
      p.place = static_cast<std::uint32_t>(out_.places.size() - 1);
    }
    return true;
  }

  // Whether there is an inside behind each place, and the winding number of its inner side.
  bool look(const triangle_mesh& body, std::vector<double>* inner) {
    const triangle_mesh cut = without_long_triangles(body);
    const triangle_bvh tree(cut.positions, cut.triangles, threads_, &monitor_);
    if (monitor_.cancelled()) return false;
    const winding_field field(tree);
    const auto visit = [&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const vec3& p = out_.places[i];
        const vec3& n = out_.normals[i];
        const double behind = field.at(p - behind_in_cells * cell_ * n);
        thin_[i] = behind < inside_winding && field.at(p + behind_in_cells * cell_ * n) < inside_winding ? 1 : 0;
        if (inner == nullptr) continue;
        (*inner)[i] = behind;
        if (behind < 0.95)
          (*inner)[i] = std::max(field.at(p - beside_in_cells * cell_ * n), field.at(p + beside_in_cells * cell_ * n));
      }
    };
    return parallel_blocks(out_.places.size(), threads_, monitor_, monitor_.done(), monitor_.done(), visit);
  }

  [[nodiscard]] double area_of(const piece& p) const noexcept {
    const auto c = triangle(p.triangle);
    const double n = cuts_of(c, cell_);
    return 0.5 * glm::length(area_normal(c)) / (n * n);
  }

  [[nodiscard]] std::vector<char> find_sheets(const std::vector<double>& inner) const {
    const connectivity net = connect(mesh_.triangles, mesh_.positions.size());
    std::vector<double> sum(net.components, 0.0), area(net.components, 0.0);
    for (const piece& p : pieces_) {
      const double a = area_of(p);
      area[net.component[p.triangle]] += a;
      sum[net.component[p.triangle]] += a * std::clamp(inner[p.place], 0.0, 1.0);
    }
    std::vector<char> sheet(mesh_.triangles.size());
    for (std::size_t t = 0; t < sheet.size(); ++t)
      sheet[t] = sum[net.component[t]] < sheet_winding * area[net.component[t]] ? 1 : 0;
    return sheet;
  }

  // Thin places that are all within reach of places with a body behind them are an edge, not a wall.
  bool keep_wide_walls(const std::vector<char>& sheet) {
    std::vector<char> on_sheet(out_.places.size(), 0);
    for (const piece& p : pieces_)
      if (sheet[p.triangle] != 0) on_sheet[p.place] = 1;
    const auto points = [&](const auto& wanted) {
      triangle_mesh out;
      for (std::uint32_t i = 0; i < out_.places.size(); ++i)
        if (wanted(i)) {
          const auto v = static_cast<std::uint32_t>(out.positions.size());
          out.positions.push_back(out_.places[i]);
          out.triangles.push_back({v, v, v});
        }
      return out;
    };
    const auto near = [&](const triangle_mesh& others, double within, std::vector<char>& out) {
      out.assign(out_.places.size(), 0);
      if (others.triangles.empty()) return true;
      const triangle_bvh tree(others.positions, others.triangles, threads_, &monitor_);
      if (monitor_.cancelled()) return false;
      const auto visit = [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
          out[i] = thin_[i] != 0 && tree.closest(out_.places[i], within).triangle != no_halfedge ? 1 : 0;
      };
      return parallel_blocks(out_.places.size(), threads_, monitor_, monitor_.done(), monitor_.done(), visit);
    };
    std::vector<char> by_body, by_core;
    if (!near(points([&](std::uint32_t i) { return thin_[i] == 0 && on_sheet[i] == 0; }), narrow_in_cells * cell_,
              by_body))
      return false;
    if (!near(points([&](std::uint32_t i) { return thin_[i] != 0 && by_body[i] == 0; }),
              (narrow_in_cells + 0.5) * cell_, by_core))
      return false;
    out_.plated.resize(out_.places.size());
    for (std::size_t i = 0; i < out_.plated.size(); ++i) out_.plated[i] = on_sheet[i] != 0 || by_core[i] != 0 ? 1 : 0;
    return true;
  }

  void gather(const std::vector<char>& sheet) {
    double all = 0.0, plated = 0.0;
    for (const piece& p : pieces_) {
      const double area = area_of(p);
      all += area;
      if (sheet[p.triangle] == 0 && out_.plated[p.place] == 0) continue;
      if (sheet[p.triangle] == 0 && thin_[p.place] == 0) continue;
      plated += area;
      const auto c = triangle(p.triangle);
      const auto first = static_cast<std::uint32_t>(out_.plates.positions.size());
      for (const vec3& corner : corners_of_piece(c, cuts_of(c, cell_), p.number))
        out_.plates.positions.push_back(corner);
      out_.plates.triangles.push_back({first, first + 1, first + 2});
    }
    out_.plate_share = all > 0.0 ? plated / all : 0.0;
  }

  const triangle_mesh& mesh_;
  double cell_;
  unsigned threads_;
  stage_monitor& monitor_;
  sorted_soup out_;
  std::vector<piece> pieces_;
  std::vector<char> thin_;
};

}  // namespace

std::optional<sorted_soup> sort_soup(const triangle_mesh& mesh, double cell_m, unsigned threads,
                                     stage_monitor& monitor) {
  return sorter(mesh, cell_m, threads, monitor).sort();
}

}  // namespace asperity::bake
