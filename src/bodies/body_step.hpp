// One implicit step of all bodies that are in touch: planes, bristles of friction, coupling, gravity.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "asperity/bodies/free_bodies.hpp"
#include "bodies/joint_solver.hpp"
#include "bodies/mover.hpp"
#include "bodies/touch_graph.hpp"

namespace asperity::detail {

/// The hand in one step: where it wants the probe, which is the first of the movers.
struct hand_pull {
  pose target_T_wc{};
  twist target_velocity_w{};
};

/// What stands is counted after the movers: body number movers.size() + i.
class body_step {
 public:
  /// Takes the memory.
  body_step(const free_bodies_settings& settings, const virtual_coupling& coupling, std::size_t movers,
            std::size_t standing, bool has_probe);

  /// Advances all that is awake by h_s seconds.
  /// @return ok | capacity_reached | not_finite (velocities are zero and nothing has moved)
  /// @rt safe
  [[nodiscard]] status step(double h_s, std::span<mover> movers, std::span<mover_contacts> contacts,
                            std::span<const vec3> standing_centres_w, const hand_pull& hand) noexcept;

  /// What contacts did to each body since begin(), times the seconds that they did it, about its centre of mass.
  [[nodiscard]] std::span<const wrench> impulses() const noexcept { return impulses_; }
  /// Calls visit(a, b) for bodies that pressed each other in the last step, or press while they sleep. @rt safe
  template <class Visit>
  void for_each_touch(Visit&& visit) const noexcept {
    for (std::size_t i = 0; i < planes_.size(); ++i) {
      if (planes_[i].lambda_n > 0.0) visit(bodies_[i].a, bodies_[i].b);
    }
  }
  void begin() noexcept;
  /// Adds to impulses() what bodies that sleep do to each other and to what stands, as they did in their last step.
  void add_sleepers(double dt_s, std::span<const mover> movers, std::span<const mover_contacts> contacts,
                    std::span<const vec3> standing_centres_w) noexcept;
  void forget(std::uint32_t mover) noexcept;  ///< its bristles
  void lose(double energy_j) noexcept { energy_.lost_j += energy_j; }
  [[nodiscard]] bool has_braked() const noexcept { return braked_; }
  [[nodiscard]] const bodies_energy& energy() const noexcept { return energy_; }
  [[nodiscard]] std::size_t heap_bytes() const noexcept;

 private:
  struct pair_of {
    std::uint32_t a = 0, b = 0;
  };
  struct of_friction {
    double at_rest = 0.0, slipping = 0.0;
  };
  struct bristle {
    pair_of of{};
    double static_coefficient = 0.0, dynamic_coefficient = 0.0;
    vec6 stretch{};
    double stored_j = 0.0, theta = 1.0;
    wrench on_a_w{};
    // Of the step that is being solved.
    mat6 metric{};
    vec6 held{};
    double normal_n = 0.0;
    vec3 arm_w{0.0};  // from b's centre of mass to a's, where b moves
    bool solved_for = false;
  };

  [[nodiscard]] bool is_mover(std::uint32_t body) const noexcept { return body < movers_; }
  [[nodiscard]] bool moves(std::span<const mover> movers, std::uint32_t body) const noexcept {
    return is_mover(body) && !movers[body].sleeps;
  }
  // The planes of all pairs that move, where the bodies are now. @return false where there were too many
  [[nodiscard]] bool gather(double h_s, std::span<const mover> movers,
                            std::span<const mover_contacts> contacts) noexcept;
  // Takes energy that came with planes which were told anew out of the motion.
  void calm(double h_s, std::span<const mover> movers, std::span<mover_contacts> contacts) noexcept;
  [[nodiscard]] pair_springs& springs_of(std::size_t plane, std::span<mover_contacts> contacts) const noexcept {
    mover_contacts& of = contacts[bodies_[plane].a];
    return of.springs[of.contact.planes[told_[plane]].body];
  }
  void order(std::span<const mover> movers) noexcept;
  // A wrench on a about its centre for some time, and its opposite on b.
  void feel(const pair_of& of, const wrench& impulse_on_a, std::span<const mover> movers,
            std::span<const vec3> standing_centres_w) noexcept;
  void turn_freely(double h_s, std::span<mover> movers) noexcept;
  void load(double h_s, std::span<const mover> movers, const hand_pull& hand) noexcept;
  [[nodiscard]] bool solve(double h_s, std::span<const mover> movers,
                           std::span<const mover_contacts> contacts) noexcept;
  [[nodiscard]] bool find_bristles(std::span<const mover> movers, std::span<const mover_contacts> contacts) noexcept;
  void measure(double h_s, std::span<const vec6> v, std::span<const mover_contacts> contacts) noexcept;
  // What the materials of a plane make of friction.
  [[nodiscard]] of_friction coefficients(std::size_t plane, std::span<const mover_contacts> contacts) const noexcept;
  [[nodiscard]] vec6 slide_of(const bristle& b, std::span<const vec6> v) const noexcept;
  // Bodies that would go further than is known get a brake. @return whether one did
  [[nodiscard]] bool brake(double h_s, std::span<const mover> movers) noexcept;
  void settle(double h_s, std::span<mover> movers, std::span<mover_contacts> contacts,
              std::span<const vec3> standing_centres_w) noexcept;

  free_bodies_settings settings_;
  virtual_coupling coupling_;
  std::size_t movers_;
  bool has_probe_;
  joint_solver solver_;
  std::vector<joint_plane> planes_;    // places instead of bodies
  std::vector<pair_of> bodies_;        // of each plane
  std::vector<support_plane> turned_;  // each plane where its bodies are now
  std::vector<std::uint32_t> told_;    // where each is among its mover's planes
  std::vector<double> calming_s_;      // of each plane: by so much its horizon is longer
  std::vector<bristle> bristles_;
  std::vector<joint_spring> springs_;
  std::vector<std::uint32_t> place_, at_place_;  // of each mover, and back
  touch_graph touches_;
  std::vector<mat6> inertia_, a_;  // by place
  std::vector<vec6> load_, v0_, v_;
  std::vector<double> brake_;  // by place, 1/s
  std::vector<wrench> impulses_;
  wrench coupled_{};  // at the beginning of the step
  bodies_energy energy_{};
  bool braked_ = false, left_out_ = false;
};

}  // namespace asperity::detail
