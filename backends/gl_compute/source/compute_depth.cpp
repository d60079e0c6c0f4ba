#include "asperity/gl/compute_depth.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "asperity/gl/functions.hpp"
#include "asperity/gl/mapped_buffer.hpp"
#include "asperity/gl/program.hpp"
#include "asperity/gl/uploaded_model.hpp"
#include "asperity/window/cpu_depth.hpp"
#include "job_layout.hpp"
#include "job_writer.hpp"
#include "read_back.hpp"
#include "shaders.hpp"

namespace asperity::gl {
namespace {

/// Names of the shader's types in single and double precision, and what its settings switch on.
std::string definitions_of(const window_depth_settings& s, bool doubles) {
  std::string text = doubles ? "#define real double\n#define rvec2 dvec2\n#define rvec3 dvec3\n"
                               "#define TOLERANCE 1e-10\n#define LAST_TOLERANCE 1e-10\n#define SMALLEST_WEIGHT 1e-37\n"
                             : "#define real float\n#define rvec2 vec2\n#define rvec3 vec3\n"
                               "#define TOLERANCE 5e-7\n#define LAST_TOLERANCE 1e-5\n#define SMALLEST_WEIGHT 1e-37\n";
  if (s.gradient == gradient_scheme::soft_max) text += "#define SOFT_MAX\n";
  if (s.parallax == parallax_mode::exact) text += "#define EXACT_PARALLAX\n";
  if (s.taper_window) text += "#define TAPER_WINDOW\n";
  if (s.taper_silhouettes && s.taper_gradient) text += "#define TAPER_GRADIENT\n";
  return text + job::definitions();
}

result<void> check_gpu_settings(const compute_settings& o, const context_facts& facts, const window_depth_settings& s) {
  const auto bad = [](std::string what) { return error{error_code::invalid_argument, "compute depth: " + what}; };
  if (o.contacts < 1 || o.contacts > 65535) {
    return bad("room for " + std::to_string(o.contacts) + " contacts; give 1 to 65535");
  }
  if (o.triangles < 2) return bad("room for " + std::to_string(o.triangles) + " triangles; give at least 2");
  if (o.arithmetic == arithmetic::double_precision && !facts.double_precision) {
    return bad("shaders of " + facts.renderer + " have no double precision here; ask for single precision");
  }
  if (s.refine_maximum) return bad("refine_maximum is the CPU backend's alone; leave it off");
  return {};
}

}  // namespace

struct compute_depth::parts {
  context_ptr context;
  job_writer writer;
  compute_settings gpu_settings;
  bool doubles = false;
  std::size_t groups = 0;  ///< per job
  uploaded_scene models;
  program_ptr program;
  GLint first_job = 0, side = 0;  ///< uniforms
  mapped_buffer numbers, integers, results;
  std::vector<contact_jobs> placed;
  compute_counters counters;
  bool overdue = false;  ///< the device has not answered yet, and may still read and write the buffers

  parts(context_ptr c, const scene& s, const window_depth_settings& settings, const compute_settings& o)
      : context(std::move(c)), writer(s, settings), gpu_settings(o) {}
  [[nodiscard]] result<void> take_buffers();
  [[nodiscard]] number_list list(const mapped_buffer& b) const noexcept {
    return doubles ? number_list(b.as<double>()) : number_list(b.as<float>());
  }
  void dispatch(std::size_t body, std::size_t first, std::size_t count) noexcept;

  template <class PoseAt>
  [[nodiscard]] status measure(const contact_set& contacts, std::span<penetration> out, PoseAt pose_at) noexcept;
};

result<void> compute_depth::parts::take_buffers() {
  const window_depth_settings& s = writer.settings();
  const std::size_t jobs_each = writer.jobs_per_contact();
  const std::size_t jobs = gpu_settings.contacts * jobs_each;
  const std::size_t samples = std::size_t{s.grid} * s.grid;
  groups = (samples + job::group_samples - 1) / static_cast<std::size_t>(job::group_samples);
  // Of the probe there is a projection per job, of the fixed body one per contact.
  const std::size_t triangles = gpu_settings.triangles * jobs_each;
  const std::size_t edges = s.gradient == gradient_scheme::soft_max ? 3 * gpu_settings.triangles : 0;
  const std::size_t number_count =
      jobs * job::header_numbers + triangles * job::triangle_numbers + edges * job::edge_numbers;
  const std::size_t integer_count =
      jobs * job::integers + triangles * job::triangle_integers + (jobs + gpu_settings.contacts) * ((samples + 1) / 2);
  const std::size_t result_count = jobs * groups * job::result_numbers;
  const std::size_t number_bytes = doubles ? sizeof(double) : sizeof(float);

  GLint64 largest = 0;
  context->gl().GetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &largest);
  const auto take = [&](mapped_buffer& to, std::size_t bytes, direction way, const std::string& what) -> result<void> {
    if (bytes > static_cast<std::size_t>(largest)) {
      return error{error_code::limit_exceeded,
                   "compute depth: " + what + " of " + std::to_string(gpu_settings.contacts) + " contacts and " +
                       std::to_string(gpu_settings.triangles) + " triangles take " + std::to_string(bytes) +
                       " bytes; this device takes " + std::to_string(largest) +
                       ": ask for fewer contacts or triangles, or a smaller grid"};
    }
    result<mapped_buffer> b = mapped_buffer::make(context, bytes, way, "compute depth: " + what);
    if (!b) return b.error();
    to = *std::move(b);
    return {};
  };
  if (result<void> r = take(numbers, number_count * number_bytes, direction::to_device, "numbers"); !r) return r;
  if (result<void> r = take(integers, integer_count * 4, direction::to_device, "integers"); !r) return r;
  if (result<void> r = take(results, result_count * number_bytes, direction::from_device, "results"); !r) return r;
  placed.reserve(gpu_settings.contacts);
  return {};
}

result<compute_depth> compute_depth::make(context_ptr context, const scene& s, const window_depth_settings& settings,
                                          const compute_settings& gpu_settings) {
  if (context == nullptr) return error{error_code::invalid_argument, "compute depth: no context; open one"};
  if (result<void> r = check(settings); !r) return r.error();
  if (result<void> r = cpu_depth::check_scene(s); !r) return r.error();
  const context_facts& facts = context->facts();
  if (result<void> r = check_gpu_settings(gpu_settings, facts, settings); !r) return r.error();
  const current_scope here(context);
  if (here.state() != status::ok) {
    return error{error_code::unsupported,
                 "compute depth: the context is lost, or current in another thread; release it there first"};
  }
  auto p = std::make_unique<parts>(context, s, settings, gpu_settings);
  p->doubles = gpu_settings.arithmetic != arithmetic::single_precision && facts.double_precision;
  result<uploaded_scene> models = upload(p->context, s);
  if (!models) return models.error();
  p->models = *std::move(models);
  if (result<void> r = p->take_buffers(); !r) return r.error();
  const shader_stage stage{GL_COMPUTE_SHADER,
                           definitions_of(settings, p->doubles),
                           {shaders::window_glsl, shaders::lookup_glsl, shaders::taper_glsl, shaders::measure_glsl}};
  result<program_ptr> program = share_program(context, std::span(&stage, 1), "the compute depth");
  if (!program) return program.error();
  p->program = *program;
  p->first_job = context->gl().GetUniformLocation(p->program->get(), "first_job");
  p->side = context->gl().GetUniformLocation(p->program->get(), "side");
  if (const std::string errors = take_errors(context->gl()); !errors.empty()) {
    return error{error_code::unsupported, "compute depth: " + facts.renderer + " reports " + errors};
  }
  return compute_depth(std::move(p));
}

void compute_depth::parts::dispatch(std::size_t body, std::size_t first, std::size_t count) noexcept {
  const functions& gl = context->gl();
  gl.ActiveTexture(GL_TEXTURE1);
  gl.BindTexture(GL_TEXTURE_2D, models.fixed[body]->texture.get());
  // A dispatch has at most 65535 groups in each direction.
  for (std::size_t done = 0; done < count;) {
    const std::size_t now = std::min<std::size_t>(count - done, 65535);
    gl.Uniform1i(first_job, static_cast<GLint>(first + done));
    gl.DispatchCompute(static_cast<GLuint>(groups), static_cast<GLuint>(now), 1);
    done += now;
  }
}

template <class PoseAt>
status compute_depth::parts::measure(const contact_set& contacts, std::span<penetration> out, PoseAt pose_at) noexcept {
  const penetration nothing{.flags = depth_flag::no_overlap};
  std::fill(out.begin(), out.end(), nothing);
  if (out.size() < contacts.size()) return status::not_ready;
  for (const contact& c : contacts.contacts()) {
    if (c.body >= models.fixed.size()) return status::not_ready;
  }
  if (contacts.size() == 0) return status::ok;
  if (contacts.size() > gpu_settings.contacts) return status::capacity_reached;
  if (context->make_current() != status::ok) return status::backend_failed;
  if (overdue) {
    if (wait_for_device(context->gl(), gpu_settings.timeout_ns) != status::ok) return status::backend_failed;
    overdue = false;
  }

  const std::size_t jobs_each = writer.jobs_per_contact();
  number_list to_numbers = list(numbers);
  integer_list to_integers(integers.as<std::int32_t>(), contacts.size() * jobs_each);
  placed.clear();
  const functions& gl = context->gl();
  gl.UseProgram(program->get());
  gl.Uniform1i(side, static_cast<GLint>(writer.settings().grid));
  gl.ActiveTexture(GL_TEXTURE0);
  gl.BindTexture(GL_TEXTURE_2D, models.probe->texture.get());
  gl.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, numbers.name());
  gl.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, integers.name());
  gl.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 2, results.name());

  // Everything is written before anything is drawn: jobs of one fixed body follow each other.
  for (std::size_t body = 0; body < models.fixed.size(); ++body) {
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const contact& c = contacts.contacts()[i];
      if (c.body != body) continue;
      contact_jobs place{.contact = static_cast<std::uint32_t>(i),
                         .first_job = static_cast<std::uint32_t>(placed.size() * jobs_each)};
      const pose_pair at = pose_at(i);
      if (writer.add(to_numbers, to_integers, c, contacts.patch_a(c), contacts.patch_b(c), at.T_wa, at.T_wb, place)) {
        placed.push_back(place);
      }
    }
  }
  if (to_numbers.overflowed() || to_integers.overflowed()) return status::capacity_reached;
  if (placed.empty()) return status::ok;
  numbers.send(to_numbers.bytes());
  integers.send(to_integers.bytes());
  for (std::size_t first = 0; first < placed.size();) {
    const std::uint32_t body = contacts.contacts()[placed[first].contact].body;
    std::size_t end = first;
    while (end < placed.size() && contacts.contacts()[placed[end].contact].body == body) ++end;
    dispatch(body, first * jobs_each, (end - first) * jobs_each);
    first = end;
  }
  ++counters.ticks;
  ++counters.round_trips;
  counters.contacts += contacts.size();
  const std::size_t result_bytes =
      placed.size() * jobs_each * groups * job::result_numbers * (doubles ? sizeof(double) : sizeof(float));
  overdue = wait_for_device(gl, gpu_settings.timeout_ns) != status::ok;
  if (overdue) return status::backend_failed;
  if (results.receive(result_bytes) != status::ok || context->check() != status::ok || gl.GetError() != GL_NO_ERROR) {
    return status::backend_failed;
  }
  const number_list from = list(results);
  for (const contact_jobs& place : placed) {
    penetration& p = out[place.contact];
    const contact& c = contacts.contacts()[place.contact];
    p = read_back(writer, from, groups, place, c, pose_at(place.contact).T_wa);
    if (std::isfinite(p.depth_m) && std::isfinite(p.soft_depth_m) && is_finite(p.gradient)) continue;
    std::fill(out.begin(), out.end(), nothing);
    return status::not_finite;
  }
  return status::ok;
}

compute_depth::compute_depth(std::unique_ptr<parts> p) noexcept : parts_(std::move(p)) {}
compute_depth::compute_depth(compute_depth&&) noexcept = default;
compute_depth& compute_depth::operator=(compute_depth&&) noexcept = default;
compute_depth::~compute_depth() = default;

status compute_depth::measure(const scene_pose& at, const contact_set& contacts, std::span<penetration> out) noexcept {
  if (at.T_wb.size() != parts_->models.fixed.size()) {
    std::fill(out.begin(), out.end(), penetration{.flags = depth_flag::no_overlap});
    return status::not_ready;
  }
  return parts_->measure(contacts, out, [&](std::size_t i) {
    return pose_pair{at.T_wa, at.T_wb[contacts.contacts()[i].body]};
  });
}

status compute_depth::measure_each(std::span<const pose_pair> at, const contact_set& contacts,
                                   std::span<penetration> out) noexcept {
  if (at.size() != contacts.size()) {
    std::fill(out.begin(), out.end(), penetration{.flags = depth_flag::no_overlap});
    return status::not_ready;
  }
  return parts_->measure(contacts, out, [&](std::size_t i) { return at[i]; });
}

const window_depth_settings& compute_depth::settings() const noexcept { return parts_->writer.settings(); }
const compute_counters& compute_depth::counters() const noexcept { return parts_->counters; }
const context_ptr& compute_depth::owner() const noexcept { return parts_->context; }
arithmetic compute_depth::arithmetic() const noexcept {
  return parts_->doubles ? gl::arithmetic::double_precision : gl::arithmetic::single_precision;
}
std::size_t compute_depth::device_bytes() const noexcept {
  return parts_->numbers.size() + parts_->integers.size() + parts_->results.size();
}
std::size_t compute_depth::heap_bytes() const noexcept {
  return sizeof(parts) + parts_->writer.heap_bytes() + asperity::heap_bytes(parts_->placed);
}

}  // namespace asperity::gl
