#include "query_pass.hpp"

#include <algorithm>

#include "shaders.hpp"

namespace asperity::gl {
namespace {

constexpr GLenum samples_passed = GL_SAMPLES_PASSED, any_passed = GL_ANY_SAMPLES_PASSED;

GLint narrow(std::uint32_t x) noexcept { return static_cast<GLint>(x); }

}  // namespace

query_names::query_names(const context_ptr& context, std::size_t count) : context_(context), names_(count) {
  context_->gl().GenQueries(static_cast<GLsizei>(count), names_.data());
}

query_names::~query_names() {
  if (context_ == nullptr) return;
  const current_scope here(context_);
  if (here.state() == status::ok) context_->gl().DeleteQueries(static_cast<GLsizei>(names_.size()), names_.data());
}

result<query_pass> query_pass::make(const context_ptr& context, std::size_t contacts, std::uint32_t grid,
                                    std::uint32_t depth_bits, bool packed, const std::string& definitions) {
  query_pass out;
  out.context_ = context;
  out.levels_.bits = depth_bits;
  out.packed_ = packed;
  out.counts_ = context->facts().dialect == dialect::core;
  out.rings_ = (grid + 1) / 2;
  out.per_slot_ = std::max<std::size_t>(out.rings_ + 1, searches);
  out.any_ = query_names(context, contacts * out.per_slot_);
  if (out.counts_) out.counted_ = query_names(context, contacts);
  out.vertices_ = make_name(context, name_kind::vertex_array);

  const functions& gl = context->gl();
  const std::string all = definitions + (gl.ClipControl != nullptr ? "#define DEPTH_FROM_VERTEX\n" : "");
  const auto program = [&](const shader_source& fragment) {
    const std::array stages{shader_stage{GL_VERTEX_SHADER, all, {shaders::quad_vertex_glsl}},
                            shader_stage{GL_FRAGMENT_SHADER, all, {fragment}}};
    return share_program(context, stages, "the queries of the occlusion depth");
  };
  auto threshold = program(shaders::threshold_fragment_glsl);
  if (!threshold) return threshold.error();
  out.threshold_program_ = *std::move(threshold);
  auto samples = program(shaders::sample_fragment_glsl);
  if (!samples) return samples.error();
  out.sample_program_ = *std::move(samples);
  out.threshold_ = gl.GetUniformLocation(out.threshold_program_->get(), "threshold");
  const auto of_sample = [&](const char* name) { return gl.GetUniformLocation(out.sample_program_->get(), name); };
  out.tile_a_ = of_sample("tile_a");
  out.tile_b_ = of_sample("tile_b");
  out.tile_difference_ = of_sample("tile_difference");
  out.samples_ = of_sample("tile_samples");
  out.quarter_ = of_sample("quarter");
  return out;
}

void query_pass::begin(const query_view& view) noexcept {
  const functions& gl = context_->gl();
  gl.BindFramebuffer(GL_FRAMEBUFFER, view.framebuffer);
  gl.Viewport(0, 0, narrow(view.difference_tiles.width()), narrow(view.difference_tiles.height()));
  gl.Enable(GL_SCISSOR_TEST);
  gl.Enable(GL_DEPTH_TEST);
  gl.DepthMask(GL_FALSE);
  if (gl.ClipControl != nullptr) gl.ClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  gl.BindVertexArray(vertices_.get());
}

void query_pass::end() noexcept {
  const functions& gl = context_->gl();
  if (gl.ClipControl != nullptr) gl.ClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
}

void query_pass::draw(const rectangle& r) noexcept {
  const functions& gl = context_->gl();
  gl.Scissor(narrow(r.x), narrow(r.y), narrow(r.width), narrow(r.height));
  gl.DrawArrays(GL_TRIANGLES, 0, 3);
}

void query_pass::begin_query(GLenum target, GLuint name) noexcept {
  context_->gl().BeginQuery(target, name);
  ++queries_;
}

std::uint32_t query_pass::answer(GLuint name) const noexcept {
  GLuint passed = 0;
  context_->gl().GetQueryObjectuiv(name, GL_QUERY_RESULT, &passed);
  return passed;
}

void query_pass::draw_ring(const query_view& view, std::size_t slot, std::uint32_t ring) noexcept {
  const tile_atlas& tiles = view.difference_tiles;
  const std::uint32_t x = tiles.x(slot, 0) + ring, y = tiles.y(slot) + ring;
  // Folded into its first quarter, a tile has the window's border at its low sides alone.
  const std::uint32_t side = tiles.tile - (packed_ ? ring : 2 * ring);
  draw({x, y, side, 1});
  if (side == 1) return;
  draw({x, y + 1, 1, side - 1});
  if (packed_) return;
  draw({x + 1, y + side - 1, side - 1, 1});
  if (side > 2) draw({x + side - 1, y + 1, 1, side - 2});
}

void query_pass::coverage(const query_view& view, std::span<contact_slot> slots,
                          std::span<const char> look_for_bad) noexcept {
  const functions& gl = context_->gl();
  begin(view);
  gl.DepthFunc(GL_LESS);
  gl.UseProgram(threshold_program_->get());
  gl.Uniform1f(threshold_, 0.0F);
  for (std::size_t s = 0; s < slots.size(); ++s) {
    if (!slots[s].visible) continue;
    for (std::uint32_t ring = 0; ring < rings_; ++ring) {
      begin_query(any_passed, any_[s * per_slot_ + ring]);
      draw_ring(view, s, ring);
      gl.EndQuery(any_passed);
    }
  }
  gl.DepthFunc(GL_ALWAYS);
  gl.UseProgram(sample_program_->get());
  gl.ActiveTexture(GL_TEXTURE0);
  gl.BindTexture(GL_TEXTURE_2D, view.heights);
  gl.Uniform2i(samples_, view.tile_samples[0], view.tile_samples[1]);
  for (std::size_t s = 0; s < slots.size(); ++s) {
    if (!slots[s].visible) continue;
    const tile_atlas& h = view.height_tiles;
    const tile_atlas& d = view.difference_tiles;
    gl.Uniform2i(tile_b_, narrow(h.x(s, 0)), narrow(h.y(s)));
    gl.Uniform2i(tile_a_, narrow(h.x(s, 1)), narrow(h.y(s)));
    gl.Uniform2i(tile_difference_, narrow(d.x(s, 0)), narrow(d.y(s)));
    const rectangle tile{d.x(s, 0), d.y(s), d.tile, d.tile};
    if (look_for_bad[s] != 0) {
      gl.Uniform1i(quarter_, -1);
      begin_query(any_passed, any_[s * per_slot_ + rings_]);
      draw(tile);
      gl.EndQuery(any_passed);
    }
    if (!counts_) continue;
    begin_query(samples_passed, counted_[s]);
    for (GLint quarter = 0; quarter < (packed_ ? 4 : 1); ++quarter) {
      gl.Uniform1i(quarter_, quarter);
      draw(tile);
    }
    gl.EndQuery(samples_passed);
  }
  ++rounds_;
  for (std::size_t s = 0; s < slots.size(); ++s) {
    contact_slot& slot = slots[s];
    if (!slot.visible) continue;
    slot.outermost = rings_;
    for (std::uint32_t ring = rings_; ring-- > 0;) {
      if (answer(any_[s * per_slot_ + ring]) != 0) slot.outermost = ring;
    }
    if (look_for_bad[s] != 0) slot.bad_texel = answer(any_[s * per_slot_ + rings_]) != 0;
    slot.samples = counts_ ? answer(counted_[s]) : (slot.outermost < rings_ ? 1 : 0);
  }
  end();
}

void query_pass::search(const query_view& view, std::span<contact_slot> slots) noexcept {
  const functions& gl = context_->gl();
  begin(view);
  gl.DepthFunc(GL_LESS);
  gl.UseProgram(threshold_program_->get());
  const tile_atlas& tiles = view.difference_tiles;
  for (std::uint32_t bit = levels_.bits; bit-- > 0;) {
    const std::uint32_t step = 1U << bit;
    for (std::size_t s = 0; s < slots.size(); ++s) {
      contact_slot& slot = slots[s];
      if (slot.samples == 0) continue;
      for (std::size_t k = 0; k < searches; ++k) {
        // Passes where the stored level is at least level + step. The last search leaves out the outermost samples.
        const std::uint32_t beaten = slot.level[k] + step - 1;
        gl.Uniform1f(threshold_, static_cast<float>(static_cast<double>(beaten) / levels_.top()));
        rectangle r{tiles.x(s, k < configurations ? k : 0), tiles.y(s), tiles.tile, tiles.tile};
        if (k == configurations) {
          const std::uint32_t less = packed_ ? 1 : std::min(2U, tiles.tile);
          r = {r.x + 1, r.y + 1, tiles.tile - less, tiles.tile - less};
        }
        begin_query(any_passed, any_[s * per_slot_ + k]);
        draw(r);
        gl.EndQuery(any_passed);
      }
    }
    ++rounds_;
    for (std::size_t s = 0; s < slots.size(); ++s) {
      if (slots[s].samples == 0) continue;
      for (std::size_t k = 0; k < searches; ++k) {
        if (answer(any_[s * per_slot_ + k]) != 0) slots[s].level[k] += step;
      }
    }
  }
  end();
}

}  // namespace asperity::gl
