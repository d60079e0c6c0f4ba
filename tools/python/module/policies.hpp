// Policies that are written in Python, or compiled by a program in Python: a contact in place of a renderer's, and a hand.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "asperity/device/simulated/hand_lead.hpp"
#include "asperity/render/any_renderer.hpp"
#include "pybind.hpp"

namespace asperity::python {

/// What code of Python raised within a tick, where no exception may leave; the session ends with it.
struct raised_in_tick {
  std::optional<py::error_already_set> what;

  /// Keeps the exception that is being handled. @pre the GIL is held, called from a catch block
  void keep() noexcept;
  /// Raises it, once. @pre the GIL is held
  void rethrow();
};

/// Fills wrench and stiffness, which are zero before the call: force and torque on the probe about its centre of mass, and
/// their derivative by the probe's motion, row by row. Poses are x y z qx qy qz qw.
using contact_function = void (*)(const double* probe, const double* bodies, std::size_t count, double* wrench,
                                  double* stiffness);

/// A renderer with the bodies of another one, whose contact is told by `contact`: a callable (probe (7,), bodies (N, 7)) ->
/// wrench (6,), or (wrench, stiffness (6, 6)); or the address of a contact_function.
/// Raises TypeError for what is neither.
[[nodiscard]] any_renderer with_contact(any_renderer feel, const py::object& contact,
                                        std::shared_ptr<raised_in_tick> raised);

/// Leads a simulated hand before each device tick: `hand` is a callable (time_s, handle (7,)) -> pose (7,) of the probe.
/// @param to_device from the probe's wanted pose in the world to the handle's
[[nodiscard]] std::function<void(double time_s, const pose& T_wa)> led_by(const py::object& hand,
                                                                          std::shared_ptr<hand_lead> lead,
                                                                          std::function<pose(const pose&)> to_device,
                                                                          std::shared_ptr<raised_in_tick> raised);

}  // namespace asperity::python
