// A MuJoCo simulation from the text of an MJCF, and boxes to put into it.
#pragma once

#include <array>
#include <cstdio>
#include <cstring>
#include <gtest/gtest.h>
#include <memory>
#include <mujoco/mujoco.h>
#include <string>
#include <utility>
#include <vector>

#include "asperity/mujoco/textured_contacts.hpp"
#include "support/kept_bodies.hpp"
#include "support/small_models.hpp"
#include "unit/control/drawn.hpp"

namespace asperity::test_support {

struct mujoco_model_end {
  void operator()(mjModel* m) const noexcept { mj_deleteModel(m); }
  void operator()(mjData* d) const noexcept { mj_deleteData(d); }
};

/// A model with its state. The text needs no <mujoco> about it.
struct simulation {
  std::unique_ptr<mjModel, mujoco_model_end> model;
  std::unique_ptr<mjData, mujoco_model_end> data;

  explicit simulation(const std::string& inside) {
    const std::string xml = "<mujoco>" + inside + "</mujoco>";
    const auto files = std::make_unique<mjVFS>();
    mj_defaultVFS(files.get());
    mj_makeEmptyFileVFS(files.get(), "m.xml", static_cast<int>(xml.size()));
    std::memcpy(files->filedata[mj_findFileVFS(files.get(), "m.xml")], xml.data(), xml.size());
    std::array<char, 500> why{};
    model.reset(mj_loadXML("m.xml", files.get(), why.data(), static_cast<int>(why.size())));
    mj_deleteVFS(files.get());
    if (!model) {
      ADD_FAILURE() << why.data() << "\n" << xml;
      std::abort();
    }
    data.reset(mj_makeData(model.get()));
    mj_forward(model.get(), data.get());
  }
  [[nodiscard]] mjModel& m() const noexcept { return *model; }
  [[nodiscard]] mjData& d() const noexcept { return *data; }
  [[nodiscard]] int body(const char* name) const noexcept { return mj_name2id(model.get(), mjOBJ_BODY, name); }
  [[nodiscard]] int geom(const char* name) const noexcept { return mj_name2id(model.get(), mjOBJ_GEOM, name); }
  [[nodiscard]] std::vector<double> xfrc() const { return {data->xfrc_applied, data->xfrc_applied + 6 * model->nbody}; }
};

/// Numbers for an attribute, to the last bit.
inline std::string text(std::initializer_list<double> numbers) {
  std::string out;
  for (const double x : numbers) {
    std::array<char, 32> one{};
    std::snprintf(one.data(), one.size(), "%.17g ", x);
    out += one.data();
  }
  return out;
}
inline std::string text(const vec3& v) { return text({v.x, v.y, v.z}); }
inline std::string text(const quat& q) { return text({q.w, q.x, q.y, q.z}); }

using textured_pair_renderer = std::function<result<any_renderer>(scene)>;

inline model_ptr flat_box(const vec3& half_m) {
  return std::make_shared<const textured_model>(make_flat_box(half_m, 48));
}
inline model_ptr ridged_box(const vec3& half_m, double amplitude_m = 50e-6, double wavelength_m = 2e-3) {
  return std::make_shared<const textured_model>(make_textured_box(half_m, 96, ridges(amplitude_m, wavelength_m)));
}

/// The default renderer on few samples, whose bodies are kept for the next one.
inline textured_pair_renderer least_motion_of(double stiffness_n_per_m = 2000.0, double period_s = 1e-3) {
  return [=](scene bodies) -> result<any_renderer> {
    least_motion_renderer_settings settings;
    settings.bodies.sample_pitch_m = 5e-4;
    settings.force.stiffness_n_per_m = stiffness_n_per_m;
    settings.force.period_s = period_s;
    return any_renderer(build_renderer(std::move(bodies), settings).value());
  };
}

/// A penalty wall: the top of the fixed box, which stands upright, pushes the lowest face of an upright probe up with k times its
/// depth.
struct wall_renderer {
  asperity::scene bodies;
  double stiffness_n_per_m;
  status step(const scene_pose& at, tick& out) noexcept {
    out = {};
    const double depth_m =
        at.T_wb[0].position.z + bodies.fixed[0]->box.high.z - at.T_wa.position.z - bodies.probe->box.low.z;
    out.centre_of_mass_w = at.T_wa * bodies.probe->mass.centre_of_mass;
    if (depth_m > 0.0) {
      out.force.on_probe_w.force.z = stiffness_n_per_m * depth_m;
      out.force.stiffness(2, 2) = -stiffness_n_per_m;
    }
    return status::ok;
  }
  [[nodiscard]] const asperity::scene& scene() const noexcept { return bodies; }
  [[nodiscard]] std::size_t memory_bytes() const noexcept { return sizeof *this; }
};
inline textured_pair_renderer walls_of(double stiffness_n_per_m) {
  return [=](scene bodies) -> result<any_renderer> {
    return any_renderer(wall_renderer{std::move(bodies), stiffness_n_per_m});
  };
}

/// Feels nothing, and takes no time to be made.
struct numb_renderer {
  asperity::scene bodies;
  status step(const scene_pose&, tick& out) noexcept {
    out = {};
    return status::ok;
  }
  [[nodiscard]] const asperity::scene& scene() const noexcept { return bodies; }
  [[nodiscard]] std::size_t memory_bytes() const noexcept { return sizeof *this; }
};
inline textured_pair_renderer numb() {
  return [](scene bodies) -> result<any_renderer> { return any_renderer(numb_renderer{std::move(bodies)}); };
}

inline quat drawn_rotation(drawn& draw) { return exp_rotation(draw.between(0.0, 3.0) * draw.direction()); }

inline mujoco::textured_contacts made(const simulation& s, std::vector<mujoco::textured_pair> pairs,
                                      const mujoco::step_bound& bound = {1.0, 0.5}) {
  result<mujoco::textured_contacts> out = mujoco::textured_contacts::make(s.m(), std::move(pairs), bound);
  if (!out) {
    ADD_FAILURE() << out.error().message;
    std::abort();
  }
  return std::move(out).value();
}

/// What make() says of these pairs; empty where it makes something of them.
inline std::string refusal(const simulation& s, std::vector<mujoco::textured_pair> pairs,
                           const mujoco::step_bound& bound = {1.0, 0.5}) {
  const result<mujoco::textured_contacts> out = mujoco::textured_contacts::make(s.m(), std::move(pairs), bound);
  return out ? "" : out.error().message;
}

/// A geom that MuJoCo makes no contacts of.
inline constexpr const char* ghost = " contype='0' conaffinity='0' ";

}  // namespace asperity::test_support
