#include "workbench.hpp"

#include <utility>

namespace asperity::experiment {
namespace {

variant on_cpu(std::string name, std::string says, const char* contacts, const char* gradient) {
  variant out{std::move(name), std::move(says), {}};
  out.options.contacts = contacts;
  if (gradient != nullptr) out.options.gradient = gradient;
  return out;
}

variant on_gpu(std::string name, std::string says, const char* backend, const char* gradient) {
  variant out = on_cpu(std::move(name), std::move(says), "window", gradient);
  out.options.backend = backend;
  out.may_be_missing = true;
  return out;
}

}  // namespace

variant least_motion_contacts() { return on_cpu("least_motion", "one potential", "least-motion", nullptr); }
variant window_soft() { return on_cpu("window_soft", "paper's contacts, soft maximum", "window", "soft"); }
variant window_central() {
  return on_cpu("window_central", "paper's contacts, central differences", "window", "central");
}

workbench::workbench(workbench_settings settings)
    : settings_(std::move(settings)),
      models_(settings_.models,
              [report = settings_.progress, cancelled = settings_.cancelled](std::string_view what, double done) {
                if (report) report(what, done);
                return !cancelled || !cancelled();
              }) {
  if (!settings_.make_renderer) {
    settings_.make_renderer = [](scene bodies, const variant& kind) {
      return command::make_chosen_renderer(std::move(bodies), kind.options);
    };
  }
  std::vector<variant>& all = settings_.variants;
  if (!all.empty()) return;
  all = {least_motion_contacts(), window_soft(), window_central()};
  if (settings_.brief || !settings_.gpu) return;
  all.push_back(on_gpu("gl_compute_soft", "compute shaders, soft maximum", "gl-compute", "soft"));
  all.push_back(on_gpu("gl_occlusion_central", "occlusion queries, central differences", "gl-occlusion", nullptr));
}

void workbench::progress(std::string_view what, double done) const {
  if (settings_.progress) settings_.progress(what, done);
}

result<void> workbench::go_on() const {
  if (!settings_.cancelled || !settings_.cancelled()) return {};
  return error{error_code::cancelled, "interrupted: the experiments that were finished are written"};
}

result<void> workbench::with_each(std::string_view name, std::span<const variant> kinds, findings& out,
                                  const std::function<result<void>(const variant&)>& run) const {
  double done = 0.0;
  for (const variant& kind : kinds) {
    if (const result<void> on = go_on(); !on) return on;
    progress(std::string(name) + ", " + kind.says, done++ / static_cast<double>(kinds.size()));
    const result<void> ran = run(kind);
    if (ran) continue;
    if (!kind.may_be_missing || ran.error().code == error_code::cancelled) return ran;
    out.notes.push_back(kind.name + " was left out: " + ran.error().message);
  }
  return {};
}

result<any_renderer> workbench::make_renderer(scene bodies, const variant& kind) const {
  return settings_.make_renderer(std::move(bodies), kind);
}

}  // namespace asperity::experiment
