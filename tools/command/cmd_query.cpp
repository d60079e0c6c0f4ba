// asperity query: contacts, depths and the wrench at one pair of poses.
#include <optional>
#include <utility>
#include <vector>

#include "cli.hpp"
#include "exact/exact_renderer.hpp"
#include "gpu_report.hpp"
#include "model_report.hpp"
#include "poses.hpp"
#include "render_kinds.hpp"
#include "render_options.hpp"
#include "run_start.hpp"
#include "scene_loading.hpp"
#include "text.hpp"

namespace asperity::command {
namespace {

struct query_command {
  std::string probe;
  std::vector<std::string> fixed;
  std::string probe_pose;
  std::vector<std::string> fixed_poses;
  render_options render;
};

json flag_names(depth_flag flags) {
  json names = json::array();
  const std::pair<depth_flag, const char*> all[] = {{depth_flag::no_overlap, "no_overlap"},
                                                    {depth_flag::window_too_small, "window_too_small"},
                                                    {depth_flag::saturated, "saturated"},
                                                    {depth_flag::bad_texel, "bad_texel"},
                                                    {depth_flag::unresolved, "unresolved"}};
  for (const auto& [flag, name] : all) {
    if (has(flags, flag)) names.push_back(name);
  }
  return names;
}

json to_json(const vec6& v) {
  json out = json::array();
  for (std::size_t i = 0; i < 6; ++i) out.push_back(v[i]);
  return out;
}

json contact_json(const contact& c, const penetration& p) {
  const contact_window& w = c.window;
  return {{"body", c.body},
          {"p_a", command::to_json(c.p_a_w)},
          {"p_b", command::to_json(c.p_b_w)},
          {"n_ab", command::to_json(w.n_ab_w)},
          {"centre", command::to_json(w.centre_w)},
          {"u", command::to_json(w.u_w)},
          {"half_size", w.half_size_m},
          {"separation", c.separation_m},
          {"depth", p.depth_m},
          {"soft_depth", p.soft_depth_m},
          {"gradient", to_json(p.gradient)},
          {"witness", command::to_json(p.witness_w)},
          {"samples", p.samples},
          {"flags", flag_names(p.flags)}};
}

std::string contact_text(std::size_t i, const contact& c, const penetration& p) {
  const vec3& n = c.window.n_ab_w;
  // Contacts as one potential have no windows.
  const double size_m = 2.0 * c.window.half_size_m;
  const std::string window = size_m > 0.0 ? ", window " + length_text(size_m) : "";
  std::string flags;
  for (const json& name : flag_names(p.flags)) flags += ", " + name.get<std::string>();
  const std::string what = p.depth_m > 0.0 ? "overlap " : "gap ";
  return row("contact " + std::to_string(i + 1), what + length_text(std::fabs(p.depth_m)) + " along (" + brief(n.x) +
                                                     ", " + brief(n.y) + ", " + brief(n.z) + ")" + window + ", " +
                                                     std::to_string(p.samples) + " samples" + flags);
}

// What a contact of the last tick is deep at most; nothing where the depth backend does not know.
std::optional<double> depth_at_most_m(any_renderer& feel, std::size_t contact) {
  exact_renderer* const exact = feel.target<exact_renderer>();
  if (exact == nullptr) return std::nullopt;
  const auto brackets = exact->depth().brackets();
  if (contact >= brackets.size() || !brackets[contact].bounded) return std::nullopt;
  return brackets[contact].upper_m;
}

answer report(const query_command& options, any_renderer& feel, const tick& found, status answered) {
  answer out;
  const std::shared_ptr<gpu_use> gpu = gpu_use_of(feel);
  json contacts = json::array();
  for (std::size_t i = 0; i < found.contacts.size(); ++i) {
    contacts.push_back(contact_json(found.contacts[i], found.depths[i]));
    const bool known = i < found.by_contact.size();
    contacts.back()["force"] = known ? command::to_json(found.by_contact[i].force) : json();
    contacts.back()["torque"] = known ? command::to_json(found.by_contact[i].torque) : json();
    if (const auto most_m = depth_at_most_m(feel, i)) contacts.back()["depth_at_most"] = *most_m;
    out.text += contact_text(i, found.contacts[i], found.depths[i]);
  }
  json bodies = json::array();
  for (const wrench& b : found.on_body) {
    bodies.push_back({{"force", command::to_json(b.force)}, {"torque", command::to_json(b.torque)}});
  }
  const wrench& w = found.force.on_probe_w;
  out.document = {{"contacts", std::move(contacts)},
                  {"force", command::to_json(w.force)},
                  {"torque", command::to_json(w.torque)},
                  {"bodies", std::move(bodies)},
                  {"centre_of_mass", command::to_json(found.centre_of_mass_w)},
                  {"stiffness", found.force.stiffness.m},
                  {"backend", options.render.backend},
                  {"formulation", formulation_name(options.render)},
                  {"gradient_scheme", gradient_name(options.render)},
                  {"lookup", lookup_json(options.render)},
                  {"status", to_string(answered)},
                  {"dropped_contacts", found.dropped_contacts},
                  {"units", "SI"}};
  if (gpu) out.document["gpu"] = command::to_json(*gpu);
  if (found.contacts.empty()) out.text += row("contacts", "none");
  out.text += row("force on the probe", brief(w.force.x) + ", " + brief(w.force.y) + ", " + brief(w.force.z) + " N");
  out.text += row("torque on the probe", brief(w.torque.x) + ", " + brief(w.torque.y) + ", " + brief(w.torque.z) +
                                             " N m, about its centre of mass");
  if (gpu) out.text += to_text(*gpu);
  if (found.dropped_contacts > 0) {
    out.text += "  warning: " + std::to_string(found.dropped_contacts) + " contacts did not fit and were left out\n";
  }
  return out;
}

result<answer> query(const query_command& options, const common_options& common) {
  const result<pose> T_wa = read_pose("--probe-pose", options.probe_pose);
  if (!T_wa) return T_wa.error();
  const result<std::vector<pose>> T_wb = read_fixed_poses(options.fixed_poses, options.fixed.size());
  if (!T_wb) return T_wb.error();
  if (const result<void> ok = check(options.render); !ok) return ok.error();
  result<scene> bodies = load_scene(options.probe, options.fixed, options.render.allow_scale_mismatch);
  if (!bodies) return bodies.error();
  result<any_renderer> made = make_chosen_renderer(std::move(bodies).value(), options.render);
  if (!made) return made.error();

  const std::shared_ptr<gpu_use> gpu = gpu_use_of(*made);
  if (gpu && !common.quiet) warn(*gpu);
  tick found;
  const status answered = made->step({*T_wa, *T_wb}, found);
  if (answered == status::backend_failed && gpu) return gpu_failed(*gpu);
  if (answered != status::ok && answered != status::capacity_reached) {
    return error{error_code::unsupported, std::string("the contact could not be computed at these poses (") +
                                              to_string(answered) + "): inspect both models"};
  }
  return report(options, *made, found, answered);
}

}  // namespace

void add_query(command_line& line) {
  const auto o = std::make_shared<query_command>();
  CLI::App& sub = line.add("query", "Compute contacts and the wrench at given poses",
                           [o](const common_options& common) { return query(*o, common); });
  sub.add_option("--probe", o->probe, "Textured model that moves (.glb)")->required();
  sub.add_option("--fixed", o->fixed, "Textured model that stays (.glb); may be given several times")
      ->required()
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  sub.add_option("--probe-pose", o->probe_pose, "Pose of the probe in the world, \"x y z qx qy qz qw\" (m)")
      ->required()
      ->check(pose_form_error, "POSE");
  sub.add_option("--fixed-pose", o->fixed_poses, "Pose of each fixed body, in their order; the origin by default")
      ->check(pose_form_error, "POSE")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  add_render_options(sub, o->render, {"least-motion", "window"});
}

}  // namespace asperity::command
