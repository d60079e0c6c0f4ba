// Files changed at random, a fixed number of them with a fixed seed: each ends in a sentence or in something usable.
#include <algorithm>
#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <vector>

#include "attacks.hpp"
#include "file_formats.hpp"
#include "fuzz_runs.hpp"
#include "gltf_mutator.hpp"
#include "mesh_builder.hpp"
#include "mesh_mutator.hpp"
#include "support/extent.hpp"
#include "survival.hpp"

namespace asperity::hostile {
namespace {

/// One in so many of the runs at length.
const std::size_t one_in = std::max(share, test_support::extent<std::size_t>(4, 1));

TEST(Fuzz, TexturedModels) {
  const auto read = [](const std::string& bytes) { return io::read_textured_model(bytes, "fuzz.glb"); };
  const tally t = fuzz(10'000 / one_in, 20041, good_model(), mutated_glb, read);
  t.print("textured models");
  EXPECT_GE(t.kinds(), 60U) << "mutations stop at the first checks";
  EXPECT_GT(t.loaded(), 0.1);
  EXPECT_LT(t.loaded(), 0.9);
}

TEST(Fuzz, ModelsWithAMapOfMaterials) {
  const auto read = [](const std::string& bytes) { return io::read_textured_model(bytes, "fuzz.glb"); };
  const tally t = fuzz(6'000 / one_in, 31, good_mapped_model(), mutated_glb, read);
  t.print("models with a map of materials");
  EXPECT_GE(t.kinds(), 60U) << "mutations stop at the first checks";
  EXPECT_GT(t.loaded(), 0.1);
}

TEST(Fuzz, PlainGltf) {
  const auto read = [](const std::string& bytes) { return io::read_gltf(bytes, "fuzz.glb"); };
  const tally t = fuzz(15'000 / one_in, 7, glb(tetrahedron(), tetrahedron_bytes()), mutated_glb, read);
  t.print("plain glTF");
  EXPECT_GE(t.kinds(), 50U);
  EXPECT_GT(t.loaded(), 0.1);
}

struct mesh_format {
  const char* name;
  std::string good;
  std::size_t text_end;
  result<triangle_mesh> (*read)(std::string_view, const std::filesystem::path&, io::reading_watch);
  std::size_t least_kinds;
};

TEST(Fuzz, PlainMeshes) {
  const std::string binary_ply = good_binary_ply();
  const std::size_t ply_text = binary_ply.find("end_header\n") + 11;
  const std::vector<mesh_format> formats{
      {"ascii PLY", good_ascii_ply(), std::string::npos, io::read_ply, 15},
      {"binary PLY", binary_ply, ply_text, io::read_ply, 15},
      {"OBJ", good_obj(), std::string::npos,
       [](std::string_view bytes, const std::filesystem::path& file, io::reading_watch watch) {
         io::part_list parts;
         return io::read_obj(bytes, file, watch, &parts);
       },
       8},
      {"ascii STL", good_ascii_stl(), std::string::npos, io::read_stl, 8},
      {"binary STL", good_binary_stl(), 0, io::read_stl, 3},
  };
  for (const mesh_format& f : formats) {
    const auto mutate = [&](const std::string& bytes, random_source& random) {
      // Where the text ends moves with the header.
      const std::size_t header = bytes.find("end_header\n");
      const std::size_t end = f.text_end == 0                                                  ? 0
                              : f.text_end != std::string::npos && header != std::string::npos ? header + 11
                                                                                               : bytes.size();
      return mutated_mesh(bytes, end, random);
    };
    const tally t = fuzz(10'000 / one_in, 3, f.good, mutate,
                         [&](const std::string& bytes) { return f.read(bytes, std::string("fuzz"), {}); });
    t.print(f.name);
    EXPECT_GE(t.kinds(), f.least_kinds) << f.name;
    EXPECT_GT(t.loaded(), 0.05) << f.name;
  }
}

// A reader without the model check would hand out such a model.
TEST(Fuzz, AModelThatNobodyCheckedIsFoundOut) {
  textured_model model = io::read_textured_model(good_model(), "good.glb").value();
  EXPECT_FALSE(complaint(result<textured_model>(model)));
  model.mesh.positions[0].x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(complaint(result<textured_model>(model)));
}

TEST(Fuzz, AMessageWithoutAMendIsFoundOut) {
  for (const char* message : {"a.glb: is bad", "a.glb: is\nbad; mend it",
                              "a.glb: is b\xe4"
                              "d; mend it"}) {
    EXPECT_TRUE(complaint(result<triangle_mesh>(error{error_code::bad_format, message}))) << message;
  }
  EXPECT_FALSE(complaint(result<triangle_mesh>(error{error_code::bad_format, "a.glb: is bad; mend it"})));
}

}  // namespace
}  // namespace asperity::hostile
