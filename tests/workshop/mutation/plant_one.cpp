// asperity_plant CATALOGUE NAME ROOT OUT: the file that a bug of a catalogue is in, below ROOT, with the bug in it, as OUT.
// Fails with one line where the catalogue cannot be read, has no such bug, or the bug does not fit the file any more.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "workshop/mutation/catalogue.hpp"
#include "workshop/mutation/plant.hpp"
#include "workshop/mutation/trial.hpp"

namespace {

using namespace asperity;
namespace fs = std::filesystem;

result<void> write_planted(const fs::path& catalogue, const std::string& name, const fs::path& root,
                           const fs::path& out) {
  const result<std::string> list = mutation::read_text(catalogue);
  if (!list) return list.error();
  const result<std::vector<mutation::bug>> bugs = mutation::read_catalogue(*list, catalogue.string());
  if (!bugs) return bugs.error();
  for (const mutation::bug& b : *bugs) {
    if (b.name != name) continue;
    const result<std::string> source = mutation::read_text(root / b.file);
    if (!source) return source.error();
    const result<std::string> broken = mutation::plant(*source, b);
    if (!broken) return broken.error();
    fs::create_directories(out.parent_path());
    std::ofstream to(out, std::ios::binary);
    if (!(to << *broken).flush()) return error{error_code::io_failed, out.string() + ": cannot be written"};
    return {};
  }
  return error{error_code::invalid_argument, catalogue.string() + ": there is no bug \"" + name + "\""};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) return std::fputs("usage: asperity_plant CATALOGUE NAME ROOT OUT\n", stderr), 2;
  const result<void> done = write_planted(argv[1], argv[2], argv[3], argv[4]);
  if (!done) return std::fprintf(stderr, "asperity_plant: %s\n", done.error().message.c_str()), 1;
  return 0;
}
