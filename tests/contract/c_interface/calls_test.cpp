// Every entry point with what it must refuse: null, handles of another kind, wrong sizes, numbers that are none.
#include <cmath>
#include <cstring>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <vector>

#include "contract/c_interface/saved_models.hpp"

namespace {

using namespace asperity::test_support;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double identity[7] = {0, 0, 0, 0, 0, 0, 1};
constexpr std::int32_t refused = ASPERITY_ERROR_INVALID_ARGUMENT;

/// A handle of one kind where another is wanted: what a language without types of C lets through.
template <class To, class From>
To* as(const From& handle) {
  return reinterpret_cast<To*>(handle.get());
}

TEST(c_calls, null_is_refused_everywhere) {
  const all_handles h;
  asperity_error why = no_error();
  asperity_model_facts facts = sized<asperity_model_facts>();
  asperity_material material = sized<asperity_material>();
  asperity_touch touch = sized<asperity_touch>();
  asperity_contact contact = sized<asperity_contact>();
  asperity_felt felt = sized<asperity_felt>();
  asperity_device_limits limits = sized<asperity_device_limits>();
  asperity_measurement sample = sized<asperity_measurement>();
  asperity_session_tick tick = sized<asperity_session_tick>();
  asperity_model* model = nullptr;
  asperity_renderer* renderer = nullptr;
  asperity_tool* tool = nullptr;
  asperity_haptic_device* device = nullptr;
  asperity_session* session = nullptr;
  double out[7] = {};
  const asperity_model* const nobody = nullptr;

  EXPECT_EQ(asperity_model_load(nullptr, &model, &why), refused);
  EXPECT_EQ(asperity_model_load("x.glb", nullptr, &why), refused);
  EXPECT_EQ(asperity_model_get_facts(nullptr, &facts), refused);
  EXPECT_EQ(asperity_model_get_facts(h.models.c_probe.get(), nullptr), refused);
  EXPECT_EQ(asperity_model_name(nullptr), nullptr);
  EXPECT_EQ(asperity_material_preset(nullptr, &material, &why), refused);
  EXPECT_EQ(asperity_material_preset("steel", nullptr, &why), refused);
  EXPECT_EQ(asperity_model_with_material(nullptr, &material, &model, &why), refused);
  EXPECT_EQ(asperity_model_with_material(h.models.c_probe.get(), &material, nullptr, &why), refused);

  EXPECT_EQ(asperity_renderer_make(nullptr, &h.models.fixed, 1, nullptr, &renderer, &why), refused);
  EXPECT_EQ(asperity_renderer_make(h.models.c_probe.get(), nullptr, 1, nullptr, &renderer, &why), refused);
  EXPECT_EQ(asperity_renderer_make(h.models.c_probe.get(), &nobody, 1, nullptr, &renderer, &why), refused);
  EXPECT_EQ(asperity_renderer_make(h.models.c_probe.get(), &h.models.fixed, 0, nullptr, &renderer, &why), refused);
  EXPECT_EQ(asperity_renderer_make(h.models.c_probe.get(), &h.models.fixed, 1, nullptr, nullptr, &why), refused);
  EXPECT_EQ(asperity_renderer_place_body(nullptr, 0, identity), refused);
  EXPECT_EQ(asperity_renderer_place_body(h.renderer.get(), 0, nullptr), refused);
  EXPECT_EQ(asperity_renderer_place_body(h.renderer.get(), 1, identity), refused);
  EXPECT_EQ(asperity_renderer_step(nullptr, identity, &touch), refused);
  EXPECT_EQ(asperity_renderer_step(h.renderer.get(), nullptr, &touch), refused);
  EXPECT_EQ(asperity_renderer_step(h.renderer.get(), identity, nullptr), refused);
  EXPECT_EQ(asperity_renderer_body_wrench(nullptr, 0, out), refused);
  EXPECT_EQ(asperity_renderer_body_wrench(h.renderer.get(), 0, nullptr), refused);
  EXPECT_EQ(asperity_renderer_body_wrench(h.renderer.get(), 1, out), refused);
  EXPECT_EQ(asperity_renderer_contact(nullptr, 0, &contact), refused);
  EXPECT_EQ(asperity_renderer_contact(h.renderer.get(), 0, nullptr), refused);
  EXPECT_EQ(asperity_renderer_find_touch(nullptr, identity + 3, out, &why), refused);
  EXPECT_EQ(asperity_renderer_find_touch(h.renderer.get(), nullptr, out, &why), refused);
  EXPECT_EQ(asperity_renderer_find_touch(h.renderer.get(), identity + 3, nullptr, &why), refused);

  EXPECT_EQ(asperity_tool_make(nullptr, &h.models.fixed, 1, nullptr, &tool, &why), refused);
  EXPECT_EQ(asperity_tool_make(h.models.c_probe.get(), &nobody, 1, nullptr, &tool, &why), refused);
  EXPECT_EQ(asperity_tool_make(h.models.c_probe.get(), &h.models.fixed, 1, nullptr, nullptr, &why), refused);
  EXPECT_EQ(asperity_tool_place(nullptr, identity), refused);
  EXPECT_EQ(asperity_tool_place(h.tool.get(), nullptr), refused);
  EXPECT_EQ(asperity_tool_move_body(nullptr, 0, identity, nullptr), refused);
  EXPECT_EQ(asperity_tool_move_body(h.tool.get(), 0, nullptr, nullptr), refused);
  EXPECT_EQ(asperity_tool_move_body(h.tool.get(), 1, identity, nullptr), refused);
  EXPECT_EQ(asperity_tool_follow(nullptr, identity, 1e-3, &felt), refused);
  EXPECT_EQ(asperity_tool_follow(h.tool.get(), nullptr, 1e-3, &felt), refused);
  EXPECT_EQ(asperity_tool_follow(h.tool.get(), identity, 1e-3, nullptr), refused);

  EXPECT_EQ(asperity_device_make_simulated(nullptr, nullptr, &why), refused);
  EXPECT_EQ(asperity_device_open(nullptr, &why), refused);
  EXPECT_EQ(asperity_device_arm(nullptr, &why), refused);
  EXPECT_EQ(asperity_device_disarm(nullptr), refused);
  EXPECT_EQ(asperity_device_read(nullptr, 0, &sample), refused);
  EXPECT_EQ(asperity_device_read(h.free_device.get(), 0, nullptr), refused);
  EXPECT_EQ(asperity_device_write(nullptr, 0, identity, 0), refused);
  EXPECT_EQ(asperity_device_write(h.free_device.get(), 0, nullptr, 0), refused);
  EXPECT_EQ(asperity_device_get_limits(nullptr, &limits), refused);
  EXPECT_EQ(asperity_device_get_limits(h.device.get(), nullptr), refused);
  EXPECT_EQ(asperity_device_state(nullptr), ASPERITY_DEVICE_ABSENT);

  const auto make = [&](const asperity_model* probe, const asperity_model* const* fixed, asperity_haptic_device* on,
                        asperity_session** to) {
    return asperity_session_make(probe, fixed, nullptr, 1, on, nullptr, to, &why);
  };
  EXPECT_EQ(make(nullptr, &h.models.fixed, h.free_device.get(), &session), refused);
  EXPECT_EQ(make(h.models.c_probe.get(), nullptr, h.free_device.get(), &session), refused);
  EXPECT_EQ(make(h.models.c_probe.get(), &h.models.fixed, nullptr, &session), refused);
  EXPECT_EQ(make(h.models.c_probe.get(), &h.models.fixed, h.free_device.get(), nullptr), refused);
  EXPECT_EQ(asperity_session_step(nullptr, 1, &tick), refused);
  EXPECT_EQ(asperity_session_step(h.session.get(), 1, nullptr), ASPERITY_STATUS_OK);
  EXPECT_EQ(asperity_session_stop(nullptr), refused);

  for (const std::int32_t freed :
       {asperity_model_free(nullptr), asperity_renderer_free(nullptr), asperity_tool_free(nullptr),
        asperity_device_free(nullptr), asperity_session_free(nullptr)}) {
    EXPECT_EQ(freed, ASPERITY_STATUS_OK);
  }
  EXPECT_EQ(model, nullptr);
  EXPECT_EQ(renderer, nullptr);
  EXPECT_EQ(tool, nullptr);
  EXPECT_EQ(device, nullptr);
  EXPECT_EQ(session, nullptr);
}

// Nothing that fails needs an error to be written to.
TEST(c_calls, no_sentence_has_to_be_wanted) {
  asperity_model* model = nullptr;
  EXPECT_EQ(asperity_model_load("nowhere.glb", &model, nullptr), ASPERITY_ERROR_IO_FAILED);
  asperity_error unset{};
  EXPECT_EQ(asperity_model_load("nowhere.glb", &model, &unset), ASPERITY_ERROR_IO_FAILED);
  EXPECT_EQ(unset.code, 0) << "its size was not set: nothing may be written";
}

TEST(c_calls, handles_of_another_kind_are_refused) {
  const all_handles h;
  asperity_error why = no_error();
  asperity_touch touch = sized<asperity_touch>();
  asperity_felt felt = sized<asperity_felt>();
  asperity_model_facts facts = sized<asperity_model_facts>();
  asperity_measurement sample = sized<asperity_measurement>();
  asperity_session_tick tick = sized<asperity_session_tick>();
  asperity_renderer* made = nullptr;
  double out[7] = {};
  EXPECT_EQ(asperity_renderer_step(as<asperity_renderer>(h.tool), identity, &touch), refused);
  EXPECT_EQ(asperity_renderer_place_body(as<asperity_renderer>(h.session), 0, identity), refused);
  EXPECT_EQ(asperity_renderer_body_wrench(as<asperity_renderer>(h.device), 0, out), refused);
  EXPECT_EQ(asperity_renderer_find_touch(as<asperity_renderer>(h.tool), identity + 3, out, &why), refused);
  EXPECT_EQ(asperity_tool_place(as<asperity_tool>(h.renderer), identity), refused);
  EXPECT_EQ(asperity_tool_move_body(as<asperity_tool>(h.renderer), 0, identity, nullptr), refused);
  EXPECT_EQ(asperity_tool_follow(as<asperity_tool>(h.renderer), identity, 1e-3, &felt), refused);
  EXPECT_EQ(asperity_model_get_facts(as<asperity_model>(h.renderer), &facts), refused);
  EXPECT_EQ(asperity_model_name(as<asperity_model>(h.renderer)), nullptr);
  EXPECT_EQ(asperity_device_read(as<asperity_haptic_device>(h.session), 0, &sample), refused);
  EXPECT_EQ(asperity_device_state(as<asperity_haptic_device>(h.session)), ASPERITY_DEVICE_ABSENT);
  EXPECT_EQ(asperity_session_step(as<asperity_session>(h.device), 1, &tick), refused);
  EXPECT_EQ(asperity_session_stop(as<asperity_session>(h.device)), refused);
  const asperity_model* const no_model = as<asperity_model>(h.tool);
  EXPECT_EQ(asperity_renderer_make(h.models.c_probe.get(), &no_model, 1, nullptr, &made, &why), refused);
  EXPECT_EQ(asperity_model_free(as<asperity_model>(h.renderer)), refused);
  EXPECT_EQ(asperity_renderer_free(as<asperity_renderer>(h.tool)), refused);
  EXPECT_EQ(asperity_tool_free(as<asperity_tool>(h.device)), refused);
  EXPECT_EQ(asperity_device_free(as<asperity_haptic_device>(h.session)), refused);
  EXPECT_EQ(asperity_session_free(as<asperity_session>(h.renderer)), refused);
  // None of them was touched.
  const double beside[7] = {0, 0, 0.05, 0, 0, 0, 1};
  EXPECT_EQ(asperity_renderer_step(h.renderer.get(), beside, &touch), ASPERITY_STATUS_OK);
  EXPECT_EQ(asperity_session_step(h.session.get(), 1, &tick), ASPERITY_STATUS_OK);
}

TEST(c_calls, sizes_that_cannot_be_are_refused) {
  const all_handles h;
  asperity_error why = no_error();
  for (const std::uint32_t size : {0U, 4U, 7U, 12U, 60U, 4104U, 0xffffffffU}) {
    SCOPED_TRACE(size);
    asperity_touch touch{};
    touch.size = size;
    EXPECT_EQ(asperity_renderer_step(h.renderer.get(), identity, &touch), refused);
    asperity_felt felt{};
    felt.size = size;
    EXPECT_EQ(asperity_tool_follow(h.tool.get(), identity, 1e-3, &felt), refused);
    asperity_session_tick tick{};
    tick.size = size;
    EXPECT_EQ(asperity_session_step(h.session.get(), 1, &tick), refused);
    EXPECT_EQ(tick.ticks, 0U);
    asperity_model_facts facts{};
    facts.size = size;
    EXPECT_EQ(asperity_model_get_facts(h.models.c_probe.get(), &facts), refused);
    asperity_renderer_settings settings{};
    settings.size = size;
    asperity_renderer* made = nullptr;
    EXPECT_EQ(asperity_renderer_make(h.models.c_probe.get(), &h.models.fixed, 1, &settings, &made, &why), refused);
    EXPECT_NE(std::strstr(why.message, "size"), nullptr) << why.message;
    asperity_tool_settings of_tool{};
    of_tool.size = size;
    asperity_tool* tool = nullptr;
    EXPECT_EQ(asperity_tool_make(h.models.c_probe.get(), &h.models.fixed, 1, &of_tool, &tool, &why), refused);
    asperity_simulated_settings of_device{};
    of_device.size = size;
    asperity_haptic_device* device = nullptr;
    EXPECT_EQ(asperity_device_make_simulated(&of_device, &device, &why), refused);
    asperity_material material{};
    material.size = size;
    asperity_model* model = nullptr;
    EXPECT_EQ(asperity_material_preset("steel", &material, &why), refused);
    EXPECT_EQ(asperity_model_with_material(h.models.c_probe.get(), &material, &model, &why), refused);
  }
}

TEST(c_calls, poses_that_are_none_leave_a_zero_wrench) {
  const all_handles h;
  const double above[7] = {0, 0, 0.0205, 0, 0, 0, 1};
  ASSERT_EQ(asperity_tool_place(h.tool.get(), above), 0);
  for (int place = 0; place < 7; ++place) {
    for (const double bad : {nan, infinity, -infinity, 1e300}) {
      SCOPED_TRACE(place);
      if (bad == 1e300 && place < 3) continue;
      double T[7] = {0, 0, 0.0195, 0, 0, 0, 1};
      T[place] = bad;
      asperity_touch touch = sized<asperity_touch>();
      touch.on_probe[0] = 1.0;
      EXPECT_EQ(asperity_renderer_step(h.renderer.get(), T, &touch), ASPERITY_STATUS_INVALID_POSE);
      for (const double x : touch.on_probe) EXPECT_EQ(x, 0.0);
      EXPECT_EQ(asperity_renderer_place_body(h.renderer.get(), 0, T), ASPERITY_STATUS_INVALID_POSE);
      asperity_felt felt = sized<asperity_felt>();
      felt.on_hand[0] = 1.0;
      EXPECT_EQ(asperity_tool_follow(h.tool.get(), T, 1e-3, &felt), ASPERITY_STATUS_INVALID_POSE);
      for (const double x : felt.on_hand) EXPECT_EQ(x, 0.0);
      EXPECT_EQ(asperity_tool_place(h.tool.get(), T), ASPERITY_STATUS_INVALID_POSE);
      EXPECT_EQ(asperity_tool_move_body(h.tool.get(), 0, T, nullptr), ASPERITY_STATUS_INVALID_POSE);
      asperity_session_settings settings = sized<asperity_session_settings>();
      std::memcpy(settings.start_pose, T, sizeof T);
      asperity_session* made = nullptr;
      asperity_error why = no_error();
      EXPECT_EQ(asperity_session_make(h.models.c_probe.get(), &h.models.fixed, nullptr, 1, h.free_device.get(),
                                      &settings, &made, &why),
                refused);
      EXPECT_EQ(asperity_session_make(h.models.c_probe.get(), &h.models.fixed, T, 1, h.free_device.get(), nullptr,
                                      &made, &why),
                refused);
    }
  }
  const double no_unit[7] = {0, 0, 0, 0, 0, 0, 2};
  asperity_touch touch = sized<asperity_touch>();
  EXPECT_EQ(asperity_renderer_step(h.renderer.get(), no_unit, &touch), ASPERITY_STATUS_INVALID_POSE);
  double out[7];
  EXPECT_EQ(asperity_renderer_find_touch(h.renderer.get(), no_unit + 3, out, nullptr), refused);
  // The device is free again after each refusal, and what was good before is good now.
  EXPECT_EQ(asperity_device_open(h.free_device.get(), nullptr), 0);
  const double good[7] = {0, 0, 0.0195, 0, 0, 0, 1};
  EXPECT_EQ(asperity_renderer_step(h.renderer.get(), good, &touch), 0);
  EXPECT_GT(touch.on_probe[2], 0.1);
}

TEST(c_calls, times_and_velocities_that_are_none) {
  const all_handles h;
  asperity_felt felt = sized<asperity_felt>();
  const double above[7] = {0, 0, 0.0205, 0, 0, 0, 1};
  EXPECT_EQ(asperity_tool_follow(h.tool.get(), above, 1e-3, &felt), ASPERITY_STATUS_NOT_READY);
  ASSERT_EQ(asperity_tool_place(h.tool.get(), above), 0);
  for (const double dt_s : {0.0, -1e-3, nan, infinity, -infinity}) {
    felt.on_hand[0] = 1.0;
    EXPECT_EQ(asperity_tool_follow(h.tool.get(), above, dt_s, &felt), refused);
    EXPECT_EQ(felt.on_hand[0], 0.0);
  }
  for (int place = 0; place < 6; ++place) {
    double twist[6] = {};
    twist[place] = nan;
    EXPECT_EQ(asperity_tool_move_body(h.tool.get(), 0, identity, twist), ASPERITY_STATUS_INVALID_POSE);
  }
  asperity_measurement sample = sized<asperity_measurement>();
  ASSERT_EQ(asperity_device_open(h.free_device.get(), nullptr), 0);
  ASSERT_EQ(asperity_device_arm(h.free_device.get(), nullptr), 0);
  EXPECT_EQ(asperity_device_read(h.free_device.get(), -1, &sample), refused);
  EXPECT_EQ(asperity_device_read(h.free_device.get(), 5'000'000, &sample), 0);
  EXPECT_EQ(asperity_device_read(h.free_device.get(), 4'000'000, &sample), refused) << "the clock went back";
  EXPECT_EQ(asperity_device_read(h.free_device.get(), std::numeric_limits<std::int64_t>::max(), &sample), refused);
  for (int place = 0; place < 6; ++place) {
    double push[6] = {};
    push[place] = infinity;
    EXPECT_EQ(asperity_device_write(h.free_device.get(), 5'000'000, push, 6'000'000), ASPERITY_STATUS_NOT_FINITE);
  }
  EXPECT_NE(asperity_device_state(h.free_device.get()), ASPERITY_DEVICE_ACTIVE);
}

TEST(c_calls, settings_out_of_range_are_named) {
  const all_handles h;
  const auto refuses_tool = [&](const char* name, const std::function<void(asperity_tool_settings&)>& change) {
    asperity_tool_settings s = sized<asperity_tool_settings>();
    change(s);
    asperity_tool* made = nullptr;
    asperity_error why = no_error();
    EXPECT_EQ(asperity_tool_make(h.models.c_probe.get(), &h.models.fixed, 1, &s, &made, &why), refused) << name;
    EXPECT_NE(std::strstr(why.message, name), nullptr) << why.message;
    EXPECT_EQ(why.code, refused);
    EXPECT_EQ(made, nullptr);
  };
  for (const double bad : {nan, infinity, -1.0}) {
    refuses_tool("period_s", [&](auto& s) { s.period_s = bad; });
    refuses_tool("mass_kg", [&](auto& s) { s.mass_kg = bad; });
    refuses_tool("coupling_n_per_m", [&](auto& s) { s.coupling_n_per_m = bad; });
    refuses_tool("coupling_n_m_per_rad", [&](auto& s) { s.coupling_n_m_per_rad = bad; });
    refuses_tool("stiffness_n_per_m", [&](auto& s) { s.stiffness_n_per_m = bad; });
    refuses_tool("dissipation_s_per_m", [&](auto& s) { s.dissipation_s_per_m = bad; });
    refuses_tool("static_friction", [&](auto& s) { s.static_friction = bad; });
    refuses_tool("dynamic_friction", [&](auto& s) { s.dynamic_friction = bad; });
    refuses_tool("most_force_n", [&](auto& s) { s.most_force_n = bad; });
    refuses_tool("most_torque_n_m", [&](auto& s) { s.most_torque_n_m = bad; });
    refuses_tool("probe_on_hand", [&](auto& s) { s.probe_on_hand[1] = bad; });
  }
  refuses_tool("dynamic_friction is above", [&](auto& s) { s.dynamic_friction = 0.5; });
  refuses_tool("substeps", [&](auto& s) { s.substeps = 100'000; });

  const auto refuses_renderer = [&](const char* name, const std::function<void(asperity_renderer_settings&)>& change) {
    asperity_renderer_settings s = sized<asperity_renderer_settings>();
    change(s);
    asperity_renderer* made = nullptr;
    asperity_error why = no_error();
    EXPECT_EQ(asperity_renderer_make(h.models.c_probe.get(), &h.models.fixed, 1, &s, &made, &why), refused) << name;
    EXPECT_NE(std::strstr(why.message, name), nullptr) << why.message;
  };
  for (const double bad : {nan, infinity, -1.0}) {
    refuses_renderer("stiffness_n_per_m", [&](auto& s) { s.stiffness_n_per_m = bad; });
    refuses_renderer("period_s", [&](auto& s) { s.period_s = bad; });
    refuses_renderer("reach_m", [&](auto& s) { s.reach_m = bad; });
    refuses_renderer("softness_m", [&](auto& s) { s.softness_m = bad; });
    refuses_renderer("sharpness", [&](auto& s) { s.sharpness = bad; });
  }
  refuses_renderer("formulation", [&](auto& s) { s.formulation = 4; });
  refuses_renderer("grid", [&](auto& s) { s.grid = 100'000; });
  refuses_renderer("formulation planes", [&](auto& s) { s.threads = 2; });
  refuses_renderer("threads", [&](auto& s) {
    s.formulation = ASPERITY_FORMULATION_PLANES;
    s.threads = 17;
  });

  const auto refuses_session = [&](const char* name, const std::function<void(asperity_session_settings&)>& change) {
    asperity_session_settings s = sized<asperity_session_settings>();
    change(s);
    asperity_session* made = nullptr;
    asperity_error why = no_error();
    EXPECT_EQ(asperity_session_make(h.models.c_probe.get(), &h.models.fixed, nullptr, 1, h.free_device.get(), &s, &made,
                                    &why),
              refused)
        << name;
    EXPECT_NE(std::strstr(why.message, name), nullptr) << why.message;
  };
  for (const double bad : {nan, infinity, -1.0}) {
    refuses_session("device_rate_hz", [&](auto& s) { s.device_rate_hz = bad; });
    refuses_session("contact_rate_hz", [&](auto& s) { s.contact_rate_hz = bad; });
    refuses_session("scale", [&](auto& s) { s.scale = bad; });
    refuses_session("coupling_n_per_m", [&](auto& s) { s.coupling_n_per_m = bad; });
    refuses_session("mass_kg", [&](auto& s) { s.mass_kg = bad; });
    refuses_session("most_force_n", [&](auto& s) { s.most_force_n = bad; });
    refuses_session("static_friction", [&](auto& s) { s.static_friction = bad; });
  }
  refuses_session("threads", [&](auto& s) { s.threads = 17; });
  refuses_session("planes", [&](auto& s) {
    s.formulation = ASPERITY_FORMULATION_LEAST_MOTION;
    s.static_friction = 0.3;
  });

  const auto refuses_device = [&](const char* name, const std::function<void(asperity_simulated_settings&)>& change) {
    asperity_simulated_settings s = sized<asperity_simulated_settings>();
    change(s);
    asperity_haptic_device* made = nullptr;
    asperity_error why = no_error();
    EXPECT_EQ(asperity_device_make_simulated(&s, &made, &why), refused) << name;
    EXPECT_NE(std::strstr(why.message, name), nullptr) << why.message;
  };
  for (const double bad : {nan, infinity}) {
    refuses_device("approach_m", [&](auto& s) { s.approach_m = bad; });
    refuses_device("approach_s", [&](auto& s) { s.approach_s = bad; });
    refuses_device("amplitude_m", [&](auto& s) { s.amplitude_m = bad; });
    refuses_device("amplitude_rad", [&](auto& s) { s.amplitude_rad = bad; });
    refuses_device("frequency_hz", [&](auto& s) { s.frequency_hz = bad; });
    refuses_device("loss", [&](auto& s) { s.loss = bad; });
    refuses_device("direction", [&](auto& s) { s.direction[2] = bad; });
    refuses_device("start_pose", [&](auto& s) { s.start_pose[0] = bad; });
  }
  refuses_device("delay_ns", [&](auto& s) { s.delay_ns = 30'000'000; });
  refuses_device("jitter_ns", [&](auto& s) { s.jitter_ns = -1; });
  refuses_device("delay_ns", [&](auto& s) { s.delay_ns = std::numeric_limits<std::int64_t>::max(); });
  refuses_device("motion", [&](auto& s) { s.motion = 6; });
  refuses_device("hand", [&](auto& s) { s.hand = 3; });

  for (const double bad : {nan, infinity, -1.0}) {
    asperity_material material = sized<asperity_material>();
    material.static_friction = bad;
    asperity_model* made = nullptr;
    EXPECT_EQ(asperity_model_with_material(h.models.c_probe.get(), &material, &made, nullptr), refused);
    EXPECT_EQ(made, nullptr);
  }
  asperity_material material = sized<asperity_material>();
  material.combine = 4;
  asperity_model* made = nullptr;
  EXPECT_EQ(asperity_model_with_material(h.models.c_probe.get(), &material, &made, nullptr), refused);
}

TEST(c_calls, files_that_are_no_models_are_named) {
  const scratch_folder folder;
  const std::string text = folder.file("text.glb", "this is no model").string();
  asperity_model* model = nullptr;
  asperity_error why = no_error();
  EXPECT_EQ(asperity_model_load(text.c_str(), &model, &why), ASPERITY_ERROR_BAD_FORMAT);
  EXPECT_NE(std::strstr(why.message, "text.glb"), nullptr) << why.message;
  EXPECT_EQ(asperity_model_load((text + "x").c_str(), &model, &why), ASPERITY_ERROR_IO_FAILED);
  EXPECT_EQ(model, nullptr);
  asperity_material material = sized<asperity_material>();
  EXPECT_EQ(asperity_material_preset("porridge", &material, &why), refused);
  EXPECT_NE(std::strstr(why.message, "rubber"), nullptr) << why.message;
}

}  // namespace
