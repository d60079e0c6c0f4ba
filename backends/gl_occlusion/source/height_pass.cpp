#include "height_pass.hpp"

#include <utility>

#include "contact_slot.hpp"
#include "record_attributes.hpp"
#include "shaders.hpp"

namespace asperity::gl {
namespace {

constexpr float no_surface = -1e30F;

result<drawn_atlas> make_atlas(const context_ptr& context, const tile_atlas& tiles, std::uint32_t contacts,
                               bool packed) {
  drawn_atlas out{.contacts = contacts, .tiles = tiles};
  auto heights = make_texture(context, packed ? GL_RGBA32F : GL_R32F, tiles.width(), tiles.height(),
                              "occlusion depth: the tiles of heights");
  if (!heights) return heights.error();
  out.colour = *std::move(heights);
  auto layers = make_texture(context, GL_DEPTH_COMPONENT32F, tiles.width(), tiles.height(),
                             "occlusion depth: the layers of the heights");
  if (!layers) return layers.error();
  out.depth = *std::move(layers);
  const functions& gl = context->gl();
  out.framebuffer = make_name(context, name_kind::framebuffer);
  gl.BindFramebuffer(GL_FRAMEBUFFER, out.framebuffer.get());
  gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, out.colour.get(), 0);
  gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, out.depth.get(), 0);
  const GLenum complete = gl.CheckFramebufferStatus(GL_FRAMEBUFFER);
  gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
  if (complete == GL_FRAMEBUFFER_COMPLETE) return out;
  return error{error_code::unsupported, "occlusion depth: " + context->facts().renderer +
                                            " cannot render to floating-point textures; use another backend"};
}

}  // namespace

std::string tile_definitions(std::uint32_t depth_bits, bool packed) {
  const depth_levels levels{depth_bits};
  std::string text = "#define NO_SURFACE (-1e30)\n#define BAD_TEXEL (-2e30)\n";
  text += "#define FIRST_LEVEL " + std::to_string(depth_levels::first) + ".0\n";
  text += "#define TOP_LEVEL " + std::to_string(levels.top()) + ".0\n";
  if (packed) text += "#define PACKED\n";
  return text;
}

result<height_pass> height_pass::make(const context_ptr& context, const tile_atlas& largest, std::uint32_t contacts,
                                      bool packed, const std::string& definitions, std::array<int, 2> tile_samples,
                                      std::size_t records) {
  height_pass out;
  out.packed_ = packed;
  out.tile_samples_ = tile_samples;
  for (const std::uint32_t room : atlas_rooms(contacts)) {
    auto atlas = make_atlas(context, largest.with_room(room), room, packed);
    if (!atlas) return atlas.error();
    out.atlases_.push_back(*std::move(atlas));
  }
  const std::size_t lists = out.lists().size();
  auto memory = mapped_buffer::make(context, lists * records * sizeof(triangle_record), direction::to_device,
                                    "occlusion depth: triangles");
  if (!memory) return memory.error();
  out.records_ = *std::move(memory);
  for (std::size_t q = 0; q < lists; ++q) {
    out.lists_[q].memory = out.records_.as<triangle_record>().subspan(q * records, records);
  }

  const functions& gl = context->gl();
  const std::array stages{shader_stage{GL_VERTEX_SHADER, definitions, {shaders::height_vertex_glsl}},
                          shader_stage{GL_FRAGMENT_SHADER, definitions, {shaders::height_fragment_glsl}}};
  auto program = share_program(context, stages, "the heights of the occlusion depth");
  if (!program) return program.error();
  out.program_ = *std::move(program);
  out.atlas_size_ = gl.GetUniformLocation(out.program_->get(), "atlas_size");
  out.samples_ = gl.GetUniformLocation(out.program_->get(), "tile_samples");
  out.mirrored_ = gl.GetUniformLocation(out.program_->get(), "mirrored");

  out.vertices_ = make_record_vertices<triangle_record>(context);
  return out;
}

void height_pass::clear(std::size_t contacts) noexcept {
  const functions& gl = vertices_.owner()->gl();
  gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer());
  gl.Enable(GL_SCISSOR_TEST);
  gl.Scissor(0, 0, static_cast<GLsizei>(atlas().width()), static_cast<GLsizei>(atlas().used_height(contacts)));
  gl.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  const std::array none{no_surface, no_surface, no_surface, no_surface};
  gl.ClearBufferfv(GL_COLOR, 0, none.data());
}

void height_pass::draw(std::span<const record_run> runs, std::size_t contacts, const uploaded_scene& models) noexcept {
  if (runs.empty()) return;
  const functions& gl = vertices_.owner()->gl();
  const std::size_t before_last = (lists().size() - 1) * lists_[0].memory.size();
  records_.send((before_last + lists().back().used) * sizeof(triangle_record));
  gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer());
  gl.Viewport(0, 0, static_cast<GLsizei>(atlas().width()), static_cast<GLsizei>(atlas().height()));
  gl.Enable(GL_SCISSOR_TEST);
  gl.Scissor(0, 0, static_cast<GLsizei>(atlas().width()), static_cast<GLsizei>(atlas().used_height(contacts)));
  gl.Enable(GL_DEPTH_TEST);
  gl.DepthFunc(GL_GREATER);
  gl.DepthMask(GL_TRUE);
  gl.ClearDepthf(0.0F);
  gl.UseProgram(program_->get());
  gl.Uniform2f(atlas_size_, static_cast<float>(atlas().width()), static_cast<float>(atlas().height()));
  gl.Uniform2i(samples_, tile_samples_[0], tile_samples_[1]);
  gl.ActiveTexture(GL_TEXTURE0);
  gl.BindTexture(GL_TEXTURE_2D, models.probe->texture.get());
  gl.ActiveTexture(GL_TEXTURE1);
  gl.BindVertexArray(vertices_.get());
  gl.BindBuffer(GL_ARRAY_BUFFER, records_.name());
  for (std::size_t q = 0; q < lists().size(); ++q) {
    // Each quarter has layers of its own.
    gl.Clear(GL_DEPTH_BUFFER_BIT);
    const auto here = [&](std::size_t channel) -> GLboolean { return !packed_ || channel == q ? GL_TRUE : GL_FALSE; };
    gl.ColorMask(here(0), here(1), here(2), here(3));
    gl.Uniform2i(mirrored_, static_cast<GLint>(q & 1), static_cast<GLint>(q >> 1));
    for (const record_run& run : runs) {
      if (run.quarter != q) continue;
      gl.BindTexture(GL_TEXTURE_2D, models.fixed[run.body]->texture.get());
      const std::size_t start = (q * lists_[q].memory.size() + run.first) * sizeof(triangle_record);
      read_records_from<triangle_record>(gl, start);
      gl.DrawArraysInstanced(GL_TRIANGLE_FAN, 0, 7, static_cast<GLsizei>(run.count));
    }
  }
  gl.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
}

}  // namespace asperity::gl
