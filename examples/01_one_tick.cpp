// Two textured models, one tick, one wrench.
#include <cstdio>

#include <asperity/asperity.hpp>
#include <asperity/io/textured_model_file.hpp>

int main(int argc, char** argv) {
  if (argc != 3) return std::puts("usage: 01_one_tick PROBE.glb FIXED.glb"), 2;
  auto probe = asperity::io::load_textured_model(argv[1]);
  auto fixed = asperity::io::load_textured_model(argv[2]);
  if (!probe || !fixed) return std::puts((probe ? fixed : probe).error().message.c_str()), 1;

  const auto a = std::make_shared<const asperity::textured_model>(std::move(*probe));
  const auto b = std::make_shared<const asperity::textured_model>(std::move(*fixed));
  auto renderer = asperity::make_renderer({a, {b}});
  if (!renderer) return std::puts(renderer.error().message.c_str()), 1;

  // The fixed body sits at the world's origin; the probe lies on top of it, half a millimetre too deep.
  const std::vector<asperity::pose> T_wb(1);
  asperity::pose T_wa;
  T_wa.position.z = b->box.high.z - a->box.low.z - 0.0005;

  asperity::tick tick;
  const asperity::status status = renderer->step({T_wa, T_wb}, tick);
  const auto& [force, torque] = tick.force.on_probe_w;
  std::printf("%s, %zu contacts\n", asperity::to_string(status), tick.contacts.size());
  std::printf("force  %8.4f %8.4f %8.4f N\n", force.x, force.y, force.z);
  std::printf("torque %8.4f %8.4f %8.4f N m, about the probe's centre of mass\n", torque.x, torque.y, torque.z);
  return status == asperity::status::ok ? 0 : 1;
}
