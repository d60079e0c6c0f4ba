// The entry point: three policies, one call per tick.
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "asperity/core/memory.hpp"
#include "asperity/render/collision_finder.hpp"
#include "asperity/render/depth_backend.hpp"
#include "asperity/render/force_model.hpp"
#include "asperity/render/plane_source.hpp"
#include "asperity/render/support_plane.hpp"

namespace asperity {

/// What one tick found. The spans point into the renderer and live until its next step.
struct tick {
  contact_force force{};                ///< on the probe; zero where the status is not ok or capacity_reached
  vec3 centre_of_mass_w{0.0};           ///< c_A, the point the torque is about
  std::span<const contact> contacts;    ///< what the force model reports
  std::span<const penetration> depths;  ///< one per contact
  std::span<const wrench> by_contact;  ///< on the probe by each contact, about c_A: the force's parts; empty: not known
  std::size_t dropped_contacts = 0;    ///< contacts that did not fit: raise contact_limits
  std::span<const wrench> on_body;     ///< on each fixed body, about its own centre of mass; empty: not known
  std::span<const support_plane> planes;  ///< gaps included; empty where the depth backend knows none
  plane_source planes_near{};             ///< tells the planes of poses near by; empty where the depth backend cannot
  const plane_reader* reader = nullptr;   ///< reads the planes again; see there how long it lives; null: nobody can
  known_motion known{};                   ///< how far the probe may move on what the planes tell
  tick_flag flags = tick_flag::none;      ///< what the planes do not answer
  depth_work work{};                      ///< what it took
};

/// A policy that can go on with another version of its scene; what it refers to of the version before is let go.
template <class P>
concept takes_scenes = requires(P& policy, const typename P::placed_type& next) {
  { policy.take(next) }
  noexcept;
};

namespace detail {

struct no_placed_scene {};
template <class P>
struct placed_for {
  using type = no_placed_scene;
};
template <takes_scenes P>
struct placed_for<P> {
  using type = typename P::placed_type;
};

/// From what each body does to the probe, about c_A, to what it feels itself, about its own centre of mass; in place.
/// @rt safe
inline std::span<const wrench> as_felt_by_bodies(std::span<wrench> by_body, const vec3& c_a_w, const scene& bodies,
                                                 const scene_pose& at) noexcept {
  for (std::size_t b = 0; b < by_body.size(); ++b) {
    if (is_zero(by_body[b])) continue;
    by_body[b] = -1.0 * transport(by_body[b], c_a_w, at.T_wb[b] * bodies.fixed[b]->mass.centre_of_mass);
  }
  return by_body;
}

}  // namespace detail

/// Feels the contact between a probe and fixed bodies: collision finder, depth backend and force model in a row.
///
///     auto made = asperity::make_renderer(scene);            // the default policies
///     asperity::tick tick;
///     if (made && made->step({T_wa, T_wb}, tick) == asperity::status::ok) send(tick.force.on_probe_w);
///
/// Data goes forward only; no stage knows the next. All memory is taken by the constructor.
/// The policies agree on what is handed on: contacts and penetrations, or near samples and their planes. What a tick
/// calls its contacts is the force model's report, in both cases.
/// @tparam Finder  who touches whom          (asperity/render/collision_finder.hpp)
/// @tparam Depth   how deep, and which way   (asperity/render/depth_backend.hpp)
/// @tparam Force   what that feels like      (asperity/render/force_model.hpp)
template <collision_finder Finder, depth_backend Depth, force_model Force>
requires std::same_as<found_by<Finder>, found_by<Depth>> && std::same_as<found_by<Finder>, found_by<Force>> &&
    std::same_as<reading_of<Depth>, reading_of<Force>>
class basic_renderer {
 public:
  using found_type = found_by<Finder>;
  using reading_type = reading_of<Depth>;
  using limits_type = typename found_type::limits_type;
  /// Versions of a scene that changes; no_placed_scene where the policies take none.
  using placed_type = typename detail::placed_for<Depth>::type;

  basic_renderer(asperity::scene scene, Finder finder, Depth depth, Force force, limits_type limits = {})
      : scene_(std::move(scene)),
        finder_(std::move(finder)),
        depth_(std::move(depth)),
        force_(std::move(force)),
        found_(limits),
        readings_(limits.readings()),
        by_body_(scene_.fixed.size()),
        by_contact_(reported_by(limits)) {
    if constexpr (reports_planes_nearby<Depth>) at_.T_wb.resize(scene_.fixed.size());
  }

  /// For a scene that changes.
  /// @param placed its first version, which finder and depth have taken
  basic_renderer(std::shared_ptr<const placed_type> placed, Finder finder, Depth depth, Force force,
                 limits_type limits = {}) requires takes_scenes<Finder> && takes_scenes<Depth>
      : basic_renderer(asperity::scene{}, std::move(finder), std::move(depth), std::move(force), limits) {
    placed_ = std::move(placed);
    by_body_.resize(scene().fixed.size());
    at_.T_wb = depth_.placed()->T_wb;
  }

  /// Goes on with another version of the scene. @pre made for a scene that changes; as many slots
  /// @return the version that it replaces: nothing of the renderer refers to it
  /// @rt safe: nothing is allocated or freed
  [[nodiscard]] std::shared_ptr<const placed_type> take(std::shared_ptr<const placed_type> next) noexcept requires
      takes_scenes<Finder> && takes_scenes<Depth> {
    finder_.take(*next);
    depth_.take(*next);
    return std::exchange(placed_, std::move(next));
  }
  /// The version of the scene; null where it never changes.
  [[nodiscard]] const placed_scene* placed() const noexcept requires takes_scenes<Finder> && takes_scenes<Depth> {
    return depth_.placed();
  }

  /// Wrench on the probe at these poses.
  /// @pre at.T_wb.size() == scene().fixed.size(); at.version tells the truth
  /// @return ok | capacity_reached (a usable result that lacks something) | invalid_pose | not_ready | not_finite |
  ///         backend_failed; the last four leave a zero wrench
  /// @rt safe: no allocation, lock, throw, print or clock
  [[nodiscard]] status step(const scene_pose& at, tick& out) noexcept {
    out = {};
    found_.clear();
    if (at.T_wb.size() != scene().fixed.size()) return status::not_ready;
    if (!is_valid(at.T_wa) || !has_valid_bodies(at)) return status::invalid_pose;
    const status found = finder_.find(at, found_);
    if (found != status::ok && found != status::capacity_reached) return found;

    const std::span<reading_type> readings = std::span(readings_).first(found_.size());
    if (const status s = depth_.measure(at, found_, readings); s != status::ok) return s;
    std::fill(by_body_.begin(), by_body_.end(), wrench{});
    std::fill(by_contact_.begin(), by_contact_.end(), wrench{});
    force_report report;
    report.by_body = by_body_;
    report.by_contact = by_contact_;
    const status felt = force_.accumulate(at, found_, readings, report);
    if (felt != status::ok && felt != status::capacity_reached) return felt;
    if (!is_finite(report.force.on_probe_w)) return status::not_finite;
    out.force = report.force;
    out.contacts = report.contacts;
    out.depths = report.depths;
    if (report.by_contact.size() == report.contacts.size()) out.by_contact = report.by_contact;
    out.centre_of_mass_w = centre_of_mass_w(scene(), at.T_wa);
    out.on_body = detail::as_felt_by_bodies(report.by_body, out.centre_of_mass_w, scene(), at);
    out.dropped_contacts = found_.dropped();
    if constexpr (reports_plane_reader<Depth>) out.reader = depth_.reader();
    if constexpr (reports_known_motion<Depth>) out.known = depth_.known();
    if constexpr (reports_tick_flags<Depth>) out.flags = depth_.flags();
    if constexpr (reports_work<Depth>) out.work = depth_.work();
    if constexpr (reports_planes_nearby<Depth>) {
      keep(at);
      out.planes_near = plane_source(*this);
    }
    if constexpr (reports_support_planes<Depth>) out.planes = depth_.support_planes();
    return found == status::ok ? felt : found;
  }

  /// What the last tick's planes_near tells; see plane_source.
  /// @pre a step before, which answered ok or capacity_reached
  /// @rt safe
  [[nodiscard]] status planes_at(const vec6& moved, double above_m,
                                 plane_list& out) noexcept requires reports_planes_nearby<Depth> {
    out.clear();
    const vec3 c_a_w = centre_of_mass_w(scene(), at_.T_wa);
    const quat turn = exp_rotation(moved.angular);
    const pose T_wa{glm::normalize(turn * at_.T_wa.rotation),
                    c_a_w + moved.linear + turn * (at_.T_wa.position - c_a_w)};
    if (!is_valid(T_wa)) return status::invalid_pose;
    return depth_.planes_at({T_wa, at_.T_wb}, found_, std::span(readings_).first(found_.size()), moved, above_m, out);
  }

  [[nodiscard]] const asperity::scene& scene() const noexcept {
    if constexpr (takes_scenes<Depth>) {
      if (const placed_scene* const s = depth_.placed(); s != nullptr) return s->bodies;
    }
    return scene_;
  }
  /// What the finder found in the last tick: contacts with their patches, or near samples.
  [[nodiscard]] const found_type& found() const noexcept { return found_; }
  /// Memory that the renderer takes, bytes: itself, its policies and all that they hold, whether a tick has used it or
  /// not. Its models belong to whoever else shares them: memory_bytes(scene()) counts them.
  /// A policy that has no heap_bytes() counts with its size alone.
  [[nodiscard]] std::size_t memory_bytes() const noexcept {
    const auto held = [](const auto& policy) noexcept -> std::size_t {
      if constexpr (reports_heap<std::remove_cvref_t<decltype(policy)>>) {
        return policy.heap_bytes();
      } else {
        return 0;
      }
    };
    return sizeof *this + heap_bytes(scene_.fixed, found_, readings_, by_body_, by_contact_, at_) + held(finder_) +
           held(depth_) + held(force_);
  }

  [[nodiscard]] Finder& finder() noexcept { return finder_; }
  [[nodiscard]] Depth& depth() noexcept { return depth_; }
  [[nodiscard]] Force& force() noexcept { return force_; }

 private:
  /// The poses of the last tick.
  struct kept_poses {
    pose T_wa{};
    std::vector<pose> T_wb;
    std::uint64_t version = 0;
    [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(T_wb); }
  };
  struct nothing {
    [[nodiscard]] std::size_t heap_bytes() const noexcept { return 0; }
  };

  [[nodiscard]] bool stands_still(const scene_pose& at) const noexcept {
    if constexpr (takes_scenes<Depth>) {
      return at.version != 0 && depth_.placed() != nullptr && depth_.placed()->version == at.version;
    } else {
      return false;
    }
  }

  // Of bodies that are where the scene has them nothing has to be asked.
  [[nodiscard]] bool has_valid_bodies(const scene_pose& at) const noexcept {
    if (!stands_still(at))
      return std::all_of(at.T_wb.begin(), at.T_wb.end(), [](const pose& T) { return is_valid(T); });
    return std::all_of(at.moved.begin(), at.moved.end(),
                       [&](std::uint32_t b) { return b < at.T_wb.size() && is_valid(at.T_wb[b]); });
  }

  // For planes_at().
  void keep(const scene_pose& at) noexcept {
    at_.T_wa = at.T_wa;
    if (stands_still(at) && at_.version == at.version) {
      for (const std::uint32_t b : at.moved) at_.T_wb[b] = at.T_wb[b];
      return;
    }
    std::copy(at.T_wb.begin(), at.T_wb.end(), at_.T_wb.begin());
    at_.version = at.version;
  }

  /// Most contacts that a force model reports.
  [[nodiscard]] static std::size_t reported_by(const limits_type& limits) noexcept {
    if constexpr (requires { limits.contacts; }) {
      return std::max(limits.contacts, reported_contacts::most);
    } else {
      return reported_contacts::most;
    }
  }

  asperity::scene scene_;
  [[no_unique_address]] Finder finder_;
  [[no_unique_address]] Depth depth_;
  [[no_unique_address]] Force force_;
  found_type found_;
  std::vector<reading_type> readings_;
  std::vector<wrench> by_body_, by_contact_;
  [[no_unique_address]] std::conditional_t<reports_planes_nearby<Depth>, kept_poses, nothing> at_;
  std::shared_ptr<const placed_type> placed_;
};

}  // namespace asperity
