#include "law/truth/striped_ball.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>
#include <memory>
#include <numbers>

#include "asperity/bake/bake.hpp"
#include "asperity/io/textured_model_file.hpp"
#include "law/truth/made_or_thrown.hpp"
#include "unit/field/charted_model.hpp"

namespace asperity::truth {
namespace {

namespace fs = std::filesystem;
constexpr double pi = std::numbers::pi;

vec3 towards(double latitude_rad, double meridian_rad) {
  return {std::cos(latitude_rad) * std::cos(meridian_rad), std::cos(latitude_rad) * std::sin(meridian_rad),
          std::sin(latitude_rad)};
}

// The lowest of evenly spread places.
template <class Function>
double lowest(const Function& f, double from, double to, int count) {
  double at = from, best = f(from);
  for (int i = 1; i <= count; ++i) {
    const double x = from + (to - from) * i / count, value = f(x);
    if (value < best) {
      best = value;
      at = x;
    }
  }
  return at;
}

// The small ball's middle is this far from the striped ball's.
double middle_m(const striped_ball& ball, const ball_slide& slide) {
  return ball.radius_m + slide.probe_radius_m - slide.pressed_m;
}

}  // namespace

double striped_ball::radius_at(double latitude_rad) const noexcept {
  return radius_m + height_m * std::sin(waves * latitude_rad);
}

triangle_mesh striped_ball::fine_mesh() const {
  const auto rows = static_cast<std::uint32_t>(0.5 * waves * 24.0), columns = std::uint32_t{160};
  triangle_mesh out;
  for (std::uint32_t r = 0; r <= rows; ++r) {
    const double latitude = pi * (static_cast<double>(r) / rows - 0.5);
    const bool pole = r == 0 || r == rows;
    for (std::uint32_t c = 0; c < (pole ? 1 : columns); ++c) {
      // Every other row is turned by half a column, so that triangles are as even as they can be.
      const double meridian = 2.0 * pi * (c + (r % 2 == 0 ? 0.0 : 0.5)) / columns;
      out.positions.push_back(radius_at(latitude) * towards(latitude, meridian));
    }
  }
  const auto at = [&](std::uint32_t r, std::uint32_t c) {
    return r == 0 ? 0U : r == rows ? 1U + (rows - 1) * columns : 1U + (r - 1) * columns + c % columns;
  };
  for (std::uint32_t c = 0; c < columns; ++c) {
    out.triangles.push_back({at(0, 0), at(1, c + 1), at(1, c)});
    for (std::uint32_t r = 1; r + 1 < rows; ++r) {
      const std::uint32_t a = at(r, c), b = at(r, c + 1), d = at(r + 1, c), e = at(r + 1, c + 1);
      if (r % 2 == 0) {
        out.triangles.push_back({a, b, d});
        out.triangles.push_back({b, e, d});
      } else {
        out.triangles.push_back({a, e, d});
        out.triangles.push_back({a, b, e});
      }
    }
    out.triangles.push_back({at(rows - 1, c), at(rows - 1, c + 1), at(rows, 0)});
  }
  return out;
}

model_ptr baked_ball(const striped_ball& ball, std::size_t triangles) {
  const fs::path folder = fs::path(ASPERITY_TEST_MODELS_DIR) / "truth";
  const fs::path file = folder / ("striped_ball_" + std::to_string(triangles) + ".glb");
  std::error_code ignored;
  const fs::path self = fs::read_symlink("/proc/self/exe", ignored);
  if (fs::exists(file, ignored) && fs::last_write_time(file, ignored) > fs::last_write_time(self, ignored)) {
    return std::make_shared<const textured_model>(made_or_thrown(io::load_textured_model(file)));
  }
  bake::bake_settings options;
  options.name = "striped ball";
  options.triangles = triangles;
  auto made = std::make_shared<const textured_model>(made_or_thrown(bake::bake(ball.fine_mesh(), options)));
  fs::create_directories(folder, ignored);
  if (const auto saved = io::save_textured_model(*made, file); !saved) throw std::runtime_error(saved.error().message);
  return made;
}

model_ptr formula_ball(double radius_m) {
  return std::make_shared<const textured_model>(test_support::make_charted_model(
      test_support::make_icosphere(radius_m, 2), 512, [=](const vec3& p) { return radius_m * glm::normalize(p); }));
}

double ball_slide::latitude(const striped_ball& ball, std::size_t step) const noexcept {
  return from_rad + waves * 2.0 * pi / ball.waves * static_cast<double>(step) / steps;
}

pose ball_slide::at(const striped_ball& ball, std::size_t step) const noexcept {
  return {{1.0, 0.0, 0.0, 0.0}, middle_m(ball, *this) * towards(latitude(ball, step), meridian_rad)};
}

vec3 ball_slide::north_w(const striped_ball& ball, std::size_t step) const noexcept {
  const double l = latitude(ball, step);
  return {-std::sin(l) * std::cos(meridian_rad), -std::sin(l) * std::sin(meridian_rad), std::cos(l)};
}

double exact_depth_m(const striped_ball& ball, const ball_slide& slide, double latitude_rad, depth_along by) {
  // In the plane of the meridian, x outwards through the small ball's middle: its points by their angle from inwards.
  const double far = middle_m(ball, slide), r = slide.probe_radius_m;
  const auto depth = [&](double angle) {
    const double x = far - r * std::cos(angle), y = r * std::sin(angle), out = std::hypot(x, y);
    const double over = std::atan2(y, x), along_radius = ball.radius_at(latitude_rad + over) - out;
    if (by == depth_along::radius) return along_radius;
    const auto squared = [&](double aside) {
      const double surface = ball.radius_at(latitude_rad + over + aside);
      return surface * surface + out * out - 2.0 * surface * out * std::cos(aside);
    };
    const double widest = 0.5 * pi / ball.waves, step = 1e-3 * widest;
    double aside = lowest(squared, -widest, widest, 24);
    // Newton, by differences: the distance is smooth and has one valley here.
    for (int i = 0; i < 3; ++i) {
      const double low = squared(aside - step), middle = squared(aside), high = squared(aside + step);
      aside -= 0.5 * step * (high - low) / (high - 2.0 * middle + low);
    }
    return std::copysign(std::sqrt(squared(aside)), along_radius);
  };
  constexpr double widest = 0.3;
  double angle = lowest([&](double at) { return -depth(at); }, -widest, widest, 60), best = depth(angle);
  for (double step = widest / 60.0; step > 1e-7;) {
    const double left = depth(angle - step), right = depth(angle + step);
    if (std::max(left, right) > best) {
      angle += right > left ? step : -step;
      best = std::max(left, right);
    } else {
      step *= 0.4;
    }
  }
  return best;
}

double exact_slope(const striped_ball& ball, const ball_slide& slide, double latitude_rad, depth_along by) {
  constexpr double step = 2e-4;
  return (exact_depth_m(ball, slide, latitude_rad + step, by) - exact_depth_m(ball, slide, latitude_rad - step, by)) /
         (2.0 * step * middle_m(ball, slide));
}

std::complex<double> at_the_wavelength(const std::vector<double>& over_slide) {
  std::complex<double> sum = 0.0;
  const auto count = static_cast<double>(over_slide.size());
  for (std::size_t i = 0; i < over_slide.size(); ++i) {
    sum += over_slide[i] * std::polar(1.0, -2.0 * pi * ball_slide::waves * static_cast<double>(i) / count);
  }
  return 2.0 * sum / count;
}

}  // namespace asperity::truth
