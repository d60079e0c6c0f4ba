#include "asperity/gl/device.hpp"

#include "context_parts.hpp"

namespace asperity::gl {

result<std::vector<device>> list_devices(const context_settings& settings) {
  const result<const egl_library*> egl = egl_library::load(settings.egl_library);
  if (!egl) return egl.error();
  const auto sources = find_sources(**egl);
  if (!sources) return sources.error();
  std::vector<device> out;
  for (const display_source& source : *sources) {
    device d;
    d.index = out.size();
    d.name = source.name;
    d.software = source.software;
    if (const result<context_ptr> c = open_on(**egl, source, settings.dialect)) {
      const context_facts& facts = (*c)->facts();
      d.name = facts.renderer;
      d.software = facts.software;
      d.version = facts.version;
    } else {
      d.problem = c.error().message;
    }
    out.push_back(std::move(d));
  }
  return out;
}

}  // namespace asperity::gl
