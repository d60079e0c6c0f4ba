// The slower of the two rates: from the newest probe pose to a linear contact.
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "asperity/control/exchange.hpp"
#include "asperity/control/linearise.hpp"
#include "asperity/render/renderer.hpp"
#include "asperity/render/tick_flag.hpp"

namespace asperity {

/// Anything that turns poses into a tick; basic_renderer is one.
template <class R>
concept contact_renderer = requires(R& renderer, const scene_pose& at, tick& out) {
  { renderer.step(at, out) }
  noexcept->std::same_as<status>;
};

/// A renderer that can go on with another version of its scene; plane_renderer is one. take() returns the version that
/// it replaces; nothing is allocated or freed. placed() is null where the renderer was made for a scene that never
/// changes.
template <class R>
concept scene_taker = contact_renderer<R> &&
    requires(R& renderer, std::shared_ptr<const typename R::placed_type> next) {
  { renderer.take(std::move(next)) }
  noexcept->std::same_as<std::shared_ptr<const typename R::placed_type>>;
  { renderer.placed() }
  noexcept->std::same_as<const placed_scene*>;
};

namespace detail {

struct no_scenes {};
template <class R>
struct scenes_for {
  using type = no_scenes;
};
template <scene_taker R>
struct scenes_for<R> {
  using type = scene_hand_over<typename R::placed_type>;
};

}  // namespace detail

/// Where the bodies of a session are. The fixed bodies stay where they are put, but for those that an application moves
/// (exchange::bodies).
struct scene_placement {
  std::vector<pose> T_wb;      ///< one per fixed body
  vec3 centre_of_mass_a{0.0};  ///< c_A in the probe's body frame, metres (textured_model::mass)

  /// Pose of the probe's centre-of-mass frame c, which has the body's axes, in the body frame.
  [[nodiscard]] pose T_ac() const noexcept { return {quat(1.0, 0.0, 0.0, 0.0), centre_of_mass_a}; }
};

/// Owns the renderer. One tick takes the newest probe pose, renders, and publishes W0, J, the support planes, q0 and
/// the time of q0. A flag of a tick stays in the contacts of the next 50 ms.
///
/// Where the scene changes, a tick begins with the newest version of it that was handed over (scenes()). Its contact
/// tells the version and whose planes it has, so that the device loop has planes, laws and bodies of one version at any
/// time.
/// @tparam Renderer see contact_renderer
template <contact_renderer Renderer>
class contact_loop {
 public:
  /// @param shared outlives the loop
  /// @param selection which support planes are handed on; selection_for() knows what fits a period
  /// @param laws those that the device loop holds the probe by: where it will rest depends on them
  contact_loop(Renderer feel, scene_placement placement, exchange& shared, const plane_selection& selection = {},
               contact_laws laws = {})
      : renderer_(std::move(feel)),
        placement_(std::move(placement)),
        shared_(&shared),
        selection_(selection),
        rest_(std::move(laws)) {
    if constexpr (scene_taker<Renderer>) {
      if (const placed_scene* const s = renderer_.placed(); s != nullptr) {
        placement_.T_wb = s->T_wb;
        rest_.look_in(s->surfaces);
      }
    }
  }

  /// compute() and publish() in one.
  /// @return the renderer's answer; ok without work where no new pose came
  /// @rt as safe as the renderer
  [[nodiscard]] status tick(std::int64_t now_ns) noexcept {
    const status s = compute(now_ns);
    publish();
    return s;
  }

  /// Renders at the newest probe pose and keeps the result until publish(). Without a new pose there is nothing to do.
  /// Where the renderer cannot answer, the result is an empty contact that carries its status: the wrench goes to zero.
  [[nodiscard]] status compute(std::int64_t now_ns) noexcept {
    take_scene();
    if (!shared_->poses.refresh()) return status::ok;
    const timed_pose& at = shared_->poses.front();
    const pose T_wa = at.T_wc * inverse(placement_.T_ac());
    const placed_scene* const scene = placed();
    const body_places there = place_bodies(at.bodies, scene);
    scene_pose posed{T_wa, placement_.T_wb, at.gaps_m};
    if (scene != nullptr && moved_.dropped() == 0) {
      posed.version = scene->version;
      posed.moved = {moved_.data(), moved_.size()};
    }
    const status answer = renderer_.step(posed, last_);
    linear_contact& out = shared_->contacts.back();
    linearise(last_, answer, at, selection_, rest_, out);
    if (scene != nullptr) tell(*scene, there, out);
    if (out.reader != nullptr) tell_places(out);
    out.flags = flags_.held(out.flags, at.time_ns);
    pending_ = true;
    ++computed_;
    computed_at_ns_ = now_ns;
    return answer;
  }

  /// Hands the last result over, if it was not handed over yet.
  void publish() noexcept {
    if (!pending_) return;
    shared_->contacts.publish();
    pending_ = false;
  }

  [[nodiscard]] Renderer& renderer() noexcept { return renderer_; }
  /// What the last compute() found.
  [[nodiscard]] const asperity::tick& last() const noexcept { return last_; }
  /// How many poses were rendered.
  [[nodiscard]] std::uint64_t computed() const noexcept { return computed_; }
  [[nodiscard]] std::int64_t computed_at_ns() const noexcept { return computed_at_ns_; }
  /// Where the bodies were in the last compute().
  [[nodiscard]] const scene_placement& placement() const noexcept { return placement_; }
  /// The way by which versions of the scene come; see scene_editor::commit().
  [[nodiscard]] auto& scenes() noexcept requires scene_taker<Renderer> { return scenes_; }

 private:
  [[nodiscard]] const placed_scene* placed() const noexcept {
    if constexpr (scene_taker<Renderer>) {
      return renderer_.placed();
    } else {
      return nullptr;
    }
  }

  void take_scene() noexcept {
    if constexpr (scene_taker<Renderer>) {
      const placed_scene* const before = renderer_.placed();
      if (before == nullptr) return;
      const std::uint64_t version = before->version;
      // The device thread reads the bodies of its contact. Until it uses one of this version, the one before lives on.
      const bool may_be_read = shared_->poses.front().version < version;
      if (may_be_read || !scenes_.give_back()) return;
      if (!scenes_.take([&](auto next) noexcept { return renderer_.take(std::move(next)); })) return;
      const placed_scene& now = *renderer_.placed();
      std::size_t kept = 0;
      for (const std::uint32_t b : moved_) {
        if (now.since[b] <= version) moved_[kept++] = b;
      }
      moved_.truncate(kept);
      for (std::uint32_t b = 0; b < now.since.size(); ++b) {
        if (now.since[b] <= version) continue;
        placement_.T_wb[b] = now.T_wb[b];
        rest_.put(b, now.surfaces[b]);
      }
      rest_.look_in(now.surfaces);
    }
  }

  // Puts the bodies where the application has moved them, but for those that the scene does not have.
  // @return the bodies that were moved
  [[nodiscard]] body_places place_bodies(const body_places& told, const placed_scene* scene) noexcept {
    body_places out;
    for (const body_place& b : told) {
      if (b.body >= placement_.T_wb.size() || (scene != nullptr && !scene->has({b.body, b.generation}))) continue;
      placement_.T_wb[b.body] = b.T_wb;
      static_cast<void>(out.push_back(b));
      if (scene != nullptr && std::find(moved_.begin(), moved_.end(), b.body) == moved_.end()) {
        static_cast<void>(moved_.push_back(b.body));
      }
    }
    return out;
  }

  // Where the bodies of the planes are. Those that move have a generation, by which the device loop finds their way.
  void tell_places(linear_contact& out) const noexcept {
    for (const support_plane& p : out.planes) {
      const auto is_of = [&](const body_place& b) { return b.body == p.body; };
      if (std::any_of(out.places.begin(), out.places.end(), is_of)) continue;
      const auto moving = std::find_if(out.bodies.begin(), out.bodies.end(), is_of);
      static_cast<void>(out.places.push_back(
          moving != out.bodies.end() ? *moving : body_place{.body = p.body, .T_wb = placement_.T_wb[p.body]}));
    }
  }

  static void tell(const placed_scene& scene, const body_places& there, linear_contact& out) noexcept {
    out.version = scene.version;
    out.bodies = there;
    for (const support_plane& p : out.planes) {
      const bool known = std::any_of(out.of.begin(), out.of.end(), [&](const contact_body& b) {
        return b.body == p.body && b.of_probe == p.of_probe && b.of_body == p.of_body;
      });
      if (known) continue;
      const surface_pair* const mapped = scene.surfaces.find(p.body, p.of_probe, p.of_body);
      static_cast<void>(out.of.push_back({p.body, scene.since[p.body],
                                          mapped != nullptr ? std::optional(*mapped) : scene.surfaces[p.body],
                                          p.of_probe, p.of_body}));
    }
  }

  Renderer renderer_;
  scene_placement placement_;
  exchange* shared_;
  plane_selection selection_;
  rest_prediction rest_;
  held_flags flags_;
  asperity::tick last_{};
  bool pending_ = false;
  std::uint64_t computed_ = 0;
  std::int64_t computed_at_ns_ = 0;
  fixed_vector<std::uint32_t, 2 * most_moving_bodies> moved_;  // not where the scene has them
  [[no_unique_address]] typename detail::scenes_for<Renderer>::type scenes_;
};

}  // namespace asperity
