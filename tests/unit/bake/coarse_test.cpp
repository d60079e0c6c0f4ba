// Meshes with so many handles that the triangles asked for cannot hold them.
#include <array>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "asperity/bake/bake.hpp"
#include "bake/check.hpp"
#include "bake/halfedges.hpp"
#include "shapes.hpp"
#include "support/extent.hpp"
#include "support/fresh_seed.hpp"

namespace asperity::bake {
namespace {

/// A plate of 3 n x 3 n cells with holes in the middles of n x n blocks, each there or not.
triangle_mesh pierced_plate(int n, shapes::dice& dice) {
  std::vector<bool> hole(static_cast<std::size_t>(n * n));
  for (std::size_t i = 0; i < hole.size(); ++i) hole[i] = dice() < 0.8;
  std::array<std::vector<double>, 3> grid;
  for (int i = 0; i <= 3 * n; ++i)
    for (const std::size_t axis : {0U, 1U}) grid[axis].push_back(0.004 * i);
  grid[2] = {0.0, 0.004, 0.008};
  return shapes::cells(grid, [&](const std::array<int, 3>& c) {
    return c[0] % 3 != 1 || c[1] % 3 != 1 || !hole[static_cast<std::size_t>(c[0] / 3 + n * (c[1] / 3))];
  });
}

TEST(ManyHandles, GetAsManyTrianglesAsTheyNeedOrAreToldACountThatIsEnough) {
  const auto runs = test_support::extent(2, 40);
  shapes::dice dice(test_support::fresh_seed("many handles", "2 or 40 plates"));
  for (int run = 0; run < runs; ++run) {
    SCOPED_TRACE("run " + std::to_string(run));
    const triangle_mesh plate = pierced_plate(4 + static_cast<int>(dice.below(2)), dice);
    const connectivity net = connect(plate.triangles, plate.positions.size());
    ASSERT_LT(net.euler, -6);
    std::vector<std::string> remarks;
    bake_settings settings;
    settings.triangles = 20 + dice.below(20);
    settings.texture_size = 256;
    settings.remark = [&](std::string_view sentence) { remarks.emplace_back(sentence); };
    const auto refused = bake(plate, settings);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, error_code::bad_mesh);
    const std::string& message = refused.error().message;
    const std::string offer = "; ask for ";
    const std::size_t at = message.find(offer);
    ASSERT_NE(at, std::string::npos) << message;
    EXPECT_NE(message.find(" triangles, which are enough", at), std::string::npos) << message;

    bake_settings more = settings;
    more.more_triangles = true;
    remarks.clear();
    const auto taken = bake(plate, more);
    ASSERT_TRUE(taken) << taken.error().message;
    ASSERT_EQ(remarks.size(), 1U);
    const std::string count =
        message.substr(at + offer.size(), message.find(' ', at + offer.size()) - at - offer.size());
    EXPECT_EQ(remarks.front().rfind("the coarse mesh was given " + count + " triangles instead of " +
                                        std::to_string(settings.triangles) + ": ",
                                    0),
              0U)
        << remarks.front();

    // The count that was named, asked for: the same model.
    settings.triangles = std::stoul(count);
    const auto asked = bake(plate, settings);
    ASSERT_TRUE(asked) << asked.error().message;
    EXPECT_TRUE(asked->mesh.positions == taken->mesh.positions);
    std::vector<index_triangle> coarse;
    for (const auto& t : taken->mesh.triangles) coarse.push_back(t.vertex);
    EXPECT_EQ(connect(coarse, taken->mesh.positions.size()).euler, net.euler);
    EXPECT_LT(coarse.size(), plate.triangles.size());
  }
}

// What is enough stays what it was: leave to take more changes nothing.
TEST(ManyHandles, FewerHandlesGetWhatWasAskedFor) {
  std::vector<std::string> remarks;
  bake_settings settings;
  settings.triangles = 300;
  settings.texture_size = 256;
  settings.remark = [&](std::string_view sentence) { remarks.emplace_back(sentence); };
  const triangle_mesh torus = shapes::wavy_torus{}.mesh(100, 50);
  const auto strict = bake(torus, settings);
  settings.more_triangles = true;
  const auto lenient = bake(torus, settings);
  ASSERT_TRUE(strict && lenient);
  EXPECT_TRUE(remarks.empty());
  EXPECT_TRUE(strict->mesh.positions == lenient->mesh.positions);
  EXPECT_EQ(lenient->mesh.triangles.size(), 300U);
}

}  // namespace
}  // namespace asperity::bake
