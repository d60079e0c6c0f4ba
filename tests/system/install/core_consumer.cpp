// A consumer's program: a flat box pressed onto another by a simulated hand. The tests of the installation build it in
// each way that asperity is offered; ./dev check with other compilers, standards, and without exceptions.
#include <cstdio>

#include <asperity/asperity.hpp>
#include <asperity/device/simulated/simulated_device.hpp>

#include "../../support/small_models.hpp"

int main() {
  const auto box =
      std::make_shared<const asperity::textured_model>(asperity::test_support::make_flat_box({0.02, 0.02, 0.01}));
  auto renderer = asperity::make_renderer({box, {box}});
  if (!renderer) return std::puts(renderer.error().message.c_str()), 1;

  asperity::simulated_settings hand;
  hand.motion.T_dh.position = {0.0, 0.0, 0.022};
  hand.motion.depth_m = 0.004;
  hand.motion.approach_s = 0.2;
  asperity::simulated_device simulated(hand);
  if (!simulated.open() || !simulated.arm()) return std::puts("the simulated device did not open"), 1;
  asperity::virtual_session session(std::move(*renderer), {{asperity::pose{}}, box->mass.centre_of_mass}, simulated,
                                    {});
  const asperity::status status = session.run_until(400'000'000);

  const double push = session.contact().last().force.on_probe_w.force.z;
  std::printf("%s, the box pushes back with %.3f N\n", asperity::to_string(status), push);
  return status == asperity::status::ok && push > 0.0 ? 0 : 1;
}
