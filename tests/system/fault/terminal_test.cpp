// Names that mean harm to a terminal: in files, of files, of folders and of devices. What the command prints has lines
// of its own making only, all of it visible.
#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>

#include <asperity/device/device_recording.hpp>

#include "command_process.hpp"

namespace fault {
namespace {

namespace fs = std::filesystem;

/// Clears the screen, sets the title, goes back to the line's start, forges a line, turns the direction of writing,
/// and is not UTF-8 at its end. Without the last: as JSON can hold it.
const std::string hostile_in_json =
    "a\x1b[2J\x1b]0;t\x07\r\nasperity, forged\t\x7f\xc2\x9b"
    "1m\xe2\x80\xae\xe2\x81\xa6z";
const std::string hostile_name = hostile_in_json + "\xff\xc0\xaf";
/// What is seen of its first part.
const std::string escaped_name = R"(a\x1b[2J\x1b]0;t\x07\r\nasperity, forged\t\x7f\u{009b}1m\u{202e}\u{2066}z)";

/// Bytes of a text that a terminal would act on, or that are no UTF-8.
std::string harm_in(const std::string& text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const auto here = [&] { return "byte " + std::to_string(byte) + " in: " + text.substr(i < 60 ? 0 : i - 60, 120); };
    if ((byte < 0x20 && byte != '\n') || byte == 0x7f) return here();
    if (byte == 0xff || byte == 0xc0 || byte == 0xaf) return here();
    for (const char* turned : {"\xc2\x9b", "\xe2\x80\xae", "\xe2\x81\xa6"}) {
      if (text.compare(i, std::string(turned).size(), turned) == 0) return here();
    }
  }
  return {};
}

class terminal : public command_test {
 protected:
  terminal() {
    fs::create_directory(path(hostile_name));
    model_ = in_it("m.glb");
    fs::copy_file(small_models() / "pin.glb", model_);
  }

  [[nodiscard]] std::string in_it(const std::string& name) const { return path(hostile_name + "/" + name); }

  /// Runs the command and expects that both streams are harmless, and that stderr has one line where there is a fault.
  outcome expect_harmless(const arguments& args, int exit_status, const process_options& options = {}) const {
    outcome o = run(args, options);
    EXPECT_EQ(o.exit_status, exit_status) << o.err;
    EXPECT_EQ(harm_in(o.out), "") << args[0];
    EXPECT_EQ(harm_in(o.err), "") << args[0];
    EXPECT_EQ(o.out.find("\nasperity, forged"), std::string::npos) << o.out;
    const std::string complaint = without_notes(o.err);
    EXPECT_EQ(std::count(complaint.begin(), complaint.end(), '\n'), exit_status == 0 ? 0 : 1) << o.err;
    return o;
  }

  std::string model_;
};

TEST_F(terminal, names_of_models_and_files_in_reports) {
  const std::string block = (small_models() / "block.ply").string();
  const arguments bake{"bake",
                       block,
                       "--coarse",
                       (small_models() / "block_coarse.ply").string(),
                       "--texture",
                       "64",
                       "--name",
                       hostile_in_json,
                       "-o",
                       in_it("named.glb"),
                       "--without-field"};
  EXPECT_NE(expect_harmless(bake, 0).out.find("name                    " + escaped_name), std::string::npos);
  const outcome seen = expect_harmless({"inspect", in_it("named.glb")}, 0);
  EXPECT_NE(seen.out.find("name                    " + escaped_name), std::string::npos) << seen.out;
  EXPECT_NE(seen.out.find(escaped_name + R"(\xff\xc0\xaf/named.glb)"), std::string::npos) << seen.out;
  // As many lines as for the same model under a name without harm.
  const outcome plain = run({"inspect", (small_models() / "pin.glb").string()});
  const outcome named = expect_harmless({"inspect", model_}, 0);
  EXPECT_EQ(std::count(named.out.begin(), named.out.end(), '\n'), std::count(plain.out.begin(), plain.out.end(), '\n'));
  expect_harmless({"inspect", model_, "--picture", in_it("p.png"), "--original", (small_models() / "pin.obj").string()},
                  0);
}

TEST_F(terminal, names_in_a_query_and_a_session) {
  expect_harmless({"query", "--probe", model_, "--fixed", model_, "--probe-pose", "0 0 0.01 0 0 0 1"}, 0);
  const std::string twin = in_it(hostile_name + ".glb");
  fs::copy_file(model_, twin);
  const outcome felt = expect_harmless({"run", "--probe", twin, "--fixed", twin, "--seconds", "0.05", "--record",
                                        in_it("r.csv"), "--plot", in_it("p.svg")},
                                       0);
  EXPECT_EQ(felt.out.rfind(escaped_name, 0), 0U) << felt.out;
  EXPECT_NE(felt.out.find("recording"), std::string::npos);
}

TEST_F(terminal, name_of_the_device_on_a_recording) {
  const std::string pin = (small_models() / "pin.glb").string();
  ASSERT_EQ(
      run({"run", "--probe", pin, "--fixed", pin, "--seconds", "0.03", "--record-device", path("s.dev")}).exit_status,
      0);
  auto session = asperity::load_device_recording(path("s.dev"));
  ASSERT_TRUE(session);
  session->name = hostile_name;
  write("h.dev", asperity::encode(*session));
  const outcome o = expect_harmless({"run", "--probe", pin, "--fixed", pin, "--device", "replay:" + path("h.dev")}, 0);
  EXPECT_NE(o.out.find(escaped_name), std::string::npos) << o.out;
}

TEST_F(terminal, names_in_errors) {
  std::ofstream(in_it("bad.ply")) << "ply\n" << hostile_name << "\n";
  std::ofstream(in_it("bad.png")) << "no image";
  for (const arguments& args : std::vector<arguments>{
           {"bake", in_it("bad.ply"), "-o", in_it("o.glb")},
           {"bake", in_it("absent.ply"), "-o", in_it("o.glb")},
           {"bake", in_it("a." + hostile_name), "-o", in_it("o.glb")},
           {"bake", (small_models() / "block.ply").string(), "-o", in_it("o.glb"), "--height-map", in_it("bad.png")},
           {"inspect", in_it("bad.ply")},
           {"query", "--probe", in_it("absent"), "--fixed", model_, "--probe-pose", "0 0 0 0 0 0 1"},
           {"run", "--probe", model_, "--fixed", in_it("absent")},
           {"run", "--probe", model_, "--fixed", model_, "--device", hostile_name},
           {"run", "--probe", model_, "--fixed", model_, "--device", "replay:" + in_it("bad.png")}}) {
    const outcome o = expect_harmless(args, 1);
    EXPECT_NE(o.err.find(R"(\x1b[2J)"), std::string::npos) << o.err;
    EXPECT_NE(o.err.find(R"(\u{202e})"), std::string::npos) << o.err;
  }
  expect_harmless({"query", "--probe", model_, "--fixed", model_, "--probe-pose", hostile_name}, 2);
  expect_harmless({hostile_name}, 2);
}

TEST_F(terminal, names_of_drivers) {
  std::ofstream(in_it(hostile_name + ".so")) << "not a shared object";
  process_options options;
  options.environment = {{"ASPERITY_DRIVER_PATH", path(hostile_name)}};
  const outcome o = expect_harmless({"devices"}, 0, options);
#ifdef ASPERITY_SAMPLE_DRIVER_DIR
  EXPECT_NE(o.out.find(escaped_name), std::string::npos) << o.out;
#else
  static_cast<void>(o);
#endif
}

}  // namespace
}  // namespace fault
