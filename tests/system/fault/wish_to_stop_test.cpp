// A wish to stop while a file is read: heard at once, whatever the file's size, and nothing is written.
#include <chrono>
#include <fstream>

#include "command_process.hpp"

namespace fault {
namespace {

class wish_to_stop : public command_test {
 protected:
  /// A file of nothing that takes a while to read and no room on the disk.
  [[nodiscard]] std::string large(const std::string& name) const {
    std::ofstream(path(name)) << "ply\n";
    std::filesystem::resize_file(path(name), std::size_t{250} << 20);
    return path(name);
  }
};

TEST_F(wish_to_stop, is_heard_while_a_file_is_read) {
  const std::string block = (small_models() / "block.glb").string();
  const std::string mesh = large("m.ply"), model = large("m.glb");
  const std::set<std::string> before = files();
  process_options at_once;
  at_once.interrupt_after_s = 0.0;
  for (const arguments& args :
       std::vector<arguments>{{"bake", mesh, "-o", path("out.glb")},
                              {"inspect", model},
                              {"query", "--probe", model, "--fixed", block, "--probe-pose", "0 0 0 0 0 0 1"},
                              {"run", "--probe", block, "--fixed", model}}) {
    const auto start = std::chrono::steady_clock::now();
    const outcome o = run(args, at_once);
    const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    EXPECT_EQ(o.exit_status, 130) << args[0] << ": " << o.err;
    EXPECT_NE(o.err.find("cancelled"), std::string::npos) << args[0] << ": " << o.err;
    EXPECT_LT(took_s, 2.0) << args[0];
    EXPECT_EQ(files(), before);
  }
}

}  // namespace
}  // namespace fault
