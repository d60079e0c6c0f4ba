// Both rates: a contact thread's work and a device thread's work around one simulated device, on a virtual clock.
#include <algorithm>
#include <cstdio>

#include <asperity/asperity.hpp>
#include <asperity/device/simulated/simulated_device.hpp>
#include <asperity/io/textured_model_file.hpp>

// Sees every device tick. It runs inside the tick, so it only compares and adds.
struct ranges {
  double force_low_n = 0.0, force_high_n = 0.0;
  double torque_high_n_m = 0.0;
  std::uint64_t ticks_in_contact = 0;
  asperity::tick_flag flags = asperity::tick_flag::none;  // what the planes did not answer

  void operator()(const asperity::session_record& r) noexcept {
    force_low_n = std::min(force_low_n, r.on_hand_d.force.y);
    force_high_n = std::max(force_high_n, r.on_hand_d.force.y);
    torque_high_n_m = std::max(torque_high_n_m, glm::length(r.on_hand_d.torque));
    if (r.contacts > 0) ++ticks_in_contact;
    flags |= r.flags;
  }
};

int main(int argc, char** argv) {
  if (argc != 3) return std::puts("usage: 02_two_rate_session PROBE.glb FIXED.glb"), 2;
  auto probe = asperity::io::load_textured_model(argv[1]);
  auto fixed = asperity::io::load_textured_model(argv[2]);
  if (!probe || !fixed) return std::puts((probe ? fixed : probe).error().message.c_str()), 1;
  const auto a = std::make_shared<const asperity::textured_model>(std::move(*probe));
  const auto b = std::make_shared<const asperity::textured_model>(std::move(*fixed));
  // The renderer for control loops: support planes, told as far as a loop of 2 ms has to know them.
  auto renderer = asperity::make_plane_renderer({a, {b}}, {.reach_m = asperity::reach_for(0.002)});
  if (!renderer) return std::puts(renderer.error().message.c_str()), 1;

  // The hand begins 5 mm above the fixed body, wants to be 3 mm inside it, and rubs to and fro across it. Device and
  // world share their axes here; workspace_map is for devices that do not.
  asperity::simulated_settings hand;
  hand.motion.kind = asperity::motion_kind::scrub;
  hand.motion.T_dh.position.z = b->box.high.z - a->box.low.z + 0.005;
  hand.motion.depth_m = 0.008;
  hand.motion.sideways_d = {0.0, 1.0, 0.0};
  hand.motion.amplitude_m = 0.004;
  hand.motion.frequency_hz = 2.0;
  asperity::simulated_device device(hand);
  if (const auto opened = device.open(); !opened) return std::puts(opened.error().message.c_str()), 1;
  if (const auto armed = device.arm(); !armed) return std::puts(armed.error().message.c_str()), 1;

  asperity::control_settings control;
  control.probe = asperity::solid_probe(a->mass);
  control.coupling = asperity::coupling_for(device.capabilities(), 1000.0);  // what a hand feels of a hard face
  asperity::virtual_schedule rates;
  rates.device_period_ns = 1'000'000;
  rates.contact_period_ns = 2'000'000;  // half as often: planes hold the probe in between

  // The same with asperity::real_session and start() runs two threads on the real clock.
  asperity::virtual_session session(std::move(*renderer), {{asperity::pose{}}, a->mass.centre_of_mass}, device, control,
                                    rates, ranges{});
  const asperity::status status = session.run_until(2'000'000'000);

  const ranges& felt = session.device().observer();
  std::printf("%s after %llu device ticks and %llu contact ticks, %llu of them in contact\n",
              asperity::to_string(status), static_cast<unsigned long long>(session.device_ticks()),
              static_cast<unsigned long long>(session.contact_ticks()),
              static_cast<unsigned long long>(felt.ticks_in_contact));
  std::printf("sideways force on the hand %.3f to %.3f N, torque up to %.4f N m\n", felt.force_low_n, felt.force_high_n,
              felt.torque_high_n_m);
  if (felt.flags != asperity::tick_flag::none) std::puts("the planes did not hold the probe in every tick");
  device.close();
  return status == asperity::status::ok && felt.ticks_in_contact > 0 ? 0 : 1;
}
