// Two small textured models in files, and handles of the C interface that end with the test.
#pragma once

#include <filesystem>
#include <gtest/gtest.h>
#include <memory>
#include <string>

#include "asperity/c/asperity.h"
#include "asperity/field/field_body.hpp"
#include "asperity/io/textured_model_file.hpp"
#include "support/small_models.hpp"
#include "unit/io/scratch_folder.hpp"

namespace asperity::test_support {

template <class Handle, std::int32_t (*end)(Handle*)>
struct ended {
  void operator()(Handle* h) const noexcept { EXPECT_EQ(end(h), ASPERITY_STATUS_OK); }
};
template <class Handle, std::int32_t (*end)(Handle*)>
using owned = std::unique_ptr<Handle, ended<Handle, end>>;
using owned_model = owned<asperity_model, asperity_model_free>;
using owned_renderer = owned<asperity_renderer, asperity_renderer_free>;
using owned_tool = owned<asperity_tool, asperity_tool_free>;
using owned_device = owned<asperity_haptic_device, asperity_device_free>;
using owned_session = owned<asperity_session, asperity_session_free>;

[[nodiscard]] inline asperity_error no_error() {
  asperity_error out{};
  out.size = sizeof out;
  return out;
}

template <class Struct>
[[nodiscard]] Struct sized() {
  Struct out{};
  out.size = sizeof out;
  return out;
}

/// A ridged cube over a ridged plate: files, models of C++, handles of C.
class two_models {
 public:
  two_models() {
    const auto saved = [&](const textured_model& box, const char* name) {
      // With its field, as a bake writes it: making one takes seconds.
      textured_model model = io::as_saved(box);
      model.report.max_displacement_m = 0.0002;
      model.field = std::make_shared<const field_body>(make_field_body(model).value());
      EXPECT_TRUE(io::save_textured_model(model, folder_.file(name)));
      return std::make_shared<const textured_model>(io::load_textured_model(folder_.file(name)).value());
    };
    probe = saved(make_textured_box({0.01, 0.01, 0.01}, 64, ridges(0.0002, 0.004)), "probe.glb");
    plate = saved(make_textured_box({0.05, 0.05, 0.01}, 64, ridges(0.0002, 0.003)), "plate.glb");
    c_probe = load("probe.glb");
    c_plate = load("plate.glb");
    fixed = c_plate.get();
  }

  [[nodiscard]] owned_model load(const char* name) const {
    asperity_model* out = nullptr;
    asperity_error why = no_error();
    EXPECT_EQ(asperity_model_load(file(name).c_str(), &out, &why), ASPERITY_STATUS_OK) << why.message;
    return owned_model(out);
  }
  [[nodiscard]] std::string file(const char* name) const { return folder_.file(name).string(); }

  [[nodiscard]] owned_renderer renderer(const asperity_renderer_settings* settings = nullptr) const {
    asperity_renderer* out = nullptr;
    asperity_error why = no_error();
    EXPECT_EQ(asperity_renderer_make(c_probe.get(), &fixed, 1, settings, &out, &why), ASPERITY_STATUS_OK)
        << why.message;
    return owned_renderer(out);
  }
  [[nodiscard]] owned_tool tool(const asperity_tool_settings* settings = nullptr) const {
    asperity_tool* out = nullptr;
    asperity_error why = no_error();
    EXPECT_EQ(asperity_tool_make(c_probe.get(), &fixed, 1, settings, &out, &why), ASPERITY_STATUS_OK) << why.message;
    return owned_tool(out);
  }
  [[nodiscard]] owned_session session(asperity_haptic_device* device,
                                      const asperity_session_settings* settings = nullptr) const {
    asperity_session* out = nullptr;
    asperity_error why = no_error();
    EXPECT_EQ(asperity_session_make(c_probe.get(), &fixed, nullptr, 1, device, settings, &out, &why),
              ASPERITY_STATUS_OK)
        << why.message;
    return owned_session(out);
  }

  model_ptr probe, plate;
  owned_model c_probe, c_plate;
  const asperity_model* fixed = nullptr;

 private:
  scratch_folder folder_;
};

/// Made once for a program, gone with it.
[[nodiscard]] inline const two_models& shared_models() {
  static const two_models once;
  return once;
}

[[nodiscard]] inline owned_device simulated(const asperity_simulated_settings* settings = nullptr) {
  asperity_haptic_device* out = nullptr;
  asperity_error why = no_error();
  EXPECT_EQ(asperity_device_make_simulated(settings, &out, &why), ASPERITY_STATUS_OK) << why.message;
  return owned_device(out);
}

/// A handle of every kind.
struct all_handles {
  const two_models& models = shared_models();
  owned_renderer renderer = models.renderer();
  owned_tool tool = models.tool();
  owned_device device = simulated();
  owned_device free_device = simulated();
  owned_session session = models.session(device.get());
};

}  // namespace asperity::test_support
