#include "asperity/gl/occlusion_depth.hpp"

#include <cmath>
#include <string>
#include <utility>

#include "asperity/window/cpu_depth.hpp"
#include "occlusion_parts.hpp"

namespace asperity::gl {
namespace {

error bad(const std::string& what) { return {error_code::invalid_argument, "occlusion depth: " + what}; }

result<void> check_settings(const window_depth_settings& s) {
  if (s.gradient != gradient_scheme::central_difference) {
    return bad("occlusion queries find a hard maximum; ask for gradient_scheme::central_difference");
  }
  if (s.parallax != parallax_mode::paper_lookup) {
    return bad("heights are the texels of the coarse hits; ask for parallax_mode::paper_lookup");
  }
  if (s.refine_maximum) return bad("refine_maximum is the CPU backend's alone; leave it off");
  return {};
}

result<void> check_gpu_settings(const occlusion_settings& o, const window_depth_settings& s) {
  if (o.contacts < 1 || o.contacts > 256) {
    return bad("room for " + std::to_string(o.contacts) + " contacts; give 1 to 256");
  }
  if (o.triangles < 2) return bad("room for " + std::to_string(o.triangles) + " triangles; give at least 2");
  if (o.depth_bits != 16 && o.depth_bits != 24) {
    return bad("a depth buffer of " + std::to_string(o.depth_bits) + " bits; give 16 or 24");
  }
  if (!(std::isfinite(o.depth_range_m) && o.depth_range_m >= 0.0)) {
    return bad("depth_range_m must be a finite length, or 0 for automatic");
  }
  if (o.packed && s.grid % 2 != 0) {
    return bad("a grid of " + std::to_string(s.grid) + " samples has no quarters; give an even one, or do not pack");
  }
  if (o.moved == moved_heights::reused) {
    if (s.difference_step_m > 0.0) {
      return bad("heights that are reused move by one sample; leave difference_step_m 0, or draw the moved heights");
    }
    if (s.origin != rotation_origin::contact) {
      return bad("heights that are reused turn about the contact; leave origin as it is, or draw the moved heights");
    }
  }
  return {};
}

}  // namespace

// A turn about n by one sample at the rim moves the corners by one and a half; resampling reads one further.
occlusion_depth::parts::parts(context_ptr c, const scene& s, const window_depth_settings& settings,
                              const occlusion_settings& o)
    : context(std::move(c)),
      writer(s, settings, o.moved == moved_heights::reused ? 3 : 0, o.packed),
      gpu_settings(o),
      levels{o.depth_bits} {}

result<void> occlusion_depth::parts::set_up() {
  result<uploaded_scene> uploaded = upload(context, writer.bodies());
  if (!uploaded) return uploaded.error();
  models = *std::move(uploaded);

  const auto contacts = static_cast<std::uint32_t>(gpu_settings.contacts);
  const std::uint32_t fold = gpu_settings.packed ? 2 : 1;
  GLint largest = 0;
  context->gl().GetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
  const auto side = static_cast<std::uint32_t>(largest);
  const tile_atlas for_heights =
      tile_atlas::fit(writer.tile_samples() / fold, static_cast<std::uint32_t>(height_tiles()), contacts, side);
  const tile_atlas for_differences =
      tile_atlas::fit(writer.settings().grid / fold, static_cast<std::uint32_t>(configurations), contacts, side);
  if (for_heights.rows == 0 || for_differences.rows == 0) {
    return error{error_code::limit_exceeded,
                 "occlusion depth: tiles of " + std::to_string(writer.tile_samples()) + " samples for " +
                     std::to_string(contacts) + " contacts do not fit into a texture of this device, " +
                     std::to_string(side) + " pixels per side; ask for fewer contacts or a smaller grid"};
  }
  const std::string definitions = tile_definitions(gpu_settings.depth_bits, gpu_settings.packed);
  // Every triangle may be drawn at rest and after every motion.
  const std::size_t records = gpu_settings.triangles * (height_tiles() - 1);
  auto h = height_pass::make(context, for_heights, contacts, gpu_settings.packed, definitions, tile_samples(), records);
  if (!h) return h.error();
  heights = *std::move(h);
  auto d =
      difference_pass::make(context, for_differences, contacts, gpu_settings.depth_bits, definitions, tile_samples());
  if (!d) return d.error();
  differences = *std::move(d);
  auto q = query_pass::make(context, gpu_settings.contacts, writer.settings().grid, gpu_settings.depth_bits,
                            gpu_settings.packed, definitions);
  if (!q) return q.error();
  queries = *std::move(q);

  asperity::detail::reserve_resident(slots, gpu_settings.contacts);
  asperity::detail::reserve_resident(look_for_bad, gpu_settings.contacts);
  asperity::detail::reserve_resident(runs, models.fixed.size() * writer.quarters());
  slot_of.assign(gpu_settings.contacts, no_slot);
  return {};
}

result<occlusion_depth> occlusion_depth::make(context_ptr context, const scene& s,
                                              const window_depth_settings& settings,
                                              const occlusion_settings& gpu_settings) {
  if (context == nullptr) return error{error_code::invalid_argument, "occlusion depth: no context; open one"};
  if (result<void> r = check(settings); !r) return r.error();
  if (result<void> r = check_settings(settings); !r) return r.error();
  if (result<void> r = cpu_depth::check_scene(s); !r) return r.error();
  if (result<void> r = check_gpu_settings(gpu_settings, settings); !r) return r.error();
  const current_scope here(context);
  if (here.state() != status::ok) {
    return error{error_code::unsupported,
                 "occlusion depth: the context is lost, or current in another thread; release it there first"};
  }
  auto p = std::make_unique<parts>(context, s, settings, gpu_settings);
  if (result<void> r = p->set_up(); !r) return r.error();
  if (const std::string errors = take_errors(context->gl()); !errors.empty()) {
    return error{error_code::unsupported, "occlusion depth: " + context->facts().renderer + " reports " + errors};
  }
  return occlusion_depth(std::move(p));
}

occlusion_depth::occlusion_depth(std::unique_ptr<parts> p) noexcept : parts_(std::move(p)) {}
occlusion_depth::occlusion_depth(occlusion_depth&&) noexcept = default;
occlusion_depth& occlusion_depth::operator=(occlusion_depth&&) noexcept = default;
occlusion_depth::~occlusion_depth() = default;

status occlusion_depth::measure(const scene_pose& at, const contact_set& contacts,
                                std::span<penetration> out) noexcept {
  return parts_->measure(at, contacts, out);
}

double occlusion_depth::quantum_m(std::size_t i) const noexcept {
  const std::uint32_t s = i < parts_->slot_of.size() ? parts_->slot_of[i] : parts::no_slot;
  return s == parts::no_slot ? 0.0 : parts_->slots[s].quantum_m;
}
double occlusion_depth::step_m(std::size_t i) const noexcept {
  const std::uint32_t s = i < parts_->slot_of.size() ? parts_->slot_of[i] : parts::no_slot;
  return s == parts::no_slot ? 0.0 : parts_->slots[s].step_m;
}
double occlusion_depth::step_rad(std::size_t i) const noexcept {
  const std::uint32_t s = i < parts_->slot_of.size() ? parts_->slot_of[i] : parts::no_slot;
  return s == parts::no_slot ? 0.0 : parts_->slots[s].step_rad;
}

const window_depth_settings& occlusion_depth::settings() const noexcept { return parts_->writer.settings(); }
const occlusion_settings& occlusion_depth::gpu_settings() const noexcept { return parts_->gpu_settings; }
const occlusion_counters& occlusion_depth::counters() const noexcept { return parts_->counters; }
const context_ptr& occlusion_depth::owner() const noexcept { return parts_->context; }
std::size_t occlusion_depth::device_bytes() const noexcept {
  return parts_->heights.device_bytes() + parts_->differences.device_bytes();
}
std::size_t occlusion_depth::heap_bytes() const noexcept {
  const parts& p = *parts_;
  return sizeof(parts) + p.writer.heap_bytes() + p.queries.heap_bytes() + p.heights.heap_bytes() +
         p.differences.heap_bytes() + asperity::heap_bytes(p.models.fixed, p.slots, p.slot_of, p.look_for_bad, p.runs);
}

}  // namespace asperity::gl
