// Whole bakes of hostile input in every format: from the bytes of a file to a saved model. Each ends in a sentence that
// says what is wrong and how to mend it, or in a model that loads again, carries a renderer, and owns up to its
// repairs.
#include "asperity/bake/bake.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <gtest/gtest.h>
#include <optional>
#include <string>
#include <vector>

#include "asperity/bake/repair.hpp"
#include "asperity/io/textured_model_file.hpp"
#include "gltf_mutator.hpp"
#include "mesh_formats.hpp"
#include "mesh_mutator.hpp"
#include "shape_mutator.hpp"
#include "survival.hpp"
#include "unit/io/scratch_folder.hpp"

namespace asperity::hostile {
namespace {

// ASPERITY_FUZZ_TIMES=n runs n times as many: for an afternoon under a sanitizer.
std::size_t runs(std::size_t usual) {
  const char* times = std::getenv("ASPERITY_FUZZ_TIMES");
  return usual * std::max<std::size_t>(1, times == nullptr ? 1 : std::strtoul(times, nullptr, 10)) / share;
}

struct bake_outcome {
  result<textured_model> model;
  std::vector<std::string> remarks;
};

/// What `asperity bake` does, small: read, perhaps close holes, bake, save, load.
bake_outcome bake_bytes(const mesh_format& format, const std::string& bytes, bool close_holes = false,
                        const std::optional<triangle_mesh>& coarse = {}) {
  static const test_support::scratch_folder folder;
  bake_outcome out{error{error_code::bad_mesh, ""}, {}};
  result<triangle_mesh> mesh = format.read(bytes, std::string("bake") + format.extension, {});
  if (const auto wrong = complaint(mesh)) {
    ADD_FAILURE() << format.name << ": " << *wrong;
  }
  if (!mesh) {
    out.model = mesh.error();
    return out;
  }
  if (close_holes) {
    if (const auto closed = bake::repair(*mesh); !closed) {
      out.model = closed.error();
      return out;
    }
  }
  bake::bake_settings options;
  options.triangles = 80;
  options.coarse = coarse;
  options.texture_size = coarse ? 128 : 64;
  options.threads = 1;
  options.remark = [&](std::string_view sentence) { out.remarks.emplace_back(sentence); };
  out.model = bake::bake(*mesh, options);
  if (!out.model) return out;
  if (const auto saved = io::save_textured_model(*out.model, folder.file("out.glb")); !saved) {
    out.model = saved.error();
    return out;
  }
  out.model = io::load_textured_model(folder.file("out.glb"));
  EXPECT_TRUE(out.model) << "what was saved does not load: " << out.model.error().message;
  return out;
}

bool has_any(const std::string& text, const std::vector<std::string>& words) {
  return std::ranges::any_of(words, [&](const std::string& w) { return text.find(w) != std::string::npos; });
}

std::string all_of(const std::vector<std::string>& sentences) {
  std::string out;
  for (const std::string& s : sentences) out += s + '\n';
  return out;
}

TEST(HostileBakes, EveryPlantedFaultIsNamedOrItsRepairReportedInEveryFormat) {
  for (const planted_fault& fault : planted_faults()) {
    for (const mesh_format& format : mesh_formats()) {
      if (fault.needs_indices && !format.indexed) continue;
      // Refusals cost little. A bake to the end costs more, and beyond the reader no format makes a difference.
      if (fault.baked && (&format - mesh_formats().data() + &fault - planted_faults().data()) % 3 != 0) continue;
      SCOPED_TRACE(std::string(fault.name) + ", " + format.name);
      random_source random(17);
      triangle_mesh mesh = good_ball();
      fault.plant(mesh, random);
      const bake_outcome got = bake_bytes(format, format.write(mesh));
      const auto wrong = complaint(got.model);
      EXPECT_FALSE(wrong) << *wrong;
      EXPECT_EQ(got.model.has_value(), fault.baked) << (got.model ? all_of(got.remarks) : got.model.error().message);
      if (fault.says.empty()) continue;
      const std::string said = got.model ? all_of(got.remarks) : got.model.error().message;
      EXPECT_TRUE(has_any(said, fault.says)) << said;
    }
  }
}

/// Counts what became of the runs of one kind.
struct tally {
  std::size_t runs = 0, baked = 0;
  std::vector<std::string> kinds;

  void add(const bake_outcome& got) {
    ++runs;
    baked += got.model.has_value();
    if (got.model) return;
    const std::string kind = kind_of(got.model.error().message);
    if (std::ranges::find(kinds, kind) == kinds.end()) kinds.push_back(kind);
  }
  void print(const char* what, const char* format) const {
    std::printf("  %-7s %-10s %5zu bakes, %4zu to the end, %3zu kinds of refusal\n", what, format, runs, baked,
                kinds.size());
  }
};

TEST(HostileBakes, ShapesChangedAtRandomEndInASentenceOrAModel) {
  const triangle_mesh good = good_ball();
  for (const mesh_format& format : mesh_formats()) {
    random_source random(2004 + static_cast<std::size_t>(&format - mesh_formats().data()));
    tally all;
    for (std::size_t run = 0; run < runs(16); ++run) {
      const triangle_mesh mesh = mutated_shape(good, random);
      const bool close_holes = random.once_in(3);
      const bool as_coarse = random.once_in(6);
      SCOPED_TRACE(std::string(format.name) + " run " + std::to_string(run));
      const bake_outcome got = as_coarse ? bake_bytes(format, format.write(good), false, mesh)
                                         : bake_bytes(format, format.write(mesh), close_holes);
      all.add(got);
      const auto wrong = complaint(got.model);
      EXPECT_FALSE(wrong) << *wrong;
    }
    all.print("shapes", format.name);
    if (share > 1) continue;
    EXPECT_GE(all.kinds.size(), 5U);
    EXPECT_GE(all.baked, 1U);
    EXPECT_LE(all.baked, all.runs * 3 / 4);
  }
}

/// A bit turned, the end cut off, a part doubled, dropped or overwritten.
std::string mutated_bytes(std::string bytes, random_source& random) {
  for (std::size_t changes = 1 + random.below(3); changes > 0 && !bytes.empty(); --changes) {
    const std::size_t at = random.below(bytes.size());
    const std::size_t length = 1 + random.below(std::min<std::size_t>(64, bytes.size() - at));
    switch (random.below(6)) {
      case 0:
        bytes.resize(at);
        break;
      case 1:
        bytes.erase(at, length);
        break;
      case 2:
        bytes.insert(at, bytes.substr(at, length));
        break;
      case 3:
        bytes.replace(at, length, length, static_cast<char>(random.bits()));
        break;
      default:
        bytes[at] = static_cast<char>(bytes[at] ^ static_cast<char>(1U << random.below(8)));
    }
  }
  return bytes;
}

TEST(HostileBakes, FilesChangedAtRandomEndInASentenceOrAModel) {
  for (const mesh_format& format : mesh_formats()) {
    const std::string good = format.write(good_ball());
    const std::size_t header = good.find("end_header\n");
    const std::size_t text_end = format.text ? good.size() : header == std::string::npos ? 0 : header + 11;
    const bool is_glb = std::string(format.extension) == ".glb";
    random_source random(11 + static_cast<std::size_t>(&format - mesh_formats().data()));
    tally all;
    for (std::size_t run = 0; run < runs(32); ++run) {
      const std::string bytes = random.once_in(2) ? mutated_bytes(good, random)
                                : is_glb          ? mutated_glb(good, random)
                                                  : mutated_mesh(good, text_end, random);
      SCOPED_TRACE(std::string(format.name) + " run " + std::to_string(run));
      const bake_outcome got = bake_bytes(format, bytes, random.once_in(4));
      all.add(got);
      const auto wrong = complaint(got.model);
      EXPECT_FALSE(wrong) << *wrong;
    }
    all.print("files", format.name);
    if (share > 1) continue;
    EXPECT_GE(all.kinds.size(), 3U);
    EXPECT_LT(all.baked, all.runs);
  }
}

}  // namespace
}  // namespace asperity::hostile
