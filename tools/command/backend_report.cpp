#include "backend_report.hpp"

#include "gpu_report.hpp"
#include "statistics.hpp"
#include "text.hpp"

namespace asperity::command {
namespace {

json to_json(const contacts_timed& t) {
  return {{"contacts", t.contacts},
          {"calls", t.calls},
          {"device_memory", t.device_bytes},
          {"seconds", command::to_json(summarise(t.seconds))},
          {"ratio_to_cpu", t.cpu_ratio}};
}

json to_json(const backend_times& b) {
  json ticks = json::array();
  for (const contacts_timed& t : b.ticks) ticks.push_back(to_json(t));
  return {{"backend", b.backend},
          {"gradient_scheme", b.gradient},
          {"lookup", b.lookup},
          {"set_up_seconds", b.set_up_s},
          {"first_tick_seconds", b.first_tick_s},
          {"ticks", std::move(ticks)},
          {"batch", b.batch ? to_json(*b.batch) : json()}};
}

json to_json(const bench_of_planes& b) {
  json sizes = json::array();
  for (const poses_timed& t : b.sizes) {
    sizes.push_back({{"poses", t.poses},
                     {"seconds", command::to_json(summarise(t.gpu_s))},
                     {"cpu_seconds", command::to_json(summarise(t.cpu_s))},
                     {"ratio_to_cpu", t.ratio}});
  }
  return {{"arithmetic", b.arithmetic},           {"set_up_seconds", b.set_up_s},
          {"device_memory", b.device_bytes},      {"sizes", std::move(sizes)},
          {"too_deep_share", b.too_deep},         {"depth_difference_m", b.depth_apart_m},
          {"force_difference_p99", b.force_apart}};
}

std::string text_of(const bench_of_planes& b) {
  std::string out = "planes of many poses, gl-compute, " + b.arithmetic + " precision\n";
  out += row("set-up", time_text(b.set_up_s) + ", " + memory_text(b.device_bytes));
  for (const poses_timed& t : b.sizes) {
    out += row(std::to_string(t.poses) + (t.poses == 1 ? " pose" : " poses"),
               to_text(summarise(t.gpu_s)) + "  (" + brief(t.ratio) + " x cpu, one by one)");
  }
  out += row("beside the cpu", "depth within " + brief(1e6 * b.depth_apart_m) + " um, force within " +
                                   brief(100.0 * b.force_apart) + " % (p99)");
  if (b.too_deep > 0.0) out += row("too deep", brief(100.0 * b.too_deep) + " % of the poses: not told, not judged");
  return out;
}

std::string text_of(const contacts_timed& t, const char* what, bool is_reference) {
  std::string value = to_text(summarise(t.seconds));
  if (!is_reference) value += "  (" + brief(t.cpu_ratio) + " x cpu, " + memory_text(t.device_bytes) + ")";
  return row(std::to_string(t.contacts) + what, value);
}

std::string text_of(const backend_times& b) {
  const bool is_reference = b.backend == "cpu";
  std::string out = b.backend + ", " + b.gradient + " gradient, " + b.lookup + " lookup\n";
  if (is_reference) {
    out += row("first tick", time_text(b.first_tick_s));
  } else {
    out += row("set-up, first tick", time_text(b.set_up_s) + ", " + time_text(b.first_tick_s));
  }
  for (const contacts_timed& t : b.ticks) out += text_of(t, t.contacts == 1 ? " contact" : " contacts", is_reference);
  if (b.batch) out += text_of(*b.batch, " pairs", is_reference);
  return out;
}

}  // namespace

answer report(const scene& bodies, const backend_bench& options, const bench_of_backends& timed, bool quiet) {
  if (!quiet) warn(timed.gpu);
  json backends = json::array();
  for (const backend_times& b : timed.backends) backends.push_back(to_json(b));
  json planes = json::array();
  for (const bench_of_planes& b : timed.planes) planes.push_back(to_json(b));
  answer out;
  out.document = {{"probe", bodies.probe->name},
                  {"fixed", bodies.fixed.front()->name},
                  {"grid", options.grid},
                  {"patch_triangles", timed.patch_triangles},
                  {"repeats", options.repeats},
                  {"seed", options.seed},
                  {"time_is", "wall"},
                  {"gpu",
                   {{"device", timed.gpu.device},
                    {"version", timed.gpu.version},
                    {"software", timed.gpu.software},
                    {"model_memory", timed.gpu.device_bytes}}},
                  {"backends", std::move(backends)},
                  {"planes", std::move(planes)},
                  {"units", "SI"}};
  out.text = printable(bodies.probe->name + " on " + bodies.fixed.front()->name) + ", a contact of " +
             std::to_string(timed.patch_triangles) + " triangles and " + std::to_string(options.grid) + " x " +
             std::to_string(options.grid) + " samples, repeated; time on the wall\n";
  out.text += row("GPU", timed.gpu.device + ", OpenGL " + timed.gpu.version);
  out.text += row("models on the GPU", memory_text(timed.gpu.device_bytes));
  for (const backend_times& b : timed.backends) out.text += text_of(b);
  for (const bench_of_planes& b : timed.planes) out.text += text_of(b);
  return out;
}

}  // namespace asperity::command
