// Machines where something of OpenGL is missing, each made by environment variables of Mesa and of EGL's dispatcher.
#include <array>
#include <cstdio>
#include <cstdlib>
#include <gtest/gtest.h>
#include <string>
#include <sys/wait.h>

namespace {

struct answer {
  int exit_status = -1;
  std::string line;
};

/// Runs gl_probe with these variables set.
answer probe(const std::string& environment, const std::string& arguments = "") {
  const std::string command = "env " + environment + " '" GL_PROBE "' " + arguments + " 2>/dev/null";
  answer out;
  FILE* const pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return out;
  std::array<char, 1024> text{};
  while (std::fgets(text.data(), text.size(), pipe) != nullptr) out.line += text.data();
  const int state = pclose(pipe);
  out.exit_status = WIFEXITED(state) ? WEXITSTATUS(state) : 128;
  return out;
}

bool says(const std::string& line, const std::string& words) { return line.find(words) != std::string::npos; }

void expect_reason(const answer& a, const std::string& step, const std::string& mend) {
  EXPECT_EQ(a.exit_status, 0) << a.line;
  EXPECT_TRUE(says(a.line, "failed unsupported OpenGL: ")) << a.line;
  EXPECT_TRUE(says(a.line, step)) << a.line;
  EXPECT_TRUE(says(a.line, mend)) << a.line;
}

TEST(GlMissing, NoEgl) {
  expect_reason(probe("A=1", "automatic libNoSuchEGL.so.1"), "loading EGL failed: libNoSuchEGL.so.1", "install");
}

TEST(GlMissing, ALibraryThatIsNotEgl) {
  expect_reason(probe("A=1", "automatic libc.so.6"), "libc.so.6 has no egl", "install");
}

TEST(GlMissing, NoVendor) {
  if (!says(probe("A=1").line, "ok ")) GTEST_SKIP() << probe("A=1").line;
  expect_reason(probe("__EGL_VENDOR_LIBRARY_DIRS=/nonexistent"), "finding a vendor failed", "libegl-mesa0");
}

TEST(GlMissing, NoDriver) {
  if (!says(probe("A=1").line, "llvmpipe")) GTEST_SKIP() << "needs Mesa's llvmpipe: " << probe("A=1").line;
  expect_reason(probe("LIBGL_DRIVERS_PATH=/nonexistent"), "starting the driver of software device failed",
                "libgl1-mesa-dri");
}

TEST(GlMissing, CoreIsTooOldSoEsIsTaken) {
  if (!says(probe("A=1").line, "llvmpipe")) GTEST_SKIP() << "needs Mesa's llvmpipe: " << probe("A=1").line;
  const answer a = probe("MESA_GL_VERSION_OVERRIDE=3.3");
  EXPECT_TRUE(says(a.line, "ok es 3.")) << a.line;
}

TEST(GlMissing, EverythingIsTooOld) {
  if (!says(probe("A=1").line, "llvmpipe")) GTEST_SKIP() << "needs Mesa's llvmpipe: " << probe("A=1").line;
  const answer a = probe("MESA_GL_VERSION_OVERRIDE=3.3 MESA_GLES_VERSION_OVERRIDE=3.0");
  expect_reason(a, "is too old: it refuses core 4.5 with EGL_BAD_MATCH", "install one with OpenGL 4.3");
  expect_reason(probe("MESA_GL_VERSION_OVERRIDE=3.3", "core"), "is too old", "OpenGL 4.3");
}

}  // namespace
