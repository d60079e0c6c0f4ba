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
                  {"units", "SI"}};
  out.text = printable(bodies.probe->name + " on " + bodies.fixed.front()->name) + ", a contact of " +
             std::to_string(timed.patch_triangles) + " triangles and " + std::to_string(options.grid) + " x " +
             std::to_string(options.grid) + " samples, repeated; time on the wall\n";
  out.text += row("GPU", timed.gpu.device + ", OpenGL " + timed.gpu.version);
  out.text += row("models on the GPU", memory_text(timed.gpu.device_bytes));
  for (const backend_times& b : timed.backends) out.text += text_of(b);
  return out;
}

}  // namespace asperity::command
