// The support planes of the pose where the probe will come to rest: what planes of its present pose cannot know.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>

#include "asperity/control/contact_solver.hpp"
#include "asperity/control/linear_contact.hpp"
#include "asperity/control/virtual_coupling.hpp"
#include "asperity/core/export.hpp"
#include "asperity/core/fixed_vector.hpp"
#include "asperity/core/pose.hpp"
#include "asperity/core/spatial.hpp"
#include "asperity/render/plane_source.hpp"

namespace asperity {

/// Completes the planes of a contact by those of the pose where the probe will rest on them.
///
/// Planes are the surface to first order. A curved or textured surface meets the probe where none of them says so; told
/// a period later, the new plane pushes at once, the old one is not needed any more, and a resting probe trembles. So
/// the pose is sought where the coupling's springs and the true surface balance: the least energy of the springs and of
/// a spring behind every sample that is in overlap. From a pose that is known the planes there are balanced with the
/// springs; where the energy at the balance is less, the search goes on from it. Where it is not, the planes of the
/// balance that hold at the known pose as well are added (cutting planes: the surface is concave), and where none does
/// (the surface is convex: beyond the edge it falls away), the way is shortened.
///
/// The pose is kept for the next contact, whose search begins there unless the probe's own pose has less energy. So a
/// resting probe gets the same planes again, whatever it does meanwhile; begun anew at each pose, the search
/// went to another side of an edge from each, and the probe with it.
///
/// Of each sample a contact then tells the plane of that pose, in the place of one of the probe's own pose that says
/// the same there or more. Where the pose is further away than a tenth of a millimetre or 5 mrad, the planes of one so
/// far on the way to it are reported.
/// @source cutting planes: J. E. Kelley, The cutting-plane method for solving convex programs, 1960; steps that have to
/// lessen a merit: bundle methods, e.g. K. C. Kiwiel, Methods of descent for nondifferentiable optimization, 1985
class ASPERITY_API rest_prediction {
 public:
  /// @param laws those that hold the probe
  explicit rest_prediction(contact_laws laws = {}) noexcept : laws_(std::move(laws)) {}

  /// Forgets the pose of rest: the next search begins where the probe is.
  void forget() noexcept { known_ = false; }
  /// Another body is in a slot. @rt safe
  void put(std::uint32_t body, const std::optional<surface_pair>& pair) noexcept { laws_.put(body, pair); }
  /// Where pairs of maps of materials are from now on. @param now outlives its use here   @rt safe
  void look_in(const surface_pairs& now) noexcept { laws_.of_scene = &now; }

  /// @param pull of the coupling at T_wc; nothing is done where it is not known
  /// @param T_wc pose of c_A at which pull and planes were reported
  /// @param planes completed in place
  /// @rt safe: at most 9 questions to planes_near
  void complete(const plane_source& planes_near, const coupling_pull& pull, const pose& T_wc,
                support_planes& planes) noexcept;

 private:
  static constexpr double gap_m = 1e-5;     // planes that are further away than this change nothing at that pose
  static constexpr double agrees_m = 1e-7;  // of a spring of 200 N/mm: 20 mN
  static constexpr double kink_m = 1e-6;    // by less than this two planes of a point say the same

  /// A pose, as a motion from the probe's, and what is there.
  struct place {
    vec6 moved{};
    plane_list planes{};  // reported there, their depths too
    double energy_j = 0.0;
    double complete_to_m = -gap_m;  // every sample that is deeper has its plane here
  };

  // The known pose, and the one that is tried.
  [[nodiscard]] place& here() noexcept { return places_[here_]; }
  [[nodiscard]] const place& here() const noexcept { return places_[here_]; }
  [[nodiscard]] place& there() noexcept { return places_[1 - here_]; }

  [[nodiscard]] static double depth_at(const support_plane& reported_at_0, const vec6& moved) noexcept;

  [[nodiscard]] bool look(const plane_source& planes_near, const vec6& moved, place& out) noexcept;
  // Of the planes of the pose of rest as many as a contact is given: those that small motions meet first, and the deepest
  // beside them. The deepest of a plain face alone may all lie on one side of it, and would tip the probe over.
  // @return every sample that is deeper has its plane in `out`
  [[nodiscard]] double choose(support_planes& out) const noexcept;

  // Chooses where the search begins: at the pose of rest of the contact before, where it is close to the probe or has
  // less energy than the probe's own pose; otherwise at the probe's own pose.
  [[nodiscard]] bool begin(const plane_source& planes_near, bool known, const vec6& rest) noexcept;

  // The one of the planes that is of the point of p; null where none is.
  [[nodiscard]] static const support_plane* same_in(std::span<const support_plane> planes,
                                                    const support_plane& p) noexcept;

  // A plane that was reported at `from`, with the depth that it says for the probe's own pose.
  [[nodiscard]] static support_plane as_from_here(const support_plane& p, const vec6& from) noexcept;

  void search(const plane_source& planes_near) noexcept;

  // Makes the pose that was tried the known one. Planes so far that hold there too, and are not its own, become cuts.
  void go_there() noexcept;

  // Adds those planes of the pose that was tried which the known pose does not contradict, and whose points are
  // deeper than the planes so far say: they belong to a wall that was not known. Where the surface only bends, none
  // is added: a shorter way does better then, because two planes of one point push twice. @return whether one was
  // added
  [[nodiscard]] bool add_cuts() noexcept;

  bool keep(const support_plane& p) noexcept;

  // Goes back to a pose on the way where the pose of rest is far away, because planes of a pose far away would push the
  // probe through what lies between.
  [[nodiscard]] bool come_near(const plane_source& planes_near) noexcept;

  // Tells the planes of the pose of rest, and of the probe's own pose those that it does not replace. A plane of the
  // probe's own pose that says more at the pose of rest than is true would keep the probe from it; one that says less
  // would be a second spring on the same point.
  void report(support_planes& planes) noexcept;

  static constexpr std::size_t most_of_a_contact = 32, most_cuts = 12;
  static_assert(plane_list::capacity() + most_cuts <= most_balanced_planes);
  contact_laws laws_;
  bool known_ = false;
  pose rest_T_wc_{};
  coupling_pull pull_{};
  std::array<place, 2> places_{};
  std::size_t here_ = 0;   // the known one
  support_planes cuts_{};  // reported where the probe is
  fixed_vector<support_plane, most_balanced_planes> all_{};
};

}  // namespace asperity
