// One call of measure(): at rest, moved, searched, answered.
#include <algorithm>
#include <cmath>

#include "occlusion_parts.hpp"

namespace asperity::gl {
namespace {

bool drawable(const contact_window& w) noexcept { return w.half_size_m > 0.0 && std::isfinite(w.half_size_m); }

std::array<float, 2> pixels(std::uint32_t x, std::uint32_t y) noexcept {
  return {static_cast<float>(x), static_cast<float>(y)};
}

}  // namespace

query_view occlusion_depth::parts::view() const noexcept {
  return {heights.texture(), differences.framebuffer(), heights.atlas(), differences.atlas(), tile_samples()};
}

/// Calls add(body) for each fixed body in turn and notes which records came from it.
template <class Add>
void occlusion_depth::parts::write_runs(Add add) noexcept {
  runs.clear();
  const std::span<record_list> lists = heights.lists();
  for (std::size_t body = 0; body < models.fixed.size(); ++body) {
    std::array<std::size_t, 4> first{};
    for (std::size_t q = 0; q < lists.size(); ++q) first[q] = lists[q].used;
    add(body);
    for (std::size_t q = 0; q < lists.size(); ++q) {
      if (lists[q].used > first[q]) runs.push_back({q, body, first[q], lists[q].used - first[q]});
    }
  }
}

void occlusion_depth::parts::write_at_rest(const scene_pose& at, const contact_set& contacts) noexcept {
  write_runs([&](std::size_t body) {
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const contact& c = contacts.contacts()[i];
      if (c.body != body || !drawable(c.window)) continue;
      const std::size_t s = slots.size();
      contact_slot slot{.contact = static_cast<std::uint32_t>(i), .half_m = c.window.half_size_m};
      const tile_atlas& tiles = heights.atlas();
      slot.b = writer.add(heights.lists(), body + 1, contacts.patch_b(c), c.window, at.T_wb[body],
                          {tiles.x(s, 0), tiles.y(s)});
      slot.a = writer.add(heights.lists(), 0, contacts.patch_a(c), c.window, at.T_wa, {tiles.x(s, 1), tiles.y(s)});
      slot.visible = slot.a.low <= slot.a.high && slot.b.low <= slot.b.high;
      slot_of[i] = static_cast<std::uint32_t>(s);
      slots.push_back(slot);
      look_for_bad.push_back(writer.has_bad_texels(body) ? 1 : 0);
    }
  });
}

void occlusion_depth::parts::write_moved(const scene_pose& at, const contact_set& contacts) noexcept {
  const window_depth_settings& settings = writer.settings();
  write_runs([&](std::size_t body) {
    for (std::size_t s = 0; s < slots.size(); ++s) {
      contact_slot& slot = slots[s];
      const contact& c = contacts.contacts()[slot.contact];
      if (c.body != body || slot.samples == 0) continue;
      const detail::sample_grid grid(settings.grid, c.window.half_size_m);
      slot.step_m = reuses() ? grid.pitch_m : detail::difference_step(settings, writer.pair(body), grid.pitch_m);
      slot.step_rad = slot.step_m / (grid.half_m - slot.outermost * grid.pitch_m);
      const vec3 origin = rotation_origin_w(c, at.T_wa);
      const tile_atlas& tiles = heights.atlas();
      for (std::size_t m = first_drawn(); m < end_drawn(); ++m) {
        const pose T = detail::moved_probe(m, c.window, at.T_wa, origin, slot.step_m, slot.step_rad);
        const height_range moved = writer.add(heights.lists(), 0, contacts.patch_a(c), c.window, T,
                                              {tiles.x(s, 2 + m - first_drawn()), tiles.y(s)});
        slot.a.include(moved.low, moved.high);
      }
    }
  });
}

bool occlusion_depth::parts::records_fit() noexcept {
  const std::span<record_list> lists = heights.lists();
  return std::none_of(lists.begin(), lists.end(), [](const record_list& list) { return list.overflowed(); });
}

void occlusion_depth::parts::choose_range(contact_slot& slot, double half_m) const noexcept {
  double low = slot.a.low - slot.b.high, high = slot.a.high - slot.b.low;
  if (gpu_settings.depth_range_m > 0.0) {
    low = -gpu_settings.depth_range_m;
    high = gpu_settings.depth_range_m;
  } else {
    // Single precision measures heights to some 5e-7 of the window's half size: a finer quantum would only pretend.
    const double middle = 0.5 * (low + high);
    const double reach = std::max(0.5005 * (high - low), 0.05 * half_m);
    low = middle - reach;
    high = middle + reach;
  }
  slot.low_m = low;
  slot.quantum_m = (high - low) / (levels.last() - depth_levels::first);
}

difference_record occlusion_depth::parts::at_rest(std::size_t s, double half_m) const noexcept {
  const tile_atlas& h = heights.atlas();
  const tile_atlas& d = differences.atlas();
  difference_record r;
  r.tile = pixels(d.x(s, 0), d.y(s));
  r.heights_b = pixels(h.x(s, 0), h.y(s));
  r.heights_a = pixels(h.x(s, 1), h.y(s));
  r.low = static_cast<float>(slots[s].low_m / half_m);
  r.levels_per_unit = static_cast<float>(half_m / slots[s].quantum_m);
  return r;
}

void occlusion_depth::parts::draw_at_rest(const contact_set& contacts) noexcept {
  std::size_t count = 0;
  for (std::size_t s = 0; s < slots.size(); ++s) {
    if (!slots[s].visible) continue;
    const double half = contacts.contacts()[slots[s].contact].window.half_size_m;
    choose_range(slots[s], half);
    differences.records()[count++] = at_rest(s, half);
  }
  differences.draw(0, count, heights.texture());
}

void occlusion_depth::parts::draw_all(const contact_set& contacts) noexcept {
  // Behind the records at rest: the device may still be reading those.
  const std::size_t first = slots.size();
  std::size_t next = first;
  const tile_atlas& h = heights.atlas();
  const tile_atlas& d = differences.atlas();
  for (std::size_t s = 0; s < slots.size(); ++s) {
    contact_slot& slot = slots[s];
    if (slot.samples == 0) continue;
    const double half = contacts.contacts()[slot.contact].window.half_size_m;
    choose_range(slot, half);
    const difference_record rest = at_rest(s, half);
    differences.records()[next++] = rest;
    for (std::size_t m = 0; m < detail::probe_motions; ++m) {
      difference_record r = rest;
      r.tile = pixels(d.x(s, 1 + m), d.y(s));
      if (m >= first_drawn() && m < end_drawn()) {
        r.heights_a = pixels(h.x(s, 2 + m - first_drawn()), h.y(s));
      } else if (m < first_turn) {
        r.shift[m / 2] = m % 2 == 0 ? 1.0F : -1.0F;
      } else {
        const double angle = m % 2 == 0 ? slot.step_rad : -slot.step_rad;
        r.cosine = static_cast<float>(std::cos(angle));
        r.sine = static_cast<float>(std::sin(angle));
      }
      differences.records()[next++] = r;
    }
  }
  differences.draw(first, next - first, heights.texture());
}

std::optional<double> occlusion_depth::parts::depth_of(const contact_slot& slot, std::size_t search) const noexcept {
  const std::uint32_t level = slot.level[search];
  if (level == depth_levels::none) return std::nullopt;
  const std::uint32_t within = std::clamp(level, depth_levels::first, levels.last());
  return slot.low_m + (within - depth_levels::first) * slot.quantum_m;
}

penetration occlusion_depth::parts::answer(const scene_pose& at, const contact& c,
                                           const contact_slot& slot) const noexcept {
  penetration out{.flags = depth_flag::no_overlap};
  if (slot.bad_texel) out.flags |= depth_flag::bad_texel;
  const std::optional<double> depth = depth_of(slot, 0), inner = depth_of(slot, configurations);
  if (slot.samples == 0 || !depth) return out;
  penetration found{.flags = slot.bad_texel ? depth_flag::bad_texel : depth_flag::none};
  found.depth_m = found.soft_depth_m = *depth;
  found.witness_w = c.window.centre_w;
  const detail::sample_grid grid(writer.settings().grid, c.window.half_size_m);
  found.samples = slot.samples;
  found.area_m2 = slot.samples * grid.cell_m2();
  if (!inner || *depth > *inner + 0.1 * writer.pair(c.body).tau_m) found.flags |= depth_flag::window_too_small;
  detail::moved_depths moved;
  for (std::size_t m = 0; m < moved.size(); ++m) moved[m] = depth_of(slot, 1 + m);
  for (std::size_t k = 0; k < configurations; ++k) {
    if (slot.level[k] == depth_levels::below || slot.level[k] == levels.top()) found.flags |= depth_flag::saturated;
  }
  found.gradient = detail::gradient_of(moved, c.window, centre_of_mass_w(writer.bodies(), at.T_wa),
                                       rotation_origin_w(c, at.T_wa), *depth, slot.step_m, slot.step_rad);
  return found;
}

status occlusion_depth::parts::draw(const scene_pose& at, const contact_set& contacts) noexcept {
  for (record_list& list : heights.lists()) list.used = 0;
  heights.make_room(contacts.size());
  differences.make_room(contacts.size());
  write_at_rest(at, contacts);
  if (!records_fit()) return status::capacity_reached;
  if (std::none_of(slots.begin(), slots.end(), [](const contact_slot& s) { return s.visible; })) return status::ok;
  heights.clear(slots.size());
  heights.draw(runs, slots.size(), models);
  draw_at_rest(contacts);
  queries.coverage(view(), slots, look_for_bad);
  if (std::none_of(slots.begin(), slots.end(), [](const contact_slot& s) { return s.samples > 0; })) return status::ok;
  write_moved(at, contacts);
  if (!records_fit()) return status::capacity_reached;
  heights.draw(runs, slots.size(), models);
  draw_all(contacts);
  queries.search(view(), slots);
  return status::ok;
}

status occlusion_depth::parts::measure(const scene_pose& at, const contact_set& contacts,
                                       std::span<penetration> out) noexcept {
  const penetration nothing{.flags = depth_flag::no_overlap};
  std::fill(out.begin(), out.end(), nothing);
  slots.clear();
  look_for_bad.clear();
  std::fill(slot_of.begin(), slot_of.end(), no_slot);
  if (out.size() < contacts.size() || at.T_wb.size() != models.fixed.size()) return status::not_ready;
  for (const contact& c : contacts.contacts()) {
    if (c.body >= models.fixed.size()) return status::not_ready;
  }
  if (contacts.size() == 0) return status::ok;
  if (contacts.size() > gpu_settings.contacts) return status::capacity_reached;
  if (context->make_current() != status::ok) return status::backend_failed;

  const status drawn = draw(at, contacts);
  ++counters.ticks;
  counters.contacts += contacts.size();
  counters.round_trips = queries.rounds();
  counters.queries = queries.queries();
  // Others draw in this context too.
  const functions& gl = context->gl();
  gl.Disable(GL_SCISSOR_TEST);
  gl.Disable(GL_DEPTH_TEST);
  gl.DepthMask(GL_TRUE);
  gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
  gl.BindVertexArray(0);
  if (context->check() != status::ok || gl.GetError() != GL_NO_ERROR) return status::backend_failed;
  if (drawn != status::ok) return drawn;

  for (const contact_slot& slot : slots) {
    penetration& p = out[slot.contact];
    p = answer(at, contacts.contacts()[slot.contact], slot);
    if (std::isfinite(p.depth_m) && is_finite(p.gradient)) continue;
    std::fill(out.begin(), out.end(), nothing);
    return status::not_finite;
  }
  return status::ok;
}

}  // namespace asperity::gl
