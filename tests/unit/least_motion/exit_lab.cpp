#include "exit_lab.hpp"

#include <cmath>
#include <numbers>
#include <utility>

#include "law/contacts/polyhedra.hpp"
#include "support/small_models.hpp"

namespace asperity::test_support {

field_body_ptr make_formula_body(const std::vector<vec3>& samples, const vec3& low, const vec3& high, double pitch_m,
                                 const depth_function& depth) {
  field_body out;
  detail::coarse_grid& g = out.field.smooth;
  g.low = low;
  g.pitch_m = pitch_m;
  std::size_t count = 1;
  for (std::size_t k = 0; k < 3; ++k) {
    const int axis = static_cast<int>(k);
    g.nodes[k] = static_cast<std::size_t>(std::ceil((high - low)[axis] / pitch_m)) + 1;
    count *= g.nodes[k];
  }
  g.value.reserve(count);
  for (std::size_t z = 0; z < g.nodes[2]; ++z) {
    for (std::size_t y = 0; y < g.nodes[1]; ++y) {
      for (std::size_t x = 0; x < g.nodes[0]; ++x) {
        const vec3 p = low + pitch_m * vec3(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z));
        g.value.push_back(static_cast<float>(depth(p)));
      }
    }
  }
  std::vector<field_sample> points;
  points.reserve(samples.size());
  for (const vec3& p : samples) points.push_back({glm::vec3(p)});
  out.samples = sample_tree(std::move(points));
  return std::make_shared<const field_body>(std::move(out));
}

field_body_ptr make_points_body(const std::vector<vec3>& samples) {
  return make_formula_body(samples, vec3(-0.01), vec3(0.01), 0.005, [](const vec3&) { return -1.0; });
}

std::vector<vec3> sphere_points(double radius_m, std::size_t count) {
  std::vector<vec3> out;
  const double golden_rad = std::numbers::pi * (3.0 - std::sqrt(5.0));
  for (std::size_t i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * static_cast<double>(i) + 1.0) / static_cast<double>(count);
    const double turn = golden_rad * static_cast<double>(i), across = std::sqrt(1.0 - z * z);
    out.push_back(radius_m * vec3(across * std::cos(turn), across * std::sin(turn), z));
  }
  return out;
}

std::vector<vec3> box_points(const vec3& half, std::size_t per_edge) {
  std::vector<vec3> out;
  for (int face = 0; face < 6; ++face) {
    for (std::size_t i = 0; i <= per_edge; ++i) {
      for (std::size_t j = 0; j <= per_edge; ++j) {
        const auto along = [&](std::size_t n) {
          return 2.0 * static_cast<double>(n) / static_cast<double>(per_edge) - 1.0;
        };
        vec3 p(0.0);
        p[face / 2] = face % 2 != 0 ? 1.0 : -1.0;
        p[(face / 2 + 1) % 3] = along(i);
        p[(face / 2 + 2) % 3] = along(j);
        out.push_back(half * p);
      }
    }
  }
  return out;
}

field_body_ptr waved_box(const vec3& half, double height_m, double wave_m) {
  const textured_model model = make_textured_box(half, 192, [=](const vec3& p, const vec3&) {
    return height_m * std::sin(p.x / wave_m) * std::cos(p.y / wave_m + 0.3) * std::sin(p.z / wave_m + 0.5);
  });
  return std::make_shared<const field_body>(make_field_body(model).value());
}

field_body_ptr grooved_block() {
  std::vector<vec2> outline{{-12, -6}, {12, -6}, {12, 6}, {4, 6}, {0, 3}, {-4, 6}, {-12, 6}};
  for (vec2& p : outline) p *= mm;
  const contacts_test::polyhedron block = contacts_test::prism(outline, -8.0 * mm, 8.0 * mm);
  return std::make_shared<const field_body>(make_field_body(*contacts_test::make_model(block, {})).value());
}

exit_lab::exit_lab(field_body_ptr probe, std::vector<field_body_ptr> fixed, const exits::exit_rule& rule,
                   const vec3& centre_of_mass_a)
    : T_wb(fixed.size()),
      rule_(rule),
      solver_(std::make_shared<const exits::exit_scene>(field_scene{std::move(probe), std::move(fixed)}),
              centre_of_mass_a, rule) {}

exit_answer exit_lab::at(const pose& T_wa) {
  solver_.solve({T_wa, T_wb});
  exit_answer out;
  out.on_probe_w = solver_.on_probe_w();
  out.stiffness = solver_.stiffness();
  out.energy_j = solver_.energy_j();
  out.deepest_m = solver_.deepest_m();
  out.hit = solver_.hit();
  out.readings = solver_.readings();
  for (const exits::way_out& w : solver_.ways()) {
    if (w.weight > 0.0) out.ways.push_back({w.z_w, w.weight});
  }
  return out;
}

}  // namespace asperity::test_support
