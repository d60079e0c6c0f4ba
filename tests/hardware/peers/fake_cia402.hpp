// A motor drive that speaks CANopen: object dictionary, NMT, SDO, PDOs as they are mapped, heartbeats both ways, and
// the power states of CiA 402 in cyclic synchronous torque mode. Written from the drive's side of the documents, so
// that the driver is tested against another reading of them than its own.
#pragma once

#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "asperity/drivers/canopen/cia402.hpp"
#include "asperity/drivers/canopen/sdo.hpp"

namespace asperity::test_support {

struct fake_cia402_settings {
  std::uint8_t node = 1;
  std::uint32_t rated_torque_m_n_m = 400;
  std::uint32_t supported_modes = 0x3ad;  // many, with bit 9
  std::int64_t boot_ns = 8'000'000;
  std::int64_t switching_ns = 2'000'000;  // of each step up in the power states
  bool starts_in_fault = false;
};

/// One drive on a bus. Call step() often; everything else is for tests.
class fake_cia402 {
 public:
  fake_cia402(const fake_cia402_settings& settings, can_bus& bus) : settings_(settings), bus_(bus) {
    if (settings.starts_in_fault) power_ = canopen::power_state::fault;
    reset_objects();
  }

  void step(std::int64_t now_ns) {
    now_ns_ = now_ns;
    if (dead_) return;
    can_frame f;
    while (bus_.receive(now_ns, f) == io_status::ok) take(f);
    if (boots_at_ns_ && now_ns >= *boots_at_ns_) {
      boots_at_ns_.reset();
      nmt_ = canopen::nmt_state::pre_operational;
      send(canopen::encode_heartbeat(settings_.node, canopen::nmt_state::boot_up));
    }
    if (nmt_ == canopen::nmt_state::boot_up) return;
    const std::uint64_t beat_ms = value(0x1017, 0);
    if (beat_ms != 0 && !mute_heartbeat && now_ns - beat_ns_ >= static_cast<std::int64_t>(beat_ms) * 1'000'000) {
      beat_ns_ = now_ns;
      send(canopen::encode_heartbeat(settings_.node, nmt_));
    }
    watch_host();
    switch_power();
  }

  /// Torque of the motor in thousandths of the rated one. Nothing but operation enabled in mode 10 lets one through.
  [[nodiscard]] int torque_permille() const {
    const bool on = !dead_ && power_ == canopen::power_state::operation_enabled && mode_shown_ == 10;
    const int limit = static_cast<int>(value(0x6072, 0));
    return on ? std::max(-limit, std::min(limit, static_cast<int>(static_cast<std::int16_t>(value(0x6071, 0))))) : 0;
  }
  void set_motion(std::int32_t position, std::int32_t velocity) {
    objects_[key(0x6064, 0)].value = static_cast<std::uint32_t>(position);
    objects_[key(0x606c, 0)].value = static_cast<std::uint32_t>(velocity);
  }

  [[nodiscard]] canopen::power_state power() const { return power_; }
  [[nodiscard]] canopen::nmt_state nmt() const { return nmt_; }
  [[nodiscard]] std::uint64_t value(std::uint16_t index, std::uint8_t sub) const {
    const auto at = objects_.find(key(index, sub));
    return at == objects_.end() ? 0 : at->second.value;
  }
  [[nodiscard]] int fault_resets() const { return fault_resets_; }
  [[nodiscard]] int enables() const { return enables_; }
  [[nodiscard]] int largest_commanded_permille() const { return largest_; }
  [[nodiscard]] std::uint64_t syncs() const { return syncs_; }

  // What tests do to it.
  void trip(std::uint16_t code) { fault(code); }
  void die() { dead_ = true; }
  void restart() { reset(true); }
  void leave_operational() { nmt_ = canopen::nmt_state::stopped; }
  void set_mode_shown(std::int8_t mode) { mode_override_ = mode; }
  void drop_to(canopen::power_state p) { power_ = p; }
  void refuse(canopen::object_address at, std::uint32_t code) { refused_[key(at.index, at.sub)] = code; }
  void forget_object(std::uint16_t index, std::uint8_t sub) {
    missing_.insert(key(index, sub));
    objects_.erase(key(index, sub));
  }
  void ignore_object(std::uint16_t index, std::uint8_t sub) { ignored_.insert(key(index, sub)); }
  bool mute_heartbeat = false;
  bool mute_process_data = false;
  bool mute_sdo = false;
  bool mute_boot_up = false;
  bool holds_fault = false;     ///< a fault that cannot be reset
  bool sends_emergency = true;  ///< before a fault shows in the status word

 private:
  struct object {
    std::uint64_t value = 0;
    std::uint8_t size = 4;
    bool writable = true;
    bool mappable = false;
  };
  static std::uint32_t key(std::uint16_t index, std::uint8_t sub) { return (std::uint32_t{index} << 8) | sub; }

  void reset_objects() {
    objects_.clear();
    const auto add = [this](std::uint16_t index, std::uint8_t sub, std::uint64_t v, std::uint8_t size, bool writable,
                            bool mappable = false) {
      if (!missing_.contains(key(index, sub))) objects_[key(index, sub)] = {v, size, writable, mappable};
    };
    const std::uint32_t n = settings_.node;
    add(0x1016, 0, 1, 1, false);
    add(0x1016, 1, 0, 4, true);
    add(0x1017, 0, 0, 2, true);
    const std::uint32_t rpdo[] = {0x200, 0x300, 0x400, 0x500};
    const std::uint32_t tpdo[] = {0x180, 0x280, 0x380, 0x480};
    for (std::uint16_t i = 0; i < 4; ++i) {
      for (const int kind : {0, 1}) {
        const auto base = static_cast<std::uint16_t>((kind == 0 ? 0x1400 : 0x1800) + i);
        const auto map = static_cast<std::uint16_t>(base + 0x200);
        add(base, 1, (kind == 0 ? rpdo[i] : tpdo[i]) + n, 4, true);
        add(base, 2, 255, 1, true);
        add(map, 0, 1, 1, true);
        for (std::uint8_t sub = 1; sub <= 8; ++sub) add(map, sub, 0, 4, true);
        objects_[key(map, 1)].value = kind == 0 ? 0x60400010 : 0x60410010;  // as drives come from the factory
      }
    }
    add(0x6007, 0, 0, 2, true);
    add(0x6040, 0, 0, 2, true, true);
    add(0x6041, 0, 0, 2, false, true);
    add(0x6060, 0, 1, 1, true, true);
    add(0x6061, 0, 1, 1, false, true);
    add(0x6064, 0, 0, 4, false, true);
    add(0x606c, 0, 0, 4, false, true);
    add(0x6071, 0, 77, 2, true, true);  // left over from somebody else
    add(0x6072, 0, 1000, 2, true, true);
    add(0x6076, 0, settings_.rated_torque_m_n_m, 4, false);
    add(0x6077, 0, 0, 2, false, true);
    add(0x60b2, 0, 0, 2, true, true);
    add(0x6502, 0, settings_.supported_modes, 4, false);
  }

  void send(const can_frame& f) { static_cast<void>(bus_.send(now_ns_, f)); }

  void reset(bool power_as_well) {
    if (power_ == canopen::power_state::operation_enabled) power_ = canopen::power_state::fault;
    if (power_as_well) power_ = canopen::power_state::switch_on_disabled;
    const std::uint64_t position = value(0x6064, 0);
    const std::uint64_t velocity = value(0x606c, 0);
    reset_objects();
    objects_[key(0x6064, 0)].value = position;
    objects_[key(0x606c, 0)].value = velocity;
    nmt_ = canopen::nmt_state::boot_up;
    host_seen_ns_.reset();
    waiting_ = {};
    control_ = 0;
    if (!mute_boot_up) boots_at_ns_ = now_ns_ + settings_.boot_ns;
  }

  void fault(std::uint16_t code) {
    if (power_ == canopen::power_state::fault) return;
    power_ = canopen::power_state::fault;
    next_power_.reset();
    if (sends_emergency && nmt_ != canopen::nmt_state::boot_up) {
      send(canopen::encode_emergency(settings_.node, {code, 0x01}));
    }
  }

  void take(const can_frame& f) {
    if (const auto order = canopen::decode_nmt(f)) {
      if (order->node == 0 || order->node == settings_.node) obey(order->command);
      return;
    }
    if (nmt_ == canopen::nmt_state::boot_up) return;
    if (canopen::is_sync(f)) return sync();
    if (const auto request = canopen::decode_request(f, settings_.node)) {
      if (nmt_ != canopen::nmt_state::stopped && !mute_sdo) answer(*request);
      return;
    }
    const std::uint64_t watched = value(0x1016, 1);
    const auto host = static_cast<std::uint8_t>(watched >> 16);
    if (host != 0 && canopen::decode_heartbeat(f, host)) host_seen_ns_ = now_ns_;
    for (std::uint16_t i = 0; i < 4; ++i) {
      const std::uint64_t id = value(static_cast<std::uint16_t>(0x1400 + i), 1);
      if (nmt_ != canopen::nmt_state::operational || (id & 0x80000000) != 0 || f.id != (id & 0x7ff)) continue;
      waiting_[i] = f;
      if (value(static_cast<std::uint16_t>(0x1400 + i), 2) >= 254) apply(i);
    }
  }

  void obey(canopen::nmt_command c) {
    using enum canopen::nmt_command;
    const bool running = nmt_ != canopen::nmt_state::boot_up;
    if (c == start && running) nmt_ = canopen::nmt_state::operational;
    if (c == stop && running) nmt_ = canopen::nmt_state::stopped;
    if (c == pre_operational && running) nmt_ = canopen::nmt_state::pre_operational;
    if (c == reset_node) reset(true);
    if (c == reset_communication) reset(false);
  }

  void answer(const canopen::sdo_request& r) {
    const auto abort = [&](std::uint32_t code) { send(canopen::encode_abort(settings_.node, r.at, code)); };
    if (const auto no = refused_.find(key(r.at.index, r.at.sub)); no != refused_.end()) return abort(no->second);
    const auto at = objects_.find(key(r.at.index, r.at.sub));
    if (at == objects_.end()) return abort(canopen::abort_code::no_object);
    if (!r.write) {
      return send(
          canopen::encode_value(settings_.node, r.at, static_cast<std::uint32_t>(at->second.value), at->second.size));
    }
    if (!at->second.writable) return abort(canopen::abort_code::read_only);
    if (r.size != 0 && r.size != at->second.size) return abort(canopen::abort_code::wrong_length);
    if (const std::uint32_t bad = mapping_error(r)) return abort(bad);
    if (!ignored_.contains(at->first)) at->second.value = r.value;
    send(canopen::encode_written(settings_.node, r.at));
  }

  // CiA 301, 7.5.2.36: a mapping changes only while its PDO is off and empty.
  std::uint32_t mapping_error(const canopen::sdo_request& r) const {
    const bool rpdo = r.at.index >= 0x1600 && r.at.index < 0x1604;
    const bool tpdo = r.at.index >= 0x1a00 && r.at.index < 0x1a04;
    const bool communication =
        (r.at.index >= 0x1400 && r.at.index < 0x1404) || (r.at.index >= 0x1800 && r.at.index < 0x1804);
    if (communication && r.at.sub == 2 && (value(r.at.index, 1) & 0x80000000) == 0) {
      return canopen::abort_code::wrong_state;
    }
    if (!rpdo && !tpdo) return 0;
    const auto base = static_cast<std::uint16_t>(r.at.index - 0x200);
    if ((value(base, 1) & 0x80000000) == 0) return canopen::abort_code::unsupported;
    if (r.at.sub != 0) {
      if (value(r.at.index, 0) != 0) return canopen::abort_code::unsupported;
      const auto o = objects_.find(r.value >> 8);
      if (o == objects_.end() || !o->second.mappable || (r.value & 0xff) != o->second.size * 8U ||
          (rpdo && !o->second.writable)) {
        return canopen::abort_code::not_mappable;
      }
      return 0;
    }
    std::uint64_t bits = 0;
    for (std::uint8_t i = 1; i <= r.value; ++i) bits += value(r.at.index, i) & 0xff;
    return bits > 64 ? canopen::abort_code::mapping_too_long : 0;
  }

  void apply(std::uint16_t pdo) {
    if (!waiting_[pdo]) return;
    const can_frame f = *waiting_[pdo];
    waiting_[pdo].reset();
    const auto map = static_cast<std::uint16_t>(0x1600 + pdo);
    std::size_t length = 0;
    for (std::uint8_t i = 1; i <= value(map, 0); ++i) length += (value(map, i) & 0xff) / 8;
    if (f.size < length) {
      send(canopen::encode_emergency(settings_.node, {0x8210, 0x10}));
      return;
    }
    std::size_t at = 0;
    for (std::uint8_t i = 1; i <= value(map, 0); ++i) {
      const std::uint64_t entry = value(map, i);
      std::uint64_t v = 0;
      for (std::size_t k = 0; k < (entry & 0xff) / 8; ++k) v |= std::uint64_t{f.data[at++]} << (8 * k);
      objects_[static_cast<std::uint32_t>(entry >> 8)].value = v;
    }
    largest_ = std::max(largest_, std::abs(static_cast<int>(static_cast<std::int16_t>(value(0x6071, 0)))));
    const auto word = static_cast<std::uint16_t>(value(0x6040, 0));
    obey_control(word);
    control_ = word;
  }

  void sync() {
    ++syncs_;
    if (nmt_ != canopen::nmt_state::operational) return;
    for (std::uint16_t i = 0; i < 4; ++i) apply(i);
    mode_shown_ = mode_override_ ? *mode_override_ : static_cast<std::int8_t>(value(0x6060, 0));
    objects_[key(0x6041, 0)].value = status_word();
    objects_[key(0x6061, 0)].value = static_cast<std::uint8_t>(mode_shown_);
    objects_[key(0x6077, 0)].value = static_cast<std::uint16_t>(torque_permille());
    if (mute_process_data) return;
    for (std::uint16_t i = 0; i < 4; ++i) {
      const auto base = static_cast<std::uint16_t>(0x1800 + i);
      const std::uint64_t id = value(base, 1);
      if ((id & 0x80000000) != 0 || value(base, 2) != 1) continue;
      const auto map = static_cast<std::uint16_t>(base + 0x200);
      can_frame f = canopen::empty_frame(static_cast<std::uint32_t>(id & 0x7ff), 0);
      for (std::uint8_t k = 1; k <= value(map, 0); ++k) {
        const std::uint64_t entry = value(map, k);
        const std::uint64_t v = objects_[static_cast<std::uint32_t>(entry >> 8)].value;
        for (std::size_t b = 0; b < (entry & 0xff) / 8; ++b) f.data[f.size++] = static_cast<std::uint8_t>(v >> (8 * b));
      }
      send(f);
    }
  }

  [[nodiscard]] std::uint16_t status_word() const {
    using canopen::power_state;
    switch (power_) {
      case power_state::switch_on_disabled:
        return 0x0250;
      case power_state::ready_to_switch_on:
        return 0x0231;
      case power_state::switched_on:
        return 0x0233;
      case power_state::operation_enabled:
        return 0x0237;
      case power_state::quick_stop:
        return 0x0217;
      case power_state::fault_reaction:
        return 0x021f;
      case power_state::fault:
        return 0x0218;
      default:
        return 0x0210;
    }
  }

  void obey_control(std::uint16_t word) {
    using canopen::power_state;
    if (power_ == power_state::fault) {
      if ((word & 0x80) != 0 && (control_ & 0x80) == 0) {
        ++fault_resets_;
        if (!holds_fault) power_ = power_state::switch_on_disabled;
      }
      return;
    }
    const auto command = word & 0x0f;
    const auto later = [this](canopen::power_state to) {
      if (!next_power_) next_power_at_ns_ = now_ns_ + settings_.switching_ns;
      next_power_ = to;
    };
    if ((command & 0x02) == 0) {  // disable voltage
      next_power_.reset();
      power_ = power_state::switch_on_disabled;
    } else if ((command & 0x06) == 0x02) {  // quick stop; the motor of this drive stands at once
      next_power_.reset();
      power_ = power_state::switch_on_disabled;
    } else if ((command & 0x07) == 0x06) {  // shutdown
      next_power_.reset();
      power_ = power_state::ready_to_switch_on;
    } else if (command == 0x07) {
      if (power_ == power_state::ready_to_switch_on) later(power_state::switched_on);
      if (power_ == power_state::operation_enabled) power_ = power_state::switched_on;
    } else if (command == 0x0f) {
      if (power_ == power_state::switched_on) later(power_state::operation_enabled);
    }
  }

  void switch_power() {
    if (!next_power_ || now_ns_ < next_power_at_ns_) return;
    if (*next_power_ == canopen::power_state::operation_enabled) ++enables_;
    power_ = *next_power_;
    next_power_.reset();
  }

  void watch_host() {
    const std::uint64_t watched = value(0x1016, 1);
    const auto limit_ns = static_cast<std::int64_t>(watched & 0xffff) * 1'000'000;
    if (limit_ns == 0 || !host_seen_ns_ || now_ns_ - *host_seen_ns_ <= limit_ns) return;
    host_seen_ns_.reset();
    send(canopen::encode_emergency(settings_.node, {0x8130, 0x11}));
    if (value(0x6007, 0) != 0 || missing_.contains(key(0x6007, 0))) {
      power_ = canopen::power_state::fault;
      next_power_.reset();
    }
  }

  fake_cia402_settings settings_;
  can_bus& bus_;
  std::int64_t now_ns_ = 0;
  canopen::nmt_state nmt_ = canopen::nmt_state::pre_operational;
  canopen::power_state power_ = canopen::power_state::switch_on_disabled;
  std::optional<canopen::power_state> next_power_;
  std::int64_t next_power_at_ns_ = 0;
  std::map<std::uint32_t, object> objects_;
  std::map<std::uint32_t, std::uint32_t> refused_;
  std::set<std::uint32_t> missing_;
  std::set<std::uint32_t> ignored_;
  std::array<std::optional<can_frame>, 4> waiting_{};
  std::uint16_t control_ = 0;
  std::int8_t mode_shown_ = 0;
  std::optional<std::int8_t> mode_override_;
  std::optional<std::int64_t> boots_at_ns_;
  std::optional<std::int64_t> host_seen_ns_;
  std::int64_t beat_ns_ = 0;
  bool dead_ = false;
  int fault_resets_ = 0;
  int enables_ = 0;
  int largest_ = 0;
  std::uint64_t syncs_ = 0;
};

}  // namespace asperity::test_support
