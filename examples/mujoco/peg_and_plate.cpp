// A textured peg slides down a tilted textured plate, both in MuJoCo: gravity is MuJoCo's, the contact asperity's.
#include <cstdio>

#include <asperity/mujoco/textured_contacts.hpp>

#include "loading.hpp"

int main(int argc, char** argv) {
  if (argc != 3) return std::puts("usage: peg_and_plate PEG.glb PLATE.glb"), 2;
  const asperity::model_ptr peg = load(argv[1]), plate = load(argv[2]);
  if (!peg || !plate) return 1;

  // The plate stands, the peg is free, and gravity is tilted by 15 degrees, so that the plate's top stays level in its axes.
  const mujoco_model m = model_of(R"(<mujoco><option timestep="0.001" gravity="0 2.54 -9.48"/><worldbody>
    <body name="plate"/>
    <body name="peg"><freejoint/><inertial pos="0 0 0" mass="0.1" diaginertia="2e-5 2e-5 2e-5"/></body>
  </worldbody></mujoco>)");
  if (!m) return 1;
  const mujoco_data d(mj_makeData(m.get()));
  d->qpos[2] = plate->box.high.z - peg->box.low.z + 5e-4;

  auto contacts = asperity::mujoco::textured_contacts::make(*m, {{.probe = {peg, "peg"}, .fixed = {plate, "plate"}}});
  if (!contacts) return std::puts(contacts.error().message.c_str()), 1;
  std::puts("time      slides     height      presses       along    contacts");
  const double began_m = d->qpos[2];
  int touched = 0;
  for (int i = 1; i <= 200; ++i) {
    const asperity::status status = contacts->step(*m, *d);
    if (status != asperity::status::ok) std::printf("%s\n", asperity::to_string(status));
    const asperity::mujoco::pair_report& r = contacts->report(0);
    touched += r.contacts > 0 ? 1 : 0;
    if (i % 20 != 0) continue;
    std::printf("%.2f s %7.2f mm %+8.3f mm %9.3f N %9.3f N %8u\n", d->time, 1e3 * d->qpos[1],
                1e3 * (d->qpos[2] - began_m), r.on_probe_w.force.z, r.on_probe_w.force.y, r.contacts);
  }
  std::printf("in touch in %d of 200 steps\n", touched);
  return touched > 0 ? 0 : 1;
}
