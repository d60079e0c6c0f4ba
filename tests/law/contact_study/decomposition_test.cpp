// How a model was cut in convex pieces is nothing that a hand can feel.
#include <array>
#include <cstdio>
#include <gtest/gtest.h>
#include <memory>
#include <optional>
#include <vector>

#include "asperity/window/window_renderer.hpp"
#include "law/contact_study/study_models.hpp"
#include "law/contact_study/touching_pose.hpp"

namespace asperity::contact_study {
namespace {

// A piece that stands for some triangles: their corners, and the triangles themselves for a hull. Good enough for a
// renderer that must not look at it, and for the paper's finder where the triangles lie in one plane.
convex_piece piece_of(const coarse_mesh& mesh, const std::vector<std::uint32_t>& triangles) {
  convex_piece out;
  out.triangles = triangles;
  out.flat = true;
  for (const std::uint32_t t : triangles) {
    const auto first = static_cast<std::uint32_t>(out.vertices.size());
    for (const vec3& p : corners(mesh, t)) out.vertices.push_back(p);
    out.hull.push_back({first, first + 1, first + 2});
  }
  return out;
}

// Each piece cut in as many as it has triangles.
model_ptr cut_in_triangles(const textured_model& model) {
  auto out = std::make_shared<textured_model>(model);
  out->pieces.clear();
  for (std::uint32_t t = 0; t < model.mesh.triangles.size(); ++t) out->pieces.push_back(piece_of(model.mesh, {t}));
  return out;
}

// Each piece cut in two.
model_ptr cut_in_halves(const textured_model& model) {
  auto out = std::make_shared<textured_model>(model);
  out->pieces.clear();
  for (const convex_piece& p : model.pieces) {
    const auto middle = p.triangles.begin() + static_cast<std::ptrdiff_t>(p.triangles.size() / 2);
    if (middle != p.triangles.begin()) out->pieces.push_back(piece_of(model.mesh, {p.triangles.begin(), middle}));
    out->pieces.push_back(piece_of(model.mesh, {middle, p.triangles.end()}));
  }
  return out;
}

TEST(decomposition, the_wrench_is_the_same_however_a_model_was_cut) {
  const std::filesystem::path folder = ASPERITY_TEST_MODELS_DIR;
  const result<model_ptr> file = study_model("file", folder, folder);
  const result<model_ptr> part = study_model("cad_part", folder, folder);
  ASSERT_TRUE(file && part);
  const scene as_baked{*file, {*part}};
  const scene halves{cut_in_halves(**file), {cut_in_halves(**part)}};
  const scene triangles{cut_in_triangles(**file), {cut_in_triangles(**part)}};
  ASSERT_GT(halves.probe->pieces.size(), as_baked.probe->pieces.size());
  ASSERT_GT(triangles.probe->pieces.size(), halves.probe->pieces.size());

  auto baked = build_renderer(as_baked);
  auto finer = build_renderer(halves);
  auto finest = build_renderer(triangles);
  auto paper_baked = make_window_renderer(as_baked);
  auto paper_finest = make_window_renderer(triangles);
  ASSERT_TRUE(baked && finer && finest && paper_baked && paper_finest);

  const std::array<pose, 1> T_wb{};
  double paper_differs = 0.0;
  int touching = 0;
  for (std::uint64_t index = 0; index < 12; ++index) {
    const std::optional<touching_pose> start = find_touching_pose(*baked, 3, index);
    if (!start) continue;
    const auto wrench_of = [&](auto& renderer) {
      tick t;
      EXPECT_NE(renderer.step({start->T_wa, T_wb}, t), status::not_ready);
      return t.force.on_probe_w;
    };
    const wrench w = wrench_of(*baked), w2 = wrench_of(*finer), w3 = wrench_of(*finest);
    ASSERT_GT(glm::length(w.force), 0.0);
    ++touching;
    // To the bit: the default renderer knows no pieces.
    EXPECT_EQ(w.force, w2.force);
    EXPECT_EQ(w.torque, w2.torque);
    EXPECT_EQ(w.force, w3.force);
    EXPECT_EQ(w.torque, w3.torque);
    const vec3 a = wrench_of(*paper_baked).force, b = wrench_of(*paper_finest).force;
    paper_differs = std::max(paper_differs, glm::length(a - b) / std::max(glm::length(a), 1e-3));
  }
  EXPECT_GE(touching, 8);
  std::printf("  %d touching poses; the paper's clusters differ by up to %.0f %%\n", touching, 100.0 * paper_differs);
  EXPECT_GT(paper_differs, 0.05) << "negative control: the paper's contacts do depend on the pieces";
}

}  // namespace
}  // namespace asperity::contact_study
