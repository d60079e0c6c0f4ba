#include "asperity/drivers/canopen/canopen_master.hpp"

#include <cstdint>

namespace asperity {

io_status canopen_master::step(std::int64_t now_ns, can_bus& bus) noexcept {
  const io_status synced = bus.send(now_ns, canopen::encode_sync());
  if (beaten_ && now_ns - beat_ns_ < settings_.heartbeat_every_ns) return synced;
  const io_status beat = bus.send(now_ns, canopen::encode_heartbeat(settings_.node, canopen::nmt_state::operational));
  if (beat == io_status::ok) {
    beaten_ = true;
    beat_ns_ = now_ns;
  }
  return synced == io_status::ok ? beat : synced;
}

void canopen_master::finish(std::int64_t now_ns, can_bus& bus) noexcept {
  beaten_ = false;
  if (!settings_.reset_when_finished) return;
  static_cast<void>(bus.send(now_ns, canopen::encode_nmt(canopen::nmt_command::reset_communication, 0)));
}

}  // namespace asperity
