// What a renderer does with a GPU, for reports and errors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

namespace asperity::command {

/// Counts belong to the thread that ticks; others read them when it is done.
struct gpu_use {
  std::string device;            ///< as the driver names it; empty where none could be opened
  std::string version;           ///< of OpenGL
  bool software = false;         ///< drawn by the processor
  std::size_t device_bytes = 0;  ///< textures and buffers on the device
  std::string problem;           ///< why it was never used; empty where it was
  bool fallback = false;         ///< the CPU answers where the GPU does not
  std::uint64_t ticks = 0;       ///< that asked for depths
  std::uint64_t failed = 0;      ///< of those, without an answer
  std::uint64_t fallbacks = 0;   ///< of those, answered by the CPU
  /// Gives the context back, so that another thread can tick: a context belongs to one thread at a time.
  std::function<void()> leave_thread = [] {};
};

}  // namespace asperity::command
