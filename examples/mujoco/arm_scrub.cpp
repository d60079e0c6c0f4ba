// A six-joint arm scrubs a textured workpiece with a textured tool, and the table shows what its wrist feels, second by second.
// The second two files are the same bodies without texture; --csv FILE writes the forces for plot_arm_scrub.py. With --planes
// the contact is made of support planes, which is several times quicker.
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <numbers>
#include <vector>

#include <asperity/mujoco/textured_contacts.hpp>

#include "arm.hpp"
#include "loading.hpp"

namespace {

// Ten times as stiff as what a hand is given: the tool lies in the relief by a tenth of a millimetre.
constexpr double seconds = 4.0, period_s = 1e-3, stiffness_n_per_m = 20e3;

// A spring for each direction on the deepest of its support planes. It is no potential: its force jumps from sample to sample,
// which an arm's joints have to damp. Gaps need not be told, so that few samples are looked at.
asperity::result<asperity::any_renderer> walls(asperity::scene bodies) {
  asperity::plane_renderer_settings settings;
  settings.springs.stiffness_n_per_m = stiffness_n_per_m;
  settings.reach_m = 1e-4;
  auto made = asperity::make_plane_renderer(std::move(bodies), settings);
  if (!made) return made.error();
  return asperity::any_renderer(std::move(*made));
}

struct scrub {
  std::vector<asperity::wrench> on_tool;  // in each step
  double real_time_factor = 0.0;          // by this thread's processor time
  std::uint64_t scaled = 0;
};

bool run(const asperity::model_ptr& tool, const asperity::model_ptr& piece, bool planes, scrub& out) {
  const asperity::vec3 piece_at(0.45, 0.0, 0.15);
  const mujoco_model m = model_of(arm_mjcf(piece_at));
  if (!m) return false;
  const mujoco_data d(mj_makeData(m.get()));
  arm robot(*m, *d);
  asperity::mujoco::textured_pair pair{
      .probe = {tool, "tool"}, .fixed = {piece, "workpiece"}, .stiffness_n_per_m = stiffness_n_per_m};
  if (planes) pair.make_renderer = walls;
  auto contacts = asperity::mujoco::textured_contacts::make(*m, {pair});
  if (!contacts) return std::puts(contacts.error().message.c_str()), false;

  // It begins 2 mm above the workpiece, wants to be 2 mm inside, which the arm's spring makes 3 N of, and rubs across.
  asperity::pose on_top;
  on_top.position = piece_at + asperity::vec3(0.0, 0.0, piece->box.high.z - tool->box.low.z);
  const auto wanted = [&](double t) {
    asperity::pose out_at = on_top;
    out_at.position.z += 0.002 - 0.004 * std::fmin(t / 0.5, 1.0);
    out_at.position.y += 0.008 * std::sin(2.0 * std::numbers::pi * t);
    return out_at;
  };
  robot.place(wanted(0.0));
  const std::clock_t began = std::clock();
  while (d->time < seconds) {
    mj_step1(m.get(), d.get());
    static_cast<void>(robot.pull_to(wanted(d->time)));
    const asperity::status status = contacts->apply(*m, *d);
    mj_step2(m.get(), d.get());
    contacts->take_back(*d);
    if (status != asperity::status::ok) std::printf("at %.3f s: %s\n", d->time, asperity::to_string(status));
    out.on_tool.push_back(contacts->report(0).on_probe_w);
  }
  out.real_time_factor = seconds / (static_cast<double>(std::clock() - began) / CLOCKS_PER_SEC);
  out.scaled = contacts->scaled();
  return true;
}

void print(const char* name, const scrub& s) {
  std::printf("%s: %.1f times as fast as real time on one core, %llu wrenches scaled for the time step\n", name,
              s.real_time_factor, static_cast<unsigned long long>(s.scaled));
  std::puts("  second    presses    along the surface, rms    torque, rms");
  const auto each = static_cast<std::size_t>(1.0 / period_s);
  for (std::size_t from = 0; from + each <= s.on_tool.size(); from += each) {
    double up = 0.0, along = 0.0, torque = 0.0;
    for (std::size_t i = from; i < from + each; ++i) {
      const auto& [f, t] = s.on_tool[i];
      up += f.z / static_cast<double>(each);
      along += (f.x * f.x + f.y * f.y) / static_cast<double>(each);
      torque += glm::dot(t, t) / static_cast<double>(each);
    }
    std::printf("  %zu %13.3f N %21.3f N %15.4f N m\n", from / each + 1, up, std::sqrt(along), std::sqrt(torque));
  }
}

bool write(const char* file, const std::vector<scrub>& all) {
  std::FILE* const out = std::fopen(file, "w");
  if (out == nullptr) return std::printf("%s cannot be written\n", file), false;
  std::fputs("run,time_s,fx_n,fy_n,fz_n,tx_n_m,ty_n_m,tz_n_m\n", out);
  for (std::size_t k = 0; k < all.size(); ++k) {
    for (std::size_t i = 0; i < all[k].on_tool.size(); ++i) {
      const auto& [f, t] = all[k].on_tool[i];
      std::fprintf(out, "%zu,%.3f,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g\n", k, static_cast<double>(i + 1) * period_s, f.x, f.y,
                   f.z, t.x, t.y, t.z);
    }
  }
  return std::fclose(out) == 0;
}

}  // namespace

int main(int argc, char** argv) {
  const char* csv = nullptr;
  if (argc > 2 && std::strcmp(argv[argc - 2], "--csv") == 0) {
    csv = argv[argc - 1];
    argc -= 2;
  }
  const bool planes = argc > 1 && std::strcmp(argv[argc - 1], "--planes") == 0;
  if (planes) --argc;
  if (argc != 3 && argc != 5) {
    return std::puts("usage: arm_scrub TOOL.glb PIECE.glb [SMOOTH_TOOL.glb SMOOTH_PIECE.glb] [--planes] [--csv FILE]"),
           2;
  }
  std::vector<scrub> all;
  for (int i = 1; i + 1 < argc; i += 2) {
    const asperity::model_ptr tool = load(argv[i]), piece = load(argv[i + 1]);
    if (!tool || !piece || !run(tool, piece, planes, all.emplace_back())) return 1;
    print(i == 1 ? "with texture" : "without texture", all.back());
  }
  return csv != nullptr && !write(csv, all) ? 1 : 0;
}
