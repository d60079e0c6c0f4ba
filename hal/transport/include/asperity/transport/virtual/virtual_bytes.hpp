// A serial line within this process, with scripted faults.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "asperity/core/export.hpp"
#include "asperity/transport/byte_link.hpp"
#include "asperity/transport/link_script.hpp"

namespace asperity {

/// Bytes on their way, one direction. A line keeps their order: a late byte delays those sent after it.
/// All memory is taken at construction.
/// @rt safe after construction
class ASPERITY_API byte_queue {
 public:
  explicit byte_queue(std::size_t capacity) : entries_(std::max<std::size_t>(capacity, 1)) {}

  [[nodiscard]] std::size_t room() const noexcept { return entries_.size() - size_; }

  /// @return whether there was room
  bool push(std::uint8_t byte, std::int64_t due_ns) noexcept;

  /// What has arrived by now_ns, as much as fits. @return how many bytes
  std::size_t pop(std::int64_t now_ns, std::span<std::uint8_t> bytes) noexcept;

 private:
  struct entry {
    std::int64_t due_ns = 0;
    std::uint8_t byte = 0;
  };
  std::vector<entry> entries_;
  std::size_t first_ = 0;
  std::size_t size_ = 0;
};

/// The line: the host's end is a driver's byte_link, a fake peer reads and writes the far end. A fault of the script
/// applies to the bytes of one write() together, as to a frame; `from_device` faults are drawn when the peer
/// writes, for the host's next call. What a peer writes beyond the queue is lost and counted. bus_off means nothing
/// here.
/// @rt read() and write() are safe
class ASPERITY_API virtual_bytes {
 public:
  explicit virtual_bytes(link_script script = {}, std::size_t queue_bytes = 4096);
  virtual_bytes(const virtual_bytes&) = delete;
  virtual_bytes& operator=(const virtual_bytes&) = delete;
  [[nodiscard]] byte_link& host() noexcept { return host_; }
  [[nodiscard]] byte_link& device() noexcept { return device_; }
  /// Calls on the host's end so far, and the script it plays.
  [[nodiscard]] const link_player& player() const noexcept { return player_; }
  /// Bytes of the peer that found no room.
  [[nodiscard]] std::uint64_t lost() const noexcept { return lost_; }

 private:
  /// One direction: its queue, and the bytes of a reordered write, which go after the next.
  struct direction {
    explicit direction(std::size_t capacity) : queue(capacity), held(capacity) {}
    byte_queue queue;
    std::vector<std::uint8_t> held;
    std::size_t held_size = 0;
  };

  class host_end final : public byte_link {
   public:
    explicit host_end(virtual_bytes& line) noexcept : line_(line) {}
    [[nodiscard]] io_status read(std::int64_t now_ns, std::span<std::uint8_t> bytes,
                                 std::size_t& done) noexcept override;
    [[nodiscard]] io_status write(std::int64_t now_ns, std::span<const std::uint8_t> bytes,
                                  std::size_t& done) noexcept override;

   private:
    virtual_bytes& line_;
  };

  class device_end final : public byte_link {
   public:
    explicit device_end(virtual_bytes& line) noexcept : line_(line) {}
    [[nodiscard]] io_status read(std::int64_t now_ns, std::span<std::uint8_t> bytes,
                                 std::size_t& done) noexcept override;
    [[nodiscard]] io_status write(std::int64_t now_ns, std::span<const std::uint8_t> bytes,
                                  std::size_t& done) noexcept override;

   private:
    virtual_bytes& line_;
  };

  [[nodiscard]] io_status host_read(std::int64_t now_ns, std::span<std::uint8_t> bytes, std::size_t& done) noexcept;
  [[nodiscard]] io_status host_write(std::int64_t now_ns, std::span<const std::uint8_t> bytes,
                                     std::size_t& done) noexcept;

  // Counts the call. True where it ends here, with `answer`.
  [[nodiscard]] bool stopped(link_direction way, std::int64_t now_ns, io_status& answer) noexcept;

  // Plays the faults of one write. @return bytes that found no room
  std::size_t put(direction& to, link_direction way, std::uint64_t call, std::int64_t now_ns,
                  std::span<const std::uint8_t> bytes) noexcept;

  link_player player_;
  direction to_device_;
  direction from_device_;
  host_end host_;
  device_end device_;
  bool gone_ = false;
  std::uint64_t lost_ = 0;
};

}  // namespace asperity
