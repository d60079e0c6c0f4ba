// Draws the tiles of one frame of the occlusion backend: asperity_gl_tiling OUT.png
// Exits with 77 where there is no OpenGL.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>

#include "asperity/gl/occlusion_depth.hpp"
#include "picture/sheet.hpp"
#include "support/height_models.hpp"

namespace {

using namespace asperity;
using picture::sheet;

constexpr std::size_t tile_px = 128, gap_px = 8, left_px = 96, tiles_per_row = 12;

/// Two windows onto ridged plates: one well inside, one over the probe's corner.
struct frame {
  scene bodies;
  pose T_wa;
  std::vector<pose> T_wb{pose{}};
  contact_set contacts{};

  frame() {
    test_support::plate_spec a, b;
    a.half_x = a.half_y = 0.007;
    a.cells_x = a.cells_y = b.cells_x = b.cells_y = 3;
    a.texels = b.texels = 512;
    a.height = [](double x, double y) { return 2e-4 * std::sin(2100 * x) + 5e-5 * std::cos(1500 * y); };
    b.height = [](double x, double y) { return 2e-4 * std::sin(1700 * x + 600 * y); };
    bodies = {test_support::make_plate(a), {test_support::make_plate(b)}};
    T_wa = {exp_rotation(vec3(0.03, -0.02, 0.35)) * test_support::face_down(), {1e-3, -5e-4, -1e-4}};
    for (const vec3& centre : {vec3(0.0), vec3(0.006, 0.004, 0.0)}) {
      contact c;
      c.window = test_support::window_downwards(4e-3, centre);
      static_cast<void>(
          contacts.add(c, test_support::all_triangles(*bodies.probe), test_support::all_triangles(*bodies.fixed[0])));
    }
  }
};

struct value_span {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
  void include(const std::vector<gl::occlusion_tile>& tiles) {
    for (const auto& t : tiles) {
      for (const double v : t.values_m) {
        if (std::isnan(v)) continue;
        low = std::min(low, v);
        high = std::max(high, v);
      }
    }
  }
};

picture::pixmap draw(const gl::occlusion_tile& tile, const value_span& span, const picture::colour_scale& scale) {
  picture::pixmap out{tile_px, tile_px, std::vector<std::uint8_t>(3 * tile_px * tile_px, 225)};
  const auto side = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(tile.values_m.size()))));
  for (std::size_t y = 0; y < tile_px; ++y) {
    for (std::size_t x = 0; x < tile_px; ++x) {
      const std::size_t row = (tile_px - 1 - y) * side / tile_px, column = x * side / tile_px;
      const double v = tile.values_m[row * side + column];
      if (std::isnan(v)) continue;  // no sample stays grey
      const picture::colour c = scale.at((v - span.low) / (span.high - span.low));
      const std::size_t i = 3 * (y * tile_px + x);
      out.rgb[i] = picture::to_srgb8(c.r);
      out.rgb[i + 1] = picture::to_srgb8(c.g);
      out.rgb[i + 2] = picture::to_srgb8(c.b);
    }
  }
  return out;
}

void draw_row(sheet& page, std::size_t top, const std::string& title, const std::vector<gl::occlusion_tile>& tiles,
              const value_span& span, const picture::colour_scale& scale) {
  page.text(10, static_cast<double>(top + tile_px / 2), title, 13, sheet::weight::bold);
  for (std::size_t k = 0; k < tiles.size(); ++k) {
    const std::size_t left = left_px + k * (tile_px + gap_px);
    page.place(draw(tiles[k], span, scale), left, top);
    page.text(static_cast<double>(left), static_cast<double>(top + tile_px + 14), tiles[k].name, 12);
  }
}

void draw_bar(sheet& page, double left, double top, const std::string& title, const value_span& span,
              const picture::colour_scale& scale) {
  const auto mm = [](double m) {
    char text[32];
    std::snprintf(text, sizeof text, "%.2f mm", 1e3 * m);
    return std::string(text);
  };
  page.text(left, top - 6, title, 12);
  page.colour_bar(left, top, 500, scale, {{0.0, mm(span.low)}, {1.0, mm(span.high)}});
}

int run(const char* to) {
  const auto context = gl::open_context();
  if (!context) {
    std::printf("no picture: %s\n", context.error().message.c_str());
    return 77;
  }
  const frame f;
  window_depth_settings settings = gl::paper_depth_settings();
  settings.difference_step_m = 2.0 * f.contacts.contacts()[0].window.half_size_m / settings.grid;
  auto backend = gl::occlusion_depth::make(*context, f.bodies, settings);
  std::vector<penetration> found(f.contacts.size());
  if (!backend || backend->measure({f.T_wa, f.T_wb}, f.contacts, found) != status::ok) {
    std::printf("the frame could not be measured: %s\n", backend ? "" : backend.error().message.c_str());
    return 1;
  }
  const auto tiles = backend->read_tiles();
  if (!tiles) {
    std::printf("%s\n", tiles.error().message.c_str());
    return 1;
  }
  value_span heights, differences;
  for (std::size_t i = 0; i < found.size(); ++i) {
    heights.include((*tiles)[i].heights);
    differences.include((*tiles)[i].differences);
  }
  const std::size_t row = tile_px + 30, contact_rows = 2 * row + 36;
  sheet page(left_px + tiles_per_row * (tile_px + gap_px) + 10, found.size() * contact_rows + 90);
  for (std::size_t i = 0; i < found.size(); ++i) {
    const std::size_t top = i * contact_rows + 30;
    char words[160];
    std::snprintf(words, sizeof words, "Contact %zu: depth %.4f mm, quantum %.2g um, step %.3f mm, %u shared samples",
                  i, 1e3 * found[i].depth_m, 1e6 * backend->quantum_m(i), 1e3 * backend->step_m(i), found[i].samples);
    page.text(10, static_cast<double>(top - 10), words, 14, sheet::weight::bold);
    draw_row(page, top, "heights", (*tiles)[i].heights, heights, picture::colour_scale::from_zero());
    draw_row(page, top + row, "differences", (*tiles)[i].differences, differences, picture::colour_scale::from_zero());
  }
  const auto bars = static_cast<double>(found.size() * contact_rows + 40);
  draw_bar(page, left_px, bars, "height along n from the window's centre; grey: no sample", heights,
           picture::colour_scale::from_zero());
  draw_bar(page, left_px + 700, bars, "h_A - h_B; its largest value is the depth", differences,
           picture::colour_scale::from_zero());
  const result<std::string> png = page.png();
  if (!png) {
    std::printf("%s\n", png.error().message.c_str());
    return 1;
  }
  std::ofstream file(to, std::ios::binary);
  file.write(png->data(), static_cast<std::streamsize>(png->size()));
  file.close();
  if (!file) std::printf("%s could not be written\n", to);
  return file ? 0 : 1;
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) {
    std::printf("usage: %s OUT.png\n", arguments[0]);
    return 2;
  }
  return run(arguments[1]);
}
