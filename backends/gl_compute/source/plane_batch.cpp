#include "asperity/gl/plane_batch.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "asperity/core/pose.hpp"
#include "asperity/field/field_body.hpp"
#include "asperity/gl/functions.hpp"
#include "asperity/gl/mapped_buffer.hpp"
#include "asperity/gl/program.hpp"
#include "field_upload.hpp"
#include "job_buffers.hpp"
#include "plane_layout.hpp"
#include "shaders.hpp"

namespace asperity::gl {
namespace {

static_assert(pose_planes::most_directions == planes::most_directions);

// Names of the shaders' types in single and double precision.
std::string definitions_of(bool doubles) {
  return (doubles ? "#define real double\n#define rvec3 dvec3\n#define rmat3 dmat3\n"
                  : "#define real float\n#define rvec3 vec3\n#define rmat3 mat3\n") +
         planes::definitions();
}

result<void> check(const plane_batch_settings& s, const context_facts& facts) {
  const auto bad = [](std::string what) { return error{error_code::invalid_argument, "plane batch: " + what}; };
  if (s.poses < 1 || s.poses > 65535) {
    return bad("room for " + std::to_string(s.poses) + " poses; give 1 to 65535");
  }
  if (s.leaves < 1 || s.leaves > 1'000'000) {
    return bad("room for " + std::to_string(s.leaves) + " leaves; give 1 to 1000000");
  }
  if (!std::isfinite(s.above_m)) return bad("above_m must be a finite length");
  if (!(s.same_direction > 0.0 && s.same_direction < 1.0)) {
    return bad("same_direction must be a cosine between 0 and 1");
  }
  if (s.arithmetic == arithmetic::double_precision && !facts.double_precision) {
    return bad("shaders of " + facts.renderer + " have no double precision here; ask for single precision");
  }
  return {};
}

// Where one body's samples meet another's field.
struct meeting {
  pose T_wx, T_wy;
  bool of_probe;
};
meeting meeting_at(const scene_pose& at, std::size_t m) noexcept {
  const pose &T_wa = at.T_wa, &T_wb = at.T_wb[m / 2];
  return m % 2 == 0 ? meeting{T_wa, T_wb, true} : meeting{T_wb, T_wa, false};
}

}  // namespace

wrench push_of(const pose_planes& planes, double stiffness_n_per_m) noexcept {
  wrench out;
  for (const near_plane& p : planes.deepest) {
    if (p.plane.depth_m > 0.0) out += to_wrench((-stiffness_n_per_m * p.plane.depth_m) * p.plane.gradient);
  }
  return out;
}

struct plane_batch::parts {
  context_ptr context;
  plane_batch_settings settings;
  std::shared_ptr<const field_scene> made;
  vec3 centre_of_mass_a{0.0};
  bool doubles = false;
  std::size_t most_leaves = 0;
  std::size_t at_once = 0;  // poses of a dispatch
  owned_name nodes, table, bodies, planes_found, found;
  mapped_buffer places, answers, told;
  program_ptr leaves, directions;
  // Of a program. Batches of a context share theirs, so that each call sets them anew.
  struct uniforms {
    GLint first_pose = -1, meetings = -1, room = -1, at_once = -1;
  };
  uniforms of_leaves_pass, of_directions_pass;
  bool overdue = false;  // the device has not answered yet, and may still read and write the buffers

  [[nodiscard]] std::size_t meetings() const noexcept { return 2 * made->fixed.size(); }
  [[nodiscard]] std::size_t number_bytes() const noexcept { return doubles ? sizeof(double) : sizeof(float); }
  [[nodiscard]] number_list list(const mapped_buffer& b) const noexcept {
    return doubles ? number_list(b.as<double>()) : number_list(b.as<float>());
  }
  [[nodiscard]] result<void> upload(const scene& of);
  [[nodiscard]] result<void> take_buffers();
  [[nodiscard]] result<void> compile();
  void write_places(std::span<const scene_pose> at) noexcept;
  void dispatch(std::size_t poses) noexcept;
  [[nodiscard]] status read_back(std::span<const scene_pose> at, std::span<pose_planes> out) const noexcept;
};

result<void> plane_batch::parts::upload(const scene& of) {
  result<packed_fields> packed = pack_fields(*made);
  if (!packed) return packed.error();
  packed->bodies[planes::above] = settings.above_m;
  packed->bodies[planes::shallow] = facing::shallow_m(of);
  packed->bodies[planes::same_direction] = settings.same_direction;
  most_leaves = packed->most_leaves;
  const auto take = [&](owned_name& to, const void* data, std::size_t bytes, const char* what) -> result<void> {
    result<owned_name> b = make_buffer(context, bytes, data, std::string("plane batch: ") + what);
    if (!b) return b.error();
    to = *std::move(b);
    return {};
  };
  if (result<void> r = take(nodes, packed->nodes.data(), packed->nodes.size() * sizeof(float), "fields and samples");
      !r) {
    return r;
  }
  if (result<void> r = take(table, packed->table.data(), packed->table.size() * sizeof(std::int32_t), "their places");
      !r) {
    return r;
  }
  if (doubles) {
    return take(bodies, packed->bodies.data(), packed->bodies.size() * sizeof(double), "numbers of bodies");
  }
  const std::vector<float> narrow(packed->bodies.begin(), packed->bodies.end());
  return take(bodies, narrow.data(), narrow.size() * sizeof(float), "numbers of bodies");
}

result<void> plane_batch::parts::take_buffers() {
  // So much memory that a device is busy with what one dispatch leaves, whatever the batch.
  constexpr std::size_t usual_bytes = 64U << 20U;
  const std::size_t pose_bytes =
      settings.leaves * (planes::plane_numbers * number_bytes() + planes::plane_integers * sizeof(std::int32_t));
  at_once = std::clamp<std::size_t>(usual_bytes / pose_bytes, 1, settings.poses);
  const std::size_t slots = at_once * settings.leaves;
  const auto take = [&](owned_name& to, const void* data, std::size_t bytes) -> result<void> {
    result<owned_name> b =
        make_buffer(context, bytes, data, "plane batch: planes of " + std::to_string(settings.leaves) + " leaves");
    if (!b) return b.error();
    to = *std::move(b);
    return {};
  };
  if (result<void> r = take(planes_found, nullptr, slots * planes::plane_numbers * number_bytes()); !r) return r;
  const std::vector<std::int32_t> none(at_once + slots * planes::plane_integers, 0);  // counts begin at 0
  if (result<void> r = take(found, none.data(), none.size() * sizeof(std::int32_t)); !r) return r;
  const auto map = [&](mapped_buffer& to, std::size_t bytes, direction way, const char* what) -> result<void> {
    result<mapped_buffer> b = mapped_buffer::make(context, bytes, way, std::string("plane batch: ") + what);
    if (!b) return b.error();
    to = *std::move(b);
    return {};
  };
  const std::size_t answered = settings.poses * planes::most_directions;
  if (result<void> r = map(places, settings.poses * meetings() * planes::place_numbers * number_bytes(),
                           direction::to_device, "poses");
      !r) {
    return r;
  }
  if (result<void> r =
          map(answers, answered * planes::plane_numbers * number_bytes(), direction::from_device, "answers");
      !r) {
    return r;
  }
  return map(told, settings.poses * planes::told_integers * sizeof(std::int32_t), direction::from_device, "counts");
}

result<void> plane_batch::parts::compile() {
  const functions& gl = context->gl();
  GLint blocks = 0;
  gl.GetIntegerv(GL_MAX_COMPUTE_SHADER_STORAGE_BLOCKS, &blocks);
  if (blocks < 6) {
    return error{error_code::unsupported, "plane batch: shaders of " + context->facts().renderer + " read " +
                                              std::to_string(blocks) + " buffers; 6 are needed"};
  }
  const std::string definitions = definitions_of(doubles);
  const shader_stage of_leaves{GL_COMPUTE_SHADER, definitions, {shaders::field_glsl, shaders::leaves_glsl}};
  const shader_stage of_directions{GL_COMPUTE_SHADER, definitions, {shaders::directions_glsl}};
  const auto make = [&](program_ptr& to, const shader_stage& stage, const char* what) -> result<void> {
    result<program_ptr> p = share_program(context, std::span(&stage, 1), what);
    if (!p) return p.error();
    to = *p;
    return {};
  };
  if (result<void> r = make(leaves, of_leaves, "the plane batch's leaves"); !r) return r;
  if (result<void> r = make(directions, of_directions, "the plane batch's directions"); !r) return r;
  const auto uniforms_of = [&](const program_ptr& program) -> uniforms {
    const auto find = [&](const char* name) { return gl.GetUniformLocation(program->get(), name); };
    return {find("first_pose"), find("meetings"), find("room"), find("at_once")};
  };
  of_leaves_pass = uniforms_of(leaves);
  of_directions_pass = uniforms_of(directions);
  return {};
}

result<plane_batch> plane_batch::make(context_ptr context, const scene& bodies, std::shared_ptr<const field_scene> made,
                                      const plane_batch_settings& settings) {
  if (context == nullptr) return error{error_code::invalid_argument, "plane batch: no context; open one"};
  if (const result<void> ok = check_field_scene(bodies, made.get()); !ok) return ok.error();
  const context_facts& facts = context->facts();
  if (result<void> r = check(settings, facts); !r) return r.error();
  const current_scope here(context);
  if (here.state() != status::ok) {
    return error{error_code::unsupported,
                 "plane batch: the context is lost, or current in another thread; release it there first"};
  }
  auto p = std::make_unique<parts>();
  p->context = context;
  p->settings = settings;
  p->made = std::move(made);
  p->centre_of_mass_a = bodies.probe->mass.centre_of_mass;
  p->doubles = settings.arithmetic != arithmetic::single_precision && facts.double_precision;
  if (result<void> r = p->upload(bodies); !r) return r.error();
  if (result<void> r = p->take_buffers(); !r) return r.error();
  if (result<void> r = p->compile(); !r) return r.error();
  if (const std::string errors = take_errors(context->gl()); !errors.empty()) {
    return error{error_code::unsupported, "plane batch: " + facts.renderer + " reports " + errors};
  }
  return plane_batch(std::move(p));
}

void plane_batch::parts::write_places(std::span<const scene_pose> at) noexcept {
  number_list to = list(places);
  for (const scene_pose& p : at) {
    for (std::size_t m = 0; m < meetings(); ++m) {
      const auto [T_wx, T_wy, of_probe] = meeting_at(p, m);
      const pose T_yx = inverse(T_wy) * T_wx;
      const mat3 R_yx = glm::mat3_cast(T_yx.rotation), R_wy = glm::mat3_cast(T_wy.rotation);
      for (int k = 0; k < 3; ++k) to.add_vector(R_yx[k]);
      to.add_vector(T_yx.position);
      for (int k = 0; k < 3; ++k) to.add_vector((of_probe ? 1.0 : -1.0) * R_wy[k]);
    }
  }
  places.send(to.bytes());
}

void plane_batch::parts::dispatch(std::size_t poses) noexcept {
  const functions& gl = context->gl();
  GLuint binding = 0;
  for (const GLuint b : {nodes.get(), table.get(), bodies.get(), places.name(), planes_found.get(), found.get(),
                         answers.name(), told.name()}) {
    gl.BindBufferBase(GL_SHADER_STORAGE_BUFFER, binding++, b);
  }
  const auto groups = (most_leaves + planes::group_size - 1) / planes::group_size;
  const auto begin = [&](const owned_name& program, const uniforms& at, std::size_t first) noexcept {
    gl.UseProgram(program.get());
    gl.Uniform1i(at.first_pose, static_cast<GLint>(first));
    gl.Uniform1i(at.meetings, static_cast<GLint>(meetings()));
    gl.Uniform1i(at.room, static_cast<GLint>(settings.leaves));
    gl.Uniform1i(at.at_once, static_cast<GLint>(at_once));
  };
  for (std::size_t first = 0; first < poses; first += at_once) {
    const auto now = static_cast<GLuint>(std::min(at_once, poses - first));
    begin(*leaves, of_leaves_pass, first);
    gl.DispatchCompute(static_cast<GLuint>(groups), now, static_cast<GLuint>(meetings()));
    gl.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    begin(*directions, of_directions_pass, first);
    gl.DispatchCompute(now, 1, 1);
    gl.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  }
}

status plane_batch::parts::read_back(std::span<const scene_pose> at, std::span<pose_planes> out) const noexcept {
  const number_list numbers = list(answers);
  const std::span<const std::int32_t> integers = told.as<std::int32_t>();
  bool left_out = false;
  for (std::size_t i = 0; i < at.size(); ++i) {
    const auto of_pose = integers.subspan(i * planes::told_integers, planes::told_integers);
    out[i].left_out = static_cast<std::uint32_t>(std::max(0, of_pose[planes::told_left_out]));
    left_out = left_out || out[i].left_out > 0;
    const auto count = static_cast<std::size_t>(std::clamp(of_pose[planes::told_count], 0, planes::most_directions));
    for (std::size_t k = 0; k < count; ++k) {
      const auto m = static_cast<std::size_t>(of_pose[planes::told_planes + 2 * k]);
      const auto sample = static_cast<std::size_t>(of_pose[planes::told_planes + 2 * k + 1]);
      if (m >= meetings()) return status::backend_failed;
      const auto [T_wx, T_wy, of_probe] = meeting_at(at[i], m);
      const std::size_t body = m / 2;
      const auto samples = (of_probe ? *made->probe : *made->fixed[body]).samples.samples();
      if (sample >= samples.size()) return status::backend_failed;
      const std::size_t first = (i * planes::most_directions + k) * planes::plane_numbers;
      const vec3 slope_w(numbers[first + 1], numbers[first + 2], numbers[first + 3]);
      near_plane p;
      p.point_w = T_wx * vec3(samples[sample].position_b);
      p.plane.depth_m = numbers[first];
      p.plane.body = static_cast<std::uint32_t>(body);
      p.plane.sample = static_cast<std::uint32_t>(2 * sample + (of_probe ? 1 : 2));
      p.plane.r_w = p.point_w - at[i].T_wa * centre_of_mass_a;
      p.plane.gradient = {slope_w, glm::cross(p.plane.r_w, slope_w)};
      p.plane.n_ab_w = slope_w / std::sqrt(glm::dot(slope_w, slope_w));
      if (!is_finite(p.plane)) return status::not_finite;
      static_cast<void>(out[i].deepest.push_back(p));  // the shader tells no more than there is room for
    }
  }
  return left_out ? status::capacity_reached : status::ok;
}

status plane_batch::measure(std::span<const scene_pose> at, std::span<pose_planes> out) noexcept {
  parts& p = *parts_;
  const auto clear = [&]() noexcept {
    for (pose_planes& o : out) {
      o.deepest.clear();
      o.left_out = 0;
    }
  };
  clear();
  if (out.size() < at.size()) return status::not_ready;
  if (at.size() > p.settings.poses) return status::capacity_reached;
  for (const scene_pose& pose : at) {
    if (pose.T_wb.size() != p.made->fixed.size()) return status::not_ready;
    const bool valid = is_valid(pose.T_wa) &&
                       std::all_of(pose.T_wb.begin(), pose.T_wb.end(), [](const auto& T) { return is_valid(T); });
    if (!valid) return status::invalid_pose;
  }
  if (at.empty()) return status::ok;
  if (p.context->make_current() != status::ok) return status::backend_failed;
  const functions& gl = p.context->gl();
  if (p.overdue) {
    if (wait_for_device(gl, p.settings.timeout_ns) != status::ok) return status::backend_failed;
    p.overdue = false;
  }
  p.write_places(at);
  p.dispatch(at.size());
  p.overdue = wait_for_device(gl, p.settings.timeout_ns) != status::ok;
  if (p.overdue) return status::backend_failed;
  const std::size_t numbers = at.size() * planes::most_directions * planes::plane_numbers * p.number_bytes();
  if (p.answers.receive(numbers) != status::ok ||
      p.told.receive(at.size() * planes::told_integers * sizeof(std::int32_t)) != status::ok ||
      p.context->check() != status::ok || gl.GetError() != GL_NO_ERROR) {
    return status::backend_failed;
  }
  const status s = p.read_back(at, out);
  if (s != status::ok && s != status::capacity_reached) clear();
  return s;
}

plane_batch::plane_batch(std::unique_ptr<parts> p) noexcept : parts_(std::move(p)) {}
plane_batch::plane_batch(plane_batch&&) noexcept = default;
plane_batch& plane_batch::operator=(plane_batch&&) noexcept = default;
plane_batch::~plane_batch() = default;

const plane_batch_settings& plane_batch::settings() const noexcept { return parts_->settings; }
arithmetic plane_batch::arithmetic() const noexcept {
  return parts_->doubles ? gl::arithmetic::double_precision : gl::arithmetic::single_precision;
}
std::size_t plane_batch::device_bytes() const noexcept {
  const parts& p = *parts_;
  return p.nodes.bytes() + p.table.bytes() + p.bodies.bytes() + p.planes_found.bytes() + p.found.bytes() +
         p.places.size() + p.answers.size() + p.told.size();
}

}  // namespace asperity::gl
