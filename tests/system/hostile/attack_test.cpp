// Every attack, each in a process of its own: refused for the right reason, within a bound on memory, and without a
// file outside the document's folder being opened.
#include <algorithm>
#include <cctype>
#include <csignal>
#include <cstdio>
#include <gtest/gtest.h>
#include <ostream>

#include "attacks.hpp"
#include "open_watch.hpp"
#include "probe_process.hpp"
#include "unit/io/scratch_folder.hpp"

namespace asperity::hostile {

// GoogleTest prints parameters; a name says more than the bytes of a struct.
void PrintTo(const attack& a, std::ostream* to) { *to << a.name; }

namespace {

namespace fs = std::filesystem;

/// Resident memory that a load may add: three times what lies in the folder, and a constant for the code of the
/// readers and for JSON within its limits, whose items are small in the file and large in memory.
constexpr std::size_t times_the_file = 3;
constexpr std::size_t plus_bytes = std::size_t{128} << 20;
/// Address space beyond that: libraries, stack, and blocks that were reserved and never touched.
constexpr std::size_t plus_address_space = std::size_t{128} << 20;

/// The folder inner/ that an attack is planted in, with a secret beside it.
class planted {
 public:
  explicit planted(const attack& a) : secret_file(outer_.file("secret.bin", tetrahedron_bytes())) {
    fs::create_directory(outer_.file("inner"));
    a.plant(outer_.file("inner"));
    file = outer_.file("inner") / a.file;
    for (const auto& entry : fs::recursive_directory_iterator(outer_.file("inner"))) {
      if (entry.is_regular_file() && !entry.is_symlink()) bytes += entry.file_size();
    }
  }

 private:
  test_support::scratch_folder outer_;

 public:
  fs::path secret_file;
  fs::path file;
  std::size_t bytes = 0;
};

class Attack : public ::testing::TestWithParam<attack> {
 protected:
  void expect(const char* how, const std::string& says) {
    const planted at(GetParam());
    const open_watch secret(at.secret_file), outside(system_file);
    static_cast<void>(secret.opened());
    static_cast<void>(outside.opened());
    // What is refused for its size costs none of it.
    const std::size_t counted = std::min(at.bytes, std::size_t{512} << 20);
    const std::size_t bound = times_the_file * counted + plus_bytes;
    const probe_outcome got = run_probe(how, at.file, {.address_space_bytes = bound + plus_address_space});
    std::printf("attack %-42s %-5s file %9zu B  peak %6.1f MB  CPU %4.2f s  %s\n", GetParam().name.c_str(), how,
                at.bytes, 1e-6 * static_cast<double>(got.peak_bytes), got.cpu_s,
                got.said.substr(got.said.find(": ") == std::string::npos ? 0 : got.said.find(": ") + 2).c_str());
    EXPECT_EQ(got.signal, 0) << strsignal(got.signal);
    EXPECT_LE(got.peak_bytes, bound);
    EXPECT_FALSE(secret.opened());
    EXPECT_FALSE(outside.opened());
    if (says.empty()) {
      EXPECT_EQ(got.said, "loaded");
      return;
    }
    // The file, the fault with its place, and a mend, on one line.
    EXPECT_EQ(got.said.rfind(at.file.string() + ": ", 0), 0U) << got.said;
    EXPECT_NE(got.said.find(says), std::string::npos) << got.said << "\nlacks: " << says;
    EXPECT_NE(got.said.find("; "), std::string::npos) << got.said;
    EXPECT_TRUE(std::all_of(got.said.begin(), got.said.end(), [](unsigned char c) { return c >= ' ' && c <= '~'; }))
        << got.said;
    EXPECT_LT(got.said.size(), at.file.string().size() * 2 + 300) << got.said;
  }
};

TEST_P(Attack, OnTheMeshReader) { expect("mesh", GetParam().mesh_says); }
TEST_P(Attack, OnTheModelReader) { expect("model", GetParam().model_says); }

std::vector<attack> all_attacks() {
  std::vector<attack> out = container_attacks();
  for (auto& more : {path_attacks(), geometry_attacks()}) out.insert(out.end(), more.begin(), more.end());
  return out;
}

std::string test_name(const ::testing::TestParamInfo<attack>& named) {
  std::string name = named.param.name;
  for (char& c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  }
  return name;
}

INSTANTIATE_TEST_SUITE_P(All, Attack, ::testing::ValuesIn(all_attacks()), test_name);

// No attack, but the costliest honest document: its buffer is text, held as JSON and decoded.
TEST(Limits, ABufferAsTextTakesSixTimesItself) {
  const test_support::scratch_folder folder;
  nlohmann::json document = tetrahedron();
  document["buffers"][0]["uri"] = "data:application/octet-stream;base64," + std::string(std::size_t{48} << 20, 'A');
  const auto file = folder.file("a.gltf", document.dump());
  const probe_outcome got = run_probe("mesh", file, {});
  EXPECT_EQ(got.said, "loaded");
  EXPECT_LE(got.peak_bytes, 6 * fs::file_size(file));  // 5.9, in each of six runs
  std::printf("48 MiB of data URI: peak %.1f MB\n", 1e-6 * static_cast<double>(got.peak_bytes));
}

/// The attack of this name.
attack named(const std::string& name) {
  for (const attack& a : all_attacks()) {
    if (a.name == name) return a;
  }
  ADD_FAILURE() << "there is no attack " << name;
  return {};
}

probe_outcome bare(const std::string& name) {
  const planted at(named(name));
  const probe_outcome got =
      run_probe("bare", at.file, {.address_space_bytes = std::size_t{8} << 30, .cpu_s = 10, .wall_s = 2});
  std::printf("without the guard: %-34s %s, peak %.1f MB\n", name.c_str(),
              got.signal != 0 ? strsignal(got.signal) : got.said.c_str(), 1e-6 * static_cast<double>(got.peak_bytes));
  return got;
}

// Negative control. Which of these still do harm depends on the version of tinygltf; that none does would mean that
// the attacks above prove nothing.
TEST(WithoutTheGuard, SomeAttacksEndTheProcess) {
  int ended = 0;
  for (const char* name : {"A1_image_far_away", "A4_byteLength_0", "A5_extras_nested_100000.glb", "A17_pipe.gltf",
                           "A18_directory.gltf", "A17_picture_is_a_pipe"}) {
    if (bare(name).signal != 0) ++ended;
  }
  EXPECT_GE(ended, 1);
}

TEST(WithoutTheGuard, SomeLiesAreBelieved) {
  int believed = 0;
  for (const char* name : {"A7_count_2_to_60.glb", "accessor_offset_wraps.glb", "A13_index_2147483647.glb",
                           "A13_position_NaN.glb", "node_below_itself.glb", "name_twice.gltf"}) {
    if (bare(name).said == "loaded") ++believed;
  }
  EXPECT_GE(believed, 1);
}

TEST(WithoutTheGuard, TheWatchSeesTheSecretBeingRead) {
  const planted at(named("A14_parent.gltf"));
  const open_watch secret(at.secret_file);
  if (!secret.watching()) GTEST_SKIP() << "this system offers no watches on files";
  static_cast<void>(secret.opened());
  const probe_outcome got = run_probe("bare", at.file, {});
  EXPECT_EQ(got.said, "loaded");
  EXPECT_TRUE(secret.opened());
}

TEST(WithoutTheGuard, TwoMillionNodesOutgrowTheBound) {
  const planted at(named("A11_2_million_nodes.glb"));
  const probe_outcome got = run_probe("bare", at.file, {});
  EXPECT_TRUE(got.signal != 0 || got.peak_bytes > times_the_file * at.bytes + plus_bytes)
      << got.said << ", " << got.peak_bytes << " bytes";
}

}  // namespace
}  // namespace asperity::hostile
