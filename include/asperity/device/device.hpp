// The device concept: six degrees of freedom in, a wrench out.
//
// Contract of a device
// - capabilities() answers in every state and does not change after open().
// - open() finds the device, takes its handle, reads its limits and homes it where needed: state ready, output zero.
//   arm() allows output: state armed. Both are outside a tick and say in one sentence what is wrong. arm() fails in any
//   state but ready; nothing else ever arms: not a reconnection, not a cleared fault.
// - read(now) fills in the newest measurement that the device has at `now`. Where nothing new came, the sample is the
//   last one, unchanged (same sequence, same times), and the status is ok: how old is too old is the caller's decision.
//   Where the device cannot answer, the sample is untouched and the status says so.
// - write(now) takes the wrench on the hand in wrench_frame::device_base. Where the state does not allow output, zero
//   is put out. The device applies zero after valid_until_ns by itself where it can.
// - disarm() and close() put out zero, in every state, also when they fail. disarm() may be called in a tick.
// - read() and write() of a device that is gone, or not open, answer not_ready; where it is there and in a fault, or
//   could not answer, backend_failed.
// - Times are the session's clock, given by the caller, never decreasing. A device never reads a clock in read() or
//   write().
// - read, write and disarm do not allocate, lock, throw or print. They may enter the kernel where the transport needs
//   it.
// - One thread at a time. The destructor puts out zero and closes.
#pragma once

#include <concepts>
#include <cstdint>

#include "asperity/core/status.hpp"
#include "asperity/device/capabilities.hpp"
#include "asperity/device/device_state.hpp"
#include "asperity/device/sample.hpp"

namespace asperity {

/// Base of a device's `policy_tag`: naming it says "I keep the contract above", which a signature alone cannot.
struct device_tag {};

template <class D>
concept haptic_device = std::derived_from<typename D::policy_tag, device_tag> &&
    requires(D& dev, const D& view, std::int64_t now_ns, device_sample& in, const device_command& out) {
  { view.capabilities() }
  noexcept->std::same_as<const device_capabilities&>;
  { view.state() }
  noexcept->std::same_as<device_state>;
  { dev.open() } -> std::same_as<result<void>>;
  { dev.arm() } -> std::same_as<result<void>>;
  { dev.clear_fault() } -> std::same_as<result<void>>;
  { dev.disarm() }
  noexcept->std::same_as<status>;
  { dev.close() }
  noexcept;
  { dev.read(now_ns, in) }
  noexcept->std::same_as<status>;
  { dev.write(now_ns, out) }
  noexcept->std::same_as<status>;
};

}  // namespace asperity
