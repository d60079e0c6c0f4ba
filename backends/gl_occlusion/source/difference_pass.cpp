#include "difference_pass.hpp"

#include <utility>

#include "contact_slot.hpp"
#include "record_attributes.hpp"
#include "shaders.hpp"

namespace asperity::gl {
namespace {

result<drawn_atlas> make_atlas(const context_ptr& context, const tile_atlas& tiles, std::uint32_t contacts,
                               std::uint32_t depth_bits) {
  drawn_atlas out{.contacts = contacts, .tiles = tiles};
  auto depth = make_texture(context, depth_bits == 16 ? GL_DEPTH_COMPONENT16 : GL_DEPTH_COMPONENT24, tiles.width(),
                            tiles.height(), "occlusion depth: the tiles of differences");
  if (!depth) return depth.error();
  out.depth = *std::move(depth);
  const functions& gl = context->gl();
  out.framebuffer = make_name(context, name_kind::framebuffer);
  gl.BindFramebuffer(GL_FRAMEBUFFER, out.framebuffer.get());
  gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, out.depth.get(), 0);
  const GLenum nothing = GL_NONE;
  gl.DrawBuffers(1, &nothing);
  gl.ReadBuffer(GL_NONE);
  const GLenum complete = gl.CheckFramebufferStatus(GL_FRAMEBUFFER);
  gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
  if (complete == GL_FRAMEBUFFER_COMPLETE) return out;
  return error{error_code::unsupported, "occlusion depth: " + context->facts().renderer + " cannot render to " +
                                            std::to_string(depth_bits) + " bits of depth alone"};
}

}  // namespace

result<difference_pass> difference_pass::make(const context_ptr& context, const tile_atlas& largest,
                                              std::uint32_t contacts, std::uint32_t depth_bits,
                                              const std::string& definitions, std::array<int, 2> tile_samples) {
  difference_pass out;
  out.tile_samples_ = tile_samples;
  for (const std::uint32_t room : atlas_rooms(contacts)) {
    auto atlas = make_atlas(context, largest.with_room(room), room, depth_bits);
    if (!atlas) return atlas.error();
    out.atlases_.push_back(*std::move(atlas));
  }
  // One set of records for the contacts at rest, one for all their configurations.
  auto memory = mapped_buffer::make(context, contacts * (1 + configurations) * sizeof(difference_record),
                                    direction::to_device, "occlusion depth: differences");
  if (!memory) return memory.error();
  out.records_ = *std::move(memory);

  const functions& gl = context->gl();
  const std::array stages{shader_stage{GL_VERTEX_SHADER, definitions, {shaders::difference_vertex_glsl}},
                          shader_stage{GL_FRAGMENT_SHADER, definitions, {shaders::difference_fragment_glsl}}};
  auto program = share_program(context, stages, "the differences of the occlusion depth");
  if (!program) return program.error();
  out.program_ = *std::move(program);
  out.atlas_size_ = gl.GetUniformLocation(out.program_->get(), "atlas_size");
  out.tile_pixels_ = gl.GetUniformLocation(out.program_->get(), "tile_pixels");
  out.samples_ = gl.GetUniformLocation(out.program_->get(), "tile_samples");

  out.vertices_ = make_record_vertices<difference_record>(context);
  return out;
}

void difference_pass::draw(std::size_t first, std::size_t count, GLuint heights) noexcept {
  const functions& gl = vertices_.owner()->gl();
  records_.send((first + count) * sizeof(difference_record));
  gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer());
  gl.Viewport(0, 0, static_cast<GLsizei>(atlas().width()), static_cast<GLsizei>(atlas().height()));
  gl.Disable(GL_SCISSOR_TEST);
  gl.Enable(GL_DEPTH_TEST);
  gl.DepthFunc(GL_ALWAYS);
  gl.DepthMask(GL_TRUE);
  gl.UseProgram(program_->get());
  gl.Uniform2f(atlas_size_, static_cast<float>(atlas().width()), static_cast<float>(atlas().height()));
  gl.Uniform1f(tile_pixels_, static_cast<float>(atlas().tile));
  gl.Uniform2i(samples_, tile_samples_[0], tile_samples_[1]);
  gl.ActiveTexture(GL_TEXTURE0);
  gl.BindTexture(GL_TEXTURE_2D, heights);
  gl.BindVertexArray(vertices_.get());
  gl.BindBuffer(GL_ARRAY_BUFFER, records_.name());
  read_records_from<difference_record>(gl, first * sizeof(difference_record));
  gl.DrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(count));
}

}  // namespace asperity::gl
