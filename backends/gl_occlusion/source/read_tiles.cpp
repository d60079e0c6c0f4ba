// What the last call drew, for pictures and for tests.
#include <cmath>
#include <limits>
#include <utility>

#include "occlusion_parts.hpp"

namespace asperity::gl {
namespace {

/// An atlas as the device has it: floats, so many to a pixel.
struct read_atlas {
  std::uint32_t width = 0, channels = 1;
  std::vector<float> values;
  [[nodiscard]] float at(std::uint32_t x, std::uint32_t y, std::uint32_t channel) const {
    return values[(std::size_t{y} * width + x) * channels + channel];
  }
};

read_atlas read(const functions& gl, GLuint framebuffer, const tile_atlas& atlas, std::size_t contacts, GLenum format) {
  read_atlas out{atlas.width(), format == GL_RGBA ? 4U : 1U, {}};
  const std::uint32_t height = atlas.used_height(contacts);
  out.values.resize(std::size_t{out.width} * height * out.channels);
  gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  gl.PixelStorei(GL_PACK_ALIGNMENT, 4);
  gl.ReadPixels(0, 0, static_cast<GLsizei>(out.width), static_cast<GLsizei>(height), format, GL_FLOAT,
                out.values.data());
  gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
  return out;
}

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
constexpr std::array motion_names{"+u",        "-u",        "+v",        "-v",        "turned +u",
                                  "turned -u", "turned +v", "turned -v", "turned +n", "turned -n"};

}  // namespace

result<std::vector<occlusion_tiles>> occlusion_depth::read_tiles() {
  parts& p = *parts_;
  if (p.context->facts().dialect == dialect::es) {
    return error{error_code::unsupported, "occlusion depth: OpenGL ES cannot read a depth buffer; open a core context"};
  }
  const current_scope here(p.context);
  if (here.state() != status::ok) {
    return error{error_code::unsupported, "occlusion depth: the context is lost, or current in another thread"};
  }
  const functions& gl = p.context->gl();
  std::vector<occlusion_tiles> out(p.slot_of.size());
  if (p.slots.empty()) return out;
  const tile_atlas& h = p.heights.atlas();
  const tile_atlas& d = p.differences.atlas();
  const read_atlas heights =
      read(gl, p.heights.framebuffer(), h, p.slots.size(), p.gpu_settings.packed ? GL_RGBA : GL_RED);
  const read_atlas levels = read(gl, p.differences.framebuffer(), d, p.slots.size(), GL_DEPTH_COMPONENT);
  if (const std::string errors = take_errors(gl); !errors.empty()) {
    return error{error_code::unsupported, "occlusion depth: reading the tiles back: " + errors};
  }

  const std::uint32_t side = p.writer.settings().grid, margin = p.writer.margin();
  const std::uint32_t last = p.writer.tile_samples() - 1;
  for (std::size_t s = 0; s < p.slots.size(); ++s) {
    const contact_slot& slot = p.slots[s];
    if (!slot.visible) continue;
    occlusion_tiles& to = out[slot.contact];
    const double half_m = slot.half_m;
    const std::size_t drawn = slot.samples == 0 ? 2 : p.height_tiles();
    for (std::size_t k = 0; k < drawn; ++k) {
      occlusion_tile tile;
      tile.name = k == 0 ? "B" : (k == 1 ? "A" : std::string("A ") + motion_names[k - 2 + p.first_drawn()]);
      for (std::uint32_t j = 0; j < side; ++j) {
        for (std::uint32_t i = 0; i < side; ++i) {
          std::uint32_t x = i + margin, y = j + margin, channel = 0;
          if (p.gpu_settings.packed && x > last / 2) x = last - x, channel += 1;
          if (p.gpu_settings.packed && y > last / 2) y = last - y, channel += 2;
          const float v = heights.at(h.x(s, k) + x, h.y(s) + y, channel);
          tile.values_m.push_back(v < -1e29F ? nothing : half_m * static_cast<double>(v));
        }
      }
      to.heights.push_back(std::move(tile));
    }
    for (std::size_t k = 0; slot.samples != 0 && k < configurations; ++k) {
      occlusion_tile tile{k == 0 ? "at rest" : motion_names[k - 1], {}};
      for (std::uint32_t j = 0; j < d.tile; ++j) {
        for (std::uint32_t i = 0; i < d.tile; ++i) {
          const double stored = static_cast<double>(levels.at(d.x(s, k) + i, d.y(s) + j, 0)) * p.levels.top();
          const auto level = static_cast<std::uint32_t>(std::lround(stored));
          tile.values_m.push_back(level == depth_levels::none
                                      ? nothing
                                      : slot.low_m +
                                            (static_cast<double>(level) - depth_levels::first) * slot.quantum_m);
        }
      }
      to.differences.push_back(std::move(tile));
    }
  }
  return out;
}

}  // namespace asperity::gl
