#include "device_recorder.hpp"

#include <utility>

namespace asperity::command {

result<std::unique_ptr<device_recorder>> device_recorder::create(const std::filesystem::path& file) {
  result<output_file> opened = output_file::create(file);
  if (!opened) return opened.error();
  return std::unique_ptr<device_recorder>(new device_recorder(std::move(opened).value()));
}

any_device device_recorder::around(any_device& device) {
  pending_ = encoder_.begin(device.capabilities(), device.state());
  return any_device(recorded_device<any_device>(device, ring_));
}

result<void> device_recorder::drain() {
  for (call_record call; ring_.pop(call);) pending_ += encoder_.call(call);
  // A whole block goes out at once: what a killed process leaves can be read up to it.
  if (encoder_.blocks() == written_blocks_) return {};
  written_blocks_ = encoder_.blocks();
  return file_.write(std::exchange(pending_, {}));
}

result<void> device_recorder::finish(recorded_end why, std::uint64_t ticks) {
  if (const result<void> written = drain(); !written) return written;
  if (ring_.lost() > 0) {
    return error{error_code::limit_exceeded,
                 "the device recording would lack " + std::to_string(ring_.lost()) +
                     " calls, which came faster than they could be written: nothing is kept; record to a faster disk"};
  }
  return file_.write(std::exchange(pending_, {}) + encoder_.end(why, ticks));
}

}  // namespace asperity::command
