// A hand at a haptic device moves an arm's tool in MuJoCo and feels what the tool feels. The device is the simulated one; any
// other goes in its place (asperity devices lists them).
#include <cstdint>
#include <cstdio>

#include <asperity/device/output_gate.hpp>
#include <asperity/device/simulated/simulated_device.hpp>
#include <asperity/mujoco/textured_contacts.hpp>

#include "arm.hpp"
#include "loading.hpp"

int main(int argc, char** argv) {
  if (argc != 3) return std::puts("usage: teleoperation TOOL.glb PIECE.glb"), 2;
  const asperity::model_ptr tool = load(argv[1]), piece = load(argv[2]);
  if (!tool || !piece) return 1;
  const asperity::vec3 piece_at(0.45, 0.0, 0.15);
  const mujoco_model m = model_of(arm_mjcf(piece_at));
  if (!m) return 1;
  const mujoco_data d(mj_makeData(m.get()));
  auto contacts =
      asperity::mujoco::textured_contacts::make(*m, {{.probe = {tool, "tool"}, .fixed = {piece, "workpiece"}}});
  if (!contacts) return std::puts(contacts.error().message.c_str()), 1;

  // The device's workspace lies on the workpiece: its origin where the tool just touches.
  const asperity::vec3 on_top = piece_at + asperity::vec3(0.0, 0.0, piece->box.high.z - tool->box.low.z);
  asperity::simulated_settings hand;
  hand.motion.kind = asperity::motion_kind::scrub;
  hand.motion.T_dh.position.z = 0.005;
  hand.motion.depth_m = 0.007;
  hand.motion.sideways_d = {0.0, 1.0, 0.0};
  hand.motion.amplitude_m = 0.004;
  hand.motion.frequency_hz = 1.0;
  asperity::simulated_device device(hand);
  if (const auto opened = device.open(); !opened) return std::puts(opened.error().message.c_str()), 1;
  if (const auto armed = device.arm(); !armed) return std::puts(armed.error().message.c_str()), 1;

  arm robot(*m, *d);
  asperity::output_gate gate(asperity::limits_of(device.capabilities()));
  asperity::device_sample seen;
  constexpr std::int64_t period_ns = 1'000'000;
  std::puts("time      hand is      tool is      tool feels    hand feels");
  bool felt = false;
  for (std::int64_t now_ns = 0; now_ns < 2'000'000'000; now_ns += period_ns) {
    if (device.read(now_ns, seen) != asperity::status::ok) break;
    asperity::pose T_wt;
    T_wt.position = on_top + seen.T_dh.position;
    if (now_ns == 0) robot.place(T_wt);
    mj_step1(m.get(), d.get());
    const asperity::wrench pull = robot.pull_to(T_wt);
    const asperity::status status = contacts->apply(*m, *d);
    mj_step2(m.get(), d.get());
    contacts->take_back(*d);
    if (status != asperity::status::ok) std::printf("%s\n", asperity::to_string(status));
    // The hand feels the other end of the spring that pulls the tool, by a share. The tool's contact force itself, sent back, comes
    // a swing of the arm too late and makes the two jump. No torque: this hand holds a point.
    constexpr double share = 0.3;
    asperity::wrench on_hand;
    on_hand.force = -share * pull.force;
    const asperity::device_command sent =
        gate.pass(now_ns, seen, {on_hand, asperity::wrench_frame::device_base, now_ns + period_ns});
    if (device.write(now_ns, sent) != asperity::status::ok) break;
    felt = felt || sent.on_hand.force.z > 0.1;
    if (now_ns % 200'000'000 != 199'000'000) continue;
    std::printf("%.2f s %9.2f mm %9.2f mm %11.3f N %11.3f N\n", 1e-9 * static_cast<double>(now_ns),
                1e3 * seen.T_dh.position.z, 1e3 * (robot.tool().position.z - on_top.z),
                contacts->report(0).on_probe_w.force.z, sent.on_hand.force.z);
  }
  device.close();
  return felt ? 0 : 1;
}
