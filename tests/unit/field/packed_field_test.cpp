// A packed field comes back to the bit, and bytes that anybody made do no harm.
#include "asperity/field/packed_field.hpp"

#include <cmath>
#include <cstring>
#include <gtest/gtest.h>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "asperity/field/field_scene.hpp"
#include "same_field.hpp"
#include "support/fresh_seed.hpp"
#include "support/small_models.hpp"

namespace asperity {
namespace {

using namespace test_support;
using field_test::expect_same;

field_body_settings small_settings() {
  field_body_settings out;
  out.field.most_nodes = 20'000;
  out.field.threads = 1;
  return out;
}

textured_model ridged_box(double height_m) {
  return make_textured_box({0.004, 0.005, 0.008}, 64, ridges(height_m, 1e-3));
}

// Packed once: making a field is what takes time here.
const std::vector<std::byte>& packed_box() {
  static const std::vector<std::byte> bytes = pack_field(make_field_body(ridged_box(40e-6), small_settings()).value());
  return bytes;
}

TEST(PackedField, ComesBackToTheBit) {
  // With thin walls, with flat walls, and with samples that no tree has to split.
  const std::vector<textured_model> models{ridged_box(40e-6), make_textured_box({0.02, 0.015, 0.001}, 32, ridges(0, 1)),
                                           ridged_box(200e-6)};
  for (const textured_model& model : models) {
    for (const double sample_pitch_m : {0.0, 0.02}) {
      field_body_settings settings = small_settings();
      settings.field.most_nodes = 60'000;
      settings.sample_pitch_m = sample_pitch_m;
      const field_body made = make_field_body(model, settings).value();
      const std::vector<std::byte> bytes = pack_field(made);
      const auto back = unpack_field(bytes);
      ASSERT_TRUE(back) << back.error().message;
      expect_same(made, *back);
      EXPECT_TRUE(back->made_with == without_threads(settings));
      EXPECT_EQ(back->of_model, made.of_model);
      EXPECT_TRUE(pack_field(*back) == bytes);
      EXPECT_LT(bytes.size(), made.heap_bytes()) << "zeros and bounds are left out";
    }
  }
}

TEST(PackedField, IsOfTheModelAndTheSettingsThatItWasMadeWith) {
  const textured_model model = ridged_box(40e-6);
  const auto back = unpack_field(packed_box());
  ASSERT_TRUE(back);
  const field_body& body = *back;
  field_body_settings same = small_settings();
  same.field.threads = 7;
  EXPECT_TRUE(is_made_of(body, model, same)) << "a field does not depend on threads";
  field_body_settings finer = small_settings();
  finer.field.most_nodes += 1;
  EXPECT_FALSE(is_made_of(body, model, finer));

  const auto changed = [&](auto&& change) {
    textured_model other = model;
    change(other);
    return is_made_of(body, other, same);
  };
  EXPECT_TRUE(changed([](textured_model& m) { m.name = "another"; }));
  EXPECT_FALSE(changed([](textured_model& m) { m.mesh.positions[3].y += 1e-12; }));
  EXPECT_FALSE(changed([](textured_model& m) { std::swap(m.mesh.triangles[0], m.mesh.triangles[1]); }));
  EXPECT_FALSE(changed([](textured_model& m) { m.mesh.triangles[2].uv[1].x += 1e-9; }));
  EXPECT_FALSE(changed([](textured_model& m) { m.texture.texels.back().z = 0.25F; }));
  EXPECT_FALSE(changed([](textured_model& m) { std::swap(m.texture.width, m.texture.height *= 2); }));
}

TEST(PackedField, ASceneUsesTheOneThatItsModelKeeps) {
  textured_model model = ridged_box(40e-6);
  const auto kept = std::make_shared<const field_body>(unpack_field(packed_box()).value());
  model.field = kept;
  const auto shared = std::make_shared<const textured_model>(model);
  const field_scene used = make_field_scene({shared, {shared}}, small_settings()).value();
  EXPECT_EQ(used.probe, kept);
  EXPECT_EQ(used.fixed[0], kept);
  EXPECT_EQ(used.heap_bytes(), heap_bytes(used.fixed)) << "the model counts it";
  textured_model bare = *shared;
  bare.field = nullptr;
  EXPECT_EQ(memory_bytes(*shared), memory_bytes(bare) + memory_bytes(*kept));

  field_body_settings finer = small_settings();
  finer.field.most_nodes = 25'000;
  EXPECT_NE(make_field_scene({shared, {shared}}, finer).value().probe, kept) << "made with other settings";

  model.texture.texels[model.texture.texels.size() / 2].x += 1e-5F;
  const auto worn = std::make_shared<const textured_model>(model);
  EXPECT_NE(make_field_scene({worn, {shared}}, small_settings()).value().probe, kept) << "made of another surface";
}

TEST(PackedField, SaysWhatIsWrong) {
  const std::vector<std::byte>& good = packed_box();
  const auto told = [](const std::vector<std::byte>& bytes) {
    const auto read = unpack_field(bytes);
    return read ? std::string() : read.error().message;
  };
  EXPECT_NE(told({}).find("its bytes end in its version"), std::string::npos) << told({});
  std::vector<std::byte> longer = good;
  longer.push_back({});
  EXPECT_NE(told(longer).find("bytes follow after its end"), std::string::npos) << told(longer);
  std::vector<std::byte> newer = good;
  newer[0] = std::byte{77};
  EXPECT_EQ(unpack_field(newer).error().code, error_code::unsupported);
  EXPECT_NE(told(newer).find("version 77"), std::string::npos) << told(newer);

  // The places of numbers in the head: docs/reference/asset-format.md.
  const auto with = [&](std::size_t at, auto number) {
    std::vector<std::byte> bytes = good;
    std::memcpy(bytes.data() + at, &number, sizeof number);
    return told(bytes);
  };
  EXPECT_NE(with(16, std::nan("")).find("a setting"), std::string::npos);
  EXPECT_NE(with(64, 1.0).find("its lowest relief"), std::string::npos);
  EXPECT_NE(with(120, 0.0).find("the pitch of its grid"), std::string::npos);
  EXPECT_NE(with(128, std::uint32_t{3}).find("the nodes of its grid"), std::string::npos);
  EXPECT_NE(with(128, std::uint32_t{0xffffffff}).find("the nodes of its grid"), std::string::npos);
  EXPECT_NE(with(140, std::numeric_limits<float>::infinity()).find("a node of its grid"), std::string::npos);
}

// The numbers of samples in leaves are the only ones that say where a ball's samples are.
TEST(PackedField, LeavesHoldEachSampleOnce) {
  const field_body made = make_field_body(ridged_box(40e-6), small_settings()).value();
  const std::vector<std::byte> good = pack_field(made);
  ASSERT_TRUE(made.plain.samples().empty());
  const std::size_t plain = sizeof(std::uint64_t);  // after the tree that tells: that there are no plain samples
  const std::size_t balls = made.samples.balls(), leaves = (balls + 1) / 2;
  const std::size_t first = good.size() - plain - 32 * balls - leaves;
  const auto with = [&](std::size_t leaf, int more) {
    std::vector<std::byte> bytes = good;
    bytes[first + leaf] = static_cast<std::byte>(std::to_integer<int>(bytes[first + leaf]) + more);
    const auto read = unpack_field(bytes);
    return read ? std::string() : read.error().message;
  };
  EXPECT_EQ(with(0, 0), "");
  EXPECT_NE(with(0, 1).find("its leaves do not hold"), std::string::npos) << with(0, 1);
  EXPECT_NE(with(leaves - 1, -1).find("its leaves do not hold"), std::string::npos) << with(leaves - 1, -1);
  EXPECT_NE(with(leaves / 2, 100).find("a leaf has no sample, or too many"), std::string::npos);
  std::vector<std::byte> bytes = good;
  const std::uint64_t no_places = 0;
  std::memcpy(bytes.data() + first - sizeof no_places, &no_places, sizeof no_places);
  EXPECT_NE(unpack_field(bytes).error().message.find("places of"), std::string::npos);
}

TEST(PackedField, EveryBeginningOfItIsRefused) {
  const std::vector<std::byte>& good = packed_box();
  std::mt19937_64 random(fresh_seed("PackedField.EveryBeginningOfItIsRefused", "300 lengths"));
  for (int i = 0; i < 300; ++i) {
    const std::size_t length = i < 100 ? static_cast<std::size_t>(2 * i) : random() % good.size();
    const auto read = unpack_field(std::span(good).first(length), 1);
    ASSERT_FALSE(read) << length;
    EXPECT_EQ(read.error().code, error_code::bad_format);
  }
}

// Damage that passes gives another field; reading it anywhere must be safe, which the sanitizers see.
TEST(PackedField, DamageDoesNoHarm) {
  const std::vector<std::byte>& good = packed_box();
  const std::uint64_t seed = fresh_seed("PackedField.DamageDoesNoHarm", "400 damages");
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(-0.02, 0.02);
  int passed = 0, refused = 0;
  for (int i = 0; i < 400; ++i) {
    std::vector<std::byte> bytes = good;
    const std::size_t changes = 1 + random() % 4;
    for (std::size_t c = 0; c < changes; ++c) {
      // Half of the damage in the head and beside it, where the sizes are.
      const std::size_t at = random() % (random() % 2 == 0 ? 400 : bytes.size());
      bytes[at] = static_cast<std::byte>(random());
    }
    if (random() % 4 == 0) bytes.resize(bytes.size() - random() % 64);
    const auto read = unpack_field(bytes, 1);
    (read ? passed : refused) += 1;
    if (!read) continue;
    double sum = 0.0;
    for (int k = 0; k < 50; ++k) {
      const vec3 p(place(random), place(random), place(random));
      sum += read->field.read(p).value_m + read->field.most_near(p, 1e-3) +
             static_cast<double>(read->field.slopes.around(p, 1e-4).low.x) +
             read->field.most_third.most_per_m2(p, 1e-4) + read->field.most_relief.most_m(p, 1e-4);
    }
    std::size_t samples = 0;
    read->samples.query(
        [](const sample_ball&, bool) noexcept { return sample_tree::branch_answer::taken; },
        [&](const sample_ball&, std::span<const field_sample> leaf) noexcept { samples += leaf.size(); });
    EXPECT_EQ(samples, read->samples.samples().size()) << seed << " " << sum;
  }
  EXPECT_GT(passed, 20);
  EXPECT_GT(refused, 20);
}

}  // namespace
}  // namespace asperity
