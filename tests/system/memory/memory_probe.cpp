// memory_probe PROBE.glb FIXED.glb: loads models and makes a renderer in a fresh process, and prints for each step what
// the library reports, what the allocator has lent, and by how much the private resident memory has grown. Bytes.
#include <cstddef>
#include <cstdio>
#include <malloc.h>
#include <memory>
#include <unistd.h>
#include <utility>

#include "asperity/io/textured_model_file.hpp"
#include "asperity/least_motion/least_motion_renderer.hpp"

namespace {

struct footprint {
  std::size_t lent = 0;
  std::size_t resident = 0;
};

footprint measure() {
  malloc_trim(0);  // what was freed goes back to the system, so that only what is held is seen
  const struct mallinfo2 heap = mallinfo2();
  std::size_t all = 0, shared = 0;
  if (std::FILE* const pages = std::fopen("/proc/self/statm", "r"); pages != nullptr) {
    if (std::fscanf(pages, "%*u %zu %zu", &all, &shared) != 2) all = shared = 0;
    std::fclose(pages);
  }
  return {heap.uordblks + heap.hblkhd, (all - shared) * static_cast<std::size_t>(sysconf(_SC_PAGESIZE))};
}

void print(const char* what, std::size_t reported, std::size_t part, const footprint& before, const footprint& after) {
  std::printf("%s %zu %zu %zu %zu\n", what, reported, part, after.lent - before.lent, after.resident - before.resident);
}

asperity::model_ptr load(const char* file) {
  auto model = asperity::io::load_textured_model(file);
  if (!model) {
    std::fprintf(stderr, "%s\n", model.error().message.c_str());
    return nullptr;
  }
  return std::make_shared<const asperity::textured_model>(std::move(model).value());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  // glibc would raise this limit while it runs, and keep large blocks that were freed.
  mallopt(M_MMAP_THRESHOLD, 128 << 10);
  static_cast<void>(load(argv[1]));      // whatever the first call sets up once is set up now
  static_cast<void>(std::printf("\n"));  // and so is the output's buffer

  footprint before = measure();
  const asperity::model_ptr probe = load(argv[1]);
  footprint after = measure();
  if (!probe) return 1;
  print("probe", asperity::memory_bytes(*probe), asperity::heap_bytes(probe->texture), before, after);

  before = after;
  const asperity::model_ptr fixed = load(argv[2]);
  after = measure();
  if (!fixed) return 1;
  print("fixed", asperity::memory_bytes(*fixed), asperity::heap_bytes(fixed->texture), before, after);

  before = after;
  auto feel = asperity::make_renderer({probe, {fixed}});
  after = measure();
  if (!feel) return 1;
  print("renderer", feel->memory_bytes(), feel->force().heap_bytes(), before, after);
  return 0;
}
