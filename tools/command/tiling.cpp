// asperity_tiling PROBE.glb FIXED.glb OUT.png: what gl_occlusion draws for one tick, read back and put on a page.
// `./dev tiling` makes docs/pictures/tiling.png with it.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "approach.hpp"
#include "asperity/gl/occlusion_depth.hpp"
#include "asperity/render/default_renderer.hpp"
#include "picture/sheet.hpp"
#include "scene_loading.hpp"
#include "text.hpp"

namespace asperity::command {
namespace {

using picture::colour;
using picture::colour_scale;
using picture::sheet;

constexpr double side = 108.0, gap = 6.0, left = 24.0, top = 100.0, label = 18.0;
constexpr double row_height = 2.0 * (side + label) + 46.0;
constexpr std::size_t columns = 12, most_rows = 3, page_width = 1400;
constexpr colour nothing{0.80F, 0.80F, 0.80F};

struct span_of_values {
  double low = 1e300, high = -1e300;
  void add(const std::vector<gl::occlusion_tile>& tiles) {
    for (const gl::occlusion_tile& t : tiles) {
      for (const double v : t.values_m) {
        if (std::isnan(v)) continue;
        low = std::min(low, v);
        high = std::max(high, v);
      }
    }
  }
};

/// @param share  of a value along the scale
template <class Share>
void draw(sheet& page, const gl::occlusion_tile& tile, double x, double y, const colour_scale& scale, Share share) {
  const auto n = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(tile.values_m.size()))));
  const double cell = side / static_cast<double>(n);
  picture::canvas pixels(static_cast<std::size_t>(side), static_cast<std::size_t>(side));
  for (std::size_t i = 0; i < tile.values_m.size(); ++i) {
    // Rows run along v, which points up on the page.
    const double x0 = cell * static_cast<double>(i % n), y0 = cell * static_cast<double>(n - 1 - i / n);
    const double v = tile.values_m[i];
    const colour c = std::isnan(v) ? nothing : scale.at(share(v));
    const auto shade = [&](const std::array<float, 3>&) { return c; };
    pixels.triangle({{{x0, y0, 0.0}, {x0 + cell, y0, 0.0}, {x0 + cell, y0 + cell, 0.0}}}, shade);
    pixels.triangle({{{x0, y0, 0.0}, {x0 + cell, y0 + cell, 0.0}, {x0, y0 + cell, 0.0}}}, shade);
  }
  page.place(pixels.finish({1.0F, 1.0F, 1.0F}), static_cast<std::size_t>(x), static_cast<std::size_t>(y));
}

/// Marks the deepest sample.
void mark_largest(sheet& page, const gl::occlusion_tile& tile, double x, double y) {
  const auto n = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(tile.values_m.size()))));
  std::size_t deepest = tile.values_m.size();
  for (std::size_t i = 0; i < tile.values_m.size(); ++i) {
    if (std::isnan(tile.values_m[i])) continue;
    if (deepest == tile.values_m.size() || tile.values_m[i] > tile.values_m[deepest]) deepest = i;
  }
  if (deepest == tile.values_m.size()) return;
  const double cell = side / static_cast<double>(n);
  const double cx = x + cell * (0.5 + static_cast<double>(deepest % n));
  const double cy = y + cell * (static_cast<double>(n - 1 - deepest / n) + 0.5);
  page.frame(cx - 5.0, cy - 5.0, 10.0, 10.0, 1.5);
}

void draw_contact(sheet& page, const gl::occlusion_tiles& tiles, const penetration& depth, double half_size_m,
                  double quantum_m, std::size_t number, double y) {
  page.text(left, y + 12.0,
            "Contact " + std::to_string(number) + ": window " + length_text(2.0 * half_size_m) + ", depth " +
                length_text(depth.depth_m) + ", a level of the depth buffer " + length_text(quantum_m),
            14.0, sheet::weight::bold);
  y += 22.0;
  span_of_values heights, differences;
  heights.add(tiles.heights);
  differences.add(tiles.differences);
  const double reach = std::max(std::fabs(differences.low), std::fabs(differences.high));
  for (std::size_t i = 0; i < tiles.heights.size(); ++i) {
    const double x = left + static_cast<double>(i) * (side + gap);
    draw(page, tiles.heights[i], x, y, colour_scale::from_zero(),
         [&](double h) { return (h - heights.low) / std::max(heights.high - heights.low, 1e-12); });
    page.text(x, y + side + 13.0, "h  " + tiles.heights[i].name, 12.0);
  }
  y += side + label;
  for (std::size_t i = 0; i < tiles.differences.size(); ++i) {
    const double x = left + static_cast<double>(i + 1) * (side + gap);
    draw(page, tiles.differences[i], x, y, colour_scale::about_zero(),
         [&](double d) { return 0.5 + 0.5 * d / std::max(reach, 1e-12); });
    mark_largest(page, tiles.differences[i], x, y);
    page.text(x, y + side + 13.0, "d  " + tiles.differences[i].name, 12.0);
  }
  page.text(left, y + 16.0, "orange: A is in B", 12.0);
  page.text(left, y + 32.0, "blue: a gap", 12.0);
  page.text(left, y + 48.0, "both ends: " + length_text(reach), 12.0);
  page.text(left, y + 64.0, "grey: no sample", 12.0);
  page.text(left, y + 80.0, "square: the largest", 12.0);
}

result<void> make_picture(const char* const* files) {
  result<scene> bodies = load_scene(files[0], {files[1]}, false);
  if (!bodies) return bodies.error();
  paper_settings settings;
  settings.depth = gl::paper_depth_settings();
  result<paper_renderer> feel = make_paper_renderer(*bodies, settings);
  if (!feel) return feel.error();
  const std::vector<pose> T_wb(1);
  const step_function step = [&](const scene_pose& at, tick& found) { return feel->step(at, found); };
  const result<pose> touch = find_touch(*bodies, step, quat(1.0, 0.0, 0.0, 0.0), T_wb);
  if (!touch) return touch.error();
  pose T_wa = *touch;
  T_wa.position.z -= 0.0005;
  tick found;
  if (feel->step({T_wa, T_wb}, found) != status::ok) {
    return error{error_code::unsupported, "the contact could not be computed: inspect both models"};
  }

  const result<gl::context_ptr> context = gl::open_context();
  if (!context) return context.error();
  result<gl::occlusion_depth> backend =
      gl::occlusion_depth::make(*context, *bodies, settings.depth, {.triangles = 16384});
  if (!backend) return backend.error();
  std::vector<penetration> depths(found.contacts.size());
  if (backend->measure({T_wa, T_wb}, feel->contacts(), depths) != status::ok) {
    return error{error_code::unsupported, "the GPU did not answer"};
  }
  const result<std::vector<gl::occlusion_tiles>> tiles = backend->read_tiles();
  if (!tiles) return tiles.error();
  std::vector<std::size_t> shown;  // the deepest ones that were drawn in full
  for (std::size_t i = 0; i < tiles->size(); ++i) {
    if (!(*tiles)[i].differences.empty()) shown.push_back(i);
  }
  std::sort(shown.begin(), shown.end(), [&](auto a, auto b) { return depths[a].depth_m > depths[b].depth_m; });
  if (shown.size() > most_rows) shown.resize(most_rows);
  if (shown.empty()) return error{error_code::invalid_argument, "nothing overlaps: choose other models"};

  sheet page(page_width, static_cast<std::size_t>(top + row_height * static_cast<double>(shown.size())));
  page.text(left, 34.0,
            "One tick of gl_occlusion: " + bodies->probe->name + " (A) on " + bodies->fixed.front()->name + " (B), " +
                std::to_string(shown.size()) + " of " + std::to_string(depths.size()) + " contacts",
            20.0, sheet::weight::bold);
  page.text(
      left, 58.0,
      "Above: heights along n, of B and of A at rest and after its ten motions. Below: the differences h(A) - h(B) "
      "as the depth buffer holds them.",
      14.0);
  page.text(left, 78.0,
            "Tiles of all contacts lie in one texture and one depth buffer. The GPU, read back: " +
                (*context)->facts().renderer,
            14.0, sheet::weight::normal, sheet::anchor::start, 1350.0);
  for (std::size_t r = 0; r < shown.size(); ++r) {
    const std::size_t i = shown[r];
    draw_contact(page, (*tiles)[i], depths[i], found.contacts[i].window.half_size_m, backend->quantum_m(i), i + 1,
                 top + row_height * static_cast<double>(r));
  }
  const result<std::string> png = page.png();
  if (!png) return png.error();
  std::ofstream out(files[2], std::ios::binary);
  if (!(out << *png).flush()) return error{error_code::io_failed, std::string(files[2]) + ": cannot be written"};
  return {};
}

}  // namespace
}  // namespace asperity::command

int main(int argc, char** argv) {
  if (argc != 4) return std::fputs("usage: asperity_tiling PROBE.glb FIXED.glb OUT.png\n", stderr), 2;
  const asperity::result<void> made = asperity::command::make_picture(argv + 1);
  if (!made) return std::fprintf(stderr, "asperity_tiling: %s\n", made.error().message.c_str()), 1;
  return 0;
}
