// What the picture of a model shows, panel by panel, on boxes whose every pixel can be reasoned about.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include "asperity/picture/model_picture.hpp"
#include "picture/atlas_panel.hpp"
#include "picture/surface_panels.hpp"
#include "support/small_models.hpp"

namespace asperity::picture {
namespace {

constexpr std::size_t width = 240;
constexpr std::size_t height = 180;
const vec3 half{0.06, 0.04, 0.03};

textured_model flat_box() {
  return test_support::make_textured_box(half, 96, [](const vec3&, const vec3&) { return 0.0; });
}

triangle_mesh mesh_of(const textured_model& model, double scale = 1.0, const vec3& moved = vec3(0.0)) {
  triangle_mesh mesh;
  for (const vec3& p : model.mesh.positions) mesh.positions.push_back(scale * p + moved);
  for (const coarse_triangle& t : model.mesh.triangles) mesh.triangles.push_back(t.vertex);
  return mesh;
}

view view_of(const textured_model& model) {
  extent covered(look_from_above(model.box.high - model.box.low, up_axis::z));
  for (const vec3& p : model.mesh.positions) covered.add(p);
  return covered.fit(20.0, 20.0, width - 40.0, height - 40.0);
}

using pixel = std::array<std::uint8_t, 3>;

pixel as_pixel(const colour& c) { return {to_srgb8(c.r), to_srgb8(c.g), to_srgb8(c.b)}; }

int difference(const pixel& a, const pixel& b) {
  int largest = 0;
  for (std::size_t k = 0; k < 3; ++k) largest = std::max(largest, std::abs(int{a[k]} - int{b[k]}));
  return largest;
}

void expect_model_in_the_middle(const pixmap& picture) {
  ASSERT_EQ(picture.width, width);
  ASSERT_EQ(picture.height, height);
  ASSERT_EQ(picture.rgb.size(), 3 * width * height);
  const pixel empty = as_pixel(paper);
  for (const std::size_t x : {std::size_t{0}, width - 1}) {
    for (const std::size_t y : {std::size_t{0}, height - 1}) EXPECT_EQ(picture.at(x, y), empty) << x << ", " << y;
  }
  EXPECT_GT(difference(picture.at(width / 2, height / 2), empty), 20);
  // The fit is tight: the model reaches two opposite sides of its frame, and no pixel beyond.
  const auto row_is_empty = [&](std::size_t y) {
    for (std::size_t x = 0; x < width; ++x) {
      if (picture.at(x, y) != empty) return false;
    }
    return true;
  };
  EXPECT_TRUE(row_is_empty(18));
  EXPECT_FALSE(row_is_empty(21));
  EXPECT_FALSE(row_is_empty(height - 22));
  EXPECT_TRUE(row_is_empty(height - 19));
}

TEST(picture_colours, ends_are_told_apart_without_hue) {
  const auto luminance = [](const colour& c) { return 0.2126F * c.r + 0.7152F * c.g + 0.0722F * c.b; };
  for (int i = 0; i < 64; ++i) {
    EXPECT_LT(luminance(colour_scale::from_zero().at(i / 64.0)),
              luminance(colour_scale::from_zero().at((i + 1) / 64.0)))
        << i;
  }
  const colour_scale& signs = colour_scale::about_zero();
  for (int i = 0; i < 32; ++i) {
    EXPECT_LT(luminance(signs.at(i / 64.0)), luminance(signs.at((i + 1) / 64.0))) << i;
    EXPECT_LT(luminance(signs.at(1.0 - i / 64.0)), luminance(signs.at(1.0 - (i + 1) / 64.0))) << i;
    EXPECT_GT(signs.at(i / 64.0).b, signs.at(i / 64.0).r) << i;
    EXPECT_LT(signs.at(1.0 - i / 64.0).b, signs.at(1.0 - i / 64.0).r) << i;
  }
  EXPECT_EQ(as_pixel(signs.at(-3.0)), as_pixel(signs.at(0.0)));
  EXPECT_EQ(as_pixel(signs.at(7.0)), as_pixel(signs.at(1.0)));
}

TEST(picture_colours, white_black_and_grey_are_where_srgb_has_them) {
  EXPECT_EQ(as_pixel(oklch(1.0, 0.0, 0.0)), (pixel{255, 255, 255}));
  EXPECT_EQ(as_pixel(oklch(0.0, 0.0, 0.0)), (pixel{0, 0, 0}));
  EXPECT_EQ(to_srgb8(0.21404114F), 128);
}

TEST(picture_canvas, triangles_with_a_common_edge_leave_nothing_out) {
  const colour red{1.0F, 0.0F, 0.0F};
  const colour green{0.0F, 1.0F, 0.0F};
  // Fans about a middle, as large as the canvas: one crooked, one whose edges go right through samples.
  for (const screen_point& middle : {screen_point{17.37, 21.11, 0.0}, screen_point{20.5, 20.5, 0.0}}) {
    const std::array<screen_point, 5> around{
        {{0.0, 0.0, 0.0}, {41.0, 0.0, 0.0}, {41.0, 23.3, 0.0}, {41.0, 41.0, 0.0}, {0.0, 41.0, 0.0}}};
    canvas to(41, 41);
    for (std::size_t k = 0; k < 5; ++k) {
      to.triangle({middle, around[k], around[(k + 1) % 5]}, [&](const std::array<float, 3>&) { return red; });
    }
    const pixmap out = to.finish(green);
    for (std::size_t y = 0; y < 41; ++y) {
      for (std::size_t x = 0; x < 41; ++x) ASSERT_EQ(out.at(x, y), as_pixel(red)) << x << ", " << y;
    }
  }
}

TEST(picture_canvas, nearer_covers_farther_in_any_order_and_edges_are_soft) {
  const colour white{1.0F, 1.0F, 1.0F};
  const colour black{};
  const colour red{1.0F, 0.0F, 0.0F};
  for (const bool near_first : {true, false}) {
    canvas to(20, 20);
    for (const bool near : {near_first, !near_first}) {
      const double z = near ? 1.0 : 0.0;
      to.triangle({screen_point{2.0, 2.0, z}, screen_point{18.0, 2.0, z}, screen_point{2.0, 18.0, z}},
                  [&](const std::array<float, 3>&) { return near ? black : red; });
    }
    const pixmap out = to.finish(white);
    EXPECT_EQ(out.at(5, 5), as_pixel(black));
    EXPECT_EQ(out.at(18, 18), as_pixel(white));
    const pixel on_the_edge = out.at(10, 9);
    EXPECT_GT(on_the_edge[0], 30);
    EXPECT_LT(on_the_edge[0], 230);
    EXPECT_EQ(on_the_edge[0], on_the_edge[1]) << "the farther triangle shows through";
  }
}

TEST(picture_view, is_right_handed_and_lays_down_what_is_tall) {
  for (const up_axis up : {up_axis::automatic, up_axis::x, up_axis::y, up_axis::z}) {
    for (const vec3& size : {vec3(1.0, 2.0, 3.0), vec3(3.0, 1.0, 2.0), vec3(0.2, 0.1, 5.0)}) {
      for (const double turn : {0.0, 100.0}) {
        const view v = look_from_above(size, up, turn);
        EXPECT_NEAR(glm::length(glm::cross(v.right, v.up) - v.to_eye), 0.0, 1e-14);
        EXPECT_GT(v.up[number_of(up, size)], 0.5);
      }
    }
  }
  EXPECT_EQ(number_of(up_axis::automatic, vec3(1.0, 2.0, 3.0)), 2);
  EXPECT_EQ(number_of(up_axis::automatic, vec3(1.0, 2.0, 4.0)), 0);
  EXPECT_EQ(number_of(up_axis::automatic, vec3(2.0, 1.0, 4.0)), 1);
  // Turned by 90 degrees counter-clockwise from above, what faced the eye faces the right.
  const view before = look_from_above(vec3(1.0), up_axis::z);
  const view after = look_from_above(vec3(1.0), up_axis::z, 90.0);
  const vec3 level(before.to_eye.x, before.to_eye.y, 0.0);
  EXPECT_NEAR(glm::dot(glm::normalize(level), after.right), 1.0, 1e-12);
}

TEST(picture_panels, show_the_model_in_the_middle_of_an_empty_frame) {
  const textured_model model = flat_box();
  const view from = view_of(model);
  const fine_surface surface = sample_fine_surface(model, 0.0);
  expect_model_in_the_middle(draw_coarse(model, from, width, height));
  expect_model_in_the_middle(draw_fine(surface, from, width, height));
  expect_model_in_the_middle(
      draw_values(surface, surface.heights, {-1.0, 1.0}, colour_scale::about_zero(), from, width, height));
}

TEST(picture_panels, pieces_with_a_common_edge_differ_in_colour) {
  textured_model model = flat_box();
  model.pieces.assign(model.mesh.triangles.size(), {});
  for (std::uint32_t t = 0; t < model.pieces.size(); ++t) model.pieces[t].triangles = {t};
  const std::vector<std::uint32_t> number = colour_pieces(model);
  ASSERT_EQ(number.size(), model.pieces.size());
  std::size_t edges = 0;
  for (std::size_t s = 0; s < number.size(); ++s) {
    for (std::size_t t = s + 1; t < number.size(); ++t) {
      std::size_t common = 0;
      for (const std::uint32_t v : model.mesh.triangles[s].vertex) {
        const auto& other = model.mesh.triangles[t].vertex;
        common += std::find(other.begin(), other.end(), v) != other.end() ? 1U : 0U;
      }
      if (common < 2) continue;
      ++edges;
      EXPECT_NE(number[s], number[t]) << s << ", " << t;
    }
  }
  EXPECT_EQ(edges, 18U);
}

TEST(picture_panels, error_of_a_perfect_model_is_all_the_colour_of_zero) {
  const textured_model model = flat_box();
  const view from = view_of(model);
  const fine_surface surface = sample_fine_surface(model, 0.0);
  const triangle_mesh original = mesh_of(model);
  const bake::triangle_bvh tree(original.positions, original.triangles);
  bake::stage_monitor monitor;
  const result<std::vector<float>> apart = distances(surface, tree, 1, monitor);
  ASSERT_TRUE(apart);

  picture_options options;
  options.original = &original;
  const result<model_picture> whole = draw_model(model, options);
  ASSERT_TRUE(whole) << whole.error().message;
  EXPECT_TRUE(whole->values.is_distance);
  EXPECT_GE(whole->values.high, 1e-5 * model.box.diagonal()) << "rounding would be shown as error";

  const value_range range{whole->values.low, whole->values.high};
  const auto draw = [&](const std::vector<float>& values) {
    return draw_values(surface, values, range, colour_scale::from_zero(), from, width, height);
  };
  const pixmap measured = draw(*apart);
  const pixmap zero = draw(std::vector<float>(apart->size(), 0.0F));
  const pixmap large = draw(std::vector<float>(apart->size(), static_cast<float>(range.high)));
  for (std::size_t y = 0; y < height; ++y) {
    for (std::size_t x = 0; x < width; ++x) {
      // Rounding of float32 may turn the last bit.
      ASSERT_LE(difference(measured.at(x, y), zero.at(x, y)), 2) << x << ", " << y;
    }
  }
  EXPECT_GT(difference(measured.at(width / 2, height / 2), large.at(width / 2, height / 2)), 100);
}

TEST(picture_panels, a_moved_texel_changes_the_picture_there_and_nowhere_else) {
  const textured_model before = flat_box();
  textured_model after = before;
  // In the middle of the face +z, which the eye looks down on.
  std::size_t moved = 0;
  double nearest = 1.0;
  for (std::size_t i = 0; i < before.texture.texels.size(); ++i) {
    const double d = glm::length(vec3(before.texture.texels[i]) - vec3(0.01, 0.01, half.z));
    if (d < nearest) {
      nearest = d;
      moved = i;
    }
  }
  ASSERT_LT(nearest, 0.005);
  after.texture.texels[moved].z += 0.004F;
  const view from = view_of(before);
  const screen_point place = from.project(vec3(before.texture.texels[moved]));
  const double reach = from.pixels_per_m * 0.012;  // two texels, which are up to 4.3 mm here, and the rise

  const auto expect_change_near_place = [&](const pixmap& a, const pixmap& b) {
    std::size_t changed = 0;
    for (std::size_t y = 0; y < height; ++y) {
      for (std::size_t x = 0; x < width; ++x) {
        if (a.at(x, y) == b.at(x, y)) continue;
        ++changed;
        EXPECT_LT(std::hypot(static_cast<double>(x) + 0.5 - place.x, static_cast<double>(y) + 0.5 - place.y), reach)
            << x << ", " << y;
      }
    }
    EXPECT_GT(changed, 20U);
  };
  const fine_surface flat = sample_fine_surface(before, 0.0);
  const fine_surface raised = sample_fine_surface(after, 0.0);
  expect_change_near_place(draw_fine(flat, from, width, height), draw_fine(raised, from, width, height));
  const auto heights = [&](const fine_surface& s) {
    return draw_values(s, s.heights, {-0.004, 0.004}, colour_scale::about_zero(), from, width, height);
  };
  expect_change_near_place(heights(flat), heights(raised));

  // The atlas, one pixel per texel.
  const texel_map map = map_texels(before);
  ASSERT_EQ(map.use[moved], texel_use::chart);
  const auto atlas = [&](const textured_model& model) {
    return draw_texels(map_texels(model), {0, 0, 96, 96}, {-0.004, 0.004}, colour_scale::about_zero(), 96, 96);
  };
  const pixmap a = atlas(before);
  const pixmap b = atlas(after);
  for (std::size_t i = 0; i < map.use.size(); ++i) {
    EXPECT_EQ(a.at(i % 96, i / 96) == b.at(i % 96, i / 96), i != moved) << i;
  }
  EXPECT_EQ(b.at(moved % 96, moved / 96), as_pixel(colour_scale::about_zero().at(1.0)));
}

TEST(picture_atlas, tells_charts_gutter_and_unused_texels) {
  textured_model model = flat_box();
  // A cell of the box's texture is 32 x 48 texels, its gutter two of them; one corner loses its texels.
  for (std::size_t y = 0; y < 6; ++y) {
    for (std::size_t x = 0; x < 6; ++x) model.texture.texels[y * 96 + x] = glm::vec3(NAN);
  }
  const texel_map map = map_texels(model);
  EXPECT_EQ(map.count(texel_use::chart), 6U * 28U * 44U - 16U);
  EXPECT_EQ(map.count(texel_use::unused), 36U);
  EXPECT_EQ(map.count(texel_use::gutter), 96U * 96U - 6U * 28U * 44U - 20U);
  const pixmap drawn = draw_texels(map, {0, 0, 96, 96}, {-1.0, 1.0}, colour_scale::about_zero(), 96, 96);
  EXPECT_EQ(drawn.at(0, 0), as_pixel(unused_texel));
  EXPECT_EQ(drawn.at(7, 1), as_pixel(gutter_texel));
  EXPECT_EQ(drawn.at(7, 2), as_pixel(colour_scale::about_zero().at(0.5)));
  const texel_window window = informative_window(map, 12, {-1.0, 1.0});
  EXPECT_EQ(window.left, 0U);
  EXPECT_EQ(window.top, 0U);
}

TEST(picture_page, is_a_png_of_the_stated_size_and_always_the_same) {
  const textured_model model = flat_box();
  const triangle_mesh original = mesh_of(model);
  picture_options options;
  options.original = &original;
  options.original_name = "box.ply";
  options.threads = 1;
  const result<model_picture> one = draw_model(model, options);
  options.threads = 3;
  const result<model_picture> three = draw_model(model, options);
  ASSERT_TRUE(one);
  ASSERT_TRUE(three);
  EXPECT_TRUE(one->png == three->png);
  const auto number_at = [&](std::size_t i) {
    std::size_t n = 0;
    for (std::size_t k = i; k < i + 4; ++k) n = 256 * n + static_cast<unsigned char>(one->png[k]);
    return n;
  };
  ASSERT_GT(one->png.size(), 1000U);
  EXPECT_EQ(one->png.substr(1, 3), "PNG");
  EXPECT_EQ(number_at(16), 1600U);
  EXPECT_EQ(number_at(20), 1236U);

  options.original = nullptr;
  const result<model_picture> alone = draw_model(model, options);
  ASSERT_TRUE(alone);
  EXPECT_FALSE(alone->values.is_distance);
  EXPECT_FALSE(alone->png == one->png);
}

TEST(picture_page, refuses_an_original_that_is_not_the_models) {
  const textured_model model = flat_box();
  const auto fault = [&](const triangle_mesh& original) {
    picture_options options;
    options.original = &original;
    options.original_name = "full.ply";
    const result<model_picture> drawn = draw_model(model, options);
    EXPECT_FALSE(drawn);
    if (drawn) return std::string();
    EXPECT_EQ(drawn.error().code, error_code::invalid_argument);
    EXPECT_EQ(drawn.error().message.rfind("full.ply ", 0), 0U) << drawn.error().message;
    return drawn.error().message;
  };
  EXPECT_NE(fault(mesh_of(model, 1000.0)).find("--scale"), std::string::npos);
  EXPECT_NE(fault(mesh_of(model, 0.5)).find("size"), std::string::npos);
  EXPECT_NE(fault(mesh_of(model, 1.0, vec3(0.1, 0.0, 0.0))).find("elsewhere"), std::string::npos);
  EXPECT_NE(fault({}).find("no triangles"), std::string::npos);
  triangle_mesh broken = mesh_of(model);
  broken.positions[3].y = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(fault(broken).find("finite"), std::string::npos);
}

TEST(picture_page, stops_where_it_is_told_to) {
  const textured_model model = flat_box();
  picture_options options;
  options.progress = [](std::string_view, double done) { return done < 0.4; };
  const result<model_picture> drawn = draw_model(model, options);
  ASSERT_FALSE(drawn);
  EXPECT_EQ(drawn.error().code, error_code::cancelled);
}

TEST(picture_page, strange_models_are_drawn_too) {
  textured_model model = flat_box();
  model.name.assign(400, 'x');
  model.name += "\n\u00e9\u00e9";
  model.pieces.clear();
  for (glm::vec3& p : model.texture.texels) p = glm::vec3(NAN);
  EXPECT_TRUE(draw_model(model));
}

}  // namespace
}  // namespace asperity::picture
