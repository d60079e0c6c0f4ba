// The readers under libFuzzer, with the mutator that keeps a .glb's structure. How to run it:
// docs/reference/asset-format.md.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <string_view>

#include "file_formats.hpp"
#include "gltf_mutator.hpp"
#include "survival.hpp"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace asperity;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const auto expect_survival = [](const auto& answer) {
    if (const auto wrong = hostile::complaint(answer)) {
      std::fprintf(stderr, "%s\n", wrong->c_str());
      std::abort();
    }
  };
  expect_survival(io::read_textured_model(bytes, "fuzz.glb"));
  expect_survival(io::read_gltf(bytes, "fuzz.glb"));
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed) {
  try {
    asperity::hostile::random_source random(seed);
    if (size < 28) return LLVMFuzzerMutate(data, size, most);
    const std::string bytes =
        asperity::hostile::mutated_glb(std::string(reinterpret_cast<const char*>(data), size), random);
    const std::size_t kept = std::min(bytes.size(), most);
    std::copy_n(bytes.begin(), kept, data);
    return kept;
  } catch (const std::exception&) {  // an input whose structure an earlier change broke
    return LLVMFuzzerMutate(data, size, most);
  }
}
