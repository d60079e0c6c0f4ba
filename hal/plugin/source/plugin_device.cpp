#include "asperity/plugin/plugin_device.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "asperity/device/device_state.hpp"
#include "asperity/device/driver_conversion.hpp"
#include "asperity/device/gate_function.hpp"
#include "guarded_call.hpp"

namespace asperity::plugin {
namespace {

// Shortened to the limit, direction kept; the certificate of the gate's function stands behind it. What is at the limit
// but for rounding stays as it is: a command that passes two of these, one in each process, is that of one. @pre finite
vec3 within(const vec3& v, double limit) noexcept {
  const double l = std::min(limit, 1e6);
  if (glm::dot(v, v) <= l * l * (1.0 + 1e-12)) return v;
  return bound_vector(v, vec3(0.0), {.limit = l, .saturation = l, .max_change = std::numeric_limits<double>::max()},
                      true)
      .value;
}

}  // namespace

const char* to_string(plugin_fault f) noexcept {
  switch (f) {
    case plugin_fault::none:
      return "none";
    case plugin_fault::device_fault:
      return "the driver reports a fault";
    case plugin_fault::departed:
      return "the device left while it was armed";
    case plugin_fault::unknown_state:
      return "the driver reports a state that does not exist";
    case plugin_fault::unexpected_state:
      return "the driver reports a state that cannot follow the one before";
    case plugin_fault::armed_itself:
      return "the driver reports output that nobody armed";
    case plugin_fault::threw:
      return "the driver threw an exception across its C interface";
    case plugin_fault::bad_command:
      return "a command was not a finite wrench in the device's base frame";
  }
  return "unknown fault";
}

class plugin_device::body {
 public:
  body(std::shared_ptr<const driver_module> module, asperity_device* handle)
      : module_(std::move(module)), handle_(handle), machine_(device_state::present) {}
  body(const body&) = delete;
  body& operator=(const body&) = delete;
  ~body() {
    static_cast<void>(guarded_call([this] { return t().disarm(handle_); }));
    static_cast<void>(guarded_call([this] { t().close(handle_); }));
    static_cast<void>(guarded_call([this] { t().destroy(handle_); }));
  }

  [[nodiscard]] const device_capabilities& capabilities() const noexcept { return capabilities_; }
  [[nodiscard]] device_state state() const noexcept { return machine_.state(); }
  [[nodiscard]] plugin_fault fault() const noexcept { return fault_; }

  result<void> learn_capabilities() {
    auto c = abi::blank<asperity_capabilities>();
    const auto code = guarded_call([&] { return t().capabilities(handle_, &c); });
    if (code != ASPERITY_OK) return fail("does not say what its device can do");
    c.struct_size = sizeof c;
    if (const std::optional<std::string> problem = find_problem(c)) {
      return fail("states capabilities that cannot be: " + *problem);
    }
    raw_capabilities_ = c;
    capabilities_ = abi::from_abi(raw_capabilities_);
    return {};
  }

  result<void> open() {
    if (machine_.state() == device_state::absent || machine_.state() == device_state::closed) {
      machine_.apply(device_event::arrived);
    }
    if (machine_.state() != device_state::present) return refused("open");
    if (result<void> done = ask([this](char* e, std::uint32_t n) { return t().open(handle_, e, n); }); !done) {
      silence();
      machine_.apply(device_event::departed);
      return done;
    }
    if (reported() != device_state::ready) {
      const std::string state = reported_name();
      silence();
      return fail("reports the state " + state + " after open(), and should be ready");
    }
    if (result<void> known = learn_capabilities(); !known) {
      silence();
      return known;
    }
    machine_.apply(device_event::opened);
    machine_.apply(device_event::prepared);
    return {};
  }

  result<void> arm() {
    if (machine_.state() != device_state::ready) return refused("arm");
    if (result<void> done = ask([this](char* e, std::uint32_t n) { return t().arm(handle_, e, n); }); !done) {
      static_cast<void>(guarded_call([this] { return t().disarm(handle_); }));
      observe();
      return done;
    }
    if (reported() != device_state::armed) {
      const std::string state = reported_name();
      trip(plugin_fault::unexpected_state);
      return fail("reports the state " + state + " after arm(), and should be armed");
    }
    machine_.apply(device_event::armed);
    return {};
  }

  result<void> clear_fault() {
    if (machine_.state() != device_state::fault) return refused("clear_fault");
    if (reported() == device_state::fault) {
      if (result<void> done = ask([this](char* e, std::uint32_t n) { return t().clear_fault(handle_, e, n); }); !done) {
        return done;
      }
    } else {
      silence();
    }
    const std::optional<device_state> now = reported();
    if (now != device_state::closed && now != device_state::present && now != device_state::absent) {
      const std::string state = reported_name();
      silence();
      return fail("reports the state " + state + " after its fault was cleared, and should be closed");
    }
    fault_ = plugin_fault::none;
    machine_.apply(device_event::cleared);
    return {};
  }

  status disarm() noexcept {
    const std::int32_t code = guarded_call([this] { return t().disarm(handle_); });
    const bool was_armed = may_put_out(machine_.state());
    const bool applied = machine_.apply(device_event::disarmed);
    if (code == call_threw) trip(plugin_fault::threw);
    observe();
    if (machine_.state() == device_state::fault && was_armed) return status::backend_failed;
    if (!applied) return status::not_ready;
    return code == ASPERITY_OK ? status::ok : status::backend_failed;
  }

  void close() noexcept {
    silence();
    machine_.apply(device_event::closed);
  }

  status read(std::int64_t now_ns, device_sample& in) noexcept {
    if (!measures()) return status::not_ready;
    auto s = abi::blank<asperity_sample>();
    const std::int32_t code = guarded_call([&] { return t().read(handle_, now_ns, &s); });
    if (code == call_threw) trip(plugin_fault::threw);
    observe();
    if (!measures()) return status::backend_failed;
    if (code != ASPERITY_OK) return abi::to_status(code);
    device_sample sample = abi::from_abi(s);
    if (!capabilities_.has_gripper()) {  // a driver of 1.0 says nothing of one, whatever the bit
      sample.valid = without(sample.valid, sample_field::gripper);
      sample.gripper_m = 0.0;
    }
    if (!is_finite(sample.T_dh.position) || !is_finite(sample.velocity_d.linear) ||
        !is_finite(sample.velocity_d.angular) || !std::isfinite(sample.gripper_m)) {
      return status::not_finite;
    }
    if (!is_valid(sample.T_dh)) return status::invalid_pose;
    in = sample;
    return status::ok;
  }

  status write(std::int64_t now_ns, const device_command& out) noexcept {
    if (!measures()) return status::not_ready;
    const bool sound = out.frame == wrench_frame::device_base && is_finite(out.on_hand);
    const bool fresh = now_ns <= out.valid_until_ns;
    const bool allowed = may_put_out(machine_.state());

    device_command given{
        .frame = wrench_frame::device_base, .valid_until_ns = out.valid_until_ns, .sequence = out.sequence};
    if (allowed && sound && fresh) {
      given.on_hand = {within(out.on_hand.force, capabilities_.peak_force_n),
                       within(out.on_hand.torque, capabilities_.peak_torque_n_m)};
    } else {
      given.valid_until_ns = now_ns;
    }
    const asperity_command c = abi::to_abi(given);
    const std::int32_t code = guarded_call([&] { return t().write(handle_, now_ns, &c); });
    if (code == call_threw) trip(plugin_fault::threw);
    if (allowed) machine_.apply(is_zero(given.on_hand) ? device_event::released : device_event::engaged);
    if (allowed && !sound) trip(plugin_fault::bad_command);
    observe();
    if (allowed && !sound) return status::not_finite;
    if (!measures()) return status::backend_failed;
    if (code != ASPERITY_OK) return abi::to_status(code);
    return allowed && !fresh ? status::stale_input : status::ok;
  }

  [[nodiscard]] std::string fault_text() const {
    std::string out = to_string(fault_);
    if (fault_ != plugin_fault::device_fault || t().fault_text == nullptr) return out;
    char text[ASPERITY_TEXT_SIZE] = "";
    const std::int32_t code = guarded_call([&] { return t().fault_text(handle_, text, sizeof text); });
    return code == ASPERITY_OK ? out + ": " + driver_error(code, text) : out;
  }

 private:
  [[nodiscard]] const asperity_driver& t() const noexcept { return module_->table(); }

  [[nodiscard]] bool measures() const noexcept { return asperity::measures(machine_.state()); }

  [[nodiscard]] error fail(const std::string& what) const {
    return {error_code::bad_format, module_->where() + ": the driver " + t().name + " " + what};
  }
  [[nodiscard]] error refused(const char* what) const {
    return {error_code::invalid_argument, std::string(what) + "() is not possible while the device of the driver " +
                                              t().name + " is " + to_string(machine_.state())};
  }

  template <class Call>
  result<void> ask(Call&& call) {
    char text[ASPERITY_TEXT_SIZE] = "";
    const std::int32_t code = guarded_call([&] { return call(text, static_cast<std::uint32_t>(sizeof text)); });
    if (code == ASPERITY_OK) return {};
    if (code == call_threw) trip(plugin_fault::threw);
    return error{code == ASPERITY_INVALID ? error_code::invalid_argument : error_code::io_failed,
                 module_->where() + ": " + driver_error(code, text)};
  }

  [[nodiscard]] std::optional<device_state> reported() const noexcept {
    const std::int32_t code = guarded_call([this] { return t().state(handle_); });
    return abi::to_state(code);
  }
  [[nodiscard]] std::string reported_name() const {
    const std::optional<device_state> s = reported();
    return s ? to_string(*s) : "that does not exist";
  }

  // Output to zero, device given back, whatever the driver thinks of it.
  void silence() noexcept {
    static_cast<void>(guarded_call([this] { return t().disarm(handle_); }));
    static_cast<void>(guarded_call([this] { t().close(handle_); }));
  }

  // The first cause stays. In a state that knows no fault (nothing is held) the device is given back instead.
  void trip(plugin_fault why) noexcept {
    if (machine_.state() == device_state::fault) return;
    static_cast<void>(guarded_call([this] { return t().disarm(handle_); }));
    if (machine_.apply(device_event::failed)) fault_ = why;
  }

  // Holds what the driver reports against what the host knows.
  void observe() noexcept {
    const std::optional<device_state> now = reported();
    const device_state known = machine_.state();
    if (!now) {
      silence();
      trip(plugin_fault::unknown_state);
    } else if (may_put_out(*now) && !may_put_out(known)) {
      silence();
      trip(plugin_fault::armed_itself);
    } else if (!measures() || (may_put_out(*now) && may_put_out(known)) || *now == known) {
      return;
    } else if (*now == device_state::ready) {
      machine_.apply(device_event::disarmed);
    } else if (*now == device_state::fault) {
      trip(plugin_fault::device_fault);
    } else if (*now == device_state::absent) {
      if (may_put_out(known)) fault_ = plugin_fault::departed;
      machine_.apply(device_event::departed);
    } else {
      silence();
      trip(plugin_fault::unexpected_state);
    }
  }

  std::shared_ptr<const driver_module> module_;
  asperity_device* handle_;
  device_state_machine machine_;
  asperity_capabilities raw_capabilities_{};
  device_capabilities capabilities_{};
  plugin_fault fault_ = plugin_fault::none;
};

plugin_device::plugin_device(std::unique_ptr<body> b) noexcept : body_(std::move(b)) {}
plugin_device::plugin_device(plugin_device&&) noexcept = default;
plugin_device& plugin_device::operator=(plugin_device&&) noexcept = default;
plugin_device::~plugin_device() = default;

result<plugin_device> plugin_device::adopt(std::shared_ptr<const driver_module> module, asperity_device* handle) {
  auto b = std::make_unique<body>(std::move(module), handle);
  if (result<void> known = b->learn_capabilities(); !known) return known.error();
  return plugin_device(std::move(b));
}

const device_capabilities& plugin_device::capabilities() const noexcept { return body_->capabilities(); }
device_state plugin_device::state() const noexcept { return body_->state(); }
result<void> plugin_device::open() { return body_->open(); }
result<void> plugin_device::arm() { return body_->arm(); }
result<void> plugin_device::clear_fault() { return body_->clear_fault(); }
status plugin_device::disarm() noexcept { return body_->disarm(); }
void plugin_device::close() noexcept { body_->close(); }
status plugin_device::read(std::int64_t now_ns, device_sample& in) noexcept { return body_->read(now_ns, in); }
status plugin_device::write(std::int64_t now_ns, const device_command& out) noexcept {
  return body_->write(now_ns, out);
}
plugin_fault plugin_device::fault() const noexcept { return body_->fault(); }
std::string plugin_device::fault_text() const { return body_->fault_text(); }

}  // namespace asperity::plugin
