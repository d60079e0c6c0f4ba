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
  auto out = std::make_shared<uploaded_model>();
  out->model = model;
  out->texture = *std::move(texture);
  known.push_back(out);
  return uploaded_ptr(std::move(out));
}

result<uploaded_scene> upload(const context_ptr& context, const scene& bodies) {
  uploaded_scene out;
  result<uploaded_ptr> there = upload(context, bodies.probe);
  if (!there) return there.error();
  out.probe = *std::move(there);
  for (const model_ptr& m : bodies.fixed) {
    there = upload(context, m);
    if (!there) return there.error();
    out.fixed.push_back(*std::move(there));
  }
  return out;
}

}  // namespace asperity::gl
