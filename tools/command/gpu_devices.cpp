#include "gpu_devices.hpp"

#include "asperity/gl/context.hpp"
#include "asperity/gl/device.hpp"
#include "asperity/gl/functions.hpp"
#include "text.hpp"

namespace asperity::command {
namespace {

json limits_of(const gl::context_ptr& context) {
  const gl::current_scope here(context);
  if (here.state() != status::ok) return {};
  const auto limit = [&](GLenum name) {
    GLint64 value = 0;
    context->gl().GetInteger64v(name, &value);
    return value;
  };
  json out{{"texture_side", limit(GL_MAX_TEXTURE_SIZE)},
           {"storage_block_bytes", limit(GL_MAX_SHADER_STORAGE_BLOCK_SIZE)},
           {"storage_blocks", limit(GL_MAX_COMPUTE_SHADER_STORAGE_BLOCKS)},
           {"group_invocations", limit(GL_MAX_COMPUTE_WORK_GROUP_INVOCATIONS)},
           {"shared_bytes", limit(GL_MAX_COMPUTE_SHARED_MEMORY_SIZE)}};
  static_cast<void>(gl::take_errors(context->gl()));
  return out;
}

json to_json(const gl::device& d, const gl::context_ptr& context) {
  json out{{"index", d.index},
           {"name", d.name},
           {"version", d.version.empty() ? json() : json(d.version)},
           {"software", d.software},
           {"problem", d.problem.empty() ? json() : json(d.problem)},
           {"dialect", nullptr},
           {"double_precision", nullptr},
           {"limits", nullptr}};
  if (context == nullptr) return out;
  const gl::context_facts& facts = context->facts();
  out["dialect"] = facts.dialect == gl::dialect::es ? "es" : "core";
  out["double_precision"] = facts.double_precision;
  out["limits"] = limits_of(context);
  return out;
}

std::string text_of(const gl::device& d, const json& gpu) {
  const std::string label = "gpu " + std::to_string(d.index);
  if (!d.problem.empty()) return row(label, d.name + ": cannot be used: " + d.problem);
  std::string out = row(label, d.name + ", OpenGL " + d.version);
  if (gpu["limits"].is_object()) {
    out += row("", "textures up to " + std::to_string(gpu["limits"]["texture_side"].get<std::int64_t>()) +
                       " texels per side, buffers up to " +
                       memory_text(gpu["limits"]["storage_block_bytes"].get<std::size_t>()) +
                       (gpu["double_precision"] == true ? ", double precision" : ", single precision only"));
  }
  if (d.software) out += row("", "draws on the processor: right for checking results, and slower than --backend cpu");
  return out;
}

}  // namespace

result<answer> list_gpus() {
  const result<std::vector<gl::device>> devices = gl::list_devices();
  if (!devices) return devices.error();
  answer out;
  out.document["gpus"] = json::array();
  for (const gl::device& d : *devices) {
    gl::context_ptr context;
    if (d.problem.empty()) {
      if (const result<gl::context_ptr> opened = gl::open_context({.device = std::to_string(d.index)})) {
        context = *opened;
      }
    }
    out.document["gpus"].push_back(to_json(d, context));
    out.text += text_of(d, out.document["gpus"].back());
  }
  return out;
}

}  // namespace asperity::command
