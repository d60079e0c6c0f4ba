#include "asperity/gl/program.hpp"

#include <algorithm>
#include <utility>

#include "context_parts.hpp"

namespace asperity::gl {
namespace {

std::string first_lines(const std::string& log) {
  std::size_t end = 0;
  for (int i = 0; i < 4 && end != std::string::npos; ++i) end = log.find('\n', end == 0 ? 0 : end + 1);
  std::string out = log.substr(0, end);
  while (!out.empty() && (out.back() == '\n' || out.back() == '\0')) out.pop_back();
  return out;
}

std::string preamble(const context_facts& facts) {
  if (facts.dialect == dialect::core) return "#version 430 core\n";
  const std::string version = facts.minor >= 2 ? "#version 320 es\n" : "#version 310 es\n";
  return version + "precision highp float;\nprecision highp int;\nprecision highp sampler2D;\n";
}

/// Files are told apart by their line numbers, because not every driver repeats the file number of a #line.
constexpr int lines_per_file = 10'000;

std::string assemble(const context_facts& facts, const shader_stage& stage) {
  std::string text = preamble(facts) + stage.definitions;
  int first = lines_per_file + 1;
  for (const shader_source& s : stage.files) {
    text += "#line " + std::to_string(first) + "\n" + std::string(s.text) + "\n";
    first += lines_per_file;
  }
  return text;
}

/// File and line of the first line number in a driver's message; empty where there is none.
std::string place(const shader_stage& stage, const std::string& log) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  for (auto at = std::find_if(log.begin(), log.end(), is_digit); at != log.end();) {
    const auto end = std::find_if_not(at, log.end(), is_digit);
    const int number = end - at < 8 ? std::stoi(std::string(at, end)) : 0;
    const auto file = static_cast<std::size_t>(number / lines_per_file);
    if (file > 0 && file <= stage.files.size()) {
      return std::string(stage.files[file - 1].file) + " line " + std::to_string(number % lines_per_file) + ": ";
    }
    at = std::find_if(end, log.end(), is_digit);
  }
  return {};
}

/// A shader that goes with its scope.
struct compiled {
  const functions& gl;
  GLuint name;
  compiled(const functions& functions, GLenum stage) : gl(functions), name(gl.CreateShader(stage)) {}
  ~compiled() { gl.DeleteShader(name); }
  compiled(const compiled&) = delete;
  compiled& operator=(const compiled&) = delete;
};

result<void> add_stage(const functions& gl, const context_facts& facts, const shader_stage& stage, GLuint program,
                       const std::string& what) {
  const std::string text = assemble(facts, stage);
  const char* const start = text.c_str();
  const compiled shader(gl, stage.stage);
  gl.ShaderSource(shader.name, 1, &start, nullptr);
  gl.CompileShader(shader.name);
  GLint good = GL_FALSE;
  gl.GetShaderiv(shader.name, GL_COMPILE_STATUS, &good);
  if (good != GL_TRUE) {
    GLint length = 0;
    gl.GetShaderiv(shader.name, GL_INFO_LOG_LENGTH, &length);
    std::string log(static_cast<std::size_t>(std::max(length, 0)), '\0');
    if (length > 0) gl.GetShaderInfoLog(shader.name, length, nullptr, log.data());
    return error{error_code::unsupported, "OpenGL: " + facts.renderer + " does not compile the shader of " + what +
                                              ": " + place(stage, log) + first_lines(log)};
  }
  gl.AttachShader(program, shader.name);  // which keeps it after its own deletion
  return {};
}

}  // namespace

result<program_ptr> share_program(const context_ptr& context, std::span<const shader_stage> stages,
                                  const std::string& what) {
  std::string text;
  for (const shader_stage& s : stages) text += std::to_string(s.stage) + "\n" + assemble(context->facts(), s);
  auto& known = context->parts().programs;
  std::erase_if(known, [](const auto& p) { return p.second.expired(); });
  for (const auto& [its_text, program] : known) {
    if (program_ptr there = program.lock(); there != nullptr && its_text == text) return there;
  }
  result<owned_name> made = make_program(context, stages, what);
  if (!made) return made.error();
  auto out = std::make_shared<const owned_name>(*std::move(made));
  known.emplace_back(std::move(text), out);
  return out;
}

result<owned_name> make_program(const context_ptr& context, std::span<const shader_stage> stages,
                                const std::string& what) {
  const functions& gl = context->gl();
  owned_name program = make_name(context, name_kind::program);
  for (const shader_stage& stage : stages) {
    if (const result<void> r = add_stage(gl, context->facts(), stage, program.get(), what); !r) return r.error();
  }
  gl.LinkProgram(program.get());
  GLint good = GL_FALSE;
  gl.GetProgramiv(program.get(), GL_LINK_STATUS, &good);
  if (good == GL_TRUE) return program;
  GLint length = 0;
  gl.GetProgramiv(program.get(), GL_INFO_LOG_LENGTH, &length);
  std::string log(static_cast<std::size_t>(std::max(length, 0)), '\0');
  if (length > 0) gl.GetProgramInfoLog(program.get(), length, nullptr, log.data());
  return error{error_code::unsupported, "OpenGL: " + context->facts().renderer + " does not link the program of " +
                                            what + ": " + first_lines(log)};
}

}  // namespace asperity::gl
