// Device ticks of file on CAD part, 1e5 at length and 2e4 otherwise, and every contact tick among them, inside the
// trap.
#include <filesystem>
#include <gtest/gtest.h>
#include <iostream>
#include <memory>
#include <string>
#include <sys/prctl.h>

#include "approach.hpp"
#include "asperity/control/virtual_session.hpp"
#include "asperity/device/simulated/simulated_device.hpp"
#include "asperity/io/textured_model_file.hpp"
#include "asperity/window/window_renderer.hpp"
#include "session/rt/tick_trap.hpp"
#include "support/extent.hpp"
#include "support/kept_bodies.hpp"

namespace {

using namespace asperity;
using test_support::tick_trap;

// The first second: the approach, the touch and the first stroke. The pages of code and stack that a session needs may
// be met for the first time in it; no later tick may find one that is missing.
constexpr std::uint64_t warm_up_ticks = 1'000;

model_ptr load(const char* name) {
  result<textured_model> model =
      io::load_textured_model(std::filesystem::path(ASPERITY_TEST_MODELS_DIR) / (std::string(name) + ".glb"));
  if (!model) {
    ADD_FAILURE() << model.error().message;
    return nullptr;
  }
  return std::make_shared<const textured_model>(std::move(model).value());
}

struct seen {
  std::uint64_t in_contact = 0;
  std::uint64_t not_ok = 0;

  void operator()(const session_record& r) noexcept {
    in_contact += r.contacts > 0 ? 1 : 0;
    not_ok += r.contact_status == status::ok || r.contact_status == status::not_ready ? 0 : 1;
  }
};

// The handle at the probe's centre of mass, above the touch by the height from which the hand begins.
workspace_map held_above(pose T_wa_touch, const vec3& centre_of_mass_a, double height_m) {
  T_wa_touch.position.z += height_m;
  return {.T_wd = {quat(1.0, 0.0, 0.0, 0.0), T_wa_touch * centre_of_mass_a},
          .T_ha = {quat(1.0, 0.0, 0.0, 0.0), -centre_of_mass_a}};
}

// So many device ticks of the session after the warm-up, a millisecond each. Make is make_renderer or
// make_window_renderer.
template <class Make>
void trap_file_on_cad_part(std::uint64_t steady_ticks, Make&& make) {
  const model_ptr file = load("file");
  const model_ptr cad_part = load("cad_part");
  ASSERT_TRUE(file && cad_part);
  auto feel = make(scene{file, {cad_part}});
  ASSERT_TRUE(feel);
  const scene_placement placement{{pose{}}, file->mass.centre_of_mass};
  const command::step_function step_once = [&](const scene_pose& at, tick& out) { return feel->step(at, out); };
  const result<pose> touch = command::find_touch(feel->scene(), step_once, quat(1.0, 0.0, 0.0, 0.0), placement.T_wb);
  ASSERT_TRUE(touch) << touch.error().message;

  constexpr double height_m = 0.003;
  simulated_device dev({.motion = {.kind = motion_kind::scrub,
                                   .sideways_d = {0.8, 0.6, 0.0},
                                   .depth_m = 0.012 + height_m,
                                   .amplitude_m = 0.01}});
  ASSERT_TRUE(dev.open() && dev.arm());
  control_settings control;
  control.map = held_above(*touch, placement.centre_of_mass_a, height_m);
  control.probe = solid_probe(file->mass);
  // The slowest contact loop that the ageing of contacts is made for, so that the test is over within half a minute.
  constexpr std::int64_t contact_period_ns = 10'000'000;
  virtual_session session(std::move(*feel), placement, dev, control, {.contact_period_ns = contact_period_ns}, seen{});

  // A kernel that gathers pages into huge ones takes them away for a moment; that is not the tick's doing.
  ::prctl(PR_SET_THP_DISABLE, 1, 0, 0, 0);

  // A step of the virtual session is the contact ticks that are due and one device tick, and nothing else.
  const auto step = [&] { static_cast<void>(session.step()); };
  tick_trap warm_up;
  tick_trap steady;
  while (warm_up.ticks() < warm_up_ticks) warm_up(step);
  while (steady.ticks() < steady_ticks) steady(step);

  const seen& felt = session.device().observer();
  std::cout << session.device_ticks() << " device ticks, " << felt.in_contact << " of them in contact; "
            << session.contact().computed() << " contact ticks; " << warm_up.page_faults()
            << " page faults in the first " << warm_up_ticks << " ticks, " << steady.page_faults() << " afterwards\n";
  if (const std::string why = tick_trap::missing_system_calls(); !why.empty()) {
    std::cout << "system calls went unseen: " << why << '\n';
  }
  EXPECT_EQ(session.device().gate().fault(), gate_fault::none);
  EXPECT_EQ(felt.not_ok, 0U);
  EXPECT_GT(felt.in_contact, steady_ticks - steady_ticks / 10);
  EXPECT_EQ(steady.page_faults(), 0U);
}

TEST(benchmark_ticks, file_on_cad_part_does_nothing_that_a_tick_must_not_do) {
  if (const std::string why = tick_trap::missing(); !why.empty()) GTEST_SKIP() << why;
  trap_file_on_cad_part(test_support::extent(4'000U, 99'000U),
                        [](const scene& bodies) { return test_support::build_renderer(bodies); });
}

TEST(benchmark_ticks, nor_does_it_with_the_contacts_of_the_paper) {
  if (const std::string why = tick_trap::missing(); !why.empty()) GTEST_SKIP() << why;
  trap_file_on_cad_part(test_support::extent(3'000U, 24'000U),
                        [](const scene& bodies) { return make_window_renderer(bodies); });
}

}  // namespace
