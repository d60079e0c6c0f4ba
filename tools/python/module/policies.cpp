#include "policies.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <exception>
#include <utility>
#include <vector>

#include "arrays.hpp"

namespace asperity::python {
namespace {

// What a contact told, in a tick. @return whether all of it is finite
bool fill(const double* six, const double* thirty_six, tick& out) noexcept {
  out.force.on_probe_w = {{six[0], six[1], six[2]}, {six[3], six[4], six[5]}};
  for (std::size_t row = 0; row < 6; ++row) {
    for (std::size_t column = 0; column < 6; ++column) out.force.stiffness(row, column) = thirty_six[6 * row + column];
  }
  return is_finite(out.force.on_probe_w) && is_finite(out.force.stiffness);
}

// The bodies of a renderer, and the room that a tick's poses are handed on in.
class told_contact {
 public:
  explicit told_contact(any_renderer bodies)
      : bodies_(std::move(bodies)), T_wb_(7 * std::max<std::size_t>(1, bodies_.scene().fixed.size())) {}
  [[nodiscard]] const asperity::scene& scene() const noexcept { return bodies_.scene(); }
  [[nodiscard]] std::size_t memory_bytes() const noexcept { return bodies_.memory_bytes(); }

 protected:
  void begin(const scene_pose& at, tick& out) noexcept {
    out = {};
    out.centre_of_mass_w = centre_of_mass_w(scene(), at.T_wa);
    put(at.T_wa, T_wa_.data());
    for (std::size_t b = 0; b < at.T_wb.size(); ++b) put(at.T_wb[b], T_wb_.data() + 7 * b);
  }
  std::array<double, 7> T_wa_{};

 private:
  any_renderer bodies_;

 protected:
  std::vector<double> T_wb_;
};

class native_contact : public told_contact {
 public:
  native_contact(any_renderer bodies, contact_function call) : told_contact(std::move(bodies)), call_(call) {}
  [[nodiscard]] status step(const scene_pose& at, tick& out) noexcept {
    begin(at, out);
    std::array<double, 6> wrench{};
    std::array<double, 36> stiffness{};
    call_(T_wa_.data(), T_wb_.data(), at.T_wb.size(), wrench.data(), stiffness.data());
    return fill(wrench.data(), stiffness.data(), out) ? status::ok : status::not_finite;
  }

 private:
  contact_function call_;
};

class python_contact : public told_contact {
 public:
  python_contact(any_renderer bodies, py::object call, std::shared_ptr<raised_in_tick> raised)
      : told_contact(std::move(bodies)), call_(std::move(call)), raised_(std::move(raised)) {}

  [[nodiscard]] status step(const scene_pose& at, tick& out) noexcept {
    begin(at, out);
    if (raised_->what) return status::backend_failed;
    const py::gil_scoped_acquire gil;
    try {
      const auto count = static_cast<py::ssize_t>(at.T_wb.size());
      const py::object told = call_(py::array_t<double>({py::ssize_t{7}}, T_wa_.data()),
                                    py::array_t<double>({count, py::ssize_t{7}}, T_wb_.data()));
      const bool both = py::isinstance<py::tuple>(told);
      if (both && py::len(told) != 2) throw py::value_error("contact returns a wrench, or a pair (wrench, stiffness)");
      const doubles wrench = numbers_of(both ? py::object(told[py::int_(0)]) : told, "contact's wrench", {6},
                                        "force on the probe, N, and torque about its centre of mass, N m");
      constexpr std::array<double, 36> none{};
      doubles stiffness;
      if (both) {
        stiffness = numbers_of(told[py::int_(1)], "contact's stiffness", {6, 6},
                               "derivative of the wrench by the probe's motion, N/m and N m/rad");
      }
      if (!fill(wrench.data(), both ? stiffness.data() : none.data(), out)) {
        throw py::value_error("contact returned a number that is not finite");
      }
      return status::ok;
    } catch (...) {
      raised_->keep();
      out.force = {};
      return status::backend_failed;
    }
  }

 private:
  py::object call_;
  std::shared_ptr<raised_in_tick> raised_;
};

}  // namespace

void raised_in_tick::keep() noexcept {
  if (what) return;
  try {
    throw;
  } catch (py::error_already_set& raised) {
    what.emplace(std::move(raised));
  } catch (const py::builtin_exception& raised) {
    raised.set_error();
    what.emplace();
  } catch (const std::exception& raised) {
    PyErr_SetString(PyExc_RuntimeError, raised.what());
    what.emplace();
  }
}

void raised_in_tick::rethrow() {
  if (!what) return;
  py::error_already_set raised = std::move(*what);
  what.reset();
  throw raised;
}

any_renderer with_contact(any_renderer feel, const py::object& contact, std::shared_ptr<raised_in_tick> raised) {
  if (py::isinstance<py::int_>(contact)) {
    const auto address = contact.cast<std::uintptr_t>();
    if (address == 0) throw py::value_error("contact is the address 0: there is no function");
    return any_renderer(native_contact(std::move(feel), reinterpret_cast<contact_function>(address)));
  }
  if (!PyCallable_Check(contact.ptr())) {
    throw py::type_error("contact is a callable (probe, bodies) -> wrench, or the address of a compiled function");
  }
  return any_renderer(python_contact(std::move(feel), contact, std::move(raised)));
}

std::function<void(double, const pose&)> led_by(const py::object& hand, std::shared_ptr<hand_lead> lead,
                                                std::function<pose(const pose&)> to_device,
                                                std::shared_ptr<raised_in_tick> raised) {
  if (!PyCallable_Check(hand.ptr())) throw py::type_error("hand is a callable (time_s, probe) -> pose");
  return [hand, lead = std::move(lead), to_device = std::move(to_device), raised = std::move(raised)](
             double time_s, const pose& T_wa) {
    if (raised->what) return;
    const py::gil_scoped_acquire gil;
    try {
      lead->lead_to(to_device(pose_of(hand(time_s, to_array(T_wa)), "hand's pose")));
    } catch (...) {
      raised->keep();
    }
  };
}

}  // namespace asperity::python
