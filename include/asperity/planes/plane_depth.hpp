// How deep samples lie in the other body's field: one support plane for a few neighbouring samples.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "asperity/core/export.hpp"
#include "asperity/core/pose.hpp"
#include "asperity/field/field_scene.hpp"
#include "asperity/model/scene.hpp"
#include "asperity/planes/near_samples.hpp"
#include "asperity/render/depth_backend.hpp"
#include "asperity/render/plane_source.hpp"
#include "asperity/render/support_plane.hpp"
#include "asperity/render/tick_flag.hpp"

namespace asperity {

class plane_watch;
class first_met;
class known_branches;
class known_depths;
class leaf_reader;
class plane_materials;
class surface_reader;
class tick_team;
struct plane_scene;

/// Reads the field at every near sample and keeps the deepest of each leaf, with its slope, as a support plane. Edge
/// across edge needs nothing of its own: the samples along one edge lie in the field of the other's body.
///
/// The field's way out is the shortest one of the point, whatever body the point belongs to. Beside a sharp edge that
/// can be sideways, where the bodies would not slide apart. A sample therefore counts by a share that falls to nothing as
/// the way turns from where its own surface looks: the plane becomes softer and leaves without a step. Further in than
/// 3 % of the smallest body's diagonal every sample counts in full.
///
/// Surface that lies no further than a ninth of the reach, and a fifth of the gaps that are asked for, is reported in
/// full. Of what is further away, the planes are reported that a motion of up to five periods can meet first
/// (first_met): a patch that lies behind other surface after every such motion has none. Whether it does follows from
/// bounds of patches and leaves, so most samples are not read; what is reported has exact depths and slopes. What
/// earlier ticks know of samples spares readings as well and changes nothing: planes follow from the pose alone.
///
/// A body of a scene that changes may come into it (be added, exchanged or placed) where the probe is. Where it would be
/// deeper in the probe than what was in its slot before, by more than let_in_m, it stands back: its surface is felt that
/// much further in, so that it pushes as hard as what was there, and flags() tell it (tick_flag::stands_back). It comes
/// forward behind a probe that leaves it, as far away as gaps are told, so a change puts no more energy into the probe
/// than springs that are let_in_m deeper hold. Judged is the pose that the probe has two periods later if it goes on as
/// since the tick before, for so old a contact is when it is last used. A body that comes deeper than seven tenths of half its thickness, or the probe's, is not felt at all until the
/// probe has come out that far: half way through a body depths have no one direction, and planes of such depths gave a soft
/// hand 25 mJ.
///
/// Where a body has a map of materials, a plane tells of which its point is, on either body. Where what is pressed becomes
/// harder under the probe, as at a seam, it stands back too, and pushes no harder than before: see docs/how-to/materials.md.
///
/// A reading whose depth is -infinity stands for a leaf that has no plane.
class ASPERITY_API plane_depth {
 public:
  using policy_tag = depth_tag;
  using found_type = near_samples;
  using reading_type = near_plane;
  using placed_type = plane_scene;

  /// By this much deeper than what was in its slot a body comes into a scene as it is, m: 4 N of a plane of 200 N/mm.
  static constexpr double let_in_m = 2e-5;

  /// @param bodies   the scene's, in its order
  /// @param reach_m  gaps up to this are reported, m
  /// @param most     planes that a tick may report: near_sample_limits::readings()
  /// @param branches shared with the finder, which this teaches; or nullptr
  /// @param team     threads that share a tick's work; or nullptr
  plane_depth(std::shared_ptr<const field_scene> bodies, const scene& of, double reach_m, std::size_t most,
              std::shared_ptr<known_branches> branches = nullptr, std::shared_ptr<tick_team> team = nullptr);
  /// Of a scene that changes. @param first its first version
  plane_depth(const plane_scene& first, double reach_m, std::size_t most, std::shared_ptr<known_branches> branches,
              std::shared_ptr<tick_team> team = nullptr);
  plane_depth(plane_depth&&) noexcept;
  plane_depth& operator=(plane_depth&&) noexcept;
  ~plane_depth();

  /// Goes on with another version of the scene, which outlives its use here. @pre as many slots   @rt safe
  void take(const plane_scene& next) noexcept;
  /// The version of the scene; null where it never changes.
  [[nodiscard]] const placed_scene* placed() const noexcept;

  /// @return ok
  /// @rt safe
  [[nodiscard]] status measure(const scene_pose& at, const near_samples& found, std::span<near_plane> out) noexcept;

  /// The planes of the samples that are deeper than above_m at a pose near that of the last measure(), whether they had
  /// a plane there or not. Where there are more than `out` takes, the deepest. Of samples that may have been beyond the
  /// reach of measure(), since they have come so far, nothing is told.
  /// @param found, read of the last measure()   @param moved from its pose to this one, about c_A
  /// @return ok | capacity_reached
  /// @rt safe
  [[nodiscard]] status planes_at(const scene_pose& at, const near_samples& found, std::span<const near_plane> read,
                                 const vec6& moved, double above_m, plane_list& out) const noexcept;

  /// The planes of the last measure(), gaps included.
  [[nodiscard]] std::span<const support_plane> support_planes() const noexcept { return reported_; }
  /// Reads them again elsewhere. Lives as long as this, or the version of the scene that was taken.
  [[nodiscard]] const plane_reader* reader() const noexcept;
  /// How far the probe may move from there: by the reach, or as far as nothing is near.
  [[nodiscard]] known_motion known() const noexcept { return known_motion_; }
  /// What these planes do not answer.
  [[nodiscard]] tick_flag flags() const noexcept { return flags_; }
  /// What the last measure() cost.
  [[nodiscard]] const depth_work& work() const noexcept { return work_; }
  [[nodiscard]] const field_scene& bodies() const noexcept { return *bodies_; }
  [[nodiscard]] std::size_t heap_bytes() const noexcept;

 private:
  void reserve(std::size_t most);
  // What known bounds grow by: how far samples have gone since the tick before.
  void learn_ways(const scene_pose& at, const near_samples& found) noexcept;
  // How far the probe goes until a contact of this pose is in use, if it goes on as since the tick before.
  [[nodiscard]] vec6 way_ahead(const pose& T_wa) const noexcept;
  // Makes what was read of bodies that stand back less deep, and leaves out those that came too deep.
  // @param ahead how far the probe goes until the contact is in use
  void stand_back(const near_samples& found, const vec6& ahead, std::span<near_plane> out) noexcept;
  // The deepest first, roughly.
  void sort_by_depth(std::span<const near_patch> patches) noexcept;
  // How much deeper the samples of a patch can be than in the tick before, where the largest bound was most_m then.
  [[nodiscard]] double growth_m(const near_patch& patch, const leaf_reader& reader, double most_m) const noexcept;
  // Which gaps of a patch are told.
  struct told_from;
  [[nodiscard]] told_from told_of(const near_patch& patch) const noexcept;
  // The planes of a patch's leaves that can matter by what is known so far. From several threads, for patches of their
  // own.
  // @param alone no other patch is looked through at the same time   @return whether there is one
  bool look_through(const near_patch& patch, std::span<const near_leaf> leaves, const leaf_reader& reader, bool alone,
                    std::span<near_plane> out) const noexcept;
  // Leaves those of them that matter beside what earlier patches have.
  void keep_what_matters(const near_patch& patch, const leaf_reader& reader, std::span<near_plane> out) noexcept;
  // The patches' bounds, as sharp as this tick made them.
  void teach(const near_samples& found) noexcept;

  std::shared_ptr<const field_scene> bodies_;
  vec3 centre_of_mass_a_;
  double reach_m_;
  double told_m_;  // of the last measure(): no gap beyond this is told
  std::vector<support_plane> reported_;
  std::vector<std::uint32_t> order_;     // of patches
  std::vector<std::uint8_t> has_plane_;  // each patch, one at least
  // How the probe has moved from the tick before, seen from each body.
  struct way {
    pose T_ba{}, before_ba{}, before_ab{};
    double chord = 0.0;
    double shallow_m = 0.0;                 // so far in a sample counts by its share
    bool comes = false;                     // since the last tick ...
    double was_m = 0.0;                     // ... in the place of one that was so deep
    double back_m = 0.0;                    // its surface stands back by this
    bool away = false;                      // it came deeper than fields answer, and is not felt
    double deepest_m = 0.0, bound_m = 0.0;  // of its planes and patches, where bodies come or stand back
    double ahead_m = 0.0;                   // of its planes where the probe will be ...
    bool too_deep = false;                  // ... and whether that is deeper than fields answer
    double half_m = 0.0;                    // half its thickness
  };
  std::vector<way> ways_;
  const plane_scene* placed_ = nullptr;
  bool come_ = false;  // a body comes or stands back
  std::unique_ptr<plane_watch> watch_;
  std::unique_ptr<first_met> met_;
  std::unique_ptr<known_depths> known_;
  std::shared_ptr<known_branches> branches_;
  std::shared_ptr<tick_team> team_;
  mutable std::vector<plane_list> parts_;  // of planes_at(), of several threads
  std::unique_ptr<plane_materials> materials_;
  std::unique_ptr<surface_reader> reader_;  // of a scene that never changes
  std::unique_ptr<vec6> asked_at_;          // the last pose of planes_at(), from that of measure()
  double probe_half_m_ = 0.0;
  pose before_wa_{};         // of the last measure() ...
  bool went_ = false;        // ... where there was one
  double farthest_m_ = 0.0;  // of the probe's samples from its centre of mass
  known_motion known_motion_;
  depth_work work_;
  tick_flag flags_ = tick_flag::none;
};

static_assert(depth_backend<plane_depth>);
static_assert(reports_planes_nearby<plane_depth>);
static_assert(reports_plane_reader<plane_depth>);
static_assert(reports_known_motion<plane_depth>);
static_assert(reports_work<plane_depth>);

}  // namespace asperity
