#include "asperity/gl/uploaded_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "asperity/gl/functions.hpp"
#include "context_parts.hpp"

namespace asperity::gl {
namespace {

result<owned_name> upload_texture(const context_ptr& context, const haptic_texture& texture, const std::string& what) {
  result<owned_name> name = make_texture(context, GL_RGBA32F, texture.width, texture.height, what);
  if (!name) return name;
  const functions& gl = context->gl();
  gl.BindTexture(GL_TEXTURE_2D, name->get());
  gl.PixelStorei(GL_UNPACK_ALIGNMENT, 4);
  // Row by row: a second copy of a large texture would cost as much as the first.
  std::vector<std::array<float, 4>> row(texture.width);
  for (std::uint32_t j = 0; j < texture.height; ++j) {
    for (std::uint32_t i = 0; i < texture.width; ++i) {
      const glm::vec3& p = texture.texels[std::size_t{j} * texture.width + i];
      const bool there = std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
      // A shader's test for NaN is worth what its compiler makes of it, so none reaches the device.
      row[i] = there ? std::array{p.x, p.y, p.z, 1.0F} : std::array<float, 4>{};
    }
    gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, static_cast<GLint>(j), static_cast<GLsizei>(texture.width), 1, GL_RGBA,
                     GL_FLOAT, row.data());
  }
  gl.BindTexture(GL_TEXTURE_2D, 0);
  if (const std::string errors = take_errors(gl); !errors.empty()) {
    return error{error_code::limit_exceeded, "OpenGL: " + what + " could not be filled: " + errors};
  }
  return name;
}

std::vector<uploaded_corner> corners_of(const textured_model& model) {
  std::vector<uploaded_corner> out;
  out.reserve(3 * model.mesh.triangles.size());
  for (const coarse_triangle& t : model.mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const vec3& p = model.mesh.positions[t.vertex[k]];
      out.push_back({{static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)},
                     {static_cast<float>(t.uv[k].x * model.texture.width - 0.5),
                      static_cast<float>(t.uv[k].y * model.texture.height - 0.5)}});
    }
  }
  return out;
}

}  // namespace

result<uploaded_ptr> upload(const context_ptr& context, const model_ptr& model) {
  auto& known = context->parts().models;
  std::erase_if(known, [](const auto& m) { return m.expired(); });
  for (const std::weak_ptr<const uploaded_model>& m : known) {
    if (uploaded_ptr there = m.lock(); there != nullptr && there->model == model) return there;
  }
  const std::string what = "model \"" + model->name + "\"";
  result<owned_name> texture = upload_texture(context, model->texture, "the haptic texture of " + what);
  if (!texture) return texture.error();
  const std::vector<uploaded_corner> corners = corners_of(*model);
  result<owned_name> buffer =
      make_buffer(context, corners.size() * sizeof(uploaded_corner), corners.data(), "the coarse mesh of " + what);
  if (!buffer) return buffer.error();
  auto out = std::make_shared<uploaded_model>();
  out->model = model;
  out->texture = *std::move(texture);
  out->corners = *std::move(buffer);
  known.push_back(out);
  return uploaded_ptr(std::move(out));
}

}  // namespace asperity::gl
